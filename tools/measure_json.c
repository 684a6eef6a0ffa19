// SPDX-License-Identifier: MIT
// sagitta measure, for programs. Numbers that are not there (an open mesh's volume) are null, as is what is
// infinite; an estimate is {"value": v, "error": e}. docs/measuring.md describes every key.
#include "formats/output.h"
#include "measure.h"

#include <math.h>
#include <string.h>

static void add_number(cJSON *object, const char *name, double value) {
    cJSON_AddNumberToObject(object, name, value); // what is not finite becomes null
}

static void add_numbers(cJSON *object, const char *name, const double *values, int count) {
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(values, count));
}

static void add_point(cJSON *object, const char *name, sag_vec3 p) {
    add_numbers(object, name, (const double[3]){p.x, p.y, p.z}, 3);
}

static void add_estimate(cJSON *object, const char *name, sag_estimate e, double scale) {
    cJSON *json = cJSON_AddObjectToObject(object, name);
    add_number(json, "value", scale * e.value);
    add_number(json, "error", scale * e.error);
}

// Of three or of three times three.
static void add_estimates(cJSON *object, const char *name, const sag_estimate *e, int rows, double scale) {
    cJSON *json = cJSON_AddObjectToObject(object, name);
    for (int what = 0; what < 2; what++) {
        cJSON *list = cJSON_CreateArray();
        for (int i = 0; i < rows; i++) {
            double numbers[3];
            for (int k = 0; k < 3; k++) numbers[k] = scale * (what ? e[3 * i + k].error : e[3 * i + k].value);
            if (rows == 1)
                cJSON_Delete(list), list = cJSON_CreateDoubleArray(numbers, 3);
            else
                cJSON_AddItemToArray(list, cJSON_CreateDoubleArray(numbers, 3));
        }
        cJSON_AddItemToObject(json, what ? "error" : "value", list);
    }
}

static void add_thickness(cJSON *object, const sag_thickness *t) {
    static const char *const names[SAG_THICKNESS_PERCENTILES] = {"1", "5", "25", "50", "75", "95", "99"};
    cJSON *json = cJSON_AddObjectToObject(object, "thickness");
    cJSON_AddStringToObject(json, "method", "inward ray");
    add_number(json, "samples", (double)t->sample_count);
    add_number(json, "min", t->min);
    add_number(json, "max", t->max);
    add_estimate(json, "mean", t->mean, 1);
    cJSON *percentiles = cJSON_AddObjectToObject(json, "percentiles");
    for (int i = 0; i < SAG_THICKNESS_PERCENTILES; i++) add_number(percentiles, names[i], t->percentiles[i]);
    add_point(json, "thinnest_point", t->thinnest);
    cJSON *histogram = cJSON_AddObjectToObject(json, "histogram");
    add_number(histogram, "from", 0);
    add_number(histogram, "to", t->max);
    add_numbers(histogram, "shares", t->histogram, SAG_THICKNESS_BINS);
}

static void add_mesh(cJSON *object, const sag_mesh_report *m) {
    cJSON *json = cJSON_AddObjectToObject(object, "mesh");
    add_number(json, "triangles", m->triangle_count);
    add_number(json, "open_edges", m->open_edge_count);
    add_number(json, "crowded_edges", m->crowded_edge_count);
    add_number(json, "flipped_edges", m->flipped_edge_count);
    if (m->open_edge_count)
        add_numbers(json, "open_edge", (const double[2]){m->open_edge[0], m->open_edge[1]}, 2);
}

static cJSON *body_to_json(const measure_report *r, size_t index) {
    static const char *const states[] = {"closed", "open", "unbounded", "empty"};
    const sag_body *b = &r->measurement->bodies[index];
    const double density = r->density > 0 ? r->density : 1;
    char text[256];
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "name", measure_label(r, index, text));
    cJSON_AddStringToObject(json, "kind",
                            b->kind == SAG_SHAPE_INSTANCE ? "solid" : sag_shape_kind_name(b->kind));
    add_number(json, "geometry", b->geometry == SAG_INVALID_ID ? NAN : b->geometry);
    cJSON *path = cJSON_AddArrayToObject(json, "instances");
    for (uint32_t i = 0; i < b->instance_depth; i++)
        cJSON_AddItemToArray(path, cJSON_CreateNumber(b->instance_path[i]));
    cJSON_AddStringToObject(json, "state", states[b->state]);
    const char *flaw = measure_flaw(b, text);
    if (*flaw) json_add_text(json, "why", flaw);
    cJSON_AddBoolToObject(json, "exact", b->state == SAG_BODY_CLOSED && !b->by_rays);
    cJSON_AddBoolToObject(json, "reached", b->reached);
    cJSON_AddBoolToObject(json, "inside_out", b->inside_out);
    cJSON_AddBoolToObject(json, "overlaps", b->overlaps);
    add_number(json, "rays", (double)b->rays);
    cJSON *bounds = cJSON_AddObjectToObject(json, "bounds");
    add_point(bounds, "min", b->bounds.min);
    add_point(bounds, "max", b->bounds.max);
    add_estimate(json, "volume", b->volume, 1);
    add_estimate(json, "area", b->area, 1);
    if (r->density > 0) add_estimate(json, "mass", b->volume, density);
    add_estimates(json, "center", b->center, 1, 1);
    add_estimates(json, "inertia", &b->inertia[0][0], 3, density);
    add_estimates(json, "principal", b->principal, 1, density);
    cJSON *axes = cJSON_AddArrayToObject(json, "axes");
    for (int i = 0; i < 3; i++)
        cJSON_AddItemToArray(
            axes, cJSON_CreateDoubleArray((const double[3]){b->axes[i].x, b->axes[i].y, b->axes[i].z}, 3));
    add_number(json, "mean_chord", 4 * b->volume.value / b->area.value);
    if (b->thickness.sample_count) add_thickness(json, &b->thickness);
    if (b->kind == SAG_SHAPE_MESH) add_mesh(json, &b->report);
    return json;
}

static cJSON *to_json(const measure_report *r) {
    const sag_measurement *m = r->measurement;
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "file", r->file);
    cJSON_AddStringToObject(json, "version", SAG_VERSION);
    add_number(json, "error", r->error);
    add_number(json, "confidence", r->confidence);
    add_number(json, "density", r->density > 0 ? r->density : 1);
    // Seeds may have more digits than a double.
    char seed[24];
    snprintf(seed, sizeof seed, "%llu", (unsigned long long)r->seed);
    cJSON_AddStringToObject(json, "seed", seed);
    add_number(json, "rays", (double)m->rays);
    add_number(json, "load_seconds", r->load_seconds);
    add_number(json, "measure_seconds", r->seconds);
    add_number(json, "omitted", (double)m->omitted_count);
    cJSON *bodies = cJSON_AddArrayToObject(json, "bodies");
    for (size_t i = 0; i < m->body_count; i++) cJSON_AddItemToArray(bodies, body_to_json(r, i));
    return json;
}

sag_status measure_write_json(const measure_report *r, sag_error *error) {
    cJSON *json = to_json(r);
    char *text = cJSON_Print(json);
    cJSON_Delete(json);
    if (!text) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    sag_status status = SAG_OK;
    if (strcmp(r->json, "-") == 0) {
        puts(text);
    } else {
        sagi_output output;
        status = sagi_output_open(&output, r->json, error);
        if (status == SAG_OK) {
            fputs(text, output.file);
            fputc('\n', output.file);
            status = sagi_output_commit(&output, error);
        }
    }
    cJSON_free(text);
    return status;
}
