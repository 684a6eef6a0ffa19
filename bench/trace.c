// SPDX-License-Identifier: MIT
// Measures building and tracing: bench_trace [FILE …], each a mesh; without one, a generated million
// triangles. For each model the time to build, bytes a triangle, and millions of rays a second for
//   camera   a picture's rays, neighbours alike (closest hit)
//   bounce   from the hits in random directions, nothing alike (closest hit)
//   shadow   from the hits to a point above (any hit)
// of one thread calling for one ray after another, and of a batch on all cores. Embree, where it is
// installed, runs on the same rays with one thread. Best of three runs.
#include "model.h"
#include <stdio.h>
#include <stdlib.h>
#ifdef BENCH_RENDER
#include <sagitta/render.h>
#endif

enum { SIDE = 1024, RAYS = SIDE * SIDE, RUNS = 3 };

typedef struct rays {
    const char *name;
    sag_ray *at;
    size_t count;
    bool occluded;
} rays;

static double unit(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

static sag_vec3 any_direction(uint64_t *state) {
    double z = 1 - 2 * unit(state), phi = 6.28318530717958647692 * unit(state), r = sqrt(1 - z * z);
    return sag_vec3_make(r * cos(phi), r * sin(phi), z);
}

// From 2.5 radii away, slightly above.
static void make_camera(rays *r, const sag_box3 *box) {
    sag_vec3 center = sag_scale(sag_add(box->min, box->max), 0.5), size = sag_sub(box->max, box->min);
    double radius = sag_length(size) / 2;
    sag_vec3 eye = sag_madd(center, 2.5 * radius, sag_normalize(sag_vec3_make(0.5, 0.4, 1)));
    sag_vec3 forward = sag_normalize(sag_sub(center, eye)),
             right = sag_normalize(sag_cross(forward, sag_vec3_make(0, 1, 0)));
    sag_vec3 up = sag_cross(right, forward);
    for (size_t i = 0; i < RAYS; i++) {
        double x = ((double)(i % SIDE) + 0.5) / SIDE - 0.5, y = 0.5 - ((double)i / SIDE + 0.5) / SIDE;
        r->at[i] = sag_ray_make(eye, sag_madd(sag_madd(forward, 0.8 * x, right), 0.8 * y, up));
    }
    r->count = RAYS;
}

static void make_others(const sag_scene *scene, const rays *camera, rays *bounce, rays *shadow,
                        const sag_box3 *box) {
    uint64_t state = 1;
    sag_vec3 light = sag_madd(box->max, 2, sag_sub(box->max, box->min));
    for (size_t i = 0; i < RAYS; i++) {
        sag_hit hit;
        sag_surface s;
        if (!sag_intersect(scene, &camera->at[i], &hit)) continue;
        sag_surface_at(scene, &camera->at[i], &hit, &s);
        sag_vec3 n = s.side == SAG_SIDE_FRONT ? s.geometric_normal : sag_neg(s.geometric_normal);
        bounce->at[bounce->count++] = sag_spawn_ray(&s, sag_madd(any_direction(&state), 1.0001, n));
        shadow->at[shadow->count++] = sag_spawn_ray_to_point(&s, light);
    }
}

static double best(double a, double b) { return a < b ? a : b; }

static void measure(const sag_scene *scene, const rays *r, peer *other, sag_hit *hits, bool *dark, float *t) {
    double single = INFINITY, batch = INFINITY, peers = INFINITY;
    size_t met = 0;
    for (int run = 0; run < RUNS; run++) {
        met = 0;
        double start = seconds_now();
        for (size_t i = 0; i < r->count; i++)
            met += r->occluded ? sag_occluded(scene, &r->at[i]) : sag_intersect(scene, &r->at[i], &hits[i]);
        single = best(single, seconds_now() - start);
        start = seconds_now();
        if (r->occluded)
            sag_occluded_batch(scene, r->at, dark, r->count);
        else
            sag_intersect_batch(scene, r->at, hits, r->count);
        batch = best(batch, seconds_now() - start);
        if (other != NULL) peers = best(peers, peer_trace(other, r->at, t, r->count, r->occluded));
    }
    double millions = (double)r->count / 1e6;
    printf("  %-8s %6.2f M rays, %4.1f %% met: one thread %6.2f M/s, batch %6.2f M/s", r->name, millions,
           100 * (double)met / (double)(r->count ? r->count : 1), millions / single, millions / batch);
    if (other != NULL) printf(", %s %6.2f M/s", peer_name(), millions / peers);
    printf("\n");
}

static int run(sag_context *context, const char *name, const model *m) {
    sag_scene *scene = sag_scene_create(context);
    sag_error error;
    sag_mesh mesh = {.positions_f32 = m->positions,
                     .vertex_count = m->vertex_count,
                     .triangles = m->triangles,
                     .triangle_count = m->triangle_count};
    sag_add_mesh(scene, &mesh);
    if (sag_scene_commit(scene, &error) != SAG_OK) {
        fprintf(stderr, "%s: %s\n", name, error.message);
        sag_scene_destroy(scene);
        return 1;
    }
    sag_scene_stats stats;
    sag_scene_get_stats(scene, &stats);
    double triangles = (double)m->triangle_count;
    printf("%s: %u triangles, built in %.3f s (%.2f M/s), %.0f bytes a triangle\n", name, m->triangle_count,
           stats.build_seconds, triangles / stats.build_seconds / 1e6,
           (double)(stats.structure_bytes + stats.geometry_bytes) / triangles);
    double peer_build = 0;
    peer *other = peer_name() != NULL ? peer_create(m, &peer_build) : NULL;
    if (other != NULL) printf("  %s builds in %.3f s\n", peer_name(), peer_build);

    rays sets[3] = {{.name = "camera"}, {.name = "bounce"}, {.name = "shadow", .occluded = true}};
    for (int i = 0; i < 3; i++) sets[i].at = malloc(RAYS * sizeof(sag_ray));
    sag_hit *hits = malloc(RAYS * sizeof *hits);
    bool *dark = malloc(RAYS * sizeof *dark);
    float *t = malloc(RAYS * sizeof *t);
    if (sets[0].at && sets[1].at && sets[2].at && hits && dark && t) {
        sag_box3 box = sag_scene_bounds(scene);
        make_camera(&sets[0], &box);
        make_others(scene, &sets[0], &sets[1], &sets[2], &box);
        for (int i = 0; i < 3; i++) measure(scene, &sets[i], other, hits, dark, t);
    }
    for (int i = 0; i < 3; i++) free(sets[i].at);
    free(hits);
    free(dark);
    free(t);
    if (other != NULL) peer_destroy(other);
    sag_scene_destroy(scene);
    return 0;
}

#ifdef BENCH_RENDER
static void keep(void *user, const char *name, const sag_mesh *mesh) {
    (void)name;
    model_append(user, mesh);
}

static bool load(sag_context *context, const char *path, model *m) {
    sag_world *world = sag_world_create(context);
    sag_error error = {.message = "out of memory"};
    bool loaded = world != NULL && sag_world_load_geometry(world, path, keep, m, &error) == SAG_OK;
    if (!loaded) fprintf(stderr, "%s: %s\n", path, error.message);
    sag_world_destroy(world);
    return loaded;
}
#else
static bool load(sag_context *context, const char *path, model *m) {
    (void)context, (void)m;
    fprintf(stderr, "%s: built without libsagitta-render, no files\n", path);
    return false;
}
#endif

int main(int argc, char **argv) {
    sag_context *context = sag_context_create(NULL);
    if (context == NULL) return fprintf(stderr, "no context (SAG_ISA?)\n"), 1;
    printf("Sagitta %s, %s, %u threads\n", SAG_VERSION, sag_context_isa(context),
           sag_context_thread_count(context));
    int failed = 0;
    for (int i = 1; i < argc || i == 1; i++) {
        model m = {0};
        bool made = i < argc ? load(context, argv[i], &m) : model_generate(&m, 707);
        failed |= made ? run(context, i < argc ? argv[i] : "bumpy sphere", &m) : 1;
        model_free(&m);
    }
    sag_context_destroy(context);
    return failed;
}
