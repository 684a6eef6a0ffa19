// SPDX-License-Identifier: MIT
// Sagitta as it is measured: built from the model, then a call a ray, or one call for all.
#include "bench.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const subject_qualities[] = {"default", "fast", "high", NULL};
static const sag_quality qualities[] = {SAG_QUALITY_DEFAULT, SAG_QUALITY_FAST, SAG_QUALITY_HIGH};

static sag_quality quality_of(const char *name) {
    for (size_t i = 0; subject_qualities[i] != NULL; i++)
        if (strcmp(subject_qualities[i], name) == 0) return qualities[i];
    return SAG_QUALITY_DEFAULT;
}

static void add_spheres(sag_scene *scene, const model *m) {
    float *centers = need((size_t)m->sphere_count * 3 * sizeof *centers);
    float *radii = need((size_t)m->sphere_count * sizeof *radii);
    for (size_t i = 0; i < m->sphere_count; i++) {
        memcpy(centers + 3 * i, m->spheres + 4 * i, 3 * sizeof *centers);
        radii[i] = m->spheres[4 * i + 3];
    }
    sag_add_spheres(scene,
                    &(sag_spheres){.centers_f32 = centers, .radii_f32 = radii, .count = m->sphere_count});
    free(centers);
    free(radii);
}

static void add_mesh(sag_scene *scene, const model *m) {
    sag_add_mesh(scene, &(sag_mesh){.positions_f32 = m->positions,
                                    .vertex_count = m->vertex_count,
                                    .triangles = m->triangles,
                                    .triangle_count = m->triangle_count});
}

static void fail(const char *what) {
    fprintf(stderr, "bench-rays: %s\n", what);
    exit(1);
}

// The time is the commit's: the geometry has been copied in before, as Embree has it in its buffers before.
subject subject_create(const model *m, const subject_options *options, built *b) {
    subject s = {0};
    s.context =
        sag_context_create(&(sag_context_options){.thread_count = options->threads, .isa = options->isa});
    if (s.context == NULL) fail("no context: does this machine have the instruction set (--isa, SAG_ISA)?");
    s.scene = sag_scene_create(s.context);
    if (s.scene == NULL) fail("out of memory");
    if (m->sphere_count > 0)
        add_spheres(s.scene, m);
    else
        add_mesh(s.scene, m);
    sag_scene_set_quality(s.scene, quality_of(options->quality));
    sag_error error;
    double start = seconds_now();
    if (sag_scene_commit(s.scene, &error) != SAG_OK) fail(error.message);
    double seconds = seconds_now() - start;
    sag_scene_stats stats;
    sag_scene_get_stats(s.scene, &stats);
    size_t peak;
    sag_context_memory(s.context, NULL, &peak);
    *b = (built){.seconds = seconds,
                 .structure_bytes = (double)stats.structure_bytes,
                 .geometry_bytes = (double)stats.geometry_bytes,
                 .peak_bytes = (double)peak,
                 .sah = stats.sah};
    return s;
}

void subject_destroy(subject *s) {
    sag_scene_destroy(s->scene);
    sag_context_destroy(s->context);
    *s = (subject){0};
}

void subject_run_init(subject_run *r, const subject *s, const ray_set *set, uint32_t threads) {
    *r = (subject_run){.scene = s->scene, .set = set, .threads = threads};
    if (set->occluded)
        r->dark = need(set->count * sizeof *r->dark);
    else
        r->hits = need(set->count * sizeof *r->hits);
    subject_reset(r);
}

void subject_run_clear(subject_run *r) {
    free(r->dark);
    free(r->hits);
}

void subject_reset(void *run) {
    subject_run *r = run;
    for (size_t i = 0; i < r->set->count; i++)
        if (r->set->occluded)
            r->dark[i] = false;
        else
            r->hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
}

static void closest_of(void *run, size_t first, size_t end) {
    const subject_run *r = run;
    for (size_t i = first; i < end; i++) sag_intersect(r->scene, &r->set->rays[i], &r->hits[i]);
}

static void any_of(void *run, size_t first, size_t end) {
    const subject_run *r = run;
    for (size_t i = first; i < end; i++) r->dark[i] = sag_occluded(r->scene, &r->set->rays[i]);
}

double subject_single(void *run) {
    subject_run *r = run;
    return crew_run(r->threads, r->set->count, r->set->occluded ? any_of : closest_of, r);
}

// The threads are those of the scene's context.
double subject_batch(void *run) {
    subject_run *r = run;
    double start = seconds_now();
    if (r->set->occluded)
        sag_occluded_batch(r->scene, r->set->rays, r->dark, r->set->count);
    else
        sag_intersect_batch(r->scene, r->set->rays, r->hits, r->set->count);
    return seconds_now() - start;
}

void subject_answers(const subject_run *r, answer *answers) {
    for (size_t i = 0; i < r->set->count; i++)
        if (r->set->occluded)
            answers[i] = (answer){0, r->dark[i] ? 0 : SAG_INVALID_ID};
        else
            answers[i] = (answer){r->hits[i].t, r->hits[i].geometry == SAG_INVALID_ID ? SAG_INVALID_ID
                                                                                      : r->hits[i].primitive};
}
