// SPDX-License-Identifier: MIT
// Faults that users of other ray libraries reported, each under the name of its report, and attacks on the
// culling.
#include "scene/scene.h"
#include "support/context.h"
#include "support/meshes.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static sag_vec3 corner(const sag_mesh *m, uint32_t triangle, int k) {
    const double *p = m->positions_f64 + 3 * (size_t)m->triangles[3 * triangle + (uint32_t)k];
    return sag_vec3_make(p[0], p[1], p[2]);
}

// An n × n grid of squares in the plane z = 0 over [0, size]², cut in two each.
static test_mesh grid(uint32_t n, double size) {
    uint32_t vertices = (n + 1) * (n + 1), triangles = 2 * n * n;
    test_mesh m = {.positions = calloc(3 * vertices, sizeof(double)),
                   .triangles = calloc(3 * triangles, sizeof(uint32_t))};
    for (uint32_t i = 0; i < vertices; i++) {
        m.positions[3 * i] = size * (i % (n + 1)) / n;
        m.positions[3 * i + 1] = size * (i / (n + 1)) / n;
    }
    for (uint32_t i = 0; i < n * n; i++) {
        uint32_t a = i / n * (n + 1) + i % n;
        uint32_t corners[6] = {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1};
        memcpy(m.triangles + 6 * (size_t)i, corners, sizeof corners);
    }
    m.mesh = (sag_mesh){.positions_f64 = m.positions,
                        .triangles = m.triangles,
                        .vertex_count = vertices,
                        .triangle_count = triangles};
    return m;
}

// Embree's SmallTriangleHitTest, which Embree keeps switched off: a plane of 100 × 100 squares, aimed at each
// centroid from a million away. Every ray hits the triangle it was aimed at.
static void embree_small_triangle_hit(void **state) {
    (void)state;
    rng r = rng_make(1);
    test_mesh m = grid(100, 1);
    sag_scene *scene = scene_of(&m.mesh);
    for (uint32_t i = 0; i < m.mesh.triangle_count; i++) {
        sag_vec3 c = sag_add(corner(&m.mesh, i, 0), sag_add(corner(&m.mesh, i, 1), corner(&m.mesh, i, 2)));
        c = sag_scale(c, 1.0 / 3);
        sag_vec3 away = rng_direction(&r);
        if (fabs(away.z) < 0.02) continue;
        sag_vec3 o = sag_madd(c, 1e6, away);
        sag_ray ray = sag_ray_make(o, sag_sub(c, o));
        sag_hit hit;
        assert_true(sag_intersect(scene, &ray, &hit));
        assert_int_equal(hit.primitive, i);
        assert_true(fabs(hit.t - 1) < 1e-12);
    }
    sag_scene_destroy(scene);
    test_mesh_free(&m);
}

// tinybvh PR #283: a part of 5 cm in metres, with triangles of a fifth of a millimetre.
static void tinybvh_283(void **state) {
    (void)state;
    for (double size = 0.05; size > 1e-12; size *= 1e-3) {
        test_mesh m = grid(250, size);
        sag_scene *scene = scene_of(&m.mesh);
        for (uint32_t i = 0; i < m.mesh.triangle_count; i += 3) {
            sag_vec3 c =
                sag_add(corner(&m.mesh, i, 0), sag_add(corner(&m.mesh, i, 1), corner(&m.mesh, i, 2)));
            sag_ray ray = sag_ray_make(sag_vec3_make(c.x / 3, c.y / 3, 1), sag_vec3_make(0, 0, -1));
            sag_hit hit;
            assert_true(sag_intersect(scene, &ray, &hit));
            assert_int_equal(hit.primitive, i);
        }
        sag_scene_destroy(scene);
        test_mesh_free(&m);
    }
}

