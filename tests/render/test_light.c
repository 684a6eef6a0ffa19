// SPDX-License-Identifier: MIT
// Light that can be worked out on paper: points, spots, the sun, balls, disks and squares over a floor; and
// glass.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "support/picture.h"

#define PI 3.14159265358979323846

// A grey floor (ρ = 0.5) at y = 0, and a picture of its point (0, 0, 0).
static studio floor_studio(void) {
    studio s = studio_open(0);
    sag_add_plane(s.scene, &(sag_plane){.normal = {0, 1, 0}});
    sag_vec3 eye = {2, 3, 6}, target = {0, 0, 0};
    studio_aim_point(&s, eye, target);
    s.settings->integrator = SAG_INTEGRATOR_DIRECT;
    return s;
}

// What a floor of irradiance E sends out: ρ E/π.
static void expect_irradiance(studio *s, double irradiance) {
    double expected = 0.5 * irradiance / PI;
    studio_mean m = studio_measure(s);
    double tolerance = 5 * m.deviation + 1e-6 * expected;
    if (!(fabs(m.mean - expected) <= tolerance))
        print_message("%.9g +- %g instead of %.9g\n", m.mean, m.deviation, expected);
    assert_true(fabs(m.mean - expected) <= tolerance);
    assert_true(m.deviation <= 0.02 * expected);
    studio_close(s);
}

static void point_light(void **state) {
    (void)state;
    studio s = floor_studio();
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_POINT, .color = {7, 7, 7}, .from = {3, 4, 0}});
    expect_irradiance(&s, 7 * 0.8 / 25); // cos θ = 4/5, distance 5
}

static void spot_light_falls_off_smoothly(void **state) {
    (void)state;
    // 45° off the axis, between full light at 30° and none at 60°.
    studio s = floor_studio();
    sag_light spot = {.kind = SAG_LIGHT_SPOT,
                      .color = {7, 7, 7},
                      .from = {3, 3, 0},
                      .to = {3, 0, 0},
                      .cone_rad = PI / 3,
                      .cone_delta_rad = PI / 6};
    sag_world_add_light(s.world, &spot);
    double x = (cos(PI / 4) - 0.5) / (cos(PI / 6) - 0.5);
    expect_irradiance(&s, 7 * x * x * (3 - 2 * x) * cos(PI / 4) / 18);
    s = floor_studio();
    spot.cone_rad = PI / 5, spot.cone_delta_rad = 0;
    sag_world_add_light(s.world, &spot);
    expect_irradiance(&s, 0);
    s = floor_studio();
    spot.cone_rad = PI / 3;
    sag_world_add_light(s.world, &spot);
    expect_irradiance(&s, 7 * cos(PI / 4) / 18);
}

// pbrt's cone is round in the light's space: stretched 3 times along x, 45° in the world are atan(1/3) there.
static void a_stretched_spot_shines_in_an_ellipse(void **state) {
    (void)state;
    sag_light spot = {.kind = SAG_LIGHT_SPOT,
                      .color = {7, 7, 7},
                      .from = {3, 3, 0},
                      .to = {3, 0, 0},
                      .cone_rad = 30 * PI / 180,
                      .cone_delta_rad = 15 * PI / 180,
                      .to_world = {{{3, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    const double x = (3 / sqrt(10) - cos(PI / 6)) / (cos(PI / 12) - cos(PI / 6));
    studio s = floor_studio();
    sag_world_add_light(s.world, &spot);
    expect_irradiance(&s, 7 * x * x * (3 - 2 * x) * cos(PI / 4) / 18);
    s = floor_studio(); // to the other side it is as narrow as ever
    spot.from = (sag_vec3){0, 3, 3}, spot.to = (sag_vec3){0, 0, 3};
    sag_world_add_light(s.world, &spot);
    expect_irradiance(&s, 0);
    s = floor_studio(); // turned, mirrored and enlarged it is round
    spot.to_world = (sag_affine){{{0, 0, 3, 1}, {0, -3, 0, 0}, {3, 0, 0, 0}}}, spot.cone_rad = PI / 3;
    spot.cone_delta_rad = 0;
    sag_world_add_light(s.world, &spot);
    expect_irradiance(&s, 7 * cos(PI / 4) / 18);
}

static void distant_light(void **state) {
    (void)state;
    studio s = floor_studio();
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_DISTANT, .color = {2, 2, 2}, .from = {3, 4, 0}});
    expect_irradiance(&s, 2 * 0.8);
    s = floor_studio(); // from below
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_DISTANT, .color = {2, 2, 2}, .to = {0, 1, 0}});
    expect_irradiance(&s, 0);
}

