// SPDX-License-Identifier: MIT
// A mesh with a dozen balls cut out of it, beside the mesh alone: the same rays, single calls and batches,
// one thread. The balls stand about vertices of the mesh, so that they cut what can be seen.
#include "../bench.h"
#include "solids.h"
#include <sagitta/solid.h>
#include <stdlib.h>
#include <string.h>

enum { BALLS = 12, MOST_REPEATS = 101 };

static bool add_mesh(sag_scene *scene, const model *m) {
    return sag_add_mesh(scene, &(sag_mesh){.positions_f32 = m->positions,
                                           .vertex_count = m->vertex_count,
                                           .triangles = m->triangles,
                                           .triangle_count = m->triangle_count}) != SAG_INVALID_ID;
}

// The mesh is part 0, the balls those after it.
static bool carve(sag_scene *solid, const model *m, sag_error *error) {
    sag_solid_step steps[BALLS + 2] = {{SAG_SOLID_PART, 0}};
    uint64_t state = 5;
    if (!add_mesh(solid, m)) return false;
    for (uint32_t i = 0; i < BALLS; i++) {
        const float *at = m->positions + 3 * (size_t)(random_unit(&state) * m->vertex_count);
        const sag_sphere ball = {.center = {(double)at[0], (double)at[1], (double)at[2]},
                                 .radius = m->radius * (0.05 + 0.1 * random_unit(&state))};
        steps[i + 1] = (sag_solid_step){SAG_SOLID_PART, sag_add_sphere(solid, &ball)};
    }
    steps[BALLS + 1] = (sag_solid_step){SAG_SOLID_DIFFERENCE, BALLS + 1};
    return sag_scene_set_solid(solid, &(sag_solid){steps, BALLS + 2}, error) == SAG_OK &&
           sag_scene_commit(solid, error) == SAG_OK;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *seconds, unsigned count) {
    qsort(seconds, count, sizeof *seconds, by_size);
    return (seconds[count / 2] + seconds[(count - 1) / 2]) / 2;
}

// Mesh and solid, single and batch, in turns.
static void race(carving *c, const ray_set *set, const subject *mesh, const subject *solid,
                 unsigned repeats) {
    double seconds[4][MOST_REPEATS];
    subject_run runs[2];
    subject_run_init(&runs[0], mesh, set, 1);
    subject_run_init(&runs[1], solid, set, 1);
    for (unsigned i = 0; i < repeats; i++)
        for (unsigned k = 0; k < 4; k++) {
            const unsigned now = (k + i) % 4;
            subject_reset(&runs[now & 1]);
            seconds[now][i] = (now < 2 ? subject_single : subject_batch)(&runs[now & 1]);
        }
    const double rays = (double)set->count / 1e6;
    *c = (carving){.set = set->name, .rays = set->count};
    for (int k = 0; k < 2; k++)
        c->mesh[k] = rays / median(seconds[2 * k], repeats),
        c->solid[k] = rays / median(seconds[2 * k + 1], repeats);
    for (size_t i = 0; i < set->count; i++) c->met += runs[1].hits[i].geometry != SAG_INVALID_ID;
    subject_run_clear(&runs[0]);
    subject_run_clear(&runs[1]);
}

static void measure(const model *m, const subject *mesh, const subject *solid, unsigned side,
                    unsigned repeats, carving carvings[CARVINGS]) {
    static const int which[CARVINGS] = {SET_CAMERA, SET_CHORD};
    ray_set sets[SET_COUNT] = {{0}};
    sets_make(sets, 1U << SET_CAMERA | 1U << SET_CHORD, m, mesh->scene, side);
    for (int i = 0; i < CARVINGS; i++) race(&carvings[i], &sets[which[i]], mesh, solid, repeats);
    sets_free(sets);
}

bool measure_carving(const char *path, unsigned side, unsigned repeats, carving carvings[CARVINGS]) {
    model m;
    sag_error error = {0};
    if (!model_load(&m, path)) return false;
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = 1});
    subject mesh = {context, sag_scene_create(context)}, solid = {context, sag_scene_create(context)};
    sag_scene *carved = sag_scene_create(context);
    const sag_affine here = sag_affine_identity();
    const bool good = mesh.scene != NULL && solid.scene != NULL && carved != NULL &&
                      add_mesh(mesh.scene, &m) && sag_scene_commit(mesh.scene, &error) == SAG_OK &&
                      carve(carved, &m, &error) &&
                      sag_add_instance(solid.scene, carved, &here) != SAG_INVALID_ID &&
                      sag_scene_commit(solid.scene, &error) == SAG_OK;
    if (good)
        measure(&m, &mesh, &solid, side, repeats < MOST_REPEATS ? repeats : MOST_REPEATS, carvings);
    else
        fprintf(stderr, "bench-solids: %s: %s\n", path, error.message);
    sag_scene_destroy(carved);
    sag_scene_destroy(solid.scene);
    sag_scene_destroy(mesh.scene);
    sag_context_destroy(context);
    model_free(&m);
    return good;
}
