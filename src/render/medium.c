// SPDX-License-Identifier: MIT
// Homogeneous media (PBR 4th ed. ch. 11 and 14).
//
// Light is absorbed with the coefficient σa and scattered with σs per length; of what enters, e^(−σt d),
// σt = σa + σs, has met nothing after d. A path meets a particle at a distance drawn with the density
// σt e^(−σt s). Its four wavelengths have each their own σt. One of the four, chosen at random, draws s; the
// density of s is then the mean of the four, and for every wavelength
//
//     met at s:   e^(−σt s) σs / mean (σt e^(−σt s)),      came through:   e^(−σt d) / mean e^(−σt d)
//
// has the right mean, whichever drew (the balance heuristic over wavelengths; Wilkie et al. 2014). Where
// nothing scatters nothing is drawn: what is absorbed is known.
//
// The medium's own light, L per length absorbed, is not drawn either: over d it comes to
// L σa (1 − e^(−σt d))/σt.
//
// Henyey–Greenstein: p(cos θ) = (1 − g²)/(4π (1 + g² + 2 g cos θ)^(3/2)), whose distribution function has a
// closed inverse ("Diffuse radiation in the galaxy", Astrophysical Journal 93, 1941).
#include "medium.h"
#include "math/elementary.h"
#include "warp.h"

static bool is_amount(const sagi_color *color) { return color->scale >= 0 && isfinite(color->scale); }

bool sagi_medium_prepare(const sag_world *world, const sag_medium *medium, sagi_medium *entry) {
    *entry = (sagi_medium){.medium = *medium,
                           .absorption = sagi_input_color(world, &medium->absorption, SAGI_RGB_UNBOUNDED),
                           .scattering = sagi_input_color(world, &medium->scattering, SAGI_RGB_UNBOUNDED),
                           .emission = sagi_input_color(world, &medium->emission, SAGI_RGB_ILLUMINANT)};
    const float scale = (float)(medium->scale == 0 ? 1 : medium->scale);
    entry->absorption.scale *= scale, entry->scattering.scale *= scale;
    if (medium->emission_scale != 0) entry->emission.scale *= (float)medium->emission_scale;
    entry->scatters = entry->scattering.scale > 0;
    entry->emits = entry->emission.scale > 0 && entry->absorption.scale > 0;
    return is_amount(&entry->absorption) && is_amount(&entry->scattering) && is_amount(&entry->emission) &&
           medium->g > -1 && medium->g < 1;
}

// e^(−σ length) for each wavelength.
static sagi_spectrum passing(sagi_spectrum sigma, double length) {
    sagi_spectrum t;
    for (int i = 0; i < 4; i++) t[i] = sigma[i] > 0 ? (float)sagi_exp(-(double)sigma[i] * length) : 1;
    return t;
}

sagi_spectrum sagi_medium_transmittance(const sagi_medium *m, sagi_spectrum lambda, double length) {
    return passing(sagi_color_at(&m->absorption, lambda) + sagi_color_at(&m->scattering, lambda), length);
}

static sagi_spectrum emitted(sagi_spectrum light, sagi_spectrum sigma_a, sagi_spectrum sigma_t,
                             double length) {
    for (int i = 0; i < 4; i++) {
        const double a = (double)sigma_a[i], t = (double)sigma_t[i];
        light[i] *= a > 0 ? (float)(-sagi_expm1(-t * length) * a / t) : 0;
    }
    return light;
}

sagi_flight sagi_medium_fly(const sagi_medium *m, sagi_spectrum lambda, bool dispersed, double length,
                            double u) {
    const sagi_spectrum sigma_a = sagi_color_at(&m->absorption, lambda),
                        sigma_s = sagi_color_at(&m->scattering, lambda), sigma_t = sigma_a + sigma_s;
    sagi_flight flight = {.distance = length};
    if (m->emits) flight.emitted = emitted(sagi_color_at(&m->emission, lambda), sigma_a, sigma_t, length);
    const int count = dispersed ? 1 : 4;
    u *= count;
    const int drawer = u < count ? (int)u : count - 1;
    const double sigma = (double)sigma_t[drawer];
    const double distance = m->scatters && sigma > 0 ? -sagi_log(1 - (u - drawer)) / sigma : INFINITY;
    flight.scattered = distance < length;
    if (flight.scattered) flight.distance = distance;
    flight.weight = passing(sigma_t, flight.distance);
    if (!m->scatters) return flight;
    const sagi_spectrum density = flight.scattered ? sigma_t * flight.weight : flight.weight;
    float mean = 0;
    for (int i = 0; i < count; i++) mean += density[i] / (float)count;
    if (flight.scattered) flight.weight *= sigma_s;
    flight.weight = mean > 0 ? flight.weight / mean : flight.weight * 0;
    return flight;
}

double sagi_phase(double g, double cosine) {
    const double d = 1 + g * g + 2 * g * cosine;
    return (1 - g * g) / (4 * SAGI_RENDER_PI * d * sqrt(d));
}

double sagi_phase_sample(double g, sag_vec3 wo, sag_vec2 u, sag_vec3 *wi) {
    double cosine = 1 - 2 * u.x;
    if (fabs(g) > 1e-3) {
        const double part = (1 - g * g) / (1 + g - 2 * g * u.x);
        cosine = sagi_clamp(-(1 + g * g - part * part) / (2 * g), -1, 1);
    }
    double sine, across;
    sag_vec3 s, t;
    sagi_sincos(2 * SAGI_RENDER_PI * u.y, &sine, &across);
    const double radius = sqrt(fmax(0, 1 - cosine * cosine));
    sag_frame(wo, &s, &t);
    *wi = sag_normalize(sag_madd(sag_madd(sag_scale(wo, cosine), radius * across, s), radius * sine, t));
    return sagi_phase(g, sag_dot(wo, *wi));
}
