// SPDX-License-Identifier: MIT
// Texture coordinates given at the corners of a patch. With (s, t) bilinear over the patch's own (u, v), the
// chain rule gives how the position changes with them: the inverse of the matrix ∂(s, t)/∂(u, v) makes ∂p/∂s
// and ∂p/∂t of ∂p/∂u and ∂p/∂v. Where it has none (all corners alike, or turned over) these stay as they are:
// they also say how the surface lies.
#include "world.h"

void sagi_given_texcoords(const sagi_appearance *appearance, sag_surface *surface) {
    if (appearance->square_uv) { // corners at (0, 0), (1, 0), (1, 1)
        surface->u += surface->v;
        surface->dpdv = sag_sub(surface->dpdv, surface->dpdu);
    }
    if (!appearance->look.has_uv) return;
    const double u = surface->u, v = surface->v;
    double at[2], by_u[2], by_v[2];
    for (int k = 0; k < 2; k++) {
        const double a = (double)appearance->look.uv[0][k], b = (double)appearance->look.uv[1][k];
        const double c = (double)appearance->look.uv[2][k], d = (double)appearance->look.uv[3][k];
        at[k] = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
        by_u[k] = (1 - v) * (b - a) + v * (d - c);
        by_v[k] = (1 - u) * (c - a) + u * (d - b);
    }
    surface->u = at[0], surface->v = at[1];
    const double determinant = by_u[0] * by_v[1] - by_u[1] * by_v[0];
    const double largest = fmax(fabs(by_u[0] * by_v[1]), fabs(by_u[1] * by_v[0]));
    if (!(fabs(determinant) > 0x1p-40 * largest)) return;
    const sag_vec3 dpdu = surface->dpdu, dpdv = surface->dpdv;
    surface->dpdu = sag_sub(sag_scale(dpdu, by_v[1] / determinant), sag_scale(dpdv, by_u[1] / determinant));
    surface->dpdv = sag_sub(sag_scale(dpdv, by_u[0] / determinant), sag_scale(dpdu, by_v[0] / determinant));
}