static void shadows(void **state) {
    (void)state;
    studio s = floor_studio();
    sag_add_sphere(s.scene, &(sag_sphere){.center = {1.5, 2, 0}, .radius = 0.1});
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_POINT, .color = {7, 7, 7}, .from = {3, 4, 0}});
    expect_irradiance(&s, 0);
    // A blocker that shadow rays do not see, and one behind the light.
    s = floor_studio();
    uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.center = {1.5, 2, 0}, .radius = 0.1});
    sag_geometry_set_mask(s.scene, ball, SAG_RAY_CAMERA);
    sag_add_sphere(s.scene, &(sag_sphere){.center = {4.5, 6, 0}, .radius = 1});
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_POINT, .color = {7, 7, 7}, .from = {3, 4, 0}});
    expect_irradiance(&s, 7 * 0.8 / 25);
}

// Every strategy must come to the same.
typedef void (*furnish)(studio *s);
static void expect_from_all_strategies(furnish furnish_studio, double irradiance) {
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
        studio s = floor_studio();
        s.settings->strategy = (sag_strategy)strategy;
        s.settings->film.width = s.settings->film.height = 64;
        s.settings->samples_per_pixel = strategy == SAG_STRATEGY_SURFACES ? 32 : 8;
        furnish_studio(&s);
        expect_irradiance(&s, irradiance);
    }
}

// The whole ball above the horizon: E = π L (r/d)² cos θ.
static void add_ball(studio *s) {
    uint32_t ball = sag_add_sphere(s->scene, &(sag_sphere){.center = {1.5, 2, 0}, .radius = 1});
    sag_world_set_appearance(s->world, s->scene, ball, &(sag_appearance){.emission = {3, 3, 3}});
}
static void ball_light(void **state) {
    (void)state;
    expect_from_all_strategies(add_ball, PI * 3 * (1 / 6.25) * 0.8);
}

// A disk facing the floor from height h on the axis: E = π L r²/(r² + h²). Seen from behind: dark.
static void add_disk(studio *s) {
    uint32_t disk =
        sag_add_disk(s->scene, &(sag_disk){.center = {0, 2, 0}, .normal = {0, -5, 0}, .radius = 1.5});
    sag_world_set_appearance(s->world, s->scene, disk, &(sag_appearance){.emission = {3, 3, 3}});
}
static void add_flipped_disk(studio *s) {
    uint32_t disk =
        sag_add_disk(s->scene, &(sag_disk){.center = {0, 2, 0}, .normal = {0, 5, 0}, .radius = 1.5});
    sag_world_set_appearance(s->world, s->scene, disk,
                             &(sag_appearance){.emission = {3, 3, 3}, .flip = true});
}
static void add_disk_on_its_back(studio *s) {
    uint32_t disk =
        sag_add_disk(s->scene, &(sag_disk){.center = {0, 2, 0}, .normal = {0, 5, 0}, .radius = 1.5});
    sag_world_set_appearance(s->world, s->scene, disk, &(sag_appearance){.emission = {3, 3, 3}});
}
static void disk_light(void **state) {
    (void)state;
    expect_from_all_strategies(add_disk, PI * 3 * 2.25 / 6.25);
    expect_from_all_strategies(add_flipped_disk, PI * 3 * 2.25 / 6.25);
    expect_from_all_strategies(add_disk_on_its_back, 0);
}

