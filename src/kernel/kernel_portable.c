// SPDX-License-Identifier: MIT
// The traversal for any machine, in nothing but C, whatever the compiler is allowed: what the others are
// compared with.
#define SAGI_SIMD_PLAIN
#define SAGI_KERNEL_NAME sagi_kernel_portable
#include "kernel/kernel.inl"
