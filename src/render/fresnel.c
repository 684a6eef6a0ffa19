// SPDX-License-Identifier: MIT
// Fresnel's equations (PBR 4th ed. §9.3.5–9.3.6; Born & Wolf §1.5).
//
// With Snell's sin θt = sin θi/η, the two polarisations reflect the amplitudes
//     r∥ = (η cos θi − cos θt)/(η cos θi + cos θt),   r⊥ = (cos θi − η cos θt)/(cos θi + η cos θt)
// and unpolarised light the mean of their squares. A metal has η + iκ in place of η; separating real and
// imaginary parts gives, with s = sin², c = cos²,
//     a² + b² = √((η² − κ² − s)² + 4η²κ²),   a = √((a² + b² + η² − κ² − s)/2),
//     R⊥ = (a² + b² + c − 2a cos)/(a² + b² + c + 2a cos),
//     R∥ = R⊥ (c(a² + b²) + s² − 2a cos s)/(c(a² + b²) + s² + 2a cos s).
#include "fresnel.h"

#include "math/elementary.h"

double sagi_fresnel_dielectric(double cos_i, double eta) {
    cos_i = sagi_clamp(cos_i, -1, 1);
    if (cos_i < 0) {
        eta = 1 / eta;
        cos_i = -cos_i;
    }
    double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    double cos_t = sqrt(1 - sin2_t);
    // (Over one denominator: a division takes as long as a dozen products.)
    const double parallel = eta * cos_i + cos_t, perpendicular = cos_i + eta * cos_t;
    const double a = (eta * cos_i - cos_t) * perpendicular, b = (cos_i - eta * cos_t) * parallel;
    const double scale = 1 / (parallel * perpendicular);
    return (a * a + b * b) * (scale * scale) / 2;
}

double sagi_fresnel_conductor(double cos_i, double eta, double k) {
    cos_i = sagi_clamp(fabs(cos_i), 0, 1);
    double c = cos_i * cos_i, s = 1 - c;
    double t = eta * eta - k * k - s;
    double sum = sqrt(t * t + 4 * eta * eta * k * k);
    double a = sqrt(fmax(0, (sum + t) / 2));
    double perpendicular = (sum + c - 2 * a * cos_i) / (sum + c + 2 * a * cos_i);
    double inner = c * sum + s * s;
    double parallel = perpendicular * (inner - 2 * a * cos_i * s) / (inner + 2 * a * cos_i * s);
    return sagi_clamp((parallel + perpendicular) / 2, 0, 1);
}

sagi_spectrum sagi_fresnel_conductor_spectrum(double cos_i, sagi_spectrum eta, sagi_spectrum k) {
    cos_i = sagi_clamp(fabs(cos_i), 0, 1);
    const float cosine = (float)cos_i, c = (float)(cos_i * cos_i), s = (float)(1 - cos_i * cos_i);
    const sagi_spectrum eta2 = eta * eta, k2 = k * k, t = eta2 - k2 - s, product = 4 * eta2 * k2;
    const sagi_spectrum sum = sagi_spectrum_sqrt(t * t + product);
    // (sum + t)/2 without cancellation.
    const sagi_spectrum a2 = sagi_spectrum_choose(t >= 0, sum + t, product / (sum - t)) * 0.5F;
    const sagi_spectrum x = 2 * cosine * sagi_spectrum_sqrt(a2);
    const sagi_spectrum perpendicular = (sum + c - x) / (sum + c + x), inner = c * sum + s * s;
    const sagi_spectrum parallel = perpendicular * (inner - x * s) / (inner + x * s);
    return sagi_spectrum_clamp((parallel + perpendicular) * 0.5F);
}

bool sagi_refract(sag_vec3 w, sag_vec3 n, double eta, double *eta_path, sag_vec3 *refracted) {
    double cos_i = sag_dot(w, n);
    if (cos_i < 0) {
        eta = 1 / eta;
        cos_i = -cos_i;
        n = sag_neg(n);
    }
    double sin2_t = fmax(0, 1 - cos_i * cos_i) / (eta * eta);
    if (!(sin2_t < 1)) return false;
    double cos_t = sqrt(1 - sin2_t);
    *refracted = sag_madd(sag_scale(w, -1 / eta), cos_i / eta - cos_t, n);
    *eta_path = eta;
    return true;
}

// The outer mean is ∫₀¹ F(√s) ds over s = cos² (since 2 cos θ sin θ dθ = d(sin²)). Radiance is squeezed by η²
// inside, so the share that gets out, 1 − inner, is (1 − outer)/η²: exactly what a lossless coat needs. What
// is absorbed is taken off that. Midpoint rule.
double sagi_fresnel_inner_mean(double eta, double thickness) {
    const int steps = 1024;
    double outer = 0, absorbed = 0;
    for (int i = 0; i < steps; i++) {
        double x = (i + 0.5) / steps; // the cosine
        outer += sagi_fresnel_dielectric(x, eta) * 2 * x / steps;
        absorbed += sagi_fresnel_dielectric(x, 1 / eta) * (1 - sagi_exp(-2 * thickness / x)) * 2 * x / steps;
    }
    return 1 - (1 - outer) / (eta * eta) - absorbed;
}