// tinybvh-192: triangles that halve in size towards a point, which drives a tree as deep as there are
// triangles. Ours stays within its caps, and every triangle is found.
static void tinybvh_192(void **state) {
    (void)state;
    enum { COUNT = 300 };
    double positions[9 * COUNT];
    uint32_t triangles[3 * COUNT];
    for (int i = 0; i < COUNT; i++) {
        double s = ldexp(1, -i), p[9] = {s, 0, 0, s, s / 4, 0, s, 0, s / 4};
        memcpy(positions + 9 * (size_t)i, p, sizeof p);
        for (uint32_t k = 0; k < 3; k++) triangles[3 * i + (int)k] = 3 * (uint32_t)i + k;
    }
    sag_mesh mesh = {.positions_f64 = positions,
                     .triangles = triangles,
                     .vertex_count = 3 * COUNT,
                     .triangle_count = COUNT};
    sag_scene *scene = scene_of(&mesh);
    sag_scene_stats stats;
    sag_scene_get_stats(scene, &stats);
    assert_true(stats.depth <= SAGI_BVH_MAX_DEPTH);
    for (int i = 0; i < COUNT; i++) {
        double s = ldexp(1, -i);
        sag_ray ray = sag_ray_make(sag_vec3_make(-1, s / 16, s / 16), sag_vec3_make(1, 0, 0));
        sag_hit hits[COUNT];
        size_t count = sag_intersect_all(scene, &ray, hits, COUNT);
        bool found = false;
        for (size_t k = 0; k < count; k++) found |= hits[k].primitive == (uint32_t)i;
        assert_true(found);
        assert_int_equal(count, sag_mesh_crossings(&mesh, &ray, hits, COUNT));
    }
    sag_scene_destroy(scene);
}

// trimesh-1496, trimesh-2317: the edges and vertices of a box are one crossing, not two.
// trimesh-2524: also at large coordinates, where an offset to find the next hit would be swallowed.
static void trimesh_2524(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (double far = 0; far < 1e13; far = far == 0 ? 1e3 : far * 1e3) {
        test_mesh m = test_mesh_cube();
        test_mesh_move(&m, 1, sag_vec3_make(far, -far, 2 * far), 0, &r);
        sag_scene *scene = scene_of(&m.mesh);
        sag_hit hits[8];
        for (int i = -4; i <= 4; i++)
            for (int j = -4; j <= 4; j++) {
                sag_ray ray = sag_ray_make(sag_vec3_make(far + i * 0.25, -far + j * 0.25, 2 * far - 9),
                                           sag_vec3_make(0, 0, 2));
                size_t count = sag_intersect_all(scene, &ray, hits, 8);
                assert_true(count == 0 || count == 2);
                if (abs(i) < 4 && abs(j) < 4) assert_int_equal(count, 2);
                if (count == 2) assert_true(hits[0].t == 4 && hits[1].t == 5);
                ray.direction = sag_vec3_make(0.25, 0.25, 1); // through edges and vertices aslant
                assert_int_equal(sag_count_crossings(scene, &ray) % 2, 0);
            }
        sag_scene_destroy(scene);
        test_mesh_free(&m);
    }
}

// open3d-5669: inside or outside by parity where the ray from the point meets a vertex or an edge.
static void open3d_5669(void **state) {
    (void)state;
    rng r = rng_make(3);
    test_mesh cube = test_mesh_cube();
    sag_scene *scene = scene_of(&cube.mesh);
    for (int i = 0; i < 4000; i++) {
        sag_vec3 p = {rng_uniform(&r, -2, 2), rng_uniform(&r, -2, 2), rng_uniform(&r, -2, 2)};
        bool inside = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) < 1;
        assert_int_equal(sag_contains(scene, p), inside);
    }
    // points from which the ray of sag_contains runs into a vertex, as exactly as may be
    sag_vec3 d = {0.41421356237309503, 0.7320508075688772, 0.2360679774997898};
    for (uint32_t v = 0; v < cube.mesh.vertex_count; v++)
        for (int k = -40; k <= 40; k++) {
            sag_vec3 at = {cube.positions[3 * v], cube.positions[3 * v + 1], cube.positions[3 * v + 2]};
            sag_vec3 p = sag_madd(at, k * 0.0625, d);
            double m = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
            if (m != 1) assert_int_equal(sag_contains(scene, p), m < 1);
        }
    sag_scene_destroy(scene);
    test_mesh_free(&cube);
}