// A square of side 2 at height 1, facing down: four times the corner's form factor of a unit square.
static const float square[] = {-1, 1, -1, 1, 1, -1, 1, 1, 1, -1, 1, 1};
static const uint32_t square_faces[] = {0, 1, 2, 0, 2, 3};
static const float down[] = {0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0};
static double square_irradiance(double radiance) {
    double corner = 2 * (1 / sqrt(2)) * atan(1 / sqrt(2)) / (2 * PI);
    return PI * radiance * 4 * corner;
}
static void add_mesh(studio *s) {
    sag_mesh mesh = {
        .positions_f32 = square, .triangles = square_faces, .vertex_count = 4, .triangle_count = 2};
    uint32_t id = sag_add_mesh(s->scene, &mesh); // the normal, by the order of the vertices, is down
    sag_world_set_appearance(s->world, s->scene, id, &(sag_appearance){.emission = {3, 3, 3}});
}
static void add_mesh_of_intensities(studio *s) { // each triangle, of area 2, as much as 6 on an area of 1
    sag_mesh mesh = {
        .positions_f32 = square, .triangles = square_faces, .vertex_count = 4, .triangle_count = 2};
    uint32_t id = sag_add_mesh(s->scene, &mesh);
    sag_world_set_appearance(s->world, s->scene, id,
                             &(sag_appearance){.emission = {6, 6, 6}, .emission_over_area = true});
}
static void add_mesh_with_normals(studio *s) {
    // The wrong way round, but with normals that say what is in front.
    const uint32_t faces[] = {0, 2, 1, 0, 3, 2};
    sag_mesh mesh = {.positions_f32 = square,
                     .triangles = faces,
                     .normals_f32 = down,
                     .vertex_count = 4,
                     .triangle_count = 2};
    uint32_t id = sag_add_mesh(s->scene, &mesh);
    sag_world_set_appearance(s->world, s->scene, id, &(sag_appearance){.emission = {3, 3, 3}});
}
static void add_rectangle(studio *s) {
    sag_rectangle half = {.corner = {-0.5, 0, -0.5}, .edge_u = {1, 0, 0}, .edge_v = {0, 0, 1}};
    uint32_t id = sag_add_rectangle(s->scene, &half);
    sag_affine place = {{{2, 0, 0, 0}, {0, 2, 0, 1}, {0, 0, 2, 0}}};
    sag_geometry_set_transform(s->scene, id, &place);
    sag_world_set_appearance(s->world, s->scene, id,
                             &(sag_appearance){.emission = {3, 3, 3}, .two_sided = true});
}
static void square_lights(void **state) {
    (void)state;
    expect_from_all_strategies(add_mesh, square_irradiance(3));
    expect_from_all_strategies(add_mesh_of_intensities, square_irradiance(3));
    expect_from_all_strategies(add_mesh_with_normals, square_irradiance(3));
    expect_from_all_strategies(add_rectangle, square_irradiance(3));
}

// The same square placed by nested instances, one of which mirrors and squeezes it.
static void add_instanced_square(studio *s) {
    sag_error error;
    sag_scene *inner = sag_world_add_object(s->world), *outer = sag_world_add_object(s->world);
    uint32_t id = sag_add_rectangle(
        inner, &(sag_rectangle){.corner = {-1, 0, -1}, .edge_u = {0, 0, 2}, .edge_v = {2, 0, 0}});
    sag_world_set_appearance(s->world, inner, id,
                             &(sag_appearance){.emission = {3, 3, 3}, .two_sided = true});
    assert_int_equal(sag_scene_commit(inner, &error), SAG_OK);
    sag_affine mirror = {{{-0.5, 0, 0, 0.5}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    sag_add_instance(outer, inner, &mirror); // x in [0, 1]
    mirror.m[0][3] = -0.5;
    sag_add_instance(outer, inner, &mirror); // x in [-1, 0]
    assert_int_equal(sag_scene_commit(outer, &error), SAG_OK);
    sag_affine up = sag_affine_translate(sag_vec3_make(0, 1, 0));
    sag_add_instance(s->scene, outer, &up);
}
static void instanced_lights(void **state) {
    (void)state;
    expect_from_all_strategies(add_instanced_square, square_irradiance(3));
}

static void add_sky(studio *s) {
    sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {3, 3, 3}});
}
static void add_graded_sky(studio *s) {
    // L = 1 + 2 cos θ: E = π + 2·2π/3.
    sag_light sky = {.kind = SAG_LIGHT_SKY, .color = {3, 3, 3}, .horizon = {1, 1, 1}};
    sag_world_add_light(s->world, &sky);
}
static void skies(void **state) {
    (void)state;
    expect_from_all_strategies(add_sky, 3 * PI);
    expect_from_all_strategies(add_graded_sky, PI + 4 * PI / 3);
}

