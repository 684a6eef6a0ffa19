// SPDX-License-Identifier: MIT
// Student's distribution: how far the mean of a few numbers may be from the truth, in units of its estimated
// deviation. With θ = atan(t/√ν), P(|T| < t) is (Abramowitz & Stegun 26.7.3 and 26.7.4)
//
//     ν odd:   2/π (θ + sin θ (cos θ + 2/3 cos³θ + … + (2·4···(ν−3))/(3·5···(ν−2)) cos^(ν−2) θ))
//     ν even:  sin θ (1 + 1/2 cos²θ + … + (1·3···(ν−3))/(2·4···(ν−2)) cos^(ν−2) θ).
//
// It grows with θ, so θ is found by halving.
#include "math/elementary.h"
#include "measure/measure.h"
#include "shapes/common.h"

static double probability(double theta, int freedom) {
    const double sine = sagi_sin(theta), cosine = sagi_cos(theta);
    if (freedom == 1) return 2 / SAGI_PI * theta;
    const bool odd = freedom % 2 == 1;
    double term = odd ? cosine : 1, sum = term;
    for (int k = odd ? 3 : 2; k <= freedom - 2; k += 2) {
        term *= cosine * cosine * (k - 1) / k;
        sum += term;
    }
    return odd ? 2 / SAGI_PI * (theta + sine * sum) : sine * sum;
}

double sagi_student_quantile(double confidence, int freedom) {
    double low = 0, high = SAGI_PI / 2;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (probability(middle, freedom) < confidence)
            low = middle;
        else
            high = middle;
    }
    return sqrt(freedom) * sagi_tan(low);
}
