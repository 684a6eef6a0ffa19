// SPDX-License-Identifier: MIT
// Nobody reads or writes beyond an array, the caller's or the library's own: kernels take four numbers at a
// time where there are three, eight triangles where there are five. Here every block of the context and every
// array of the caller ends, or begins, where a page does whose neighbour may not be touched.
#include "shapes/shape.h"
#include "support/guarded_memory.h"
#include "support/random_scene.h"
#include "support/random_solid.h"
#include "support/saved.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_RAYS = 40, MOST_HITS = 5 };

static sag_context *context_on(guarded_side side) {
    sag_context *c =
        sag_context_create(&(sag_context_options){.allocator = guarded_allocator(side), .thread_count = 2});
    assert_non_null(c);
    return c;
}

static void *guarded_room(size_t bytes) {
    static const unsigned char nothing[MOST_RAYS * sizeof(sag_hit)];
    assert_true(bytes <= sizeof nothing);
    return guarded_copy(nothing, bytes);
}

// One ray, with room for `capacity` hits and no more.
static void ask_ray(const sag_scene *scene, const sag_ray *given, size_t capacity) {
    sag_ray *ray = guarded_copy(given, sizeof *given);
    sag_hit *hit = guarded_room(sizeof *hit), *hits = guarded_room(capacity * sizeof *hits);
    sag_surface *surface = guarded_room(sizeof *surface);
    sag_span *spans = guarded_room(capacity * sizeof *spans);
    bool met = sag_intersect(scene, ray, hit);
    assert_int_equal(sag_occluded(scene, ray), met);
    if (met) sag_surface_at(scene, ray, hit, surface);
    size_t count = sag_intersect_all(scene, ray, hits, capacity);
    assert_int_equal(count > 0, met);
    for (size_t i = 0; i < count && i < capacity; i++) sag_surface_at(scene, ray, &hits[i], surface);
    sag_scene_spans(scene, ray, spans, capacity);
    guarded_free(ray, sizeof *ray), guarded_free(hit, sizeof *hit);
    guarded_free(hits, capacity * sizeof *hits), guarded_free(surface, sizeof *surface);
    guarded_free(spans, capacity * sizeof *spans);
}

static void ask_batch(const sag_scene *scene, const sag_ray *given, size_t count) {
    sag_ray *rays = guarded_copy(given, count * sizeof *rays);
    sag_hit *hits = guarded_room(count * sizeof *hits);
    bool *dark = guarded_room(count * sizeof *dark);
    sag_intersect_batch(scene, rays, hits, count);
    sag_occluded_batch(scene, rays, dark, count);
    for (size_t i = 0; i < count; i++) assert_int_equal(hits[i].geometry != SAG_INVALID_ID, dark[i]);
    guarded_free(rays, count * sizeof *rays), guarded_free(hits, count * sizeof *hits);
    guarded_free(dark, count * sizeof *dark);
}

// Single rays; batches of any length, of rays that have nothing in common and of rays from one point.
static void ask(rng *r, const sag_scene *scene, double size) {
    sag_ray rays[MOST_RAYS];
    for (int i = 0; i < 12; i++) {
        rays[0] = random_scene_ray(r, size);
        ask_ray(scene, &rays[0], rng_below(r, MOST_HITS + 1));
    }
    for (int round = 0; round < 4; round++) {
        size_t count = 1 + rng_below(r, MOST_RAYS);
        for (size_t i = 0; i < count; i++) rays[i] = random_scene_ray(r, size);
        sag_vec3 eye = rng_vec3(r, 4 * size), way = sag_sub(rng_vec3(r, size), eye);
        for (size_t i = 0; i < count && round % 2 == 0; i++)
            rays[i] = sag_ray_make(eye, sag_add(way, rng_vec3(r, 0.02 * size)));
        ask_batch(scene, rays, count);
    }
    sag_closest nearest;
    sag_closest_point(scene, rng_vec3(r, size), INFINITY, &nearest);
    sag_contains(scene, rng_vec3(r, size));
}

static void ask_samples(rng *r, const sag_scene *scene) {
    for (uint32_t id = 0; id < sag_scene_geometry_count(scene); id++)
        for (uint32_t primitive = 0; primitive < 2; primitive++) {
            sag_surface surface;
            double density;
            sag_geometry_bounds(scene, id, primitive);
            sag_geometry_area(scene, id, primitive);
            if (sag_geometry_sample(scene, id, primitive, rng_vec2(r), &surface, &density))
                sag_geometry_density(scene, id, primitive, &surface);
        }
}

