// SPDX-License-Identifier: MIT
// Surfaces of hits under transforms and nested instances: where they are, which way they face, and that a ray
// spawned at one never meets it again, at scales from 1e-9 to 1e9. And area, samples and density of what is
// placed.
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

// A random map of any size and place; keeps |translation| of the order of the size, or far beyond it.
static sag_affine random_map(rng *r) {
    double size = rng_log_uniform(r, 1e-3, 1e3);
    sag_affine turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
    sag_vec3 factors = {size, size, size};
    if (rng_one_in(r, 2)) factors.y *= rng_uniform(r, 0.2, 5), factors.z *= rng_uniform(r, 0.2, 5);
    if (rng_one_in(r, 3)) factors.x = -factors.x;
    sag_affine scale = sag_affine_scale(factors);
    sag_affine shift = sag_affine_translate(rng_vec3(r, size * (rng_one_in(r, 4) ? 1e4 : 2)));
    sag_affine m = sag_affine_multiply(&turn, &scale);
    turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
    m = sag_affine_multiply(&m, &turn);
    return sag_affine_multiply(&shift, &m);
}

// A convex closed shape around 0 of about the given size, placed at random, in `levels` instances.
typedef struct nest {
    sag_scene *scenes[4];
    int levels;
    sag_affine whole; // from the shape's space to the top's
} nest;

static nest make_nest(rng *r, double size, int levels) {
    nest n = {.levels = levels};
    for (int i = 0; i <= levels; i++) {
        n.scenes[i] = sag_scene_create(context);
        sag_affine map = random_map(r);
        if (i == 0) {
            uint32_t id = 0;
            test_mesh mesh;
            switch (rng_below(r, 5)) {
            case 0: id = sag_add_sphere(n.scenes[0], &(sag_sphere){.radius = size}); break;
            case 1:
                id = sag_add_box(n.scenes[0], &(sag_box){{-size, -size, -size}, {size, 2 * size, size}});
                break;
            case 2:
                mesh = test_mesh_sphere(1);
                test_mesh_move(&mesh, size, (sag_vec3){0, 0, 0}, 0, r);
                id = sag_add_mesh(n.scenes[0], &mesh.mesh);
                test_mesh_free(&mesh);
                break;
            case 3:
                id = sag_add_capsule(n.scenes[0],
                                     &(sag_capsule){.p0 = {-size, 0, 0}, .p1 = {0, size, 0}, .radius = size});
                break;
            default:
                id = sag_add_oriented_box(
                    n.scenes[0],
                    &(sag_oriented_box){{0, 0, 0},
                                        {{size, 0.1 * size, 0}, {0, size, 0.2 * size}, {0, 0, size}}});
            }
            assert_int_equal(id, 0);
            if (rng_one_in(r, 4))
                map = sag_affine_identity();
            else
                assert_int_equal(sag_geometry_set_transform(n.scenes[0], 0, &map), SAG_OK);
            n.whole = map;
        } else {
            assert_int_equal(sag_add_instance(n.scenes[i], n.scenes[i - 1], &map), 0);
            n.whole = sag_affine_multiply(&map, &n.whole);
        }
        assert_int_equal(sag_scene_commit(n.scenes[i], NULL), SAG_OK);
    }
    return n;
}

static void free_nest(nest *n) {
    for (int i = 0; i <= n->levels; i++) sag_scene_destroy(n->scenes[i]);
}

static void check_surface(const sag_ray *ray, const sag_hit *hit, const sag_surface *s, const nest *n) {
    sag_vec3 p = sag_ray_at(ray, hit->t);
    sag_vec3 away = sag_abs(sag_sub(p, s->position));
    // the ray's own point errs too: by a few ulp of its terms
    double reach =
        sag_max_component(sag_abs(ray->origin)) + fabs(hit->t) * sag_max_component(sag_abs(ray->direction));
    assert_true(sag_max_component(away) <= sag_max_component(s->position_error) + 0x1p-40 * reach);
    assert_true(fabs(sag_length(s->geometric_normal) - 1) < 1e-14);
    sag_vec3 u = sag_normalize(s->dpdu), v = sag_normalize(s->dpdv);
    assert_true(fabs(sag_dot(u, s->geometric_normal)) < 1e-8 && fabs(sag_dot(v, s->geometric_normal)) < 1e-8);
    // outward: away from the middle, also for mirrors
    sag_vec3 middle = sag_affine_point(&n->whole, (sag_vec3){0, 0, 0});
    assert_true(sag_dot(sag_sub(s->position, middle), s->geometric_normal) > 0);
    double approach = sag_dot(ray->direction, s->geometric_normal);
    assert_int_equal(s->side, approach > 0 ? SAG_SIDE_BACK : SAG_SIDE_FRONT);
}

