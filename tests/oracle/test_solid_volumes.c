// SPDX-License-Identifier: MIT
// Volumes and areas of solids with known formulas by random lines. Of lines that are spread uniformly over
// all directions, and for each over the disc of the ball of radius R around the solid, one has on average a
// length of V/(πR²) within the solid and meets its boundary S/(2πR²) times (Cauchy and Crofton).
//
// The lines are the points of a rank-1 sequence in four dimensions (steps by powers of the root of x⁵ = x +
// 1; M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), which fill the space more
// evenly than random ones; each of 32 independent random shifts gives an unbiased answer, and the spread of
// the 32 says how far their mean may be off. A result fails at 5 σ; and 5 σ must be below 1 %, so that an
// error of that size would not pass.
#include "support/context.h"
#include "support/known_solids.h"
#include "support/random.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#define PI     3.14159265358979323846
#define SHIFTS 32
#define LINES  8192 // of each shift

typedef struct estimate {
    double sum, squares;
} estimate;

static void add(estimate *e, double x) { e->sum += x, e->squares += x * x; }
static double mean(const estimate *e) { return e->sum / SHIFTS; }
static double deviation(const estimate *e) {
    double m = mean(e), variance = (e->squares / SHIFTS - m * m) / (SHIFTS - 1);
    return sqrt(fmax(variance, 0));
}

// A line through the ball by four numbers in [0, 1): its direction by height and longitude, its place in the
// disc by area and angle.
static sag_ray line(const double u[4], double reach) {
    double z = 2 * u[0] - 1, rho = sqrt(fmax(1 - z * z, 0)), phi = 2 * PI * u[1];
    sag_vec3 d = {rho * cos(phi), rho * sin(phi), z}, s, t;
    sag_frame(d, &s, &t);
    double radius = reach * sqrt(u[2]), angle = 2 * PI * u[3];
    sag_vec3 o = sag_madd(sag_scale(s, radius * cos(angle)), radius * sin(angle), t);
    sag_ray ray = sag_ray_make(sag_madd(o, -2 * reach, d), d);
    return ray;
}

// The length in the solid by its boundaries; *count becomes their number.
static double length_within(const sag_scene *scene, const sag_ray *ray, size_t *count) {
    sag_hit hits[64];
    *count = sag_intersect_all(scene, ray, hits, 64);
    assert_true(*count <= 64 && *count % 2 == 0);
    double sum = 0;
    for (size_t i = 0; i < *count; i += 2) sum += hits[i + 1].t - hits[i].t;
    return sum;
}

static void check_solid(const known_solid *known, size_t lines, uint64_t seed) {
    rng r = rng_make(seed);
    sag_scene *solid = known->make(context), *scene = sag_scene_create(context);
    sag_affine here = sag_affine_identity();
    sag_add_instance(scene, solid, &here);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    double phi = 2;
    for (int i = 0; i < 60; i++) phi = pow(1 + phi, 0.2); // x⁵ = x + 1
    const double step[4] = {1 / phi, pow(phi, -2), pow(phi, -3), pow(phi, -4)};
    const double disc = PI * known->reach * known->reach;
    estimate volume = {0, 0}, area = {0, 0};
    for (int k = 0; k < SHIFTS; k++) {
        double u[4], length = 0, crossings = 0;
        for (int i = 0; i < 4; i++) u[i] = rng_unit(&r);
        for (size_t n = 0; n < lines; n++) {
            for (int i = 0; i < 4; i++) u[i] += step[i], u[i] -= floor(u[i]);
            sag_ray ray = line(u, known->reach);
            size_t count;
            length += length_within(scene, &ray, &count), crossings += (double)count;
        }
        add(&volume, length / (double)lines * disc), add(&area, 2 * crossings / (double)lines * disc);
    }
    double v = mean(&volume), sv = deviation(&volume), a = mean(&area), sa = deviation(&area);
    print_message("%-36s volume %9.6f is %9.6f (%+5.2f sigma of %.3f %%)", known->name, known->volume, v,
                  (v - known->volume) / sv, 100 * sv / v);
    if (known->area > 0)
        print_message("  area %9.5f is %9.5f (%+5.2f sigma of %.3f %%)", known->area, a,
                      (a - known->area) / sa, 100 * sa / a);
    print_message("\n");
    assert_true(fabs(v - known->volume) < 5 * sv);
    if (known->area > 0) assert_true(fabs(a - known->area) < 5 * sa);
    if (lines >= LINES) assert_true(5 * sv < 0.01 * v && (known->area <= 0 || 5 * sa < 0.01 * a));
    sag_scene_destroy(scene), sag_scene_destroy(solid);
}

static void volumes_and_areas(void **state) {
    (void)state;
    known_solid list[64];
    size_t count = known_solids(list, 64);
    assert_true(count >= 30 && count <= 64);
    for (size_t i = 0; i < count; i++) check_solid(&list[i], soak(LINES), 700 + i);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(volumes_and_areas)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
