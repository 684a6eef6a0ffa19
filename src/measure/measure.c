// SPDX-License-Identifier: MIT
// sag_measure: which body is measured how.
//
// A body is looked at in the space of its own snapshot where the way to the scene is a similarity: then all
// instances of it have one measurement, which is mapped to each place. Under another map areas and
// thicknesses change in their own ways, so the body is looked at in the scene's space, each instance by
// itself.
//
//   * one closed shape: closed forms, mapped (closed_form.c, revolution.c; area.c);
//   * a mesh whose edges are in balance: exact sums (mesh_moments.c);
//   * all else that is closed: solids, sets of spheres, meshes that are closed but face both ways: rays.
#include "measure/measure.h"
#include "math/elementary.h"
#include "shapes/shape.h"
#include <string.h>

// Rays for thickness: that many lines of each family for one body, fewer when there are many bodies.
#define THICKNESS_LINES  128
#define THICKNESS_BUDGET ((size_t)1 << 18)

// One geometry or solid, wherever it stands.
typedef struct slot {
    sagi_result *result; // once it is known and another body will ask for it
    uint32_t uses;       // bodies that have not asked yet
} slot;

typedef struct job {
    const sag_context *context;
    const sagi_kernel *kernel;
    sag_measure_options options;
    sagi_reporter reporter;
    sagi_body_list list;
    struct slot *slots; // what similar instances share
    uint32_t thickness_lines;
    sag_error *error;
} job;

bool sagi_report(sagi_reporter *reporter, double fraction, uint64_t rays) {
    sag_measure_progress *p = &reporter->progress;
    p->rays += rays;
    if (fraction > p->fraction) p->fraction = fraction;
    if (reporter->options->progress != NULL && !reporter->options->progress(reporter->options->user, p))
        reporter->stop = true;
    return !reporter->stop;
}

// What a body's measuring needs to know: where it is looked at.
typedef struct scene_of_body {
    sag_body *body;
    const sagi_subject *subject;
    const sagi_item *item; // NULL for a solid
    bool mapped;           // to the scene's space, by `place`
    sagi_place place;
    sagi_place shape_place; // from the shape's space to where it is looked at
    bool shape_placed;
    sag_box3 box;
    uint64_t seed;
} scene_of_body;

static sag_status say(job *j, sag_status status, const char *what) {
    return sag_error_set(j->error, status, "%s", what);
}

static sag_status sampling_failed(job *j) {
    return j->reporter.stop ? say(j, SAG_ERROR_CANCELLED, "cancelled")
                            : say(j, SAG_ERROR_MEMORY, "out of memory");
}

static bool look_by_depth(const scene_of_body *b) {
    if (b->item == NULL) return false;
    if (b->item->kind == SAG_SHAPE_SPHERES) return true;
    if (b->item->kind != SAG_SHAPE_TORUS) return false;
    const sag_torus *t = b->item->shape;
    return t->major_radius < t->minor_radius;
}

static sagi_target target_of(const job *j, const scene_of_body *b) {
    return (sagi_target){.context = j->context,
                         .kernel = j->kernel,
                         .snapshot = b->subject->snapshot,
                         .geometry = b->body->geometry,
                         .by_depth = look_by_depth(b),
                         .mapped = b->mapped,
                         .place = b->place,
                         .box = b->box};
}

static bool is_bounded(const sag_box3 *box) { return sag_is_finite(box->min) && sag_is_finite(box->max); }

// ---- one body, where it is looked at

static void take_exact(const job *j, const scene_of_body *b, const sagi_moments *moments,
                       sagi_result *result) {
    const sag_shape_kind kind = (sag_shape_kind)b->item->kind;
    const sagi_place *place = b->shape_placed ? &b->shape_place : NULL;
    result->moments = place != NULL ? sagi_moments_map(moments, &place->to_scene) : *moments;
    result->area = sagi_shape_area(kind, b->item->shape, place, &j->options, b->seed);
    result->by_rays = result->area.error > 0;
    result->reached = !(result->area.error > j->options.error * result->area.value);
}