static void spawned_rays(void **state) {
    (void)state;
    rng r = rng_make(11);
    size_t hits = 0;
    for (size_t i = 0, count = soak(600); i < count; i++) {
        nest n = make_nest(&r, rng_log_uniform(&r, 1e-9, 1e9), (int)rng_below(&r, 4));
        sag_scene *top = n.scenes[n.levels];
        sag_box3 box = sag_scene_bounds(top);
        sag_vec3 extent = sag_sub(box.max, box.min);
        for (int k = 0; k < 30; k++) {
            sag_vec3 in = rng_vec3(&r, 0.5), o = rng_vec3(&r, rng_one_in(&r, 5) ? 1e4 : 2);
            sag_vec3 target = sag_add(sag_scale(sag_add(box.min, box.max), 0.5), sag_mul(in, extent));
            sag_ray ray = sag_ray_make(sag_add(target, sag_mul(o, extent)), (sag_vec3){0, 0, 0});
            ray.direction = sag_scale(sag_sub(target, ray.origin), rng_log_uniform(&r, 1e-6, 1e6));
            sag_hit hit;
            if (!sag_ray_is_valid(&ray) || !sag_intersect(top, &ray, &hit)) continue;
            hits++;
            sag_surface s;
            sag_surface_at(top, &ray, &hit, &s);
            check_surface(&ray, &hit, &s, &n);
            // Where the place leaves the shape few digits, a step inwards may lead through it.
            bool fine = sag_max_component(s.position_error) < 1e-9 * sag_max_component(extent);
            for (int d = 0; d < 3; d++) {
                sag_vec3 w = rng_direction(&r);
                sag_ray out = sag_spawn_ray(&s, w);
                size_t crossings = sag_count_crossings(top, &out);
                double side = sag_dot(w, s.geometric_normal);
                if (side > 0)
                    assert_int_equal(crossings, 0); // convex: nothing else to meet
                else if (fine && side < -1e-6)
                    assert_int_equal(crossings, 1); // the way out
            }
        }
        free_nest(&n);
    }
    assert_true(hits > soak(600) * 5);
}

// A mirrored, textured, smooth mesh: normals and texture coordinates go where the geometry goes.
static void mirrored_mesh(void **state) {
    (void)state;
    float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    float normals[9] = {0, 0.6f, 0.8f, 0, 0, 1, 0, 0, 1};
    float texcoords[6] = {0, 0, 1, 0, 0, 2};
    uint32_t triangles[3] = {0, 1, 2};
    sag_mesh mesh = {.positions_f32 = positions,
                     .normals_f32 = normals,
                     .texcoords_f32 = texcoords,
                     .triangles = triangles,
                     .vertex_count = 3,
                     .triangle_count = 1,
                     .one_sided = true};
    sag_affine mirror = sag_affine_scale((sag_vec3){-1, 1, 1});
    sag_scene *scene = sag_scene_create(context);
    sag_geometry_set_transform(scene, sag_add_mesh(scene, &mesh), &mirror);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_ray ray = sag_ray_make((sag_vec3){-0.25, 0.5, 3}, (sag_vec3){0, 0, -1});
    sag_hit hit;
    assert_true(sag_intersect(scene, &ray, &hit)); // the front is still the side +z
    assert_true(hit.u == 0.25 && hit.v == 0.5);
    sag_surface s;
    sag_surface_at(scene, &ray, &hit, &s);
    assert_int_equal(s.side, SAG_SIDE_FRONT);
    assert_true(s.geometric_normal.z == 1 && s.shading_normal.z > 0.9 && s.shading_normal.y > 0);
    assert_true(s.u == 0.25 && s.v == 1 && s.dpdu.x == -1 && s.dpdv.y == 0.5);
    sag_ray behind = sag_ray_make((sag_vec3){-0.25, 0.5, -3}, (sag_vec3){0, 0, 1});
    assert_false(sag_occluded(scene, &behind));
    double density;
    assert_true(sag_geometry_sample(scene, 0, 0, (sag_vec2){0.3, 0.3}, &s, &density));
    assert_true(s.geometric_normal.z == 1 && density == 2 && s.position.x < 0);
    sag_scene_destroy(scene);
}

