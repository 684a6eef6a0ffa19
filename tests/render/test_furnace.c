// SPDX-License-Identifier: MIT
// The furnace: where everything sends out what it does not reflect, everything has the same brightness, and
// nothing can be told from anything. One wrong normal, density, weight or lost ray shows. Every shape,
// diffuse (with emission), mirror, and, when it is closed, glass.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
// clang-format on
#include "support/picture.h"

typedef struct subject {
    const char *name;
    sag_shape_kind kind;
    const void *shape;
    bool closed;
} subject;

static const sag_vec3 polygon_points[] = {{-1, -1, 0}, {1, -1, 0.0}, {0, 0, 0}, {1, 1, 0}, {-1, 1, 0}};
static const uint32_t polygon_loops[] = {5};
static const sag_half_space prism[] = {{{1, 0, 0}, 1},  {{-1, 0, 0}, 1},      {{0, 1, 0.2}, 1},
                                       {{0, -1, 0}, 1}, {{0.1, 0.2, 1}, 0.9}, {{0, 0, -1}, 1}};
static const float octahedron[] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
static const uint32_t octahedron_faces[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                            2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
static const float centers[] = {-0.8f, 0, 0, 0.8f, 0, 0, 0, 0.9f, 0.3f};

static const subject subjects[] = {
    {"plane", SAG_SHAPE_PLANE, &(const sag_plane){.normal = {0.3, 0.2, 1}}, false},
    {"disk", SAG_SHAPE_DISK, &(const sag_disk){.normal = {0.3, 0.2, 1}, .radius = 1.2, .inner_radius = 0.2},
     false},
    {"rectangle", SAG_SHAPE_RECTANGLE,
     &(const sag_rectangle){.corner = {-1, -1, 0}, .edge_u = {2, 0, 0.5}, .edge_v = {0.3, 2, 0}}, false},
    {"polygon", SAG_SHAPE_POLYGON,
     &(const sag_polygon){
         .positions = polygon_points, .position_count = 5, .loop_sizes = polygon_loops, .loop_count = 1},
     false},
    {"sphere", SAG_SHAPE_SPHERE, &(const sag_sphere){.radius = 1}, true},
    {"ellipsoid", SAG_SHAPE_ELLIPSOID, &(const sag_ellipsoid){.radii = {1, 0.6, 1.3}}, true},
    {"partial sphere", SAG_SHAPE_SPHERE,
     &(const sag_sphere){.radius = 1, .z_min = -0.6, .z_max = 0.8, .phi_max_rad = 4}, false},
    {"cylinder", SAG_SHAPE_CYLINDER, &(const sag_cylinder){.radius = 0.7, .z_min = -0.8, .z_max = 0.9},
     false},
    {"closed cylinder", SAG_SHAPE_CYLINDER,
     &(const sag_cylinder){.radius = 0.7, .z_min = -0.8, .z_max = 0.9, .closed = true}, true},
    {"cone", SAG_SHAPE_CONE, &(const sag_cone){.radius = 0.9, .height = 1.2}, false},
    {"closed cone", SAG_SHAPE_CONE, &(const sag_cone){.radius = 0.9, .height = 1.2, .closed = true}, true},
    {"paraboloid", SAG_SHAPE_PARABOLOID, &(const sag_paraboloid){.radius = 0.9, .z_max = 1.2}, false},
    {"closed paraboloid", SAG_SHAPE_PARABOLOID,
     &(const sag_paraboloid){.radius = 0.9, .z_max = 1.2, .closed = true}, true},
    {"hyperboloid", SAG_SHAPE_HYPERBOLOID,
     &(const sag_hyperboloid){.p1 = {0.9, 0, -0.8}, .p2 = {0, 0.9, 0.9}}, false},
    {"closed hyperboloid", SAG_SHAPE_HYPERBOLOID,
     &(const sag_hyperboloid){.p1 = {0.9, 0, -0.8}, .p2 = {0, 0.9, 0.9}, .closed = true}, true},
    {"hyperboloid of two sheets", SAG_SHAPE_HYPERBOLOID2,
     &(const sag_hyperboloid2){.a = 0.6, .c = 0.4, .z_min = -1.2, .z_max = 1.2}, false},
    {"quadric", SAG_SHAPE_QUADRIC,
     &(const sag_quadric){.coefficients = {1, 1.5, 0.7, 0.1, 0, -0.2, 0, 0, 0, -1},
                          .clip = {{-2, -2, -2}, {2, 2, 2}}},
     true},
    {"box", SAG_SHAPE_BOX, &(const sag_box){.min = {-1, -0.7, -0.5}, .max = {0.9, 0.8, 0.7}}, true},
    {"oriented box", SAG_SHAPE_ORIENTED_BOX,
     &(const sag_oriented_box){.half_axes = {{0.8, 0.3, 0}, {-0.3, 0.8, 0.1}, {0.1, -0.1, 1}}}, true},
    {"polyhedron", SAG_SHAPE_POLYHEDRON, &(const sag_polyhedron){.planes = prism, .plane_count = 6}, true},
    {"capsule", SAG_SHAPE_CAPSULE,
     &(const sag_capsule){.p0 = {-0.8, -0.3, 0}, .p1 = {0.7, 0.4, 0.5}, .radius = 0.5}, true},
    {"triangle", SAG_SHAPE_TRIANGLE,
     &(const sag_triangle){.a = {-1, -1, 0}, .b = {1, -1, 0.2}, .c = {0, 1, 0}}, false},
    {"bilinear patch", SAG_SHAPE_BILINEAR_PATCH,
     &(const sag_bilinear_patch){
         .p00 = {-1, -1, 0}, .p10 = {1, -1, 0.5}, .p01 = {-1, 1, 0.5}, .p11 = {1, 1, 0}},
     false},
    {"torus", SAG_SHAPE_TORUS, &(const sag_torus){.major_radius = 0.8, .minor_radius = 0.3}, true},
    {"spheres", SAG_SHAPE_SPHERES, &(const sag_spheres){.centers_f32 = centers, .radius = 0.45, .count = 3},
     true},
    {"mesh", SAG_SHAPE_MESH,
     &(const sag_mesh){
         .positions_f32 = octahedron, .triangles = octahedron_faces, .vertex_count = 6, .triangle_count = 8},
     true},
};
#define SUBJECT_COUNT (sizeof subjects / sizeof *subjects)

// The subject, turned so that it is seen from the side, in light of radiance 1 from everywhere.
static studio furnace(const subject *it, sag_appearance look) {
    studio s = studio_open(0);
    s.settings->film.width = s.settings->film.height = 24;
    assert_int_not_equal(
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}}), 0);
    uint32_t id = sag_add_shape(s.scene, it->kind, it->shape);
    sag_vec3 axis = {1, 0.4, 0.2};
    sag_affine turn = sag_affine_rotate(-1, axis);
    assert_int_equal(sag_geometry_set_transform(s.scene, id, &turn), SAG_OK);
    assert_int_equal(sag_world_set_appearance(s.world, s.scene, id, &look), SAG_OK);
    return s;
}

