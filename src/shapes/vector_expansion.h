// SPDX-License-Identifier: MIT
// Vectors of expansions (math/expansion.h), for the exact ends of predicates on triangles. Expansions are
// exact only while no low half of a product underflows, so vectors are brought to a common large scale first:
// by a power of two, which changes no bit, the largest component goes to about 2⁴⁵⁰. Parts below 2⁻⁴⁸⁵ there,
// that is smaller than 2⁻⁹³⁵ of the vector, are dropped: then a product of a part of one such vector with a
// part of another is at least 2⁻⁹⁷⁰ and its lowest bit at least 2⁻¹⁰⁷⁴, so it is exact, and no sum overflows.
#ifndef SAGI_SHAPES_VECTOR_EXPANSION_H
#define SAGI_SHAPES_VECTOR_EXPANSION_H

#include "math/expansion.h"
#include <sagitta/math.h>

#define SAGI_VECTOR_TERMS 16

typedef struct sagi_expansion3 {
    int count[3];
    double terms[3][SAGI_VECTOR_TERMS];
} sagi_expansion3;

// Multiplies by a power of two so that the largest component is near 2⁴⁵⁰ and drops what is then below 2⁻⁴⁸⁵.
// Returns the power's exponent; 0 for the zero vector.
int sagi_expansion3_normalize(sagi_expansion3 *a);
sagi_expansion3 sagi_expansion3_from(sag_vec3 a);
sagi_expansion3 sagi_expansion3_from_diff(sag_vec3 a, sag_vec3 b);
// Component i of a × b. Room in h: 4 · (the most terms of a) · (the most terms of b).
int sagi_expansion3_cross_component(const sagi_expansion3 *a, const sagi_expansion3 *b, int i, double *h);
// a × b, whose components must fit in SAGI_VECTOR_TERMS: at most 4 of the product of term counts.
sagi_expansion3 sagi_expansion3_cross(const sagi_expansion3 *a, const sagi_expansion3 *b);
// a · b. Room in h: 6 · (the most terms of a) · (the most terms of b), at most 192.
int sagi_expansion3_dot(const sagi_expansion3 *a, const sagi_expansion3 *b, double *h);
// n/d · 2^exponent to within two units of the last place; d ≠ 0.
double sagi_expansion_quotient(int n_count, const double *n, int d_count, const double *d, int exponent);

#endif
