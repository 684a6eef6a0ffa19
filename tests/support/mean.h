// SPDX-License-Identifier: MIT
// The mean of random numbers, and how far it may be off.
#ifndef TESTS_SUPPORT_MEAN_H
#define TESTS_SUPPORT_MEAN_H

#include <math.h>

typedef struct mean {
    double sum, squares;
    int count;
} mean;
static inline void mean_add(mean *m, double x) { m->sum += x, m->squares += x * x, m->count++; }
static inline double mean_of(const mean *m) { return m->sum / m->count; }
// The standard deviation of the mean.
static inline double deviation_of(const mean *m) {
    const double mu = mean_of(m);
    return sqrt(fmax(0, m->squares / m->count - mu * mu) / m->count);
}

#endif