// A fan of n − 2 triangles in the caller's memory, each array as long as it must be.
typedef struct fan {
    sag_mesh mesh;
    size_t position_bytes, normal_bytes, texcoord_bytes, triangle_bytes;
} fan;

static fan fan_of(rng *r, uint32_t n) {
    float floats[3 * 80], normals[3 * 80], texcoords[2 * 80];
    double doubles[3 * 80];
    uint32_t triangles[3 * 80];
    for (uint32_t i = 0; i < n; i++) {
        double angle = 6 * (double)i / n, p[3] = {cos(angle), sin(angle), rng_uniform(r, -0.3, 0.3)};
        for (uint32_t k = 0; k < 3; k++)
            floats[3 * i + k] = (float)(doubles[3 * i + k] = p[k]), normals[3 * i + k] = (float)rng_unit(r);
        texcoords[2 * i] = (float)rng_unit(r), texcoords[2 * i + 1] = (float)rng_unit(r);
    }
    for (uint32_t i = 0; i + 2 < n; i++) // the last vertex is in all of them
        triangles[3 * i] = n - 1, triangles[3 * i + 1] = i, triangles[3 * i + 2] = i + 1;
    fan f = {.mesh = {.vertex_count = n, .triangle_count = n - 2, .one_sided = rng_one_in(r, 4)}};
    bool wide = rng_one_in(r, 2);
    f.position_bytes = 3 * n * (wide ? sizeof(double) : sizeof(float));
    f.normal_bytes = 3 * n * sizeof(float), f.texcoord_bytes = 2 * n * sizeof(float);
    f.triangle_bytes = 3 * (n - 2) * sizeof(uint32_t);
    f.mesh.triangles = guarded_copy(triangles, f.triangle_bytes);
    if (wide)
        f.mesh.positions_f64 = guarded_copy(doubles, f.position_bytes);
    else
        f.mesh.positions_f32 = guarded_copy(floats, f.position_bytes);
    if (rng_one_in(r, 2)) f.mesh.normals_f32 = guarded_copy(normals, f.normal_bytes);
    if (rng_one_in(r, 2)) f.mesh.texcoords_f32 = guarded_copy(texcoords, f.texcoord_bytes);
    return f;
}

static void fan_free(fan *f) {
    guarded_free((void *)f->mesh.positions_f32, f->position_bytes);
    guarded_free((void *)f->mesh.positions_f64, f->position_bytes);
    guarded_free((void *)f->mesh.normals_f32, f->normal_bytes);
    guarded_free((void *)f->mesh.texcoords_f32, f->texcoord_bytes);
    guarded_free((void *)f->mesh.triangles, f->triangle_bytes);
}

// Of every length, so that some fill their blocks to the last byte. A mesh that a transform had moved, of an
// even number of vertices and without normals, was read eight bytes beyond its block.
static void meshes_end_with_their_last_vertex(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int side = GUARDED_END; side <= GUARDED_BEGIN; side++) {
        sag_context *c = context_on((guarded_side)side);
        for (uint32_t n = 3; n < 80; n++) {
            fan f = fan_of(&r, n);
            sag_scene *child = sag_scene_create(c), *scene = sag_scene_create(c);
            sag_affine map;
            sag_scene_set_quality(child, (sag_quality)(n % 3));
            sag_add_mesh(child, &f.mesh);
            assert_int_equal(sag_scene_commit(child, NULL), SAG_OK);
            for (int i = 0; i < 2; i++) {
                uint32_t id = sag_add_mesh(scene, &f.mesh);
                if (random_place(&r, 1, &map)) sag_geometry_set_transform(scene, id, &map);
                sag_geometry_set_update(scene, id, (sag_update)(n / 3 % 3));
                sag_add_instance(scene, child, random_place(&r, 1, &map) ? &map : NULL);
            }
            for (int turn = 0; turn < 2; turn++) {
                assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
                ask(&r, scene, 1), ask_samples(&r, scene);
                map = sag_affine_translate(rng_vec3(&r, 1));
                sag_geometry_set_transform(scene, 0, &map);
            }
            ask(&r, child, 1), ask_samples(&r, child);
            sag_mesh_report report;
            assert_int_equal(sag_mesh_check(c, &f.mesh, &report, NULL), SAG_OK);
            float *normals = guarded_room(f.normal_bytes);
            sag_mesh_compute_normals(&f.mesh, normals);
            guarded_free(normals, f.normal_bytes);
            sag_scene_destroy(scene), sag_scene_destroy(child);
            fan_free(&f);
        }
        sag_context_destroy(c);
    }
}