// A ray meets one side of a one-sided mesh only, but what the mesh contains is the same.
static void one_sided_meshes_contain(void **state) {
    (void)state;
    test_mesh cube = test_mesh_cube();
    cube.mesh.one_sided = true;
    sag_scene *scene = scene_of(&cube.mesh);
    assert_true(sag_contains(scene, sag_vec3_make(0.1, 0.2, 0.3)));
    assert_false(sag_contains(scene, sag_vec3_make(-2, -3, -2)));
    assert_false(sag_contains(scene, sag_vec3_make(2, 0, 0)));
    sag_scene_destroy(scene);
    test_mesh_free(&cube);
}

// ifc-lite-3561: one NaN vertex must not take the triangles around it along.
static void ifc_lite_3561(void **state) {
    (void)state;
    test_mesh m = grid(10, 1);
    m.positions[3 * 60 + 1] = NAN; // the middle vertex, of six triangles
    sag_scene *scene = scene_of(&m.mesh);
    sag_scene_stats stats;
    sag_scene_get_stats(scene, &stats);
    assert_int_equal(stats.dropped_not_finite, 6);
    assert_int_equal(stats.primitive_count, 194);
    for (uint32_t i = 0; i < 200; i++) {
        sag_vec3 c = sag_add(corner(&m.mesh, i, 0), sag_add(corner(&m.mesh, i, 1), corner(&m.mesh, i, 2)));
        if (isnan(c.y)) continue;
        sag_ray ray = sag_ray_make(sag_vec3_make(c.x / 3, c.y / 3, 1), sag_vec3_make(0, 0, -1));
        sag_hit hit;
        assert_true(sag_intersect(scene, &ray, &hit) && hit.primitive == i);
    }
    sag_scene_destroy(scene);
    test_mesh_free(&m);
}

// embree-416: false hits at 1e9 … 1e11; embree-42: geometry beyond 1.844e18 is skipped. Here to 2¹⁰⁰.
static void embree_416_and_42(void **state) {
    (void)state;
    rng r = rng_make(4);
    double scales[] = {1e9, 1e10, 1e11, 1e18, 1e19, 1e25, 0x1p99};
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++) {
        test_mesh m = test_mesh_sphere(2);
        test_mesh_move(&m, scales[s], sag_vec3_make(0, 0, 0), 0, &r);
        sag_scene *scene = scene_of(&m.mesh);
        for (int i = 0; i < 300; i++) {
            sag_ray ray = sag_ray_make(rng_vec3(&r, 2 * scales[s]), rng_direction(&r));
            sag_hit a, b;
            bool found = sag_intersect(scene, &ray, &a);
            assert_int_equal(found, sag_mesh_hit(&m.mesh, &ray, &b));
            if (found) assert_true(a.t == b.t && a.primitive == b.primitive);
            assert_int_equal(sag_count_crossings(scene, &ray), sag_mesh_crossings(&m.mesh, &ray, NULL, 0));
        }
        sag_scene_destroy(scene);
        test_mesh_free(&m);
    }
}

