// SPDX-License-Identifier: MIT
// The tree of lights: probabilities sum to 1 and are those of the choices it makes; no light that reaches a
// point is left out; nearer and brighter lamps are chosen; it stands any number of lights, anywhere.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/light_tree.h"
#include "support/failing_allocator.h"
#include "support/random.h"

#define PI 3.14159265358979323846

static sag_context *context;
static int setup(void **state) {
    (void)state;
    context = sag_context_create(&(sag_context_options){.thread_count = 1});
    return context == NULL;
}
static int teardown(void **state) {
    (void)state;
    sag_context_destroy(context);
    return 0;
}

// A lamp of any kind within the cube of that size around `at`.
static sagi_light_bounds random_light(rng *r, sag_vec3 at, double size) {
    const sag_vec3 p = sag_add(at, rng_vec3(r, size));
    sagi_light_bounds light = {
        .box = {p, p}, .axis = rng_direction(r), .cos_normals = -1, .intensity = rng_log_uniform(r, 1e-4, 1)};
    switch (rng_below(r, 4)) {
    case 0: break; // a point
    case 1:        // a beam
        light.cos_normals = cos(rng_uniform(r, 0.05, PI));
        light.cos_spread = 0.999;
        break;
    default: { // a flat piece, or a bent one
        const sag_vec3 half = sag_scale(sag_abs(rng_vec3(r, size)), rng_log_uniform(r, 1e-3, 1));
        light.box = (sag_box3){sag_sub(p, half), sag_add(p, half)};
        light.cos_normals = rng_one_in(r, 2) ? 1 : rng_uniform(r, -1, 1);
        light.two_sided = rng_one_in(r, 3);
    }
    }
    return light;
}

static sagi_light_view random_view(rng *r, sag_vec3 at, double size) {
    sagi_light_view view = {.position = sag_add(at, rng_vec3(r, 2 * size))};
    if (!rng_one_in(r, 5)) view.normal = rng_direction(r), view.front_only = rng_one_in(r, 2);
    return view;
}

// Whether the light may shine from a point of its box to the view; conservative the other way round than the
// tree: only what is certain.
static bool surely_shines(rng *r, const sagi_light_bounds *light, const sagi_light_view *view) {
    sag_vec3 p = light->box.min;
    const sag_vec3 size = sag_sub(light->box.max, light->box.min);
    p = sag_add(p, sag_mul(size, sag_vec3_make(rng_unit(r), rng_unit(r), rng_unit(r))));
    const sag_vec3 d = sag_normalize(sag_sub(view->position, p));
    if (view->front_only && !(sag_dot(view->normal, d) < -1e-3)) return false;
    double cosine = sag_dot(light->axis, d);
    if (light->two_sided) cosine = fabs(cosine);
    const double angle = acos(fmin(1, cosine)) - acos(light->cos_normals);
    return angle < acos(light->cos_spread) - 1e-3;
}

static void check_tree(rng *r, uint32_t count, sag_vec3 at, double size) {
    sagi_light_bounds *lights = calloc(count, sizeof *lights);
    sagi_light_tree tree;
    for (uint32_t i = 0; i < count; i++) {
        lights[i] = random_light(r, at, size);
        if (rng_one_in(r, 10)) lights[i].intensity = 0;
    }
    assert_true(sagi_light_tree_init(&tree, context, lights, count));
    for (int k = 0; k < 30; k++) {
        const sagi_light_view view = random_view(r, at, size);
        double sum = 0;
        for (uint32_t i = 0; i < count; i++) {
            const double p = sagi_light_tree_probability(&tree, &view, i);
            assert_true(p >= 0 && p <= 1);
            if (!(lights[i].intensity > 0)) assert_true(p == 0);
            // A single light needs no weighing.
            else if (surely_shines(r, &lights[i], &view))
                assert_true(p > 0);
            sum += p;
        }
        bool found = false;
        for (int j = 0; j < 50; j++) {
            const double random = j == 0 ? 0 : j == 1 ? 0x1.fffffffffffffp-1 : rng_unit(r);
            double u = random, p;
            uint32_t light;
            found = sagi_light_tree_sample(&tree, &view, &u, &light, &p);
            if (!found) break;
            assert_true(u >= 0 && u < 1 && light < count);
            assert_true(p > 0 && p == sagi_light_tree_probability(&tree, &view, light));
        }
        // What reaches no light at a lower level is lost to a choice above: never more than 1.
        assert_true(sum <= 1 + 1e-6);
        if (!found) assert_true(sum < 1);
    }
    sagi_light_tree_clear(&tree, context);
    free(lights);
}