// The verbs of each kind, with the struct and what it points to in the caller's memory.
static void ask_alone(rng *r, sag_shape_kind kind, const void *given) {
    const sagi_shape_class *class = &sagi_shape_classes[kind];
    void *shape = guarded_copy(given, class->struct_bytes);
    sag_hit *hits = guarded_room(2 * sizeof *hits);
    sag_surface *surface = guarded_room(sizeof *surface);
    if (class->validate(shape, NULL) == SAG_OK) {
        class->bounds(shape), class->area(shape), class->sample(shape, rng_vec2(r), surface);
        if (class->volume != NULL) class->volume(shape);
        if (class->contains != NULL) class->contains(shape, rng_vec3(r, 1));
        if (class->closest_point != NULL) class->closest_point(shape, rng_vec3(r, 1));
        for (int i = 0; i < 20; i++) {
            sag_ray one = random_scene_ray(r, 1), *ray = guarded_copy(&one, sizeof one);
            if (class->hit(shape, ray, hits + 1)) class->surface(shape, ray, hits + 1, surface);
            class->occluded(shape, ray);
            class->crossings(shape, ray, hits, 2);
            guarded_free(ray, sizeof *ray);
        }
    }
    guarded_free(shape, class->struct_bytes), guarded_free(hits, 2 * sizeof *hits);
    guarded_free(surface, sizeof *surface);
}

static void shapes_alone(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (uint32_t n = 3; n < 40; n++) {
        fan f = fan_of(&r, n);
        ask_alone(&r, SAG_SHAPE_MESH, &f.mesh);
        fan_free(&f);
    }
    for (uint32_t i = 0; i < 20 * SAG_SHAPE_USER; i++) {
        sag_shape_kind kind = (sag_shape_kind)(i % SAG_SHAPE_USER);
        random_shape s;
        random_shape_make(&r, kind, 1, &s);
        void *copies[2] = {NULL, NULL};
        size_t bytes[2] = {0, 0};
        if (kind == SAG_SHAPE_POLYGON) {
            bytes[0] = s.as.polygon.position_count * sizeof(sag_vec3);
            bytes[1] = s.as.polygon.loop_count * sizeof(uint32_t);
            s.as.polygon.positions = copies[0] = guarded_copy(s.as.polygon.positions, bytes[0]);
            s.as.polygon.loop_sizes = copies[1] = guarded_copy(s.as.polygon.loop_sizes, bytes[1]);
        } else if (kind == SAG_SHAPE_POLYHEDRON) {
            bytes[0] = s.as.polyhedron.plane_count * sizeof(sag_half_space);
            s.as.polyhedron.planes = copies[0] = guarded_copy(s.as.polyhedron.planes, bytes[0]);
        } else if (kind == SAG_SHAPE_SPHERES) {
            const uint32_t n = s.as.spheres.count;
            bytes[0] = 3 * n * (s.as.spheres.centers_f64 != NULL ? sizeof(double) : sizeof(float));
            bytes[1] = n * sizeof(float);
            if (s.as.spheres.centers_f64 != NULL)
                s.as.spheres.centers_f64 = copies[0] = guarded_copy(s.as.spheres.centers_f64, bytes[0]);
            else
                s.as.spheres.centers_f32 = copies[0] = guarded_copy(s.as.spheres.centers_f32, bytes[0]);
            s.as.spheres.radii_f32 = copies[1] = guarded_copy(s.as.spheres.radii_f32, bytes[1]);
        }
        ask_alone(&r, kind, &s.as);
        guarded_free(copies[0], bytes[0]), guarded_free(copies[1], bytes[1]);
    }
}

