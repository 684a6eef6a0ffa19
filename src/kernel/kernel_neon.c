// SPDX-License-Identifier: MIT
// The traversal for 64-bit ARM, all of which has NEON: no flags are needed. The eight boxes of a node are in
// two registers each coordinate.
#if defined(__aarch64__) && defined(__ARM_NEON)
#define SAGI_KERNEL_NAME sagi_kernel_neon
#include "kernel/kernel.inl"
#else
#include "kernel/kernel.h"
const sagi_kernel sagi_kernel_neon = {0};
#endif
