// SPDX-License-Identifier: MIT
// Instruction set detection. On x86 a processor that has AVX is not enough: the operating system must save
// the wider registers when it switches threads, and says so in the extended control register XCR0 (read by
// XGETBV, which may be used only when CPUID.1:ECX.OSXSAVE is set). Bits of XCR0: 1 SSE, 2 AVX; 5, 6 and 7 the
// mask and upper registers of AVX-512. (Intel SDM vol. 1, ch. 13 to 15.)
#include "base/cpu.h"
#include <stddef.h>
#include <string.h>

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#define SAGI_X86 1
#endif

static const char *const names[SAGI_ISA_COUNT] = {
    [SAGI_ISA_PORTABLE] = "portable", [SAGI_ISA_SSE42] = "sse42", [SAGI_ISA_AVX2] = "avx2",
    [SAGI_ISA_AVX512] = "avx512",     [SAGI_ISA_NEON] = "neon",
};

const char *sagi_isa_name(sagi_isa isa) { return names[isa]; }

#ifdef SAGI_X86
static unsigned long long control_register(void) {
    unsigned low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (unsigned long long)high << 32 | low;
}

static bool has_all(unsigned long long value, unsigned long long bits) { return (value & bits) == bits; }

static bool x86_has(sagi_isa isa) {
    unsigned a, b, c1, d, b7 = 0, c7, d7;
    if (!__get_cpuid(1, &a, &b, &c1, &d)) return false;
    if (__get_cpuid_max(0, NULL) >= 7) __cpuid_count(7, 0, a, b7, c7, d7);
    bool sse42 = has_all(c1, bit_SSE4_2 | bit_POPCNT);
    unsigned long long saved = has_all(c1, bit_OSXSAVE) ? control_register() : 0;
    bool avx2 = sse42 && has_all(saved, 0x6) && has_all(c1, bit_AVX | bit_FMA | bit_F16C) &&
                has_all(b7, bit_AVX2 | bit_BMI | bit_BMI2);
    bool avx512 =
        avx2 && has_all(saved, 0xe6) && has_all(b7, bit_AVX512F | bit_AVX512DQ | bit_AVX512BW | bit_AVX512VL);
    switch (isa) {
    case SAGI_ISA_PORTABLE: return true;
    case SAGI_ISA_SSE42: return sse42;
    case SAGI_ISA_AVX2: return avx2;
    case SAGI_ISA_AVX512: return avx512;
    case SAGI_ISA_NEON: return false;
    }
    return false;
}
#endif

bool sagi_cpu_has(sagi_isa isa) {
#if defined(SAGI_X86)
    return x86_has(isa);
#elif defined(__aarch64__)
    return isa == SAGI_ISA_PORTABLE || isa == SAGI_ISA_NEON; // every 64-bit ARM has it
#else
    return isa == SAGI_ISA_PORTABLE;
#endif
}

bool sagi_isa_choose(const char *name, sagi_isa *isa) {
    for (int i = SAGI_ISA_COUNT - 1; i >= 0; i--) {
        if (name != NULL && strcmp(name, names[i]) != 0) continue;
        if (!sagi_isa_is_built((sagi_isa)i) || !sagi_cpu_has((sagi_isa)i)) continue;
        *isa = (sagi_isa)i;
        return true;
    }
    return false;
}
