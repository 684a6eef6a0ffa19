// SPDX-License-Identifier: MIT
// Ambient occlusion against what it must be: under an endless ceiling at height h, of which only the part
// within the distance R counts, the directions θ with cos θ > h/R are blocked: (h/R)² is left.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "support/picture.h"

#include <math.h>

static void distance_counts(void **state) {
    (void)state;
    for (int uniform = 0; uniform < 2; uniform++)
        for (int veiled = 0; veiled < 2; veiled++)
            for (double reach = 0; reach < 6; reach += 1.5) {
                studio s = studio_open(1);
                s.settings->integrator = SAG_INTEGRATOR_AO;
                s.settings->occlusion_uniform = uniform;
                s.settings->occlusion_distance = reach;
                s.settings->samples_per_pixel = 32;
                studio_aim_point(&s, (sag_vec3){3, 1, 0}, (sag_vec3){0, 0, 0});
                sag_add_box(s.scene, &(sag_box){{-99, -1, -99}, {99, 0, 99}});
                sag_add_box(s.scene, &(sag_box){{-999, 2, -999}, {999, 3, 999}});
                if (veiled) { // rays that go on behind it go on as far as they would have gone
                    const uint32_t nothing =
                        studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
                    const uint32_t veil = sag_add_box(s.scene, &(sag_box){{-9, 0.5, -9}, {0.5, 1, 9}});
                    sag_world_set_appearance(s.world, s.scene, veil, &(sag_appearance){.material = nothing});
                }
                const studio_mean m = studio_measure(&s);
                const double truth = reach == 0 ? 0 : reach <= 2 ? 1 : 4 / (reach * reach);
                assert_true(fabs(m.mean - truth) < 5 * m.deviation + (reach == 0 ? 1e-3
                                                                      : uniform  ? 0.02
                                                                                 : 1e-9));
                studio_close(&s);
            }
}

// The true normal counts, not the shading normal: a facet that looks round is as open as it is flat.
static void the_surface_counts(void **state) {
    (void)state;
    studio s = studio_open(1);
    s.settings->integrator = SAG_INTEGRATOR_AO;
    static const double corners[] = {-9, 0, -9, 9, 0, -9, 0, 0, 9};
    static const float normals[] = {-1, 0.2F, 0, 1, 0.2F, 0, 0, 0.2F, 1};
    static const uint32_t faces[] = {0, 2, 1};
    sag_add_mesh(s.scene, &(sag_mesh){.positions_f64 = corners,
                                      .normals_f32 = normals,
                                      .triangles = faces,
                                      .vertex_count = 3,
                                      .triangle_count = 1});
    studio_aim_point(&s, (sag_vec3){1, 5, 0}, (sag_vec3){1, 0, 0});
    const studio_mean m = studio_measure(&s);
    assert_true(m.least == 1 && m.most == 1);
    studio_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(distance_counts),
                                       cmocka_unit_test(the_surface_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
