// SPDX-License-Identifier: MIT
// What sagitta info says of solids.
#ifndef SAGITTA_INFO_SOLIDS_H
#define SAGITTA_INFO_SOLIDS_H

#include "tool.h"
#include <sagitta/solid.h>

#define SOLID_OPERATIONS (SAG_SOLID_XOR + 1)

typedef struct solid_info {
    uint64_t steps[SOLID_OPERATIONS]; // how many of each kind, parts included
    sag_box3 bounds;                  // in its own space
} solid_info;

// Zero-initialised: none.
typedef struct solids {
    solid_info *items;
    size_t count, capacity;
    uint64_t steps[SOLID_OPERATIONS]; // of all
    bool out_of_memory;
} solids;

// Whether a committed scene is a solid; if so it is added (or out_of_memory is set).
bool solids_add(solids *list, const sag_scene *scene);
void solids_print_summary(const solids *list); // a line
void solids_print(const solids *list);         // a table
void solids_to_json(const solids *list, cJSON *json);
void solids_clear(solids *list);

#endif