// A picture of the sky: the eighth of the sphere with x, y, z > 0 shines with 5, placed by a quarter turn
// about y, that is x > 0, y > 0, z < 0. E = 5 · π/4.
static void add_picture(studio *s) {
    sag_light light = {.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}};
    sag_error error;
    const uint32_t n = 64;
    assert_int_equal(sag_image_create(s->context, n, n, 3, &light.image, &error), SAG_OK);
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            // In the middle diamond z > 0; x and y are those of the plane.
            double a = (x + 0.5) / n * 2 - 1, b = (y + 0.5) / n * 2 - 1;
            float value = a > 0 && b > 0 && a + b < 1 + 1e-9 ? 5 : 0;
            if (fabs(a + b - 1) < 1e-9) value /= 2; // the diagonal cuts this texel in halves
            for (size_t k = 0; k < 3; k++) light.image.pixels[3 * ((size_t)y * n + x) + k] = value;
        }
    sag_vec3 axis = {0, 1, 0};
    light.to_world = sag_affine_rotate(PI / 2, axis);
    assert_int_not_equal(sag_world_add_light(s->world, &light), 0);
}
static void picture_of_the_sky(void **state) {
    (void)state;
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
        studio s = floor_studio();
        s.settings->strategy = (sag_strategy)strategy;
        add_picture(&s);
        studio_mean m = studio_measure(&s);
        double expected = 0.5 / PI * 5 * PI / 4;
        if (!(fabs(m.mean / expected - 1) < 0.02)) print_message("%g instead of %g\n", m.mean, expected);
        assert_true(fabs(m.mean / expected - 1) < 0.02);
        studio_close(&s);
    }
}

// Light from many sources of all kinds, over surfaces of all kinds: every strategy has the same mean.
static double busy_room(sag_strategy strategy, sag_integrator_kind integrator, uint64_t seed) {
    studio s = studio_open(0);
    s.settings->strategy = strategy;
    s.settings->integrator = integrator;
    s.settings->seed = seed;
    s.settings->max_depth = 4;
    s.settings->samples_per_pixel = 16;
    s.settings->film.width = s.settings->film.height = 16;
    const sag_material materials[] = {
        {.kind = SAG_MATERIAL_DIFFUSE, .reflectance.value = {0.7, 0, 0}},
        {.kind = SAG_MATERIAL_CONDUCTOR,
         .eta.value = {0.2, 1, 1},
         .k.value = {3.9, 1, 1},
         .roughness_u.value = {0.3, 0, 0},
         .roughness_v.value = {0.2, 0, 0}},
        {.kind = SAG_MATERIAL_COATED_DIFFUSE,
         .reflectance.value = {0.5, 0, 0},
         .eta.value = {1.5, 0, 0},
         .roughness_u.value = {0.3, 0, 0},
         .roughness_v.value = {0.3, 0, 0}},
        {.kind = SAG_MATERIAL_DIELECTRIC,
         .eta.value = {1.5, 0, 0},
         .roughness_u.value = {0.4, 0, 0},
         .roughness_v.value = {0.4, 0, 0}},
    };
    for (int i = 0; i < 4; i++) {
        sag_sphere ball = {.center = {i % 2 * 2.0 - 1, i / 2 * 2.0 - 1, 0}, .radius = 0.8};
        uint32_t id = sag_add_sphere(s.scene, &ball), material = studio_material(&s, materials[i]);
        sag_world_set_appearance(s.world, s.scene, id, &(sag_appearance){.material = material});
    }
    sag_add_plane(s.scene, &(sag_plane){.point = {0, -2, 0}, .normal = {0, 1, 0}});
    uint32_t lamp = sag_add_sphere(s.scene, &(sag_sphere){.center = {3, 4, 3}, .radius = 1.5});
    sag_world_set_appearance(s.world, s.scene, lamp, &(sag_appearance){.emission = {5, 5, 5}});
    uint32_t torch =
        sag_add_disk(s.scene, &(sag_disk){.center = {-3, 1, 2}, .normal = {3, -1, -2}, .radius = 1});
    sag_world_set_appearance(s.world, s.scene, torch, &(sag_appearance){.emission = {5, 5, 5}});
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_SKY, .color = {1, 1, 1}, .horizon = {0.2, 0.2, 0.2}});
    sag_world_add_light(s.world,
                        &(sag_light){.kind = SAG_LIGHT_POINT, .color = {2, 2, 2}, .from = {0, 3, 3}});
    studio_mean m = studio_measure(&s);
    studio_close(&s);
    return m.mean;
}

// The mean of several pictures of the room, and how far that mean may be off by chance.
static studio_mean busy_rooms(sag_strategy strategy, sag_integrator_kind integrator) {
    enum { PICTURES = 10 };
    double sum = 0, squares = 0;
    for (uint64_t seed = 0; seed < PICTURES; seed++) {
        double mean = busy_room(strategy, integrator, seed);
        sum += mean;
        squares += mean * mean;
    }
    double mean = sum / PICTURES, variance = fmax(0, squares / PICTURES - mean * mean);
    return (studio_mean){.mean = mean, .deviation = sqrt(variance / (PICTURES - 1))};
}

