// SPDX-License-Identifier: MIT
// The columns of Sobol's generator matrices. Dimension 0 is the index mirrored. Each other one belongs to a
// primitive polynomial over GF(2), x^s + a_1 x^(s−1) + … + a_(s−1) x + 1, and starts from s odd numbers m_j
// of j + 1 bits each; the next ones follow by
//
//     m_j = 2 a_1 m_(j−1) ^ 4 a_2 m_(j−2) ^ … ^ 2^s m_(j−s) ^ m_(j−s),
//
// and column j is m_j, its highest of j + 1 bits first. Which m_j one starts from decides how evenly pairs of
// dimensions lie; these are those of S. Joe and F. Y. Kuo, "Constructing Sobol' sequences with better
// two-dimensional projections", SIAM J. Sci. Comput. 30 (2008), table new-joe-kuo-6.21201.
#include "sampler.h"

typedef struct start {
    uint8_t degree, polynomial; // a_1 … a_(s−1), a_1 the highest bit
    uint8_t m[7];
} start;

static const start starts[SAGI_SOBOL_DIMENSIONS - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
    {7, 7, {1, 1, 3, 13, 7, 35, 63}},
    {7, 8, {1, 3, 5, 9, 1, 25, 53}},
    {7, 14, {1, 3, 1, 13, 9, 35, 107}},
    {7, 19, {1, 3, 1, 5, 27, 61, 31}},
    {7, 21, {1, 1, 5, 11, 19, 41, 61}},
    {7, 28, {1, 3, 5, 3, 3, 13, 69}},
    {7, 31, {1, 1, 7, 13, 1, 19, 1}},
    {7, 32, {1, 3, 7, 5, 13, 19, 59}},
    {7, 37, {1, 1, 3, 9, 25, 29, 41}},
    {7, 41, {1, 3, 5, 13, 23, 1, 55}},
    {7, 42, {1, 3, 7, 3, 13, 59, 17}},
};

void sagi_sobol_columns(uint32_t columns[SAGI_SOBOL_DIMENSIONS][SAGI_SOBOL_COLUMNS]) {
    for (uint32_t j = 0; j < SAGI_SOBOL_COLUMNS; j++) columns[0][j] = j < 32 ? UINT32_C(1) << j : 0;
    for (uint32_t d = 1; d < SAGI_SOBOL_DIMENSIONS; d++) {
        const start *from = &starts[d - 1];
        const uint32_t s = from->degree;
        uint64_t m[SAGI_SOBOL_COLUMNS];
        for (uint32_t j = 0; j < SAGI_SOBOL_COLUMNS; j++) {
            if (j < s) {
                m[j] = from->m[j];
            } else {
                m[j] = m[j - s] ^ m[j - s] << s;
                for (uint32_t k = 1; k < s; k++)
                    if (from->polynomial >> (s - 1 - k) & 1) m[j] ^= m[j - k] << k;
            }
            // Bit j of m is the first digit, which stands in bit 0 here.
            columns[d][j] = (uint32_t)sagi_reverse_bits64(m[j] << (63 - j));
        }
    }
}
