// SPDX-License-Identifier: MIT
// sagitta info: the solids of a file, each with its parts, operations and bounds.
#include "info_solids.h"

#include <stdlib.h>

#define SOLIDS_SHOWN 20

bool solids_add(solids *list, const sag_scene *scene) {
    const sag_solid description = sag_scene_get_solid(scene);
    if (description.step_count == 0) return false;
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 64;
        solid_info *items = realloc(list->items, capacity * sizeof *items);
        if (!items) {
            list->out_of_memory = true;
            return true;
        }
        list->items = items;
        list->capacity = capacity;
    }
    solid_info *solid = &list->items[list->count++];
    *solid = (solid_info){.bounds = sag_scene_bounds(scene)};
    for (uint32_t i = 0; i < description.step_count; i++) solid->steps[description.steps[i].operation]++;
    for (int i = 0; i < SOLID_OPERATIONS; i++) list->steps[i] += solid->steps[i];
    return true;
}

void solids_clear(solids *list) {
    free(list->items);
    *list = (solids){0};
}

static const char *const names[SOLID_OPERATIONS] = {"part", "union", "intersection", "difference", "xor"};

// "3 unions, 1 xor": the operations without the parts.
static void print_operations(const uint64_t steps[SOLID_OPERATIONS]) {
    char text[TEXT_BYTES];
    const char *separator = "";
    for (int i = SAG_SOLID_UNION; i < SOLID_OPERATIONS; i++) {
        if (steps[i] == 0) continue;
        printf("%s%s %s%s", separator, text_count(text, steps[i]), names[i], steps[i] == 1 ? "" : "s");
        separator = ", ";
    }
}

void solids_print_summary(const solids *list) {
    if (list->count == 0) return;
    char a[TEXT_BYTES], b[TEXT_BYTES];
    printf("  %-14s %s: %s part%s; ", "solids", text_count(a, list->count),
           text_count(b, list->steps[SAG_SOLID_PART]), list->steps[SAG_SOLID_PART] == 1 ? "" : "s");
    print_operations(list->steps);
    printf("\n");
}

void solids_print(const solids *list) {
    if (list->count == 0) return;
    char text[TEXT_BYTES];
    printf("\n  %-6s %9s  %-50s  %s\n", "solid", "parts", "bounds in its own space", "operations");
    for (size_t i = 0; i < list->count && i < SOLIDS_SHOWN; i++) {
        const solid_info *s = &list->items[i];
        const sag_box3 *box = &s->bounds;
        char bounds[128];
        if (sag_box3_is_empty(box))
            snprintf(bounds, sizeof bounds, "nothing is left");
        else
            snprintf(bounds, sizeof bounds, "%.4g %.4g %.4g to %.4g %.4g %.4g", box->min.x, box->min.y,
                     box->min.z, box->max.x, box->max.y, box->max.z);
        printf("  %-6zu %9s  %-50s  ", i + 1, text_count(text, s->steps[SAG_SOLID_PART]), bounds);
        print_operations(s->steps);
        printf("\n");
    }
    if (list->count > SOLIDS_SHOWN)
        printf("  ... and %s more (--json lists all)\n", text_count(text, list->count - SOLIDS_SHOWN));
}

void solids_to_json(const solids *list, cJSON *json) {
    cJSON *array = cJSON_AddArrayToObject(json, "solids");
    for (size_t i = 0; i < list->count; i++) {
        const solid_info *s = &list->items[i];
        cJSON *solid = cJSON_CreateObject();
        static const char *const keys[SOLID_OPERATIONS] = {"parts", "unions", "intersections", "differences",
                                                           "xors"};
        for (int k = 0; k < SOLID_OPERATIONS; k++)
            cJSON_AddNumberToObject(solid, keys[k], (double)s->steps[k]);
        const double min[3] = {s->bounds.min.x, s->bounds.min.y, s->bounds.min.z};
        const double max[3] = {s->bounds.max.x, s->bounds.max.y, s->bounds.max.z};
        cJSON *bounds = cJSON_AddObjectToObject(solid, "bounds");
        cJSON_AddItemToObject(bounds, "min", cJSON_CreateDoubleArray(min, 3));
        cJSON_AddItemToObject(bounds, "max", cJSON_CreateDoubleArray(max, 3));
        cJSON_AddItemToArray(array, solid);
    }
}
