// SPDX-License-Identifier: MIT
// The same bits on every machine: answers to rays at fixed scenes, one hash a scene, compared with the hashes
// written below. It needs nothing but the library, so that it can be compiled for any machine
// (scripts/neon.sh does for 64-bit ARM); CTest runs it for every instruction set and compiler. Scenes and
// rays are made with operations that IEEE 754 rounds the same everywhere: no sine, no logarithm.
//
// answers [ISA]: fails, too, when another instruction set than this is in use.
#include "support/random.h"
#include <sagitta/sagitta.h>
#include <stdio.h>
#include <string.h>

enum { RAYS = 4000, MOST = 32 };

static uint64_t mixed(uint64_t hash, const void *data, size_t bytes) { // FNV-1a
    const unsigned char *p = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ p[i]) * 0x100000001b3u;
    return hash;
}
static uint64_t mixed_number(uint64_t hash, uint64_t x) {
    unsigned char little[8];
    for (int i = 0; i < 8; i++) little[i] = (unsigned char)(x >> (8 * i));
    return mixed(hash, little, sizeof little);
}
static uint64_t mixed_double(uint64_t hash, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return mixed_number(hash, bits);
}
static uint64_t mixed_hit(uint64_t hash, const sag_hit *h) {
    hash = mixed_double(mixed_double(mixed_double(hash, h->t), h->u), h->v);
    hash = mixed_number(mixed_number(hash, h->geometry), h->primitive);
    for (uint32_t i = 0; i < h->instance_depth; i++) hash = mixed_number(hash, h->instance_path[i]);
    return hash;
}

// A hilly net of squares cut in two, with heights that are whole numbers here and there.
static void add_net(sag_scene *scene, rng *r) {
    enum { SIDE = 24 };
    static float p[(SIDE + 1) * (SIDE + 1) * 3];
    static uint32_t t[SIDE * SIDE * 6];
    uint32_t n = 0, m = 0;
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j <= SIDE; j++) {
            p[n++] = (float)i / 4 - 3;
            p[n++] = (i + j) % 3 == 0 ? 0 : (float)rng_uniform(r, -0.3, 0.3);
            p[n++] = (float)j / 4 - 3;
        }
    for (uint32_t i = 0; i < SIDE; i++)
        for (uint32_t j = 0; j < SIDE; j++) {
            uint32_t a = i * (SIDE + 1) + j, b = a + SIDE + 1, corners[6] = {a, a + 1, b, a + 1, b + 1, b};
            for (int k = 0; k < 6; k++) t[m++] = corners[k];
        }
    sag_mesh mesh = {.positions_f32 = p, .vertex_count = n / 3, .triangles = t, .triangle_count = m / 3};
    sag_add_mesh(scene, &mesh);
}

static void add_loose(sag_scene *scene, rng *r) {
    static double p[900];
    static uint32_t t[300];
    for (uint32_t i = 0; i < 300; i++) {
        sag_vec3 a = rng_vec3(r, 3);
        p[3 * i] = a.x, p[3 * i + 1] = a.y, p[3 * i + 2] = a.z, t[i] = i;
    }
    sag_mesh mesh = {.positions_f64 = p, .vertex_count = 300, .triangles = t, .triangle_count = 100};
    sag_add_mesh(scene, &mesh);
}

static void add_balls(sag_scene *scene, rng *r) {
    static double centers[900];
    static float radii[300];
    for (size_t i = 0; i < 300; i++) {
        sag_vec3 c = rng_vec3(r, 3);
        centers[3 * i] = c.x, centers[3 * i + 1] = c.y, centers[3 * i + 2] = c.z;
        radii[i] = (float)rng_uniform(r, 0.01, 0.4);
    }
    sag_spheres balls = {.centers_f64 = centers, .radii_f32 = radii, .count = 300};
    sag_add_spheres(scene, &balls);
}

static void add_shapes(sag_scene *scene, rng *r) {
    for (int i = 0; i < 12; i++) {
        // One number after the other: the order of arguments and initialisers is the compiler's own.
        sag_sphere sphere = {.center = rng_vec3(r, 3)};
        sphere.radius = rng_uniform(r, 0.1, 1);
        sag_add_sphere(scene, &sphere);
        sag_box box = {.min = rng_vec3(r, 3)};
        sag_vec3 size = rng_vec3(r, 1);
        box.max = sag_add(box.min, sag_vec3_make(fabs(size.x), fabs(size.y), fabs(size.z)));
        sag_add_box(scene, &box);
        sag_disk disk = {.center = rng_vec3(r, 3)};
        disk.normal = rng_direction(r);
        disk.radius = rng_unit(r);
        sag_add_disk(scene, &disk);
        sag_torus torus = {.major_radius = rng_uniform(r, 0.5, 2)};
        torus.minor_radius = rng_uniform(r, 0.1, 0.4);
        uint32_t id = sag_add_torus(scene, &torus);
        sag_affine move = sag_affine_translate(rng_vec3(r, 2));
        sag_geometry_set_transform(scene, id, &move);
    }
    sag_plane floor = {.point = {0, -4, 0}, .normal = {0.25, 1, 0}};
    sag_add_plane(scene, &floor);
}