static sag_status measure_mesh(job *j, const scene_of_body *b, sagi_result *result) {
    const sag_mesh *mesh = b->item->shape;
    const sag_vec3 middle = sag_scale(sag_add(b->box.min, b->box.max), 0.5);
    sagi_mesh_sums sums;
    if (!sagi_mesh_sum(j->context, mesh, b->mapped ? &b->place.to_scene : NULL, middle, &sums))
        return say(j, SAG_ERROR_MEMORY, "out of memory");
    result->area = (sag_estimate){sums.area, 0};
    result->reached = true;
    result->report.triangle_count = mesh->triangle_count;
    const bool balanced = sums.balanced;
    if (!balanced) {
        const sag_status status = sag_mesh_check(j->context, mesh, &result->report, j->error);
        if (status != SAG_OK) return status;
        result->state = sagi_geometry_is_closed(b->subject->snapshot, b->body->geometry) ? SAG_BODY_CLOSED
                                                                                         : SAG_BODY_OPEN;
        return SAG_OK;
    }
    result->report.closed = true;
    result->state = SAG_BODY_CLOSED;
    const bool turned = (b->mapped && b->place.mirrored) != b->item->mirrored;
    result->inside_out = (sums.raw.m[0] < 0) != turned;
    if (sums.raw.m[0] < 0)
        for (int k = 0; k < SAGI_RAW_COUNT; k++) sums.raw.m[k] = -sums.raw.m[k];
    result->moments = sagi_moments_from_raw(&sums.raw, middle);
    result->volume_error = sums.volume_error > 0x1p-30 * result->moments.volume ? sums.volume_error : 0;
    return SAG_OK;
}

static sag_status sample_body(job *j, const scene_of_body *b, sagi_result *result) {
    const sagi_target target = target_of(j, b);
    sagi_result sampled = *result;
    if (!sagi_sample_body(&target, b->seed, &j->reporter, &sampled)) return sampling_failed(j);
    // A mesh's area is known, and what its report says.
    if (b->item != NULL && b->item->kind == SAG_SHAPE_MESH && !j->options.sample_all)
        sampled.area = result->area;
    *result = sampled;
    return SAG_OK;
}

static sag_status measure_inside(job *j, const scene_of_body *b, sagi_result *result) {
    sagi_moments moments;
    bool exact = false;
    if (b->item == NULL) {
        result->state = sag_box3_is_empty(&b->box) ? SAG_BODY_EMPTY : SAG_BODY_CLOSED;
    } else if (b->item->kind == SAG_SHAPE_MESH) {
        const sag_status status = measure_mesh(j, b, result);
        if (status != SAG_OK) return status;
        exact = result->report.closed;
    } else {
        const sag_shape_kind kind = (sag_shape_kind)b->item->kind;
        result->state = sagi_shape_state(kind, b->item->shape);
        exact = result->state == SAG_BODY_CLOSED && sagi_shape_moments(kind, b->item->shape, &moments);
        if (exact) take_exact(j, b, &moments, result);
        if (result->state == SAG_BODY_OPEN)
            result->area = sagi_shape_area(kind, b->item->shape, b->shape_placed ? &b->shape_place : NULL,
                                           &j->options, b->seed);
    }
    if (result->state == SAG_BODY_CLOSED && !is_bounded(&b->box)) result->state = SAG_BODY_UNBOUNDED;
    if (result->state != SAG_BODY_CLOSED) return SAG_OK;
    if (!exact || j->options.sample_all) {
        const sag_status status = sample_body(j, b, result);
        if (status != SAG_OK) return status;
    }
    if (j->options.no_thickness || result->state != SAG_BODY_CLOSED) return SAG_OK;
    const sagi_target target = target_of(j, b);
    if (!sagi_sample_thickness(&target, b->seed + 1, j->thickness_lines, &j->reporter, result))
        return sampling_failed(j);
    return SAG_OK;
}

// ---- to the scene

static sag_estimate scaled(double value, double error, double scale) {
    return (sag_estimate){scale * value, scale * error};
}