static void strategies_agree(void **state) {
    (void)state;
    const sag_integrator_kind integrators[] = {SAG_INTEGRATOR_PATH, SAG_INTEGRATOR_DIRECT};
    for (int i = 0; i < 2; i++) {
        studio_mean mis = busy_rooms(SAG_STRATEGY_MIS, integrators[i]);
        for (int strategy = SAG_STRATEGY_LIGHTS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
            studio_mean other = busy_rooms((sag_strategy)strategy, integrators[i]);
            double z = (other.mean - mis.mean) / hypot(mis.deviation, other.deviation);
            if (!(fabs(z) < 5))
                print_message("strategy %d: %g instead of %g\n", strategy, other.mean, mis.mean);
            assert_true(fabs(z) < 5);
            // Together they are never much noisier than alone.
            assert_true(mis.deviation < 2 * other.deviation && other.deviation < 0.04 * other.mean);
        }
    }
}

// From inside glass (y < 0), beyond the critical angle, only the shining ground below is seen; within it the
// sky, of radiance η² (1 − F) there, and the share F of the ground.
static void looking_out_of_glass(void **state) {
    (void)state;
    const double angles[] = {60 * PI / 180, 30 * PI / 180};
    for (int i = 0; i < 2; i++) {
        studio s = studio_open(0);
        uint32_t glass =
            studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}});
        uint32_t black = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE});
        uint32_t top = sag_add_plane(s.scene, &(sag_plane){.normal = {0, 1, 0}});
        uint32_t ground = sag_add_plane(s.scene, &(sag_plane){.point = {0, -5, 0}, .normal = {0, 1, 0}});
        sag_world_set_appearance(s.world, s.scene, top, &(sag_appearance){.material = glass});
        sag_world_set_appearance(s.world, s.scene, ground,
                                 &(sag_appearance){.material = black, .emission = {3, 3, 3}});
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        sag_vec3 eye = {0, -1, 0}, target = {0, -1 + cos(angles[i]), sin(angles[i])};
        studio_aim_point(&s, eye, target);
        studio_mean m = studio_measure(&s);
        if (i == 0) {
            assert_true(fabs(m.mean - 3) < 1e-6 && m.most - m.least < 1e-6);
        } else {
            double cos_i = cos(angles[i]), cos_t = sqrt(1 - 2.25 * 0.25);
            double a = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t),
                   b = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
            double f = (a * a + b * b) / 2;
            assert_true(fabs(m.mean - (f * 3 + (1 - f) * 2.25)) < 5 * m.deviation + 1e-6);
        }
        studio_close(&s);
    }
}

// A checkerboard of holes: half of the light goes through, for camera and shadow rays alike; an interface is
// air.
static void holes_and_interfaces(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        studio s = floor_studio();
        sag_appearance look = {.emission = {0, 0, 0}};
        if (i == 0) {
            sag_texture holes = {.kind = SAG_TEXTURE_CHECKERBOARD,
                                 .b.value = {1, 1, 1},
                                 .mapping = {.u_scale = 50, .v_scale = 50}};
            look.alpha.texture = sag_world_add_texture(s.world, &holes);
            assert_int_not_equal(look.alpha.texture, 0);
        } else {
            look.material = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
        }
        uint32_t veil = sag_add_rectangle(
            s.scene, &(sag_rectangle){.corner = {-2, 1, -2}, .edge_u = {4, 0, 0}, .edge_v = {0, 0, 4}});
        sag_world_set_appearance(s.world, s.scene, veil, &look);
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        // The veil hides the floor from the camera, were it not for its mask.
        sag_geometry_set_mask(s.scene, veil, ~(uint32_t)SAG_RAY_CAMERA);
        s.settings->samples_per_pixel = 64;
        double veil_part = 4 * (2 * (2 / sqrt(5)) * atan(2 / sqrt(5)) / (2 * PI)); // form factor of the veil
        expect_irradiance(&s, PI * (i == 0 ? 1 - veil_part / 2 : 1));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_light),
        cmocka_unit_test(spot_light_falls_off_smoothly),
        cmocka_unit_test(a_stretched_spot_shines_in_an_ellipse),
        cmocka_unit_test(distant_light),
        cmocka_unit_test(shadows),
        cmocka_unit_test(ball_light),
        cmocka_unit_test(disk_light),
        cmocka_unit_test(square_lights),
        cmocka_unit_test(instanced_lights),
        cmocka_unit_test(skies),
        cmocka_unit_test(picture_of_the_sky),
        cmocka_unit_test(strategies_agree),
        cmocka_unit_test(looking_out_of_glass),
        cmocka_unit_test(holes_and_interfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