// embree-387: a grazing triangle gave t = 12291 with all vertices within 600. A hit is where the triangle is.
static void embree_387(void **state) {
    (void)state;
    rng r = rng_make(5);
    sag_scene *scene = sag_scene_create(context);
    sag_triangle t = {{600, 0, 1e-5}, {-500, 3, 0}, {-590, -4, -1e-5}, false};
    sag_add_triangle(scene, &t);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    size_t hits = 0;
    for (int i = 0; i < 20000; i++) {
        sag_vec3 o = {rng_uniform(&r, -2000, 2000), rng_uniform(&r, -5, 5), rng_uniform(&r, -1, 1) * 1e-3};
        sag_vec3 to = {rng_uniform(&r, -590, 600), rng_uniform(&r, -4, 3), 0};
        sag_ray ray = sag_ray_make(o, sag_sub(to, o));
        sag_hit hit;
        if (!sag_intersect(scene, &ray, &hit)) continue;
        hits++;
        sag_vec3 p = sag_ray_at(&ray, hit.t);
        assert_true(fabs(p.x) < 600.001 && p.y > -4.001 && p.y < 3.001);
    }
    assert_true(hits > 1000);
    sag_scene_destroy(scene);
}

// What no split can part: the same triangle ten thousand times. Ordered by primitive, all counted.
static void equal_boxes(void **state) {
    (void)state;
    enum { COUNT = 10000 };
    double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t *triangles = malloc(3 * COUNT * sizeof *triangles);
    for (uint32_t i = 0; i < 3 * COUNT; i++) triangles[i] = i % 3;
    sag_mesh mesh = {
        .positions_f64 = positions, .triangles = triangles, .vertex_count = 3, .triangle_count = COUNT};
    sag_scene *scene = scene_of(&mesh);
    sag_ray ray = sag_ray_make(sag_vec3_make(0.2, 0.2, 1), sag_vec3_make(0, 0, -1));
    sag_hit hit, first[5];
    assert_true(sag_intersect(scene, &ray, &hit));
    assert_int_equal(hit.primitive, 0);
    assert_int_equal(sag_intersect_all(scene, &ray, first, 5), COUNT);
    for (uint32_t i = 0; i < 5; i++) assert_int_equal(first[i].primitive, i);
    sag_scene_destroy(scene);
    free(triangles);
}

// Attacks on the culling: triangles whose boxes are flat or tiny, lines through their very corners, origins
// up to 1e30 away, directions almost along an axis, of lengths from 1e-300 to 1e300. The scene must agree
// with the mesh asked triangle by triangle.
static void culling_loses_nothing(void **state) {
    (void)state;
    rng r = rng_make(6);
    enum { COUNT = 150 };
    double positions[9 * COUNT];
    uint32_t triangles[3 * COUNT];
    for (uint32_t i = 0; i < 3 * COUNT; i++) triangles[i] = i;
    size_t hits = 0;
    for (size_t round = 0; round < soak(60); round++) {
        double size = rng_log_uniform(&r, 1e-12, 1e12);
        sag_vec3 middle = rng_vec3(&r, rng_one_in(&r, 2) ? size : 1e6 * size);
        for (int i = 0; i < COUNT; i++) {
            sag_vec3 at = sag_add(middle, rng_vec3(&r, size));
            double small = size * rng_log_uniform(&r, 1e-8, 1);
            int flat = (int)rng_below(&r, 4); // 3: not flat
            for (int k = 0; k < 3; k++) {
                sag_vec3 p = sag_add(at, rng_vec3(&r, small));
                if (flat == 0) p.x = at.x;
                if (flat == 1) p.y = at.y;
                if (flat == 2) p.z = at.z;
                memcpy(positions + 9 * (size_t)i + 3 * (size_t)k, &p, sizeof p);
            }
        }
        sag_mesh mesh = {.positions_f64 = positions,
                         .triangles = triangles,
                         .vertex_count = 3 * COUNT,
                         .triangle_count = COUNT};
        sag_scene *scene = scene_of(&mesh);
        for (int i = 0; i < 300; i++) {
            uint32_t t = rng_below(&r, COUNT);
            sag_vec3 p = corner(&mesh, t, (int)rng_below(&r, 3));
            if (rng_one_in(&r, 3)) p = sag_scale(sag_add(p, corner(&mesh, t, 0)), 0.5);
            sag_vec3 d = rng_direction(&r);
            if (rng_one_in(&r, 2)) d.x *= rng_log_uniform(&r, 1e-40, 1);
            if (rng_one_in(&r, 2)) d.y *= rng_log_uniform(&r, 1e-40, 1);
            if (rng_one_in(&r, 6)) d.z = 0;
            if (rng_one_in(&r, 6)) d.x = 0;
            double distance = size * rng_log_uniform(&r, 1e-3, rng_one_in(&r, 3) ? 1e30 : 1e3);
            sag_ray ray = sag_ray_make(sag_madd(p, -distance, d), d);
            double length = rng_log_uniform(&r, 1e-30, 1e30);
            if (rng_one_in(&r, 8)) length = rng_one_in(&r, 2) ? 1e-300 : 1e300;
            ray.direction = sag_scale(d, length);
            if (rng_one_in(&r, 3)) ray.t_min = -INFINITY;
            if (rng_one_in(&r, 3)) ray.t_max = distance / length * rng_uniform(&r, 0.99, 1.01);
            if (!sag_ray_is_valid(&ray)) continue;
            sag_hit a, b;
            bool found = sag_mesh_hit(&mesh, &ray, &b);
            assert_int_equal(sag_intersect(scene, &ray, &a), found);
            if (found) assert_true(a.t == b.t && a.primitive == b.primitive);
            assert_int_equal(sag_occluded(scene, &ray), found);
            assert_int_equal(sag_count_crossings(scene, &ray), sag_mesh_crossings(&mesh, &ray, NULL, 0));
            hits += found;
        }
        sag_scene_destroy(scene);
    }
    assert_true(hits > soak(60) * 30);
}