// |M| e, and |M| E |M|ᵀ: errors of what is mapped by M.
static void map_errors(const sag_affine *map, const sagi_result *r, double factor, double center[3],
                       double inertia[3][3]) {
    double half[3][3];
    for (int i = 0; i < 3; i++) {
        center[i] = 0;
        for (int j = 0; j < 3; j++) {
            center[i] += fabs(map->m[i][j]) * r->center_error[j];
            half[i][j] = 0;
            for (int k = 0; k < 3; k++) half[i][j] += fabs(map->m[i][k]) * r->inertia_error[k][j];
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            inertia[i][j] = 0;
            for (int k = 0; k < 3; k++) inertia[i][j] += factor * half[i][k] * fabs(map->m[j][k]);
        }
}

static void write_thickness(const sagi_result *r, const sag_affine *map, double scale, sag_thickness *t) {
    *t = r->thickness;
    t->min *= scale, t->max *= scale, t->mean.value *= scale, t->mean.error *= scale;
    for (int i = 0; i < SAG_THICKNESS_PERCENTILES; i++) t->percentiles[i] *= scale;
    t->thinnest = t->sample_count > 0 ? sag_affine_point(map, t->thinnest) : sag_vec3_make(0, 0, 0);
}

static void write_body(const sagi_result *r, const sag_affine *map, sag_body *body) {
    const double determinant = fabs(sag_affine_determinant(map)), scale = sagi_cbrt(determinant);
    const sagi_moments m = sagi_moments_map(&r->moments, map);
    body->state = r->state;
    body->by_rays = r->by_rays, body->reached = r->reached;
    body->inside_out = r->inside_out, body->overlaps = r->overlaps;
    body->rays = r->rays, body->report = r->report;
    body->area = scaled(r->area.value, r->area.error, scale * scale);
    write_thickness(r, map, scale, &body->thickness);
    const sag_estimate unknown = {NAN, NAN};
    if (r->state != SAG_BODY_CLOSED && r->state != SAG_BODY_EMPTY) {
        const double value = r->state == SAG_BODY_UNBOUNDED ? INFINITY : NAN;
        body->volume = (sag_estimate){value, 0};
        if (r->state == SAG_BODY_UNBOUNDED) body->area = body->volume;
        for (int i = 0; i < 3; i++) {
            body->center[i] = body->principal[i] = unknown;
            for (int k = 0; k < 3; k++) body->inertia[i][k] = unknown;
        }
        return;
    }
    body->volume = (sag_estimate){m.volume, determinant * r->volume_error};
    double inertia[3][3], inertia_error[3][3], center_error[3], principal[3];
    sagi_moments_inertia(&m, inertia);
    sagi_symmetric_eigen(inertia, principal, body->axes);
    map_errors(map, r, determinant, center_error, inertia_error);
    for (int i = 0; i < 3; i++) {
        body->center[i] = (sag_estimate){sag_component(m.center, i), center_error[i]};
        body->principal[i] =
            (sag_estimate){principal[i], determinant * scale * scale * r->principal_error[i]};
        for (int k = 0; k < 3; k++) body->inertia[i][k] = (sag_estimate){inertia[i][k], inertia_error[i][k]};
    }
}

static bool place_body(scene_of_body *b) {
    const sagi_snapshot *s = b->subject->snapshot;
    const uint32_t id = b->body->geometry;
    b->item = id == SAG_INVALID_ID ? NULL : &s->items[id];
    const sag_affine *to_scene = &b->subject->to_scene;
    if (!sagi_place_make(to_scene, &b->place)) return false;
    b->mapped = !b->place.similarity;
    const sagi_place *own = b->item != NULL ? b->item->place : NULL;
    b->shape_placed = own != NULL || b->mapped;
    if (own != NULL) b->shape_place = *own;
    if (b->mapped) {
        sag_affine both = *to_scene;
        if (own != NULL) both = sag_affine_multiply(to_scene, &own->to_scene);
        if (!sagi_place_make(&both, &b->shape_place)) return false;
    }
    b->box = b->body->bounds;
    if (!b->mapped && !sag_affine_is_identity(to_scene)) b->box = sagi_subject_box(b->subject, id);
    return true;
}

static sag_status measure_body(job *j, size_t index) {
    scene_of_body b = {.body = &j->list.bodies[index],
                       .subject = &j->list.subjects[index],
                       .seed = sagi_measure_hash(j->options.seed, index, 0)};
    const sag_affine identity = sag_affine_identity();
    j->reporter.progress.body = index, j->reporter.progress.fraction = 0;
    if (!place_body(&b)) { // instances that make each other singular: there is nothing of it
        b.body->state = SAG_BODY_EMPTY;
        return SAG_OK;
    }
    slot *shared = &j->slots[b.subject->slot];
    sagi_result result = {0};
    shared->uses--;
    const bool known = !b.mapped && shared->result != NULL;
    if (known) {
        result = *shared->result;
        result.rays = 0; // those of the first instance were for all
    } else {
        const sag_status status = measure_inside(j, &b, &result);
        if (status != SAG_OK) return status;
    }
    if (!b.mapped && !known && shared->uses > 0) {
        shared->result = sag_allocate(j->context, sizeof result);
        if (shared->result != NULL) *shared->result = result; // else the next one is measured anew
    }
    write_body(&result, b.mapped ? &identity : &b.subject->to_scene, b.body);
    return sagi_report(&j->reporter, 1, 0) ? SAG_OK : sampling_failed(j);
}

// ---- all of them

static sag_status check_options(const sag_measure_options *given, sag_measure_options *o, sag_error *error) {
    *o = given != NULL ? *given : (sag_measure_options){0};
    if (o->error == 0) o->error = 1e-3;
    if (o->confidence == 0) o->confidence = 0.95;
    if (o->max_rays == 0) o->max_rays = 100000000;
    if (o->max_bodies == 0) o->max_bodies = 65536;
    if (!(o->error > 0 && o->error < 1))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "the error %g is not between 0 and 1", o->error);
    if (!(o->confidence > 0 && o->confidence < 1))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "the confidence %g is not between 0 and 1",
                             o->confidence);
    return SAG_OK;
}

