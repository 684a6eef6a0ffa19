// SPDX-License-Identifier: MIT
// How much light a smooth boundary reflects, and where the rest goes.
#ifndef SAGI_RENDER_FRESNEL_H
#define SAGI_RENDER_FRESNEL_H

#include "spectrum.h"

// Unpolarised reflectance of a dielectric at cos θi, eta = n_other/n_here. A negative cosine comes from the
// other side: eta is inverted. 1 under total internal reflection.
double sagi_fresnel_dielectric(double cos_i, double eta);
// The same of a metal of index eta + i·k, |cos θi|.
double sagi_fresnel_conductor(double cos_i, double eta, double k);
// At four wavelengths, to the accuracy of float.
sagi_spectrum sagi_fresnel_conductor_spectrum(double cos_i, sagi_spectrum eta, sagi_spectrum k);
// The direction w bent at a surface of unit normal n (on w's side or not; eta = n_below/n_above as n points
// up): *refracted, and *eta_path = the ratio of indices as w crosses. False under total internal reflection.
bool sagi_refract(sag_vec3 w, sag_vec3 n, double eta, double *eta_path, sag_vec3 *refracted);
// The mean of the dielectric reflectance over the cosine-weighted hemisphere inside a coat of index eta,
// dimmed by the way back and forth through its thickness: F(μ) exp(−2 thickness/μ).
double sagi_fresnel_inner_mean(double eta, double thickness);

#endif