// A direction so long that t is a subnormal number, which rounds it to t_max: the filters took the triangle
// for too far away.
static void subnormal_times(void **state) {
    (void)state;
    sag_vec3 p[3] = {{0x1.e34p-24, 0x1.9d8p-25, 0x1.9d8p-25},
                     {0x1.e34p-24, 0x1.8ecp-24, 0x1.9d8p-25},
                     {0x1.e34p-24, 0x1.9d8p-25, 0x1.8ecp-24}};
    const uint32_t corners[3] = {0, 1, 2};
    sag_mesh mesh = {.positions_f64 = &p[0].x, .vertex_count = 3, .triangles = corners, .triangle_count = 1};
    sag_scene *scene = scene_of(&mesh);
    sag_ray ray = {.origin = {0x1.e3400000011afp-24, 0x1.43c298fc8deb8p-24, 0x1.c4cd3191322a3p-25},
                   .direction = {-0x1.d18549030fdcdp+992, -0x1.c3a368ef1f2abp+993, -0x1.48db5b71f62b5p+991},
                   .t_min = 0x0.0000000026e6p-1022,
                   .t_max = 0x0.0000000026e6p-1022};
    sag_triangle alone = {p[0], p[1], p[2], false};
    sag_hit hit, expected;
    assert_true(sag_triangle_hit(&alone, &ray, &expected));
    assert_true(sag_intersect(scene, &ray, &hit));
    assert_memory_equal(&hit.t, &expected.t, sizeof hit.t);
    assert_true(sag_occluded(scene, &ray));
    sag_scene_destroy(scene);
}

