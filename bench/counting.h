// SPDX-License-Identifier: MIT
// The traversal with counters (counting.c).
#ifndef BENCH_COUNTING_H
#define BENCH_COUNTING_H

#include "kernel/kernel.h"

// How often each step has been taken since the counts were last set to 0. For one thread.
typedef struct kernel_counts {
    size_t nodes, blocks; // steps through a node; blocks of eight tested
    size_t uncertain;     // primitives that a block's float test left open
    size_t exact_tests;   // of those, triangles asked whether they are hit at all
    size_t solved;        // hits for which t, u and v were worked out
    size_t packet_nodes, packet_blocks, packet_triangles;
} kernel_counts;

extern kernel_counts bench_counts;
extern const sagi_kernel bench_counting_kernel;

#endif
