// SPDX-License-Identifier: MIT
// What rays ask of a committed scene: thin doors to the kernel chosen for this machine.
#include "scene/scene.h"

bool sag_intersect(const sag_scene *scene, const sag_ray *ray, sag_hit *hit) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    return s != NULL && scene->kernel->intersect(&s->world, ray, hit);
}

bool sag_occluded(const sag_scene *scene, const sag_ray *ray) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    return s != NULL && scene->kernel->occluded(&s->world, ray);
}

static size_t crossings(const sag_scene *scene, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    return s != NULL ? scene->kernel->crossings(&s->world, ray, both_sides, hits, capacity) : 0;
}

size_t sag_intersect_all(const sag_scene *scene, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    return crossings(scene, ray, false, hits, capacity);
}

size_t sag_count_crossings(const sag_scene *scene, const sag_ray *ray) {
    return sag_intersect_all(scene, ray, NULL, 0);
}

bool sag_contains(const sag_scene *scene, sag_vec3 point) {
    // Any direction would do, as ties are decided exactly; this one is not along the axes and diagonals that
    // modelled surfaces like, so it meets few ties. (√2 − 1, √3 − 1, √5 − 2.)
    sag_ray ray =
        sag_ray_make(point, sag_vec3_make(0.41421356237309503, 0.7320508075688772, 0.2360679774997898));
    return crossings(scene, &ray, true, NULL, 0) % 2 == 1;
}

// Rays a thread takes at a time: enough to hide the hand-over, few enough to share evenly.
#define RAYS_AT_A_TIME ((size_t)1024)

typedef struct batch {
    const sag_scene *scene;
    const sagi_snapshot *snapshot;
    const sag_ray *rays;
    sag_hit *hits;
    bool *occluded;
    size_t count;
} batch;

static size_t part_of(const batch *b, size_t begin) {
    return b->count - begin < RAYS_AT_A_TIME ? b->count - begin : RAYS_AT_A_TIME;
}

static void intersect_some(void *argument, size_t index) {
    const batch *b = argument;
    size_t begin = index * RAYS_AT_A_TIME;
    b->scene->kernel->intersect_batch(&b->snapshot->world, b->rays + begin, b->hits + begin,
                                      part_of(b, begin));
}

static void occlude_some(void *argument, size_t index) {
    const batch *b = argument;
    size_t begin = index * RAYS_AT_A_TIME;
    b->scene->kernel->occluded_batch(&b->snapshot->world, b->rays + begin, b->occluded + begin,
                                     part_of(b, begin));
}

// As many pieces as it takes; what fits in one needs no other thread.
static void trace(batch *b, void (*some)(void *argument, size_t index)) {
    if (b->count <= RAYS_AT_A_TIME) {
        if (b->count > 0) some(b, 0);
        return;
    }
    sag_parallel_for(b->scene->context, (b->count - 1) / RAYS_AT_A_TIME + 1, some, b);
}

void sag_intersect_batch(const sag_scene *scene, const sag_ray *rays, sag_hit *hits, size_t count) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL) {
        for (size_t i = 0; i < count; i++) hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
        return;
    }
    batch b = {.scene = scene, .snapshot = s, .rays = rays, .hits = hits, .count = count};
    trace(&b, intersect_some);
}

void sag_occluded_batch(const sag_scene *scene, const sag_ray *rays, bool *occluded, size_t count) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL) {
        for (size_t i = 0; i < count; i++) occluded[i] = false;
        return;
    }
    batch b = {.scene = scene, .snapshot = s, .rays = rays, .occluded = occluded, .count = count};
    trace(&b, occlude_some);
}
