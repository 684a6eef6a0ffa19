// SPDX-License-Identifier: MIT
// The traversal for AVX-512, whose comparisons of eight floats leave a mask of eight bits.
#if defined(__AVX512F__) && defined(__AVX512VL__)
#define SAGI_KERNEL_NAME sagi_kernel_avx512
#include "kernel/kernel.inl"
#else
#include "kernel/kernel.h"
const sagi_kernel sagi_kernel_avx512 = {0};
#endif