static sag_status measure_all(job *j, const sagi_snapshot *snapshot) {
    if (!sagi_body_list_make(&j->list, snapshot)) return say(j, SAG_ERROR_MEMORY, "out of memory");
    const size_t bytes = j->list.slot_count * sizeof *j->slots;
    if (bytes > 0) {
        j->slots = sag_allocate(j->context, bytes);
        if (j->slots == NULL) return say(j, SAG_ERROR_MEMORY, "out of memory");
        memset(j->slots, 0, bytes);
    }
    for (size_t i = 0; i < j->list.count; i++) j->slots[j->list.subjects[i].slot].uses++;
    size_t lines = j->list.count > 0 ? THICKNESS_BUDGET / j->list.count : 0;
    if (lines < 2) lines = 2;
    j->thickness_lines = lines < THICKNESS_LINES ? (uint32_t)lines : THICKNESS_LINES;
    j->reporter.progress.body_count = j->list.count;
    sag_status status = SAG_OK;
    for (size_t i = 0; i < j->list.count && status == SAG_OK; i++) status = measure_body(j, i);
    for (uint32_t i = 0; i < j->list.slot_count; i++)
        sag_release(j->context, j->slots[i].result, sizeof *j->slots[i].result);
    sag_release(j->context, j->slots, bytes);
    return status;
}

sag_status sag_measure(const sag_scene *scene, const sag_measure_options *options,
                       sag_measurement *measurement, sag_error *error) {
    const sagi_snapshot *snapshot = sagi_scene_snapshot(scene);
    if (snapshot == NULL) return sag_error_set(error, SAG_ERROR_STATE, "the scene was never committed");
    job j = {.context = scene->context, .kernel = scene->kernel, .error = error};
    sag_status status = check_options(options, &j.options, error);
    if (status != SAG_OK) return status;
    j.reporter.options = &j.options;
    j.list = (sagi_body_list){.context = j.context, .limit = j.options.max_bodies};
    status = measure_all(&j, snapshot);
    if (status == SAG_OK) {
        // The list becomes the caller's: room for what it has and no more would need another copy.
        *measurement = (sag_measurement){.bodies = j.list.bodies,
                                         .body_count = j.list.count,
                                         .omitted_count = j.list.omitted,
                                         .rays = j.reporter.progress.rays,
                                         .context = j.context,
                                         .capacity = j.list.capacity};
        j.list.bodies = NULL;
    }
    sagi_body_list_release(&j.list);
    return status;
}

void sag_measurement_clear(sag_measurement *measurement) {
    if (measurement == NULL) return;
    sag_release(measurement->context, measurement->bodies,
                measurement->capacity * sizeof *measurement->bodies);
    *measurement = (sag_measurement){0};
}
