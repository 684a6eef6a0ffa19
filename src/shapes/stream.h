// SPDX-License-Identifier: MIT
// More random numbers out of two: what rejection sampling needs where its interface hands it only a pair. The
// pair's bits seed splitmix64 (Steele, Lea & Flood, OOPSLA 2014), so the same pair gives the same point, on
// any machine.
#ifndef SAGI_SHAPES_STREAM_H
#define SAGI_SHAPES_STREAM_H

#include "math/hash.h"

typedef struct sagi_stream {
    uint64_t state;
} sagi_stream;

static inline uint64_t sagi_stream_bits(sagi_stream *s) { return sagi_mix(s->state += 0x9E3779B97F4A7C15u); }

static inline sagi_stream sagi_stream_of(sag_vec2 random) {
    uint64_t x, y;
    memcpy(&x, &random.x, sizeof x);
    memcpy(&y, &random.y, sizeof y);
    sagi_stream s = {x};
    s.state = sagi_stream_bits(&s) ^ y;
    return s;
}

// Uniform in [0, 1).
static inline double sagi_stream_unit(sagi_stream *s) {
    return (double)(sagi_stream_bits(s) >> 11) * 0x1p-53;
}

#endif
