// SPDX-License-Identifier: MIT
// Which instruction set's kernels a context uses.
#ifndef SAGI_BASE_CPU_H
#define SAGI_BASE_CPU_H

#include <stdbool.h>

// In order of preference within one family of processors.
typedef enum sagi_isa {
    SAGI_ISA_PORTABLE,
    SAGI_ISA_SSE42,
    SAGI_ISA_AVX2,
    SAGI_ISA_AVX512,
    SAGI_ISA_NEON
} sagi_isa;
#define SAGI_ISA_COUNT (SAGI_ISA_NEON + 1)

// "portable", "sse42" …; what sag_context_isa returns.
const char *sagi_isa_name(sagi_isa isa);
// Whether the processor and the operating system can both run it.
bool sagi_cpu_has(sagi_isa isa);
// Whether this build has kernels for it; only the kernels know (src/kernel/pick.c).
bool sagi_isa_is_built(sagi_isa isa);
// The named instruction set, or the best when `name` is NULL. False, writing nothing, when the name is
// unknown or there are no kernels for it or the machine cannot run them.
bool sagi_isa_choose(const char *name, sagi_isa *isa);

#endif
