// SPDX-License-Identifier: MIT
// The results of a run, kept, and written as JSON: {"machine", "results": [...], "build": [...]}. Speeds are
// millions of rays (or primitives) a second; null says "not measured". cJSON writes the text.
#include "bench.h"
#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *longer(void *array, size_t count, size_t size) {
    void *memory = need((count + 1) * size);
    if (count > 0) memcpy(memory, array, count * size);
    free(array);
    return memory;
}

void report_add_result(report *r, const result *added) {
    r->results = longer(r->results, r->result_count, sizeof *r->results);
    r->results[r->result_count++] = *added;
}

void report_add_build(report *r, const build_result *added) {
    r->builds = longer(r->builds, r->build_count, sizeof *r->builds);
    r->builds[r->build_count++] = *added;
}

void report_free(report *r) {
    free(r->results);
    free(r->builds);
    *r = (report){0};
}

static void put(cJSON *object, const char *key, double value) {
    if (value > 0 && isfinite(value))
        cJSON_AddNumberToObject(object, key, value);
    else
        cJSON_AddNullToObject(object, key);
}

static cJSON *of_result(const result *r) {
    static const char *const contenders[CONTENDER_COUNT] = {"sagitta_single", "sagitta_batch",
                                                            "embree_fast",    "embree_robust",
                                                            "embree_packet",  "embree_coherent"};
    cJSON *o = cJSON_CreateObject();
    cJSON_AddStringToObject(o, "mesh", r->model);
    cJSON_AddStringToObject(o, "set", r->set);
    cJSON_AddNumberToObject(o, "threads", r->threads);
    for (int i = 0; i < CONTENDER_COUNT; i++) put(o, contenders[i], r->mrays[i]);
    put(o, "ratio_single", ratio_of(r, SAGITTA_SINGLE, EMBREE_FAST));
    put(o, "ratio_batch", ratio_of(r, SAGITTA_BATCH, EMBREE_FAST));
    put(o, "ratio_packet", ratio_of(r, SAGITTA_BATCH, EMBREE_PACKET));
    put(o, "ratio_coherent", ratio_of(r, SAGITTA_BATCH, EMBREE_COHERENT));
    cJSON_AddStringToObject(o, "isa", r->isa);
    cJSON_AddStringToObject(o, "quality", r->quality);
    cJSON_AddNumberToObject(o, "rays", (double)r->rays);
    cJSON_AddNumberToObject(o, "hits", (double)r->met);
    cJSON_AddNumberToObject(o, "batch_differs", (double)r->batch_differs);
    const settled *s = &r->settled;
    bool settled_any = peer_name() != NULL;
    const struct {
        const char *key;
        size_t value;
    } counts[] = {{"disagree", s->fast.disagree},          {"sagitta_wrong", s->sagitta_wrong},
                  {"embree_fast_wrong", s->fast.wrong},    {"ties", s->fast.ties},
                  {"disagree_robust", s->robust.disagree}, {"embree_robust_wrong", s->robust.wrong},
                  {"ties_robust", s->robust.ties},         {"not_searched", s->unsearched}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (settled_any)
            cJSON_AddNumberToObject(o, counts[i].key, (double)counts[i].value);
        else
            cJSON_AddNullToObject(o, counts[i].key);
    return o;
}

static double each(const built *b, double bytes, uint32_t primitives) {
    return b->seconds > 0 ? bytes / primitives : 0;
}

static void of_side(cJSON *o, const char *name, const built *b, uint32_t primitives) {
    const struct {
        const char *ending;
        double value;
    } parts[] = {{"mtris", b->seconds > 0 ? primitives / b->seconds / 1e6 : 0},
                 {"bytes_per_tri", each(b, b->structure_bytes + b->geometry_bytes, primitives)},
                 {"structure_bytes_per_tri", each(b, b->structure_bytes, primitives)},
                 {"peak_bytes_per_tri", each(b, b->peak_bytes, primitives)}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        char key[64];
        snprintf(key, sizeof key, "%s_%s", name, parts[i].ending);
        put(o, key, parts[i].value);
    }
}

static cJSON *of_build(const build_result *b) {
    cJSON *o = cJSON_CreateObject();
    cJSON_AddStringToObject(o, "mesh", b->model);
    cJSON_AddStringToObject(o, "quality", b->quality);
    cJSON_AddNumberToObject(o, "threads", b->threads);
    cJSON_AddNumberToObject(o, "primitives", b->primitives);
    of_side(o, "sagitta", &b->sagitta, b->primitives);
    of_side(o, "embree", &b->embree, b->primitives);
    put(o, "sah", b->sagitta.sah);
    return o;
}

// As Linux tells it; elsewhere "unknown".
static void processor_name(char *name, size_t size) {
    snprintf(name, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || colon == NULL) continue;
        snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    if (file != NULL) fclose(file);
}

bool json_write(const report *r, const char *path) {
    cJSON *all = cJSON_CreateObject();
    char cpu[128];
    processor_name(cpu, sizeof cpu);
    cJSON_AddStringToObject(all, "processor", cpu);
    cJSON_AddStringToObject(all, "sagitta", SAG_VERSION);
    if (peer_name() != NULL)
        cJSON_AddStringToObject(all, "peer", peer_name());
    else
        cJSON_AddNullToObject(all, "peer");
    cJSON *results = cJSON_AddArrayToObject(all, "results"), *builds = cJSON_AddArrayToObject(all, "build");
    for (size_t i = 0; i < r->result_count; i++) cJSON_AddItemToArray(results, of_result(&r->results[i]));
    for (size_t i = 0; i < r->build_count; i++) cJSON_AddItemToArray(builds, of_build(&r->builds[i]));
    char *text = cJSON_Print(all);
    cJSON_Delete(all);
    FILE *file = text != NULL ? fopen(path, "w") : NULL;
    bool written = file != NULL && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    if (file != NULL) written = fclose(file) == 0 && written;
    if (!written) fprintf(stderr, "bench-rays: %s could not be written\n", path);
    free(text);
    return written;
}
