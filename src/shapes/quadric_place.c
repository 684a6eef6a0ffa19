// SPDX-License-Identifier: MIT
// Positions on a quadric, and the bound of their error.
//
// Newton's method along the half gradient g: F(y + δ) ≈ F + 2 g·δ, so δ = −F g/2g². What a step leaves is of
// second order. Mostly the first does; a ray from 1e9 sizes away, whose t is known to half an ulp, is 1e-7
// sizes off, and a few more steps are needed where that is not small beside the radius of curvature.
//
// The bound of the error is generous on purpose. Along the normal it must exceed the distance within which
// the filter of quadric_solve.c cannot tell inside from outside, so that a spawned ray is rejected at once:
// the filter's bound of F is 16u ΣF, the sum of magnitudes, and F grows by 2|g| along the normal, so that is
// 8u ΣF/|g|. Taken is four times as much, along each coordinate in proportion to the normal, and the
// roundings of the coordinates. To that comes what the last step was: near the apex of a cone the root of F
// is nearly double, the steps only halve the distance, and twice the last one is left. Where the gradient
// nearly vanishes elsewhere (a crease) the filter is no measure; then 2⁻⁴⁴ of the coordinates is enough.
// FLOOR, 2⁻¹⁶⁰ of the smallest size or less, is for a point that is exactly 0, all of it (the vertex of a
// paraboloid): the next double after 0 is so small that F underflows.
//
// Where the gradient vanishes the normal is a column of Q: right for a double plane (Q = v vᵀ), any will do
// in an apex.
#include "shapes/quadric_local.h"

#define FLOOR 0x1p-200

static void place(const sagi_quadric_form *f, sagi_dd y[3], sag_surface *surface) {
    const double center[3] = {f->center.x, f->center.y, f->center.z}, ones[3] = {1, 1, 1};
    double g[3] = {0}, magnitude[3], gg = 1, blur = 0, k = 0, position[3], error[3];
    for (int step = 0; step < 8; step++) {
        const double at[3] = {y[0].hi, y[1].hi, y[2].hi};
        sagi_polynomial unused;
        double value_error, value = sagi_quadric_residual(f, y, ones, &value_error, &unused);
        sagi_quadric_apply(f, at, g, magnitude);
        for (int i = f->mixed ? 0 : 2; i < 3; i++) g[i] += f->linear[i].hi;
        gg = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        if (!(gg > 0)) break; // the apex of a cone
        blur = 32 * SAGI_EPSILON * (value_error / SAGI_QUADRIC_EPSILON_DD) / gg;
        k = value / (2 * gg);
        for (int i = 0; i < 3; i++) y[i] = sagi_dd_add_double(y[i], -k * g[i]);
        if (fabs(k) <= blur / 64) break; // the step was below the bound's unit
    }
    double most = fmax(fabs(y[0].hi), fmax(fabs(y[1].hi), fabs(y[2].hi)));
    blur = fmin(blur, 0x1p-44 * most / sqrt(gg));
    for (int i = 0; i < 3; i++) {
        double local = ldexp(y[i].hi, f->exponent);
        position[i] = center[i] + local;
        error[i] = ldexp((blur + 4 * fabs(k)) * fabs(g[i]) + FLOOR, f->exponent) +
                   4 * SAGI_EPSILON * (fabs(local) + fabs(position[i]));
    }
    surface->position = sag_vec3_make(position[0], position[1], position[2]);
    surface->position_error = sag_vec3_make(error[0], error[1], error[2]);
    if (!(gg > 0)) {
        const double size[3] = {fabs(f->square[0].hi), fabs(f->square[1].hi), fabs(f->square[2].hi)};
        int main_axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
        const double unit[3] = {main_axis == 0, main_axis == 1, main_axis == 2};
        sagi_quadric_apply(f, unit, g, magnitude);
    }
    surface->geometric_normal = sag_normalize(sag_vec3_make(g[0], g[1], g[2]));
}

void sagi_quadric_place_hit(const sagi_quadric_form *form, const sag_ray *ray, double t,
                            sag_surface *surface) {
    const sag_vec3 o = ray->origin, c = form->center, d = ray->direction;
    sagi_dd y[3] = {sagi_ray_coordinate(o.x, c.x, t, d.x), sagi_ray_coordinate(o.y, c.y, t, d.y),
                    sagi_ray_coordinate(o.z, c.z, t, d.z)};
    for (int i = 0; i < 3 && form->exponent != 0; i++)
        y[i] = (sagi_dd){ldexp(y[i].hi, -form->exponent), ldexp(y[i].lo, -form->exponent)};
    place(form, y, surface);
}

void sagi_quadric_place_point(const sagi_quadric_form *form, sag_vec3 point, sag_surface *surface) {
    const sag_ray still = {.origin = point, .direction = {1, 1, 1}};
    sagi_local_ray local = sagi_quadric_localise(form, &still);
    place(form, local.origin, surface);
}
