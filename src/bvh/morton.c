// SPDX-License-Identifier: MIT
// Sorting primitives by where they are: a centroid's coordinates, 11 bits each, are interleaved to one
// number, and numbers in order visit space along Morton's curve, on which neighbours are mostly near (Morton,
// "A Computer Oriented Geodetic Data Base", 1966; Lauterbach et al., "Fast BVH Construction on GPUs", 2009).
//
// The sort is by radix, 11 bits in each of three rounds: chunks of a fixed size count their digits, the
// counts are summed up over digits and chunks, and each chunk puts its keys where they go. It is stable and
// keys begin in the primitives' order, so the result depends on nothing else.
#include "bvh/morton.h"
#include <string.h>

#define DIGITS (1u << SAGI_MORTON_BITS)
#define ROUNDS 3

typedef struct sorter {
    const sagi_bvh_primitive *primitives;
    uint64_t *from, *to;
    uint32_t count, chunk; // keys a chunk
    uint32_t chunk_count;
    int shift;
    float origin[3], scale;
    sagi_float_box *extents;    // of each chunk's centroids
    uint32_t (*places)[DIGITS]; // of each chunk: counts, then where the next key of the digit goes
} sorter;

static uint32_t chunk_end(const sorter *s, size_t index, uint32_t *begin) {
    *begin = (uint32_t)index * s->chunk;
    return s->count - *begin < s->chunk ? s->count : *begin + s->chunk;
}

static void measure_chunk(void *argument, size_t index) {
    const sorter *s = argument;
    sagi_extent extent = sagi_extent_empty();
    uint32_t i, end = chunk_end(s, index, &i);
    for (; i < end; i++) sagi_extent_add(&extent, &s->primitives[i]);
    s->extents[index] = sagi_extent_box(&extent);
}

// The bits of an 11-bit number, two places between each and the next.
static inline uint64_t spread(uint32_t x) {
    uint64_t v = x;
    v = (v | v << 16) & 0x0000FF0000FFu;
    v = (v | v << 8) & 0x00F00F00F00Fu;
    v = (v | v << 4) & 0x0C30C30C30C3u;
    return (v | v << 2) & 0x249249249249u;
}

static void encode_chunk(void *argument, size_t index) {
    const sorter *s = argument;
    uint32_t i, end = chunk_end(s, index, &i);
    for (; i < end; i++) {
        uint64_t code = 0;
        for (int k = 0; k < 3; k++) {
            float c = (sagi_centroid(&s->primitives[i], k) - s->origin[k]) * s->scale;
            code |= spread((uint32_t)(int32_t)c) << k;
        }
        s->from[i] = code << SAGI_MORTON_INDEX | i;
    }
}

static void count_chunk(void *argument, size_t index) {
    const sorter *s = argument;
    uint32_t *counts = s->places[index];
    memset(counts, 0, sizeof s->places[index]);
    uint32_t i, end = chunk_end(s, index, &i);
    for (; i < end; i++) counts[s->from[i] >> s->shift & (DIGITS - 1)]++;
}

static void scatter_chunk(void *argument, size_t index) {
    const sorter *s = argument;
    uint32_t *places = s->places[index];
    uint32_t i, end = chunk_end(s, index, &i);
    for (; i < end; i++) s->to[places[s->from[i] >> s->shift & (DIGITS - 1)]++] = s->from[i];
}

// From counts to places; false when all keys have the same digit, and stay.
static bool sum_up(sorter *s) {
    uint32_t sum = 0;
    for (uint32_t d = 0; d < DIGITS; d++) {
        uint32_t before = sum;
        for (uint32_t c = 0; c < s->chunk_count; c++) {
            uint32_t own = s->places[c][d];
            s->places[c][d] = sum;
            sum += own;
        }
        if (sum - before == s->count) return false;
    }
    return true;
}

// One scale for all three axes, so that a cell of the curve is a cube. The largest centroid comes to at most
// 2¹¹ (1 − 2⁻²⁰)(1 + 2⁻²⁴)³ < 2¹¹. Centroids that are all the same, or too near for the quotient, get the
// code 0.
static void choose_units(sorter *s) {
    sagi_float_box extent = sagi_float_box_empty();
    for (uint32_t i = 0; i < s->chunk_count; i++)
        sagi_float_box_extend(&extent, s->extents[i].lo, s->extents[i].hi);
    float widest = 0;
    for (int k = 0; k < 3; k++) {
        s->origin[k] = extent.lo[k];
        widest = sagi_float_max(widest, extent.hi[k] - extent.lo[k]);
    }
    float scale = (float)DIGITS * (1 - 0x1p-20f) / widest;
    s->scale = widest > 0 && scale < 0x1p120f ? scale : 0;
}

sag_status sagi_morton_sort(const sag_context *context, const sagi_bvh_primitive *primitives, uint32_t count,
                            uint64_t *keys, uint64_t *scratch) {
    sorter s = {.primitives = primitives, .from = keys, .to = scratch, .count = count};
    s.chunk = count / 64 > 32768 ? count / 64 : 32768;
    s.chunk_count = count / s.chunk + (count % s.chunk != 0);
    s.extents = sag_allocate(context, s.chunk_count * sizeof *s.extents);
    s.places = sag_allocate(context, s.chunk_count * sizeof *s.places);
    sag_status status = SAG_ERROR_MEMORY;
    if (s.extents != NULL && s.places != NULL) {
        sag_parallel_for(context, s.chunk_count, measure_chunk, &s);
        choose_units(&s);
        sag_parallel_for(context, s.chunk_count, encode_chunk, &s);
        for (int round = 0; round < ROUNDS; round++) {
            s.shift = SAGI_MORTON_INDEX + round * SAGI_MORTON_BITS;
            sag_parallel_for(context, s.chunk_count, count_chunk, &s);
            if (!sum_up(&s)) continue;
            sag_parallel_for(context, s.chunk_count, scatter_chunk, &s);
            uint64_t *t = s.from;
            s.from = s.to, s.to = t;
        }
        if (s.from != keys) memcpy(keys, s.from, (size_t)count * sizeof *keys);
        status = SAG_OK;
    }
    sag_release(context, s.extents, s.chunk_count * sizeof *s.extents);
    sag_release(context, s.places, s.chunk_count * sizeof *s.places);
    return status;
}