static void probabilities_are_those_of_the_choices(void **state) {
    (void)state;
    rng r = rng_make(1);
    const uint32_t counts[] = {1, 2, 3, 4, 5, 17, 100, 1000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (int k = 0; k < 5; k++) {
            const double size = rng_log_uniform(&r, 1e-9, 1e9);
            check_tree(&r, counts[i], rng_vec3(&r, size * rng_log_uniform(&r, 1e-3, 1e4)), size);
        }
}

static void choices_are_as_frequent_as_probable(void **state) {
    (void)state;
    enum { COUNT = 40, SAMPLES = 200000 };
    rng r = rng_make(2);
    sagi_light_bounds lights[COUNT];
    for (int i = 0; i < COUNT; i++) {
        lights[i] = random_light(&r, sag_vec3_make(0, 0, 0), 1);
        lights[i].cos_normals = -1; // every lamp reaches everywhere
    }
    sagi_light_tree tree;
    assert_true(sagi_light_tree_init(&tree, context, lights, COUNT));
    for (int k = 0; k < 3; k++) {
        sagi_light_view view = random_view(&r, sag_vec3_make(0, 0, 0), 1);
        view.front_only = false;
        uint32_t counts[COUNT] = {0};
        double mean_u = 0, sum = 0, chi = 0;
        for (int i = 0; i < SAMPLES; i++) {
            double u = rng_unit(&r), p;
            uint32_t light;
            assert_true(sagi_light_tree_sample(&tree, &view, &u, &light, &p));
            counts[light]++;
            mean_u += u / SAMPLES;
        }
        for (uint32_t i = 0; i < COUNT; i++) {
            const double p = sagi_light_tree_probability(&tree, &view, i), expected = p * SAMPLES;
            sum += p;
            chi += (counts[i] - expected) * (counts[i] - expected) / expected;
        }
        assert_true(fabs(sum - 1) < 1e-6);
        assert_true(fabs(mean_u - 0.5) < 5 * sqrt(1 / 12.0 / SAMPLES)); // what is left is uniform again
        assert_true((chi - (COUNT - 1)) / sqrt(2.0 * (COUNT - 1)) < 5);
    }
    sagi_light_tree_clear(&tree, context);
}

// Lamps in a long row: the one overhead is chosen far more often than by its share; what is behind is not.
static void near_lamps_are_chosen(void **state) {
    (void)state;
    enum { COUNT = 1024 };
    sagi_light_bounds lights[COUNT];
    for (int i = 0; i < COUNT; i++)
        lights[i] = (sagi_light_bounds){.box = {{i, 1, 0}, {i + 0.1, 1, 0.1}},
                                        .axis = {0, i % 2 ? 1 : -1, 0},
                                        .cos_normals = 1,
                                        .intensity = 1};
    sagi_light_tree tree;
    assert_true(sagi_light_tree_init(&tree, context, lights, COUNT));
    const sagi_light_view view = {.position = {500, 0, 0}, .normal = {0, 1, 0}, .front_only = true};
    double near = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        const double p = sagi_light_tree_probability(&tree, &view, i);
        if (i % 2 && i > 300 && i < 700) assert_true(p == 0); // it looks up
        if (i >= 496 && i <= 504) near += p;
    }
    assert_true(near > 0.5);
    const sagi_light_view above = {.position = {500, 2, 0}, .normal = {0, 1, 0}, .front_only = true};
    double u = 0.5, p;
    uint32_t light;
    assert_false(sagi_light_tree_sample(&tree, &above, &u, &light, &p));
    sagi_light_tree_clear(&tree, context);
}

// Each lamp as far again as the one before: splits take one off at a time, and the tree is not deep.
static void no_tree_is_too_deep(void **state) {
    (void)state;
    enum { COUNT = 900 };
    static sagi_light_bounds lights[COUNT];
    for (int i = 0; i < COUNT; i++) {
        const sag_vec3 p = {ldexp(1, i - COUNT / 2), 0, 0};
        lights[i] = (sagi_light_bounds){.box = {p, p},
                                        .axis = {0, 0, 1},
                                        .cos_normals = -1,
                                        .intensity = ldexp(1, i % 2 ? i / 2 : -i / 2)};
    }
    sagi_light_tree tree;
    assert_true(sagi_light_tree_init(&tree, context, lights, COUNT));
    const sagi_light_view view = {.position = {1, 1, 0}};
    for (uint32_t i = 0; i < COUNT; i++) {
        assert_true(tree.trails[i] >> 56 == 0);
        (void)sagi_light_tree_probability(&tree, &view, i);
    }
    sagi_light_tree_clear(&tree, context);
}

static void memory_may_run_out(void **state) {
    (void)state;
    for (size_t k = 0;; k++) {
        failing_allocator f = {.fail_at = k};
        sag_context *c = sag_context_create(
            &(sag_context_options){.thread_count = 1, .allocator = failing_allocator_make(&f)});
        bool done = false;
        if (c) {
            rng r = rng_make(4);
            sagi_light_bounds lights[200];
            for (int i = 0; i < 200; i++) lights[i] = random_light(&r, sag_vec3_make(0, 0, 0), 1);
            sagi_light_tree tree;
            done = sagi_light_tree_init(&tree, c, lights, 200);
            sagi_light_tree_clear(&tree, c);
        }
        sag_context_destroy(c);
        failing_allocator_assert_empty(&f);
        if (done) break;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probabilities_are_those_of_the_choices),
        cmocka_unit_test(choices_are_as_frequent_as_probable),
        cmocka_unit_test(near_lamps_are_chosen),
        cmocka_unit_test(no_tree_is_too_deep),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
