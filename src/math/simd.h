// SPDX-License-Identifier: MIT
// Eight floats at once, or four doubles: all that the kernels need of an instruction set.
//
// The types are the vector types of GCC and Clang, which the compiler lowers to what there is: one register
// with AVX, two with SSE or NEON, plain code elsewhere. Arithmetic is written with operators. What operators
// cannot say, or not well on all machines, are functions: in simd_avx2.h for one register, in simd_halves.h
// for two. To fill a vector with a number (`a * fill(x)`, not `a * x`), to make one of numbers that are no
// constants, and to compare are among them: with two registers GCC does these by way of memory, and it takes
// five times as long.
#ifndef SAGI_MATH_SIMD_H
#define SAGI_MATH_SIMD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(SAGI_SIMD_PLAIN) // by kernel_portable.c
#elif defined(__AVX2__) && defined(__FMA__)
#define SAGI_SIMD_AVX2 1
#include <immintrin.h>
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__)
#define SAGI_SIMD_AVX512 1
#endif
#elif defined(__SSE2__)
#define SAGI_SIMD_SSE 1
#include <emmintrin.h>
#ifdef __SSE4_1__
#define SAGI_SIMD_SSE4 1
#include <smmintrin.h>
#endif
#elif defined(__aarch64__) && defined(__ARM_NEON)
#define SAGI_SIMD_NEON 1
#include <arm_neon.h>
#endif

typedef float sagi_f8 __attribute__((vector_size(32)));
typedef int32_t sagi_i8 __attribute__((vector_size(32))); // a comparison's result: −1 where it holds, else 0
typedef double sagi_d4 __attribute__((vector_size(32)));
typedef int64_t sagi_l4 __attribute__((vector_size(32)));
typedef uint16_t sagi_h8 __attribute__((vector_size(16)));
typedef float sagi_f4 __attribute__((vector_size(16)));
typedef int32_t sagi_w4 __attribute__((vector_size(16)));

#define SAGI_INLINE static inline __attribute__((always_inline))

// The same number, of which the compiler no longer knows what it is.
SAGI_INLINE size_t sagi_opaque(size_t n) {
    __asm__("" : "+r"(n));
    return n;
}

// The same place, of which the compiler no longer knows what is there: constants that stand together are then
// read as operands, where it would make each anew by two instructions or more.
SAGI_INLINE const void *sagi_hidden(const void *p) {
    __asm__("" : "+r"(p));
    return p;
}

// The last n bits, n < 32.
SAGI_INLINE uint32_t sagi_last_bits(uint32_t x, uint32_t n) {
#if defined(SAGI_SIMD_AVX2) && defined(__BMI2__)
    return _bzhi_u32(x, n);
#else
    return x & ((1U << n) - 1);
#endif
}

// The number of the lowest bit set; 32 where none is.
SAGI_INLINE uint32_t sagi_lowest(uint32_t x) {
#if defined(SAGI_SIMD_AVX2) && defined(__BMI__)
    return _tzcnt_u32(x);
#else
    return x != 0 ? (uint32_t)__builtin_ctz(x) : 32;
#endif
}

// x > y ? a : b, without a branch: for what nobody can foresee.
SAGI_INLINE uint32_t sagi_if_above(uint32_t x, uint32_t y, uint32_t a, uint32_t b) {
#if defined(__x86_64__) && !defined(SAGI_SIMD_PLAIN)
    __asm__("cmp %[y], %[x]\n\tcmova %[a], %[b]" : [b] "+r"(b) : [x] "r"(x), [y] "ri"(y), [a] "r"(a) : "cc");
    return b;
#else
    return x > y ? a : b;
#endif
}
SAGI_INLINE uint64_t sagi_if_above_long(uint64_t x, uint64_t y, uint64_t a, uint64_t b) {
#if defined(__x86_64__) && !defined(SAGI_SIMD_PLAIN)
    __asm__("cmp %[y], %[x]\n\tcmova %[a], %[b]"
            : [b] "+r"(b)
            : [x] "r"(x), [y] "rme"(y), [a] "rm"(a)
            : "cc");
    return b;
#else
    return x > y ? a : b;
#endif
}

// Aligned to 32 bytes.
SAGI_INLINE sagi_f8 sagi_f8_load(const void *p) { return *(const sagi_f8 *)__builtin_assume_aligned(p, 32); }
SAGI_INLINE sagi_i8 sagi_i8_load(const void *p) { return *(const sagi_i8 *)__builtin_assume_aligned(p, 32); }
SAGI_INLINE sagi_d4 sagi_d4_load(const void *p) { // of any alignment
    sagi_d4 a;
    memcpy(&a, p, sizeof a);
    return a;
}

SAGI_INLINE void sagi_zero32(void *p) { // of any alignment
    const sagi_d4 zero = {0, 0, 0, 0};
    memcpy(p, &zero, sizeof zero);
}

