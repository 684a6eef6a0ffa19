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
#include "support/scene_text.h"
#include <stdlib.h>
#include <string.h>

static const char everything[] =
    "LookAt 0 2.5 -8  0 .8 0  0 1 0\n"
    "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" .05 \"float focaldistance\" 8\n"
    "Film \"rgb\" \"integer xresolution\" 50 \"integer yresolution\" 38\n"
    "Sampler \"zsobol\" \"integer pixelsamples\" 4\n"
    "PixelFilter \"mitchell\"\n"
    "Integrator \"volpath\" \"integer maxdepth\" 8 \"bool regularize\" true\n"
    "WorldBegin\n"
    "MakeNamedMedium \"mist\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [.02 .02 .03] \"rgb sigma_a\" "
    "[.01 .01 .01]\n"
    "MakeNamedMedium \"juice\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 .3 .2] \"rgb sigma_a\" [.1 "
    "1 "
    "2] \"float g\" .6\n"
    "LightSource \"infinite\" \"string filename\" \"sky.exr\"\n"
    "LightSource \"spot\" \"point3 from\" [-3 5 -3] \"point3 to\" [0 0 0] \"blackbody I\" 4000 \"float "
    "power\" "
    "200\n"
    "LightSource \"goniometric\" \"rgb I\" [2 2 3] \"string filename\" \"sky.exr\"\n"
    "LightSource \"projection\" \"string filename\" \"sky.exr\" \"float scale\" 5\n"
    "Texture \"noise\" \"float\" \"fbm\" Texture \"bumps\" \"float\" \"scale\" \"texture tex\" \"noise\" "
    "\"float "
    "scale\" .05\n"
    "Texture \"picture\" \"spectrum\" \"imagemap\" \"string filename\" \"sky.exr\" \"string filter\" "
    "\"ewa\"\n"
    "Texture \"board\" \"spectrum\" \"checkerboard\" \"float uscale\" 20 \"float vscale\" 20 \"texture "
    "tex1\" "
    "\"picture\" \"rgb tex2\" [.1 .1 .2]\n"
    "Texture \"marble\" \"spectrum\" \"marble\"\n"
    "Texture \"leaf\" \"float\" \"dots\" \"float inside\" .2 \"float outside\" 1 \"float uscale\" 9 \"float "
    "vscale\" 9\n"
    "Material \"diffuse\" \"texture reflectance\" \"board\"\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-9 0 -9  9 0 -9  -9 0 9  9 0 9]\n"
    "AttributeBegin Translate 0 4 0 AreaLightSource \"diffuse\" \"rgb L\" [4 4 3] \"bool twosided\" true\n"
    "Shape \"sphere\" \"float radius\" .3 Translate 1 0 0 Shape \"disk\" \"float radius\" .4 AttributeEnd\n"
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [2 3 4] Shape \"trianglemesh\" \"point3 P\" [-3 3 "
    "3 -2 3 "
    "3 -3 4 3 -2 4 3] \"integer indices\" [0 2 1 1 2 3] AttributeEnd\n"
    "AttributeBegin Translate -2.4 1 0 Material \"dielectric\" \"spectrum eta\" \"glass-F11\" \"float "
    "roughness\" "
    ".01 Shape \"sphere\" AttributeEnd\n"
    "AttributeBegin Translate 0 1 0 MediumInterface \"juice\" \"\" Material \"dielectric\" \"float eta\" "
    "1.33 "
    "Rotate -90 1 0 0 Shape \"cylinder\" \"float radius\" .7 \"bool closed\" true AttributeEnd\n"
    "AttributeBegin Translate 2.4 1 0 Material \"coatedconductor\" \"float thickness\" .2 \"rgb albedo\" [.5 "
    ".5 .5] "
    "\"texture displacement\" \"bumps\" Shape \"sphere\" AttributeEnd\n"
    "AttributeBegin Translate 0 1 2.5 MediumInterface \"mist\" \"\" Material \"interface\" Shape \"box\" "
    "\"point3 "
    "min\" [-4 -1 -1] \"point3 max\" [4 2 1] AttributeEnd\n"
    "AttributeBegin Translate -1.2 .4 -2 Material \"coateddiffuse\" \"texture reflectance\" \"marble\" "
    "\"float "
    "roughness\" .1 SolidBegin \"difference\" Shape \"box\" \"point3 min\" [-.4 -.4 -.4] \"point3 max\" [.4 "
    ".4 .4] "
    "Shape \"sphere\" \"float radius\" .5 SolidEnd AttributeEnd\n"
    "ObjectBegin \"leaf\" Material \"diffusetransmission\" \"rgb reflectance\" [.2 .4 .1] \"rgb "
    "transmittance\" [.1 "
    ".3 .1] Shape \"disk\" \"float radius\" .5 \"texture alpha\" \"leaf\" Material \"conductor\" \"float "
    "uroughness\" "
    ".1 \"float vroughness\" .3 Shape \"torus\" \"float majorradius\" .5 \"float minorradius\" .1 ObjectEnd\n"
    "AttributeBegin Translate 1.2 .7 -2 Rotate 30 0 1 0 ObjectInstance \"leaf\" Translate .3 .3 .5 Scale -.7 "
    "1 1 "
    "ObjectInstance \"leaf\" AttributeEnd\n"
    "MakeNamedMaterial \"a\" \"string type\" \"thindielectric\" MakeNamedMaterial \"b\" \"string type\" "
    "\"diffuse\"\n"
    "AttributeBegin Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .4 Translate 0 2.6 "
    "-1 Shape "
    "\"disk\" \"float radius\" .6 AttributeEnd\n";

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
    sag_image image = {0};
    assert_int_equal(sag_image_create(scene_context, 8, 8, 3, &image, NULL), SAG_OK);
    for (size_t i = 0; i < 8 * 8 * 3; i++) image.pixels[i] = (float)((i * 37) % 11) / 10;
    assert_int_equal(sag_image_write(scene_context, &image, scene_path("sky.exr"), NULL), SAG_OK);
    sag_image_clear(scene_context, &image);
    scene_write("everything.pbrt", everything, strlen(everything));
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
    for (sag_integrator_kind kind = SAG_INTEGRATOR_PATH; kind <= SAG_INTEGRATOR_VOLPATH; kind++)
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