// Sets of spheres of every length, and as many spheres of their own.
static void spheres_of_every_count(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int side = GUARDED_END; side <= GUARDED_BEGIN; side++) {
        sag_context *c = context_on((guarded_side)side);
        for (uint32_t n = 1; n < 40; n++) {
            float centers[3 * 40], radii[40];
            double wide[3 * 40];
            for (uint32_t i = 0; i < 3 * n; i++) centers[i] = (float)(wide[i] = rng_uniform(&r, -1, 1));
            for (uint32_t i = 0; i < n; i++) radii[i] = (float)rng_uniform(&r, 0.1, 0.4);
            sag_spheres set = {.count = n, .radius = 0.3};
            size_t bytes = 3 * n * (n % 2 ? sizeof *wide : sizeof *centers), radius_bytes = n * sizeof *radii;
            if (n % 2)
                set.centers_f64 = guarded_copy(wide, bytes);
            else
                set.centers_f32 = guarded_copy(centers, bytes);
            if (n % 3) set.radii_f32 = guarded_copy(radii, radius_bytes);
            sag_scene *scene = sag_scene_create(c), *single = sag_scene_create(c);
            sag_affine map;
            sag_add_spheres(scene, &set);
            uint32_t id = sag_add_spheres(scene, &set);
            if (random_place(&r, 1, &map)) sag_geometry_set_transform(scene, id, &map);
            for (uint32_t i = 0; i < n; i++) {
                sag_sphere s = {.center = {wide[3 * i], wide[3 * i + 1], wide[3 * i + 2]}, .radius = 0.2};
                sag_add_sphere(single, &s);
            }
            assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
            assert_int_equal(sag_scene_commit(single, NULL), SAG_OK);
            ask(&r, scene, 1), ask_samples(&r, scene), ask(&r, single, 1);
            sag_scene_destroy(scene), sag_scene_destroy(single);
            guarded_free((void *)set.centers_f32, bytes), guarded_free((void *)set.centers_f64, bytes);
            guarded_free((void *)set.radii_f32, radius_bytes);
        }
        sag_context_destroy(c);
    }
}

// All kinds with transforms, in scenes within scenes: asked, changed, saved, loaded and measured.
static void scenes_of_all_kinds(void **state) {
    (void)state;
    rng r = rng_make(4);
    for (int side = GUARDED_END; side <= GUARDED_BEGIN; side++) {
        sag_context *c = context_on((guarded_side)side);
        for (int round = 0; round < 2; round++) {
            sag_scene *scene = random_nested_scene(&r, c, 10 + 20 * rng_below(&r, 3), 2, 1), *loaded = NULL;
            for (int step = 0; step < 4; step++) {
                ask(&r, scene, 1);
                sag_affine map;
                uint32_t id = rng_below(&r, sag_scene_geometry_count(scene));
                sag_geometry_set_update(scene, id, (sag_update)(step % 3));
                sag_geometry_set_transform(scene, id, random_place(&r, 1, &map) ? &map : NULL);
                sag_scene_set_quality(scene, (sag_quality)(step % 3));
                assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
            }
            ask_samples(&r, scene);
            saved file = saved_from(scene, NULL, NULL);
            unsigned char *bytes = guarded_copy(file.bytes, file.count);
            assert_int_equal(saved_read(c, bytes, file.count, &loaded, NULL), SAG_OK);
            guarded_free(bytes, file.count);
            saved_free(&file);
            ask(&r, loaded, 1);
            sag_scene_destroy(scene), sag_scene_destroy(loaded);
        }
        sag_context_destroy(c);
    }
}

static void solids(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int side = GUARDED_END; side <= GUARDED_BEGIN; side++) {
        sag_context *c = context_on((guarded_side)side);
        for (int round = 0; round < 60; round++) {
            sag_scene *scene = random_solid(&r, c, 1 + rng_below(&r, 12), 1, 1, NULL, NULL);
            if (scene == NULL) continue;
            ask(&r, scene, 1);
            sag_measurement measured;
            sag_measure_options options = {.max_rays = 24576, .no_thickness = true};
            if (round < 3 && sag_measure(scene, &options, &measured, NULL) == SAG_OK)
                sag_measurement_clear(&measured);
            sag_scene_destroy(scene);
        }
        sag_context_destroy(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_end_with_their_last_vertex),
        cmocka_unit_test(shapes_alone),
        cmocka_unit_test(spheres_of_every_count),
        cmocka_unit_test(scenes_of_all_kinds),
        cmocka_unit_test(solids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
