// SPDX-License-Identifier: MIT
// Choosing by weight: one of many in constant time, and a point of a picture by its brightness.
#ifndef SAGI_RENDER_DISTRIBUTION_H
#define SAGI_RENDER_DISTRIBUTION_H

#include <sagitta/base.h>

// One column of Vose's alias table: with probability `keep` the index itself, else `other`.
typedef struct sagi_alias_entry {
    double keep;
    double probability; // of the index
    uint32_t other;
} sagi_alias_entry;

typedef struct sagi_alias {
    uint32_t count; // 0: nothing to choose from
    sagi_alias_entry *entries;
} sagi_alias;

// From `count` weights ≥ 0, not all 0 (then the table is empty). False when memory is short.
bool sagi_alias_init(sagi_alias *alias, const sag_context *context, const double *weights, uint32_t count);
void sagi_alias_clear(sagi_alias *alias, const sag_context *context);
// The index that u in [0, 1) chooses; *rest becomes a number in [0, 1) to use again. count > 0.
uint32_t sagi_alias_sample(const sagi_alias *alias, double u, double *rest);

#endif
