// SPDX-License-Identifier: MIT
#include "kernel/kernel.h"

const sagi_kernel *sagi_kernel_pick(sagi_isa isa) {
    const sagi_kernel *kernel = &sagi_kernel_portable;
    switch (isa) {
    case SAGI_ISA_AVX2: kernel = &sagi_kernel_avx2; break;
    case SAGI_ISA_AVX512: kernel = &sagi_kernel_avx512; break;
    case SAGI_ISA_PORTABLE:
    case SAGI_ISA_SSE42:
    case SAGI_ISA_NEON: break;
    }
    return kernel->intersect != NULL ? kernel : &sagi_kernel_portable;
}
