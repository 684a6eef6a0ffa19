// SPDX-License-Identifier: MIT
// Ways to get from a reference in a leaf to the code of its shape. Each is a kernel of its own, compiled from
// the same source (src/kernel/kernel.inl) but for `list`.
#ifndef BENCH_DISPATCH_H
#define BENCH_DISPATCH_H

#include "kernel/kernel.h"

extern const sagi_kernel dispatch_leaf;      // leaf.inl as it is: runs of one kind, each reference switched
extern const sagi_kernel dispatch_again;     // the same once more: what differs is the measurement's noise
extern const sagi_kernel dispatch_run;       // runs, one switch each, a loop in every case
extern const sagi_kernel dispatch_primitive; // no runs: a switch for each reference
extern const sagi_kernel dispatch_pointer;   // no runs: each object points to its class's functions

#endif
