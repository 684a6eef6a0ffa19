// SPDX-License-Identifier: MIT
// Homogeneous participating media: what becomes of light between surfaces.
#ifndef SAGI_RENDER_MEDIUM_H
#define SAGI_RENDER_MEDIUM_H

#include "world.h"

// A medium of a world, made ready.
typedef struct sagi_medium {
    sag_medium medium;
    sagi_color absorption, scattering, emission; // times the scales
    bool scatters, emits;
} sagi_medium;

// Makes a medium ready. False for numbers that cannot be.
bool sagi_medium_prepare(const sag_world *world, const sag_medium *medium, sagi_medium *entry);

// The medium of an id, NULL for 0: vacuum.
static inline const sagi_medium *sagi_medium_of(const sag_world *world, uint32_t id) {
    return id ? (const sagi_medium *)world->media.items + (id - 1) : NULL;
}

// The share of light that passes `length` of the medium: exp(−(σa + σs) length).
sagi_spectrum sagi_medium_transmittance(const sagi_medium *medium, sagi_spectrum lambda, double length);

// What light going `length` through a medium meets first: a particle that scatters it, or the end.
typedef struct sagi_flight {
    bool scattered;
    double distance;       // to the particle
    sagi_spectrum weight;  // for the path that goes on from there, or from the end
    sagi_spectrum emitted; // light of the medium itself, on the whole way
} sagi_flight;

// `dispersed`: only the first wavelength counts. u in [0, 1).
sagi_flight sagi_medium_fly(const sagi_medium *medium, sagi_spectrum lambda, bool dispersed, double length,
                            double u);

// Henyey and Greenstein's phase function per solid angle; wo and wi both point away, so that cos θ = wo · wi
// is −1 where light goes straight on. It is its own density: sample draws wi with it, and returns it.
double sagi_phase(double g, double cosine);
double sagi_phase_sample(double g, sag_vec3 wo, sag_vec2 u, sag_vec3 *wi);

// The medium on the side that wi points to, of a surface (oriented) that has `medium` around it where it
// does not say better.
static inline uint32_t sagi_medium_beyond(const sagi_appearance *appearance, const sag_surface *surface,
                                          sag_vec3 wi, uint32_t medium) {
    if (!appearance || appearance->look.inside == appearance->look.outside) return medium;
    return sag_dot(wi, surface->geometric_normal) > 0 ? appearance->look.outside : appearance->look.inside;
}

#endif