// A t_min of −0 is not negative, but as a whole number it came before all others: a ray that begins in the
// scene took the place of a missing child for a box that it meets, without end.
static void minus_zero(void **state) {
    (void)state;
    rng r = rng_make(31);
    for (uint32_t count = 1; count < 200; count += 1 + count / 4) {
        double p[9 * 200];
        uint32_t t[3 * 200];
        for (uint32_t i = 0; i < 3 * count; i++) {
            sag_vec3 at = rng_vec3(&r, i % 3 == 0 ? 1 : 0.1);
            for (int k = 0; k < 3; k++)
                p[3 * i + (uint32_t)k] =
                    sag_component(at, k) + (i % 3 == 0 ? 0 : p[9 * (i / 3) + (uint32_t)k]);
            t[i] = i;
        }
        sag_mesh mesh = {
            .positions_f64 = p, .vertex_count = 3 * count, .triangles = t, .triangle_count = count};
        sag_scene *scene = scene_of(&mesh);
        for (int n = 0; n < 200; n++) {
            enum { RAYS = 16 };
            sag_ray rays[RAYS];
            sag_hit hits[RAYS], hit;
            bool dark[RAYS];
            sag_vec3 origin = rng_vec3(&r, 1), direction = rng_direction(&r);
            for (int i = 0; i < RAYS; i++) {
                rays[i] = sag_ray_make(origin, sag_add(direction, rng_vec3(&r, 0.01)));
                rays[i].t_min = -0.0;
            }
            sag_intersect_batch(scene, rays, hits, RAYS);
            sag_occluded_batch(scene, rays, dark, RAYS);
            for (int i = 0; i < RAYS; i++) {
                sag_ray ray = rays[i];
                ray.t_min = 0;
                bool found = sag_intersect(scene, &ray, &hit);
                assert_int_equal(dark[i], found);
                assert_int_equal(hits[i].geometry != SAG_INVALID_ID, found);
                if (found) assert_memory_equal(&hit, &hits[i], sizeof hit);
                assert_int_equal(sag_intersect(scene, &rays[i], &hit), found);
                assert_int_equal(sag_occluded(scene, &rays[i]), found);
                assert_int_equal(sag_count_crossings(scene, &rays[i]), sag_count_crossings(scene, &ray));
            }
        }
        sag_scene_destroy(scene);
    }
}

// Where the scene is so small and the direction so long that the unit of τ overflowed, nothing was met.
static void long_directions_in_small_scenes(void **state) {
    (void)state;
    size_t met = 0;
    for (int size = 0; size > -900; size -= 25) {
        double unit = ldexp(1, size);
        sag_sphere spheres[2] = {{.center = {0, 0, 0}, .radius = unit},
                                 {.center = {3 * unit, 0, 0}, .radius = unit}};
        sag_scene *scene = sag_scene_create(context);
        for (int i = 0; i < 2; i++) sag_add_sphere(scene, &spheres[i]);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        for (int length = -400; length < 1000; length += 25) {
            sag_ray rays[16];
            sag_hit hits[16], hit, expected;
            for (int i = 0; i < 16; i++)
                rays[i] =
                    sag_ray_make(sag_vec3_make(-5 * unit, 0.1 * unit, 0.2 * unit),
                                 sag_vec3_make(ldexp(1, length), ldexp(1e-3, length), ldexp(i, length - 7)));
            sag_intersect_batch(scene, rays, hits, 16);
            for (int i = 0; i < 16; i++) {
                bool found = sag_sphere_hit(&spheres[0], &rays[i], &expected);
                met += found;
                assert_int_equal(sag_intersect(scene, &rays[i], &hit), found);
                assert_int_equal(hits[i].geometry != SAG_INVALID_ID, found);
                assert_int_equal(sag_occluded(scene, &rays[i]), found);
                if (found) assert_memory_equal(&hit.t, &expected.t, sizeof hit.t);
                if (found) assert_memory_equal(&hits[i].t, &expected.t, sizeof hit.t);
            }
        }
        sag_scene_destroy(scene);
    }
    assert_true(met > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(embree_small_triangle_hit),
        cmocka_unit_test(tinybvh_283),
        cmocka_unit_test(tinybvh_192),
        cmocka_unit_test(trimesh_2524),
        cmocka_unit_test(subnormal_times),
        cmocka_unit_test(minus_zero),
        cmocka_unit_test(long_directions_in_small_scenes),
        cmocka_unit_test(open3d_5669),
        cmocka_unit_test(one_sided_meshes_contain),
        cmocka_unit_test(ifc_lite_3561),
        cmocka_unit_test(embree_416_and_42),
        cmocka_unit_test(embree_387),
        cmocka_unit_test(equal_boxes),
        cmocka_unit_test(culling_loses_nothing),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
