// SPDX-License-Identifier: MIT
// Area and uniform sampling of the surface ρ² = α z² + β z + γ turned about z.
//
// dA = φ ρ √(1 + ρ'²) dz = φ √(ρ² + (ρρ')²) dz with ρρ' = α z + β/2: the root of a quadratic in z, whatever
// the conic. Its integral has closed forms that cancel badly near their borders (cone, cylinder, paraboloid);
// a Gauss rule on few panels has none of that.
#ifndef SAGI_SHAPES_REVOLVE_H
#define SAGI_SHAPES_REVOLVE_H

// The curve in h = z − origin, so that no large z cancels.
typedef struct sagi_profile {
    double alpha, beta, gamma;
} sagi_profile;

// ∫ √(ρ² + (ρρ')²) dh from low to high, to about 1e-13 of itself.
double sagi_profile_area(const sagi_profile *profile, double low, double high);
// The h with that integral from low being `fraction` of the whole to high.
double sagi_profile_invert(const sagi_profile *profile, double low, double high, double fraction);

#endif