static void diffuse_and_shining(void **state) {
    (void)state;
    for (size_t i = 0; i < SUBJECT_COUNT; i++) {
        for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
            sag_appearance look = {.emission = {0.5, 0.5, 0.5},
                                   .two_sided = true}; // the default look reflects half
            studio s = furnace(&subjects[i], look);
            s.settings->strategy = (sag_strategy)strategy;
            s.settings->samples_per_pixel = 8;
            studio_mean m = studio_measure(&s);
            if (!(fabs(m.mean - 1) < 5 * m.deviation + 1e-6))
                print_message("%s: %g +- %g\n", subjects[i].name, m.mean, m.deviation);
            assert_true(fabs(m.mean - 1) < 5 * m.deviation + 1e-6);
            assert_true(m.deviation < 0.01);
            studio_close(&s);
        }
    }
}

static void mirrors(void **state) {
    (void)state;
    for (size_t i = 0; i < SUBJECT_COUNT; i++) {
        studio s = furnace(&subjects[i], (sag_appearance){.material = 0});
        uint32_t mirror = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_CONDUCTOR,
                                                             .eta.value = {1, 1, 1},
                                                             .k.value = {1e8, 1e8, 1e8}});
        sag_world_set_appearance(s.world, s.scene, 0, &(sag_appearance){.material = mirror});
        studio_mean m = studio_measure(&s);
        if (!(m.least > 1 - 1e-6 && m.most < 1 + 1e-6))
            print_message("%s: %g to %g\n", subjects[i].name, m.least, m.most);
        assert_true(m.least > 1 - 1e-6 && m.most < 1 + 1e-6);
        studio_close(&s);
    }
}

