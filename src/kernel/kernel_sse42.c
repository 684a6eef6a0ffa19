// SPDX-License-Identifier: MIT
// The traversal for SSE4.2, the least that x86 processors of the last fifteen years have: the eight boxes of
// a node in two registers each coordinate.
#if defined(__SSE4_2__)
#define SAGI_KERNEL_NAME sagi_kernel_sse42
#include "kernel/kernel.inl"
#else
#include "kernel/kernel.h"
const sagi_kernel sagi_kernel_sse42 = {0};
#endif
