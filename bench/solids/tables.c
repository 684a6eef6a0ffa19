// SPDX-License-Identifier: MIT
// What the terminal shows, and the same as JSON: {"processor", "sagitta", "povray", "scenes": […], "carving":
// […]}. Speeds are millions of rays a second; null says "not measured". cJSON writes the text.
#include "solids.h"
#include <cjson/cJSON.h>
#include <sagitta/base.h>
#include <stdlib.h>
#include <string.h>

// A number in so many columns, or a dash where there is none.
static void cell(int width, double value) {
    if (value > 0)
        printf(" %*.2f", width, value);
    else
        printf(" %*s", width, "-");
}

static double ratio(double a, double b) { return a > 0 && b > 0 ? a / b : 0; }

static double percent(size_t part, size_t all) { return all > 0 ? 100 * (double)part / (double)all : 0; }

void print_heading(void) {
    printf("\n  %-30s %11s  %9s %9s %7s   %s\n", "", "", "million rays a second", "", "", "  depth images");
    printf("  %-30s %11s  %9s %9s %7s   %7s %11s %10s %10s %10s\n", "scene", "pixels", "POV-Ray", "Sagitta",
           "ratio", "met", "silhouettes", "differ", "anywhere", "mean");
}

void print_outcome(const outcome *o) {
    char pixels[32];
    snprintf(pixels, sizeof pixels, "%u x %u", o->film.width, o->film.height);
    printf("  %-30s %11s ", o->kind->title, pixels);
    cell(9, o->povray);
    cell(9, o->sagitta);
    cell(7, ratio(o->sagitta, o->povray));
    const likeness *l = &o->likeness;
    if (o->compared)
        printf("   %5.1f %% %9.2f %% %8.4f %% %8.4f %% %10.2g", percent(l->met, l->pixels),
               percent(l->silhouettes, l->pixels), percent(l->differing, l->pixels),
               percent(l->differing_anywhere, l->pixels), l->mean / 65535);
    printf("\n");
    fflush(stdout);
}

void print_carvings(const char *mesh, const carving carvings[CARVINGS]) {
    printf("\n  %s with balls cut out, beside the mesh alone; million rays a second\n", mesh);
    printf("  %-8s %8s %8s   %9s %9s %7s   %9s %9s %7s\n", "rays", "count", "met", "mesh", "solid", "ratio",
           "mesh", "solid", "ratio");
    printf("  %-8s %8s %8s   %27s   %27s\n", "", "", "", "single calls", "batch");
    for (int i = 0; i < CARVINGS; i++) {
        const carving *c = &carvings[i];
        printf("  %-8s %6.2f M %6.1f %%  ", c->set, (double)c->rays / 1e6, percent(c->met, c->rays));
        for (int k = 0; k < 2; k++) {
            cell(9, c->mesh[k]);
            cell(9, c->solid[k]);
            cell(7, ratio(c->solid[k], c->mesh[k]));
            printf("  ");
        }
        printf("\n");
    }
    fflush(stdout);
}

static void put(cJSON *o, const char *key, double value) {
    if (value > 0)
        cJSON_AddNumberToObject(o, key, value);
    else
        cJSON_AddNullToObject(o, key);
}

static cJSON *of_outcome(const outcome *o) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "scene", o->kind->name);
    cJSON_AddNumberToObject(json, "width", o->film.width);
    cJSON_AddNumberToObject(json, "height", o->film.height);
    put(json, "povray", o->povray);
    put(json, "sagitta", o->sagitta);
    put(json, "ratio", ratio(o->sagitta, o->povray));
    if (!o->compared) return json;
    const likeness *l = &o->likeness;
    cJSON_AddNumberToObject(json, "pixels_met", (double)l->met);
    cJSON_AddNumberToObject(json, "pixels_at_silhouettes", (double)l->silhouettes);
    cJSON_AddNumberToObject(json, "pixels_differing", (double)l->differing);
    cJSON_AddNumberToObject(json, "pixels_differing_anywhere", (double)l->differing_anywhere);
    cJSON_AddNumberToObject(json, "mean_difference", l->mean / 65535);
    return json;
}

static cJSON *of_carving(const carving *c) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "set", c->set);
    cJSON_AddNumberToObject(json, "rays", (double)c->rays);
    cJSON_AddNumberToObject(json, "hits", (double)c->met);
    put(json, "mesh_single", c->mesh[0]);
    put(json, "solid_single", c->solid[0]);
    put(json, "ratio_single", ratio(c->solid[0], c->mesh[0]));
    put(json, "mesh_batch", c->mesh[1]);
    put(json, "solid_batch", c->solid[1]);
    put(json, "ratio_batch", ratio(c->solid[1], c->mesh[1]));
    return json;
}

// As Linux tells it; elsewhere "unknown".
static void processor_name(char name[128]) {
    snprintf(name, 128, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || colon == NULL) continue;
        snprintf(name, 128, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    if (file != NULL) fclose(file);
}

bool write_json(const char *path, const char *povray, const outcome *outcomes, size_t count,
                const carving carvings[CARVINGS]) {
    cJSON *all = cJSON_CreateObject();
    char cpu[128];
    processor_name(cpu);
    cJSON_AddStringToObject(all, "processor", cpu);
    cJSON_AddStringToObject(all, "sagitta", SAG_VERSION);
    if (povray != NULL)
        cJSON_AddStringToObject(all, "povray", povray);
    else
        cJSON_AddNullToObject(all, "povray");
    cJSON *scenes = cJSON_AddArrayToObject(all, "scenes"), *carved = cJSON_AddArrayToObject(all, "carving");
    for (size_t i = 0; i < count; i++) cJSON_AddItemToArray(scenes, of_outcome(&outcomes[i]));
    for (size_t i = 0; i < CARVINGS; i++)
        if (carvings[i].rays > 0) cJSON_AddItemToArray(carved, of_carving(&carvings[i]));
    char *text = cJSON_Print(all);
    cJSON_Delete(all);
    FILE *file = text != NULL ? fopen(path, "w") : NULL;
    bool written = file != NULL && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    if (file != NULL) written = fclose(file) == 0 && written;
    if (!written) fprintf(stderr, "bench-solids: %s could not be written\n", path);
    free(text);
    return written;
}