static void glass(void **state) {
    (void)state;
    for (size_t i = 0; i < SUBJECT_COUNT; i++) {
        if (!subjects[i].closed) continue;
        studio s = furnace(&subjects[i], (sag_appearance){.material = 0});
        uint32_t id =
            studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}});
        sag_world_set_appearance(s.world, s.scene, 0, &(sag_appearance){.material = id});
        s.settings->max_depth = 1000;
        studio_mean m = studio_measure(&s);
        // Light may be caught inside for longer than any path; none is made.
        if (!(m.mean > 1 - 1e-3 && m.most < 1 + 1e-6))
            print_message("%s: %g, %g to %g\n", subjects[i].name, m.mean, m.least, m.most);
        assert_true(m.mean > 1 - 1e-3 && m.most < 1 + 1e-6);
        studio_close(&s);
    }
}

static void coats_of_white(void **state) {
    (void)state;
    for (size_t i = 0; i < SUBJECT_COUNT; i++) {
        studio s = furnace(&subjects[i], (sag_appearance){.material = 0});
        uint32_t id = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_COATED_DIFFUSE,
                                                         .reflectance.value = {1, 1, 1},
                                                         .eta.value = {1.5, 0, 0}});
        sag_world_set_appearance(s.world, s.scene, 0, &(sag_appearance){.material = id});
        studio_mean m = studio_measure(&s);
        if (!(fabs(m.mean - 1) < 5 * m.deviation + 1e-3))
            print_message("%s: %g +- %g\n", subjects[i].name, m.mean, m.deviation);
        assert_true(fabs(m.mean - 1) < 5 * m.deviation + 1e-3);
        studio_close(&s);
    }
}

// What neither loses nor makes light in any other material, on a flat, a round and a dented shape.
static void all_white_materials(void **state) {
    (void)state;
    static const struct {
        const char *name;
        sag_material material;
    } whites[] = {
        {
            "paper",
            {.kind = SAG_MATERIAL_DIFFUSE_TRANSMISSION,
             .reflectance.value = {0.5, 0.5, 0.5},
             .transmittance.value = {0.5, 0.5, 0.5}},
        },
        {"pane", {.kind = SAG_MATERIAL_THIN_DIELECTRIC, .eta.value = {1.5, 0, 0}}},
        {"lacquered mirror",
         {.kind = SAG_MATERIAL_COATED_CONDUCTOR, .eta.value = {1, 1, 1}, .k.value = {1e8, 1e8, 1e8}}},
        {"mirror in white fog",
         {.kind = SAG_MATERIAL_COATED_CONDUCTOR,
          .eta.value = {1, 1, 1},
          .k.value = {1e8, 1e8, 1e8},
          .thickness.value = {0.5, 0, 0},
          .coat_albedo.value = {1, 1, 1},
          .coat_g.value = {0.3, 0, 0}}},
        {"white paint in white fog",
         {.kind = SAG_MATERIAL_COATED_DIFFUSE,
          .reflectance.value = {1, 1, 1},
          .thickness.value = {0.5, 0, 0},
          .coat_albedo.value = {1, 1, 1}}},
        {"mix", {.kind = SAG_MATERIAL_MIX, .materials = {1, 3}, .amount.value = {0.3, 0, 0}}},
        {"mix of mixes", {.kind = SAG_MATERIAL_MIX, .materials = {6, 2}, .amount.value = {0.6, 0, 0}}},
    };
    static const char *const shapes[] = {"rectangle", "sphere", "torus", "mesh"};
    for (size_t i = 0; i < SUBJECT_COUNT; i++) {
        bool chosen = false;
        for (int k = 0; k < 4; k++) chosen |= strcmp(subjects[i].name, shapes[k]) == 0;
        if (!chosen) continue;
        for (size_t w = 0; w < sizeof whites / sizeof *whites; w++) {
            studio s = furnace(&subjects[i], (sag_appearance){.material = 0});
            uint32_t id = 0;
            for (size_t k = 0; k <= w; k++) id = studio_material(&s, whites[k].material);
            sag_world_set_appearance(s.world, s.scene, 0, &(sag_appearance){.material = id});
            s.settings->max_depth = 1000;
            const studio_mean m = studio_measure(&s);
            // White spectra made of colours are white to 1e-4 or so.
            if (!(fabs(m.mean - 1) < 5 * m.deviation + 2e-3 && m.deviation < 0.02))
                print_message("%s, %s: %g +- %g\n", subjects[i].name, whites[w].name, m.mean, m.deviation);
            assert_true(fabs(m.mean - 1) < 5 * m.deviation + 2e-3 && m.deviation < 0.02);
            studio_close(&s);
        }
    }
}

