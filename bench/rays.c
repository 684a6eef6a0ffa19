// SPDX-License-Identifier: MIT
// The four sets of rays:
//
//   camera  a picture of side × side pixels from 2.5 radii away, one ray a pixel, in tiles of 4 × 4 (so that
//           sixteen rays in a row are a packet); closest hit
//   bounce  one from each of the camera's hits, cosine-distributed about the normal; closest hit
//   shadow  ambient occlusion: the same with other random numbers, 0.3 radii long; any hit
//   chord   from one random point of the bounding sphere to another, and on; nothing alike; closest hit
//
// Bounces are spawned in double by sag_spawn_ray and then, as all rays, rounded to float, since Embree takes
// nothing else. That may put the origin back behind the surface, so bounces and shadows start at t = 1e-4
// radii, for both sides alike: far enough for either not to meet the surface it has just left (float carries
// 6e-8 of the coordinates), and the same question for both.
#include "bench.h"
#include <stdlib.h>

const char *const set_names[SET_COUNT] = {"camera", "bounce", "shadow", "chord"};

#define FIELD 0.55 // twice the tangent of half the angle of view: the model fills the picture, with some sky
#define START 1e-4
#define REACH 0.3

static sag_vec3 rounded(sag_vec3 v) { return sag_vec3_make((float)v.x, (float)v.y, (float)v.z); }

static sag_ray float_ray(sag_vec3 origin, sag_vec3 direction, double t_min, double t_max) {
    sag_ray ray = sag_ray_make(rounded(origin), rounded(direction));
    ray.t_min = (float)t_min;
    ray.t_max = (float)t_max;
    return ray;
}

static sag_vec3 any_direction(uint64_t *state) {
    double z = 1 - 2 * random_unit(state), phi = 6.28318530717958647692 * random_unit(state);
    double r = sqrt(1 - z * z);
    return sag_vec3_make(r * cos(phi), r * sin(phi), z);
}

static sag_vec3 cosine_direction(sag_vec3 normal, uint64_t *state) {
    sag_vec3 s, t;
    sag_frame(normal, &s, &t);
    double r2 = random_unit(state), phi = 6.28318530717958647692 * random_unit(state), r = sqrt(r2);
    return sag_madd(sag_madd(sag_scale(normal, sqrt(1 - r2)), r * cos(phi), s), r * sin(phi), t);
}

static void make_camera(ray_set *set, const model *m, uint32_t side) {
    sag_vec3 eye = sag_madd(m->center, 2.5 * m->radius, sag_normalize(sag_vec3_make(0.5, 0.4, 1)));
    sag_vec3 forward = sag_normalize(sag_sub(m->center, eye));
    sag_vec3 right = sag_normalize(sag_cross(forward, sag_vec3_make(0, 1, 0)));
    sag_vec3 up = sag_cross(right, forward);
    uint32_t tiles = side / 4;
    for (size_t i = 0; i < (size_t)side * side; i++) {
        size_t tile = i / 16, within = i % 16;
        double column = (double)(tile % tiles * 4 + within % 4),
               row = (double)(tile / tiles * 4 + within / 4);
        double x = (column + 0.5) / side - 0.5, y = 0.5 - (row + 0.5) / side;
        sag_vec3 towards = sag_madd(sag_madd(forward, FIELD * x, right), FIELD * y, up);
        set->rays[i] = float_ray(eye, sag_normalize(towards), 0, INFINITY);
    }
    set->count = (size_t)side * side;
}

static void make_from_hits(ray_set sets[SET_COUNT], const model *m, const sag_scene *scene) {
    const ray_set *camera = &sets[SET_CAMERA];
    ray_set *bounce = &sets[SET_BOUNCE], *shadow = &sets[SET_SHADOW];
    uint64_t state = 1;
    for (size_t i = 0; i < camera->count; i++) {
        sag_hit hit;
        sag_surface s;
        if (!sag_intersect(scene, &camera->rays[i], &hit)) continue;
        sag_surface_at(scene, &camera->rays[i], &hit, &s);
        sag_vec3 normal = s.side == SAG_SIDE_FRONT ? s.geometric_normal : sag_neg(s.geometric_normal);
        sag_ray ray = sag_spawn_ray(&s, cosine_direction(normal, &state));
        bounce->rays[bounce->count++] = float_ray(ray.origin, ray.direction, START * m->radius, INFINITY);
        ray = sag_spawn_ray(&s, cosine_direction(normal, &state));
        shadow->rays[shadow->count++] =
            float_ray(ray.origin, ray.direction, START * m->radius, REACH * m->radius);
    }
}

static void make_chords(ray_set *set, const model *m, size_t count) {
    uint64_t state = 2;
    while (set->count < count) {
        sag_vec3 from = any_direction(&state), way = sag_sub(any_direction(&state), from);
        if (!(sag_length(way) > 0)) continue;
        set->rays[set->count++] =
            float_ray(sag_madd(m->center, m->radius, from), sag_normalize(way), 0, INFINITY);
    }
}

void sets_make(ray_set sets[SET_COUNT], unsigned wanted, const model *m, const sag_scene *scene,
               uint32_t side) {
    size_t most = (size_t)side * side;
    for (int i = 0; i < SET_COUNT; i++)
        sets[i] = (ray_set){.name = set_names[i], .rays = need(most * sizeof(sag_ray))};
    sets[SET_CAMERA].packets = true;
    sets[SET_SHADOW].occluded = true;
    make_camera(&sets[SET_CAMERA], m, side);
    if ((wanted & (1u << SET_BOUNCE | 1u << SET_SHADOW)) != 0) make_from_hits(sets, m, scene);
    if ((wanted & 1u << SET_CHORD) != 0) make_chords(&sets[SET_CHORD], m, most);
    for (int i = 0; i < SET_COUNT; i++)
        if ((wanted & 1u << i) == 0) sets[i].count = 0;
}

void sets_free(ray_set sets[SET_COUNT]) {
    for (int i = 0; i < SET_COUNT; i++) free(sets[i].rays);
}
