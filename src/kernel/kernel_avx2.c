// SPDX-License-Identifier: MIT
// The traversal for AVX2: the eight boxes of a node in one register each coordinate.
#ifdef __AVX2__
#define SAGI_KERNEL_NAME sagi_kernel_avx2
#include "kernel/kernel.inl"
#else
#include "kernel/kernel.h"
const sagi_kernel sagi_kernel_avx2 = {0};
#endif