// A mix is the weighted sum of what it mixes, also when it is mixed again; and of nothing that is no
// material.
static void mixes_are_weighted_sums(void **state) {
    (void)state;
    studio_mean m[3];
    for (int i = 0; i < 3; i++) {
        studio s = furnace(&subjects[4], (sag_appearance){.material = 0});
        const uint32_t a = studio_material(
            &s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {0.2, 0.2, 0.2}});
        const uint32_t b = studio_material(
            &s, (sag_material){.kind = SAG_MATERIAL_CONDUCTOR, .reflectance.value = {0.9, 0.9, 0.9}});
        const uint32_t air = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
        sag_material mix = {.kind = SAG_MATERIAL_MIX, .materials = {a, b}, .amount.value = {0.25, 0, 0}};
        const uint32_t once = studio_material(&s, mix);
        mix.materials[0] = once, mix.amount.value.r = 0.5;
        const uint32_t ids[] = {a, b, studio_material(&s, mix)};
        assert_true(ids[2] != 0);
        mix.materials[1] = air;
        assert_int_equal(sag_world_add_material(s.world, &mix), 0);
        mix.materials[1] = 99;
        assert_int_equal(sag_world_add_material(s.world, &mix), 0);
        sag_world_set_appearance(s.world, s.scene, 0, &(sag_appearance){.material = ids[i]});
        s.settings->samples_per_pixel = 256;
        m[i] = studio_measure(&s);
        studio_close(&s);
    }
    const double share = 0.25 * 0.5 + 0.5, sum = (1 - share) * m[0].mean + share * m[1].mean;
    if (!(fabs(m[2].mean - sum) < 5 * m[2].deviation + 1e-3))
        print_message("%g and %g: %g, not %g\n", m[0].mean, m[1].mean, m[2].mean, sum);
    assert_true(fabs(m[2].mean - sum) < 5 * m[2].deviation + 1e-3 && m[2].deviation < 0.01);
}

// The other furnace: no light from outside, a closed room that shines itself, and lamps of every kind of
// sampling.
static void closed_room(void **state) {
    (void)state;
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
        studio s = studio_open(0);
        s.settings->strategy = (sag_strategy)strategy;
        sag_appearance look = {.emission = {0.5, 0.5, 0.5}, .two_sided = true};
        uint32_t ids[3];
        ids[0] = sag_add_box(s.scene, &(sag_box){.min = {-9, -9, -9}, .max = {9, 9, 9}});
        ids[1] = sag_add_sphere(s.scene, &(sag_sphere){.center = {1, 0, 0}, .radius = 1});
        ids[2] = sag_add_mesh(s.scene, &(sag_mesh){.positions_f32 = octahedron,
                                                   .triangles = octahedron_faces,
                                                   .vertex_count = 6,
                                                   .triangle_count = 8});
        sag_affine aside = sag_affine_translate(sag_vec3_make(-1, 0, 1));
        sag_geometry_set_transform(s.scene, ids[2], &aside);
        for (int i = 0; i < 3; i++)
            assert_int_equal(sag_world_set_appearance(s.world, s.scene, ids[i], &look), SAG_OK);
        // Lights alone, near a corner's edge, have no finite variance: of few samples what is seldom is
        // missing from mean and deviation.
        if (strategy == SAG_STRATEGY_LIGHTS) s.settings->samples_per_pixel = 400;
        studio_mean m = studio_measure(&s);
        if (!(fabs(m.mean - 1) < 5 * m.deviation))
            print_message("%d: %g +- %g\n", strategy, m.mean, m.deviation);
        assert_true(fabs(m.mean - 1) < 5 * m.deviation);
        assert_true(m.deviation < 0.02);
        studio_close(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diffuse_and_shining),
        cmocka_unit_test(mirrors),
        cmocka_unit_test(glass),
        cmocka_unit_test(coats_of_white),
        cmocka_unit_test(closed_room),
        cmocka_unit_test(all_white_materials),
        cmocka_unit_test(mixes_are_weighted_sums),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
