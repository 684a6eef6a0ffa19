// SPDX-License-Identifier: MIT
// The traversal compiled once more, in plain C, with counters in the places that SAGI_KERNEL_COUNT marks.
#include "counting.h"

kernel_counts bench_counts;

#define SAGI_KERNEL_COUNT(what) ((void)bench_counts.what++)
#define SAGI_KERNEL_NAME        bench_counting_kernel
#include "kernel/kernel.inl"
