// SPDX-License-Identifier: MIT
// The alias method (Walker 1977; Vose 1991): `count` columns of equal width, each shared by at most two
// indices. A column whose own weight is under the mean is filled up from one that is over it, until all are
// level; one random number then picks the column by its whole part and the owner by its fraction.
#include "distribution.h"

#include <math.h>
#include <sagitta/base.h>

#define ONE_MINUS 0x1.fffffffffffffp-1

bool sagi_alias_init(sagi_alias *alias, const sag_context *context, const double *weights, uint32_t count) {
    *alias = (sagi_alias){0, NULL};
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += weights[i];
    if (!(sum > 0) || !isfinite(sum)) return true;
    sagi_alias_entry *entries = sag_allocate(context, count * sizeof *entries);
    // The work list: indices under the mean grow from the left, those over it from the right.
    uint32_t *list = sag_allocate(context, count * sizeof *list);
    if (!entries || !list) {
        sag_release(context, entries, count * sizeof *entries);
        sag_release(context, list, count * sizeof *list);
        return false;
    }
    uint32_t under = 0, over = count;
    for (uint32_t i = 0; i < count; i++) {
        double level = weights[i] / sum * count;
        entries[i] = (sagi_alias_entry){.keep = level, .probability = weights[i] / sum, .other = i};
        if (level < 1)
            list[under++] = i;
        else
            list[--over] = i;
    }
    // `keep` of an index over the mean is what it has left to give.
    while (under > 0 && over < count) {
        uint32_t small = list[--under], large = list[over];
        entries[small].other = large;
        entries[large].keep -= 1 - entries[small].keep;
        if (entries[large].keep < 1) {
            over++;
            list[under++] = large;
        }
    }
    // What is left is level but for rounding.
    while (under > 0) entries[list[--under]].keep = 1;
    while (over < count) entries[list[over++]].keep = 1;
    sag_release(context, list, count * sizeof *list);
    *alias = (sagi_alias){count, entries};
    return true;
}

void sagi_alias_clear(sagi_alias *alias, const sag_context *context) {
    sag_release(context, alias->entries, alias->count * sizeof *alias->entries);
    *alias = (sagi_alias){0, NULL};
}

uint32_t sagi_alias_sample(const sagi_alias *alias, double u, double *rest) {
    double scaled = u * alias->count;
    uint32_t column = (uint32_t)scaled;
    if (column >= alias->count) column = alias->count - 1;
    const sagi_alias_entry *entry = &alias->entries[column];
    double fraction = fmin(scaled - column, ONE_MINUS);
    if (fraction < entry->keep || entry->keep >= 1) {
        *rest = fmin(fraction / fmin(entry->keep, 1), ONE_MINUS);
        return column;
    }
    *rest = fmin((fraction - entry->keep) / (1 - entry->keep), ONE_MINUS);
    return entry->other;
}