static sag_ray random_ray(rng *r) {
    sag_vec3 o = rng_vec3(r, rng_one_in(r, 5) ? 1e4 : 5), aim = rng_vec3(r, 3);
    if (rng_one_in(r, 3)) { // a vertex of the net, exactly
        aim.x = (double)rng_below(r, 25) / 4 - 3;
        aim.y = 0;
        aim.z = (double)rng_below(r, 25) / 4 - 3;
    }
    sag_ray ray = sag_ray_make(o, sag_sub(aim, o));
    if (rng_one_in(r, 8)) ray.origin.x = aim.x, ray.origin.z = aim.z, ray.direction = sag_vec3_make(0, 1, 0);
    if (rng_one_in(r, 8)) ray.direction = sag_scale(ray.direction, rng_double(r, -300, 300));
    if (rng_one_in(r, 4)) ray.t_max = rng_uniform(r, 0, 2);
    if (rng_one_in(r, 4)) ray.t_min = -INFINITY;
    return ray;
}

static uint64_t ask(const sag_scene *scene, uint64_t seed) {
    static sag_ray rays[RAYS];
    static sag_hit hits[RAYS];
    static bool dark[RAYS];
    rng r = rng_make(seed);
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < RAYS; i++) {
        sag_hit all[MOST], first;
        rays[i] = random_ray(&r);
        size_t count = sag_intersect_all(scene, &rays[i], all, MOST);
        hash = mixed_number(hash, count);
        for (size_t k = 0; k < count && k < MOST; k++) hash = mixed_hit(hash, &all[k]);
        if (sag_intersect(scene, &rays[i], &first)) hash = mixed_hit(hash, &first);
        hash = mixed_number(hash, sag_occluded(scene, &rays[i]));
    }
    sag_intersect_batch(scene, rays, hits, RAYS);
    sag_occluded_batch(scene, rays, dark, RAYS);
    for (size_t i = 0; i < RAYS; i++) {
        hash = mixed_number(hash, dark[i]);
        if (hits[i].geometry != SAG_INVALID_ID) hash = mixed_hit(hash, &hits[i]);
    }
    return hash;
}

typedef struct model {
    const char *name;
    void (*add)(sag_scene *scene, rng *r);
    uint64_t expected;
} model;

static bool check(const char *name, sag_scene *scene, uint64_t expected) {
    sag_error error;
    if (sag_scene_commit(scene, &error) != SAG_OK) {
        printf("%s: %s\n", name, error.message);
        return false;
    }
    uint64_t hash = ask(scene, 7);
    printf("%-10s 0x%016llx%s\n", name, (unsigned long long)hash,
           hash == expected ? "" : " is not what it was");
    return hash == expected;
}

int main(int argc, char **argv) {
    static const model models[] = {{"net", add_net, 0x6f357db9e2386f35},
                                   {"loose", add_loose, 0x1bef64ec5f9ab06b},
                                   {"balls", add_balls, 0x074910209881df12},
                                   {"shapes", add_shapes, 0xe5979765482f7ca6}};
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = 2});
    if (context == NULL) return 2;
    const char *isa = sag_context_isa(context);
    printf("%s\n", isa);
    bool right = argc < 2 || strcmp(isa, argv[1]) == 0;
    sag_scene *all = sag_scene_create(context);
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        rng r = rng_make(i + 1);
        sag_scene *scene = sag_scene_create(context);
        models[i].add(scene, &r);
        right &= check(models[i].name, scene, models[i].expected);
        for (int k = 0; k < 3; k++) {
            sag_affine move = sag_affine_translate(rng_vec3(&r, 2)), turn = sag_affine_identity();
            turn.m[0][0] = turn.m[2][2] = 0.6, turn.m[0][2] = 0.8, turn.m[2][0] = -0.8;
            sag_affine both = sag_affine_multiply(&move, &turn);
            sag_add_instance(all, scene, &both);
        }
        sag_scene_destroy(scene);
    }
    right &= check("instances", all, 0xf86ef339090ad12f);
    sag_scene_destroy(all);
    sag_context_destroy(context);
    return right ? 0 : 1;
}
