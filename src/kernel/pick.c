// SPDX-License-Identifier: MIT
// The table of each instruction set. One that was compiled without its flags is empty and counts as not
// there.
#include "kernel/kernel.h"
#include <stddef.h>

static const sagi_kernel *table(sagi_isa isa) {
    switch (isa) {
    case SAGI_ISA_PORTABLE: return &sagi_kernel_portable;
    case SAGI_ISA_SSE42: return &sagi_kernel_sse42;
    case SAGI_ISA_AVX2: return &sagi_kernel_avx2;
    case SAGI_ISA_AVX512: return &sagi_kernel_avx512;
    case SAGI_ISA_NEON: return &sagi_kernel_neon;
    }
    return NULL;
}

bool sagi_isa_is_built(sagi_isa isa) {
    const sagi_kernel *kernel = table(isa);
    return kernel != NULL && kernel->intersect != NULL;
}

const sagi_kernel *sagi_kernel_pick(sagi_isa isa) {
    return sagi_isa_is_built(isa) ? table(isa) : &sagi_kernel_portable;
}
