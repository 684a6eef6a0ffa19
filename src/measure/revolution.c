// SPDX-License-Identifier: MIT
// Moments of bodies of revolution about the z axis.
//
// A slice at z is a disk of radius ρ(z). ∫ 1 = πρ², ∫ x² = ∫ y² = πρ⁴/4 over it, so
//
//     V = π ∫ ρ² dz,   ∫ z dV = π ∫ z ρ² dz,   ∫ z² dV = π ∫ z² ρ² dz,   ∫ x² dV = (π/4) ∫ ρ⁴ dz.
//
// Cylinder, cone, paraboloid and both hyperboloids have a ρ² that is a polynomial of second degree in z: all
// four integrands have degree four at most, for which Gauss and Legendre's rule of three points is exact. All
// its terms of V, z² and ρ⁴ are positive, so nothing cancels; z counts from the middle of the interval.
//
// The torus. Its outer sheet is ρ = R + r cos ψ, z = r sin ψ for |ψ| ≤ β: β = π for a ring, cos β = −R/r for
// a spindle, whose inner sheet is inside. Over all of it, ∫ f(ρ) dz with dz = r cos ψ dψ takes what is within
// the outer part and takes off what is within the inner one. A ring has
//
//     V = 2π² R r²,   ∫ z² dV = V r²/4,   ∫ x² dV = V (R²/2 + 3r²/8)
//
// (Pappus). For a spindle the integrands are trigonometric polynomials of degree five over an angle of at
// most 2π: Gauss's rule with five points on 32 panels leaves an error below 1e-16.
#include "math/elementary.h"
#include "measure/measure.h"
#include "shapes/common.h"

const double sagi_revolution_nodes[3] = {-0.77459666924148337704, 0, 0.77459666924148337704}; // √(3/5)

sagi_moments sagi_revolution_moments(double z_min, double z_max, const double square[3]) {
    static const double weight[3] = {5 / 9.0, 8 / 9.0, 5 / 9.0};
    const double half = z_max / 2 - z_min / 2, middle = z_min + half;
    double volume = 0, first = 0, along = 0, across = 0;
    for (int i = 0; i < 3; i++) {
        const double z = half * sagi_revolution_nodes[i], w = SAGI_PI * half * weight[i] * square[i];
        volume += w;
        first += w * z;
        along += w * z * z;
        across += w * square[i] / 4;
    }
    const sagi_raw_moments raw = {{volume, 0, 0, first, across, across, along, 0, 0, 0}};
    return sagi_moments_from_raw(&raw, sag_vec3_make(0, 0, middle));
}

// Both on the axis; the other moments about the common centre follow from Steiner's theorem.
sagi_moments sagi_revolution_sum(const sagi_moments *a, const sagi_moments *b) {
    const double volume = a->volume + b->volume;
    if (!(volume > 0)) return *a;
    const double apart = b->center.z - a->center.z, share = b->volume / volume;
    sagi_moments sum = {.volume = volume, .center = {0, 0, a->center.z + share * apart}};
    for (int k = 0; k < 6; k++) sum.central[k] = a->central[k] + b->central[k];
    sum.central[2] += a->volume * share * apart * apart;
    return sum;
}

static sagi_moments spindle(double major, double minor) {
    static const double node[5] = {-0.90617984593866399280, -0.53846931010568309104, 0,
                                   0.53846931010568309104, 0.90617984593866399280};
    static const double weight[5] = {0.23692688505618908751, 0.47862867049936646804, 128 / 225.0,
                                     0.47862867049936646804, 0.23692688505618908751};
    enum { PANELS = 32 };
    const double beta = sagi_acos(-major / minor), half = beta / (2 * PANELS);
    sagi_moments sum = {0};
    for (int panel = 0; panel < PANELS; panel++)
        for (int i = 0; i < 5; i++) {
            const double psi = half * (2 * panel + 1 + node[i]);
            const double rho = major + minor * sagi_cos(psi), z = minor * sagi_sin(psi), square = rho * rho;
            const double w = 2 * SAGI_PI * half * weight[i] * minor * sagi_cos(psi) * square; // both ±ψ
            sum.volume += w;
            sum.central[0] += w * square / 4;
            sum.central[2] += w * z * z;
        }
    sum.central[1] = sum.central[0];
    return sum;
}

sagi_moments sagi_torus_moments(const sag_torus *torus) {
    const double major = torus->major_radius, minor = torus->minor_radius;
    if (major < minor) return spindle(major, minor);
    const double volume = 2 * SAGI_PI * SAGI_PI * major * minor * minor;
    const double across = volume * (major * major / 2 + 3 * minor * minor / 8);
    return (sagi_moments){.volume = volume, .central = {across, across, volume * minor * minor / 4}};
}