// The mean of 1/density over samples is the area; areas of flat shapes and similarities are exact.
static void area_and_samples(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_affine stretch = sag_affine_scale((sag_vec3){2, 3, -4});
    sag_affine twice = sag_affine_scale((sag_vec3){-2, 2, 2});
    uint32_t flat = sag_add_rectangle(scene, &(sag_rectangle){{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    uint32_t sphere = sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    uint32_t ellipsoid = sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    uint32_t plane = sag_add_plane(scene, &(sag_plane){.normal = {0, 1, 0}});
    sag_geometry_set_transform(scene, flat, &stretch);
    sag_geometry_set_transform(scene, sphere, &twice);
    sag_geometry_set_transform(scene, ellipsoid, &stretch);
    sag_geometry_set_transform(scene, plane, &stretch);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_true(fabs(sag_geometry_area(scene, flat, 0) - 6) < 1e-14);
    assert_true(fabs(sag_geometry_area(scene, sphere, 0) - 16 * 3.14159265358979323846) < 1e-12);
    assert_true(fabs(sag_geometry_area(scene, ellipsoid, 0) - 111.5457) < 0.02); // by elliptic integrals
    assert_true(isinf(sag_geometry_area(scene, plane, 0)) && isnan(sag_geometry_area(scene, 9, 0)));
    rng r = rng_make(12);
    uint32_t ids[3] = {flat, sphere, ellipsoid};
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        int count = 20000;
        for (int i = 0; i < count; i++) {
            sag_surface s;
            double density;
            assert_true(sag_geometry_sample(scene, ids[k], 0, rng_vec2(&r), &s, &density));
            double again = sag_geometry_density(scene, ids[k], 0, &s);
            assert_true(fabs(density - again) <= 1e-10 * density);
            assert_int_equal(s.geometry, ids[k]);
            sum += 1 / density;
        }
        double area = sag_geometry_area(scene, ids[k], 0);
        assert_true(fabs(sum / count - area) < 0.02 * area);
    }
    sag_surface s;
    double density;
    assert_false(sag_geometry_sample(scene, plane, 0, (sag_vec2){0.5, 0.5}, &s, &density));
    sag_scene_destroy(scene);
}

// A sample of what an instance of an instance shows, brought outward, is the surface that a ray finds there.
static void samples_within_instances(void **state) {
    (void)state;
    rng r = rng_make(7);
    for (int k = 0; k < 100; k++) {
        nest n = make_nest(&r, rng_log_uniform(&r, 1e-3, 1e3), 2);
        sag_surface sample, found;
        double density;
        assert_true(sag_instance_scene(n.scenes[1], 0) == n.scenes[0]);
        assert_true(sag_instance_scene(n.scenes[2], 0) == n.scenes[1]);
        assert_null(sag_instance_scene(n.scenes[0], 0));
        assert_null(sag_instance_scene(n.scenes[2], 7));
        assert_int_equal(sag_scene_geometry_count(n.scenes[1]), 1);
        assert_true(sag_geometry_sample(n.scenes[0], 0, 0, rng_vec2(&r), &sample, &density));
        const sag_surface inner = sample;
        const sag_box3 box = sag_geometry_bounds(n.scenes[0], 0, 0),
                       all = sag_geometry_bounds(n.scenes[1], 0, 0),
                       none = sag_geometry_bounds(n.scenes[1], 7, 0);
        assert_true(sag_box3_is_empty(&none) && !sag_box3_is_empty(&all));
        const sag_box3 with = sag_box3_extend(box, sample.position);
        if (n.scenes[0] && sag_geometry_area(n.scenes[0], 0, 1) == sag_geometry_area(n.scenes[0], 0, 0))
            assert_memory_equal(&with, &box, sizeof box); // (one primitive, not a triangle of a mesh)
        sag_instance_map_surface(n.scenes[2], 7, &sample);
        assert_memory_equal(&sample, &inner, sizeof sample);
        sag_instance_map_surface(n.scenes[1], 0, &sample);
        sag_instance_map_surface(n.scenes[2], 0, &sample);
        // From outside of a convex shape: the point is the first that the ray meets.
        const double size =
            sag_length(sag_sub(sample.position, sag_affine_point(&n.whole, sag_vec3_make(0, 0, 0))));
        sag_ray ray = sag_ray_make(sag_madd(sample.position, size, sample.geometric_normal),
                                   sag_neg(sample.geometric_normal));
        sag_hit hit;
        assert_true(sag_intersect(n.scenes[2], &ray, &hit));
        sag_surface_at(n.scenes[2], &ray, &hit, &found);
        const double apart = sag_length(sag_sub(found.position, sample.position));
        // Far from the origin positions are less exact.
        const double blur = sag_length(found.position_error) + sag_length(sample.position_error);
        if (!(apart < 1e-7 * size + 8 * blur)) fail_msg("nest %d of size %g: %g apart", k, size, apart);
        assert_true(sag_dot(found.geometric_normal, sample.geometric_normal) > 0.999);
        free_nest(&n);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spawned_rays),
        cmocka_unit_test(mirrored_mesh),
        cmocka_unit_test(area_and_samples),
        cmocka_unit_test(samples_within_instances),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
