// SPDX-License-Identifier: MIT
// The same picture, and the same layers beside it, to the bit: whatever the threads and the instruction set,
// for every integrator and every sampler, in a scene that has something of everything.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "base/cpu.h"
#include "support/scene_files.h"
#include "support/scene_text.h"
#include <stdlib.h>
#include <string.h>

// A context of its own for each way, with the scene in it.
typedef struct way {
    const char *isa; // NULL: the best
    uint32_t threads;
    sag_context *context;
    sag_world *world;
} way;

static way ways[] = {{.threads = 1},
                     {.threads = 2},
                     {.threads = 7},
                     {.isa = "portable", .threads = 2},
                     {.isa = "sse42", .threads = 2},
                     {.isa = "avx2", .threads = 2},
                     {.isa = "avx512", .threads = 2},
                     {.isa = "neon", .threads = 2}};
enum { WAYS = sizeof ways / sizeof *ways };

static int setup(void **state) {
    if (scene_setup(state) != 0) return 1;
    scene_copy_files();
    for (int i = 0; i < WAYS; i++) {
        sagi_isa isa;
        way *w = &ways[i];
        if (w->isa && !sagi_isa_choose(w->isa, &isa)) continue;
        if (w->isa) assert_int_equal(setenv("SAG_ISA", w->isa, 1), 0);
        w->context = sag_context_create(&(sag_context_options){.thread_count = w->threads});
        assert_int_equal(unsetenv("SAG_ISA"), 0);
        if (w->isa) assert_string_equal(sag_context_isa(w->context), w->isa);
        w->world = sag_world_create(w->context);
        sag_error error;
        if (sag_world_load(w->world, scene_path("everything.pbrt"), &error) != SAG_OK)
            fail_msg("%d:%d: %s", error.line, error.column, error.message);
        sag_world_settings(w->world)->film.layers = SAG_LAYER_ALL;
    }
    return 0;
}

static int teardown(void **state) {
    for (int i = 0; i < WAYS; i++) {
        sag_world_destroy(ways[i].world);
        if (ways[i].context) sag_context_destroy(ways[i].context);
    }
    return scene_teardown(state);
}

static sag_layers shoot(const way *w, sag_integrator_kind integrator, sag_sampler_kind sampler,
                        sag_render_stats *stats) {
    sag_settings *settings = sag_world_settings(w->world);
    settings->integrator = integrator;
    settings->sampler = sampler;
    sag_error error;
    sag_layers layers;
    sag_render *render = sag_render_create(w->world, &error);
    assert_non_null(render);
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_layers(render, &layers, &error), SAG_OK);
    sag_render_get_stats(render, stats);
    sag_render_destroy(render);
    return layers;
}

static void compare(sag_integrator_kind integrator, sag_sampler_kind sampler) {
    sag_render_stats expected, stats;
    sag_layers first = shoot(&ways[0], integrator, sampler, &expected);
    const size_t count = (size_t)first.width * first.height * first.channel_count;
    assert_true(first.channel_count > 20);
    assert_int_equal(expected.bad_samples, 0);
    for (int i = 1; i < WAYS; i++) {
        if (!ways[i].world) continue;
        sag_layers other = shoot(&ways[i], integrator, sampler, &stats);
        assert_int_equal(other.channel_count, first.channel_count);
        assert_true(stats.rays == expected.rays);
        for (size_t k = 0; k < count; k++)
            if (memcmp(&first.pixels[k], &other.pixels[k], sizeof(float)) != 0)
                fail_msg("integrator %d, sampler %d, %s, %u threads: %s is %.9g, not %.9g", integrator,
                         sampler, ways[i].isa ? ways[i].isa : "best", ways[i].threads,
                         first.names[k % first.channel_count], (double)other.pixels[k],
                         (double)first.pixels[k]);
        sag_layers_clear(ways[i].context, &other);
    }
    sag_layers_clear(ways[0].context, &first);
}

static void integrators(void **state) {
    (void)state;
    for (sag_integrator_kind kind = SAG_INTEGRATOR_PATH; kind <= SAG_INTEGRATOR_LIGHTPATH; kind++)
        compare(kind, SAG_SAMPLER_ZSOBOL);
}

static void samplers(void **state) {
    (void)state;
    for (sag_sampler_kind kind = SAG_SAMPLER_INDEPENDENT; kind <= SAG_SAMPLER_HALTON; kind++)
        compare(SAG_INTEGRATOR_VOLPATH, kind);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(integrators), cmocka_unit_test(samplers)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