SAGI_INLINE sagi_i8 sagi_f8_bits(sagi_f8 a) { return (sagi_i8)a; }
// The sum modulo 2³²; what is too large for a sum of signed numbers, C leaves undefined.
SAGI_INLINE sagi_i8 sagi_i8_wrapping_sum(sagi_i8 a, sagi_i8 b) {
    typedef uint32_t whole __attribute__((vector_size(32)));
    return (sagi_i8)((whole)a + (whole)b);
}
SAGI_INLINE sagi_f8 sagi_f8_and(sagi_f8 a, sagi_i8 bits) { return (sagi_f8)((sagi_i8)a & bits); }
SAGI_INLINE sagi_f8 sagi_f8_abs(sagi_f8 a) { return (sagi_f8)((sagi_i8)a & INT32_MAX); }
SAGI_INLINE sagi_d4 sagi_d4_abs(sagi_d4 a) { return (sagi_d4)((sagi_l4)a & INT64_MAX); }
// Where the mask holds a, else b.
SAGI_INLINE sagi_f8 sagi_f8_select(sagi_i8 mask, sagi_f8 a, sagi_f8 b) {
    return (sagi_f8)((mask & (sagi_i8)a) | (~mask & (sagi_i8)b));
}
SAGI_INLINE sagi_d4 sagi_d4_select(sagi_l4 mask, sagi_d4 a, sagi_d4 b) {
    return (sagi_d4)((mask & (sagi_l4)a) | (~mask & (sagi_l4)b));
}

// What makes vectors of numbers, compares and shuffles them, and more.
#ifdef SAGI_SIMD_AVX2
#include "math/simd_avx2.h"
#else
#include "math/simd_halves.h"
#endif

SAGI_INLINE sagi_i8 sagi_f8_below(sagi_f8 a, float x) { return sagi_f8_less(a, sagi_f8_fill(x)); }
SAGI_INLINE sagi_i8 sagi_f8_above(sagi_f8 a, float x) { return sagi_f8_less(sagi_f8_fill(x), a); }
SAGI_INLINE sagi_l4 sagi_d4_below(sagi_d4 a, double x) { return sagi_d4_less(a, sagi_d4_fill(x)); }
SAGI_INLINE sagi_l4 sagi_d4_above(sagi_d4 a, double x) { return sagi_d4_less(sagi_d4_fill(x), a); }

// The greatest of eight.
SAGI_INLINE float sagi_f8_most(sagi_f8 a) {
    sagi_f4 half = {a[4], a[5], a[6], a[7]}, other = {a[0], a[1], a[2], a[3]};
    half = (sagi_f4)(((half > other) & (sagi_w4)half) | (~(half > other) & (sagi_w4)other));
    float x = half[0] > half[1] ? half[0] : half[1], y = half[2] > half[3] ? half[2] : half[3];
    return x > y ? x : y;
}
// Eight vectors of three as three of eight.
SAGI_INLINE void sagi_f4_turn8(const sagi_f4 a[8], sagi_f8 *x, sagi_f8 *y, sagi_f8 *z) {
    *x = sagi_f8_join((sagi_f4){a[0][0], a[1][0], a[2][0], a[3][0]},
                      (sagi_f4){a[4][0], a[5][0], a[6][0], a[7][0]});
    *y = sagi_f8_join((sagi_f4){a[0][1], a[1][1], a[2][1], a[3][1]},
                      (sagi_f4){a[4][1], a[5][1], a[6][1], a[7][1]});
    *z = sagi_f8_join((sagi_f4){a[0][2], a[1][2], a[2][2], a[3][2]},
                      (sagi_f4){a[4][2], a[5][2], a[6][2], a[7][2]});
}

// What puts the lanes where a ≤ b in the order of a: a, as a whole number without a sign, with the lane's
// number in place of its last three bits; in other lanes more than that of any. *met: the lanes where a ≤ b.
//
// a is neither negative nor −0, so that its bits are in its order, and b's, which are those of a negative
// whole number where b has a sign, are below them: for b = −0, which is as good as negative here.
SAGI_INLINE sagi_i8 sagi_f8_in_order(sagi_f8 a, sagi_f8 b, uint32_t *met) {
    const sagi_i8 number = {0, 1, 2, 3, 4, 5, 6, 7};
    const sagi_i8 missed = sagi_i8_above(sagi_f8_bits(a), sagi_f8_bits(b));
    sagi_i8 order = (sagi_f8_bits(a) & ~7) | number;
    *met = sagi_i8_mask(missed) ^ 0xFF;
#ifdef SAGI_SIMD_AVX512
    __asm__("" : "+x"(order)); // or GCC would have `number`, too, wait for the comparison
#endif
    return order | missed;
}

#endif
