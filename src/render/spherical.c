// SPDX-License-Identifier: MIT
// Triangles on the sphere of directions. A flat light is best sampled over the directions it fills: then the
// inverse square and the cosine at the light are no part of the estimate's variance any more.
//
// The solid angle of the triangle of unit vectors A, B, C (van Oosterom & Strackee 1983):
//     tan(Ω/2) = |A·(B×C)| / (1 + A·B + B·C + C·A).
// A sample takes the share u of it as a triangle A, B, C' with C' on the arc from A to C, and a point of the
// arc from B to C' by its height (Arvo, "Stratified Sampling of Spherical Triangles", 1995). Where C' is
// follows from the same formula without any angle: with T the unit vector perpendicular to A towards C,
// C' = A cos φ + T sin φ, and x = tan(φ/2), the sines and cosines become rational:
//     tan(Ω'/2) = x G/((1 + A·B) + x B·T),  G = A·(B×T)
//     x = s (1 + A·B) / (c G − s B·T),      s = sin(Ω'/2), c = cos(Ω'/2).
//
// The receiver's cosine is nearly brought in too: the unit square that is mapped to the triangle gets the
// density that is linear between the cosines at its corners (Hart et al., "Practical Product Sampling by
// Fitting and Composing Warps", 2020; as pbrt-v4 does), each at least LEAST_COSINE. Corner (0, 1) is A, (1,
// 1) is C, and (0, 0) and (1, 0) are B.
#include "spherical.h"

#include "math/elementary.h"
#include "math/map.h"
#include "warp.h"

#define LEAST_COSINE 0.01

static double area(sag_vec3 a, sag_vec3 b, sag_vec3 c) {
    const double volume = fabs(sag_dot(a, sag_cross(b, c)));
    return 2 * sagi_atan2(volume, 1 + sag_dot(a, b) + sag_dot(b, c) + sag_dot(c, a));
}

static double receive(sag_vec3 normal, bool front_only, sag_vec3 d) {
    const double cosine = sag_dot(normal, d);
    return fmax(front_only ? cosine : fabs(cosine), LEAST_COSINE);
}

static void make(sagi_spherical_triangle *t, sag_vec3 a, sag_vec3 b, sag_vec3 c) {
    t->a = a, t->b = b, t->c = c;
    t->ab = sag_dot(a, b), t->bc = sag_dot(b, c), t->ca = sag_dot(c, a);
    t->determinant = fabs(sag_dot(a, sag_cross(b, c)));
    t->solid_angle = 2 * sagi_atan2(t->determinant, 1 + t->ab + t->bc + t->ca);
    if (!(t->determinant > 0)) t->solid_angle = 0; // also when it is not finite
}

void sagi_facet_see(const sagi_facet *facet, sag_vec3 from, sag_vec3 normal, bool front_only,
                    sagi_facet_view *view) {
    const sag_vec3 p = sag_sub(facet->a, from);
    sag_vec3 corner[4] = {p, sag_add(p, facet->e), sag_add(p, facet->f)};
    view->count = facet->parallelogram ? 2 : 1;
    if (facet->parallelogram) corner[3] = sag_add(corner[1], facet->f);
    for (int i = 0; i < view->count + 2; i++) corner[i] = sagi_normalize(corner[i]);
    make(&view->parts[0], corner[1], corner[0], corner[2]);
    if (view->count == 2) make(&view->parts[1], corner[1], corner[3], corner[2]);
    const bool facing = normal.x != 0 || normal.y != 0 || normal.z != 0;
    double share[2] = {0, 0};
    view->solid_angle = 0;
    for (int i = 0; i < view->count; i++) {
        sagi_spherical_triangle *t = &view->parts[i];
        double *w = t->weights;
        w[0] = w[1] = facing ? receive(normal, front_only, t->b) : 1;
        w[2] = facing ? receive(normal, front_only, t->a) : 1;
        w[3] = facing ? receive(normal, front_only, t->c) : 1;
        share[i] = t->solid_angle * (w[0] + w[1] + w[2] + w[3]);
        view->solid_angle += t->solid_angle;
    }
    view->first = view->solid_angle > 0 ? share[0] / (share[0] + share[1]) : 1;
}

// The point of the arc from a to the unit vector b at which a·p = z.
static sag_vec3 on_arc(sag_vec3 a, sag_vec3 b, double z) {
    const sag_vec3 across = sag_madd(b, -sag_dot(a, b), a);
    const double squared = sag_dot(across, across);
    if (!(squared > 0)) return a;
    return sag_madd(sag_scale(a, z), sqrt(fmax(0, 1 - z * z) / squared), across);
}

static sag_vec3 sample_triangle(const sagi_spherical_triangle *t, sag_vec2 u) {
    // T, G and B·T times |C − (A·C) A|
    const sag_vec3 across = sag_madd(t->c, -t->ca, t->a);
    const double length2 = sag_dot(across, across), length = sqrt(length2);
    double s, c;
    sagi_sincos(u.x * t->solid_angle / 2, &s, &c);
    const double up = s * (1 + t->ab) * length, down = c * t->determinant - s * (t->bc - t->ca * t->ab);
    const double norm = up * up + down * down;
    sag_vec3 far = t->a;
    if (norm > 0 && length2 > 0) {
        const double cosine = (down * down - up * up) / norm, sine = 2 * up * down / norm;
        far = sag_madd(sag_scale(t->a, cosine), sine / length, across);
    }
    return on_arc(t->b, far, 1 - u.y * (1 - sag_dot(t->b, far)));
}

// The numbers that sample_triangle makes this direction of.
static sag_vec2 invert_triangle(const sagi_spherical_triangle *t, sag_vec3 wi) {
    sag_vec3 far = sag_normalize(sag_cross(sag_cross(t->b, wi), sag_cross(t->c, t->a)));
    if (sag_dot(far, sag_add(t->a, t->c)) < 0) far = sag_neg(far);
    const double x = area(t->a, t->b, far) / t->solid_angle;
    const double y = (1 - sag_dot(t->b, wi)) / (1 - sag_dot(t->b, far));
    return (sag_vec2){sagi_clamp(x, 0, 1), sagi_clamp(y, 0, 1)};
}

sag_vec3 sagi_facet_sample(const sagi_facet_view *view, sag_vec2 u, double *pdf) {
    double share = view->first;
    const sagi_spherical_triangle *t = &view->parts[0];
    if (view->count == 2) {
        if (u.x < share) {
            u.x = fmin(u.x / share, SAGI_ONE_MINUS);
        } else {
            u.x = fmin((u.x - share) / (1 - share), SAGI_ONE_MINUS);
            share = 1 - share;
            t = &view->parts[1];
        }
    }
    u = sagi_warp_bilinear(t->weights, u);
    *pdf = share * sagi_warp_bilinear_pdf(t->weights, u) / t->solid_angle;
    return sample_triangle(t, u);
}

double sagi_facet_pdf(const sagi_facet_view *view, sag_vec3 wi) {
    double share = view->first;
    const sagi_spherical_triangle *t = &view->parts[0];
    if (view->count == 2) { // which side of the diagonal from a to c?
        const sag_vec3 across = sag_cross(t->a, t->c);
        if (sag_dot(across, wi) * sag_dot(across, t->b) < 0) {
            share = 1 - share;
            t = &view->parts[1];
        }
    }
    return share * sagi_warp_bilinear_pdf(t->weights, invert_triangle(t, wi)) / t->solid_angle;
}

void sagi_facet_meet(const sagi_facet *facet, sag_vec3 from, sag_vec3 wi, double *u, double *v, double *t) {
    const sag_vec3 normal = sag_cross(facet->e, facet->f), p = sag_sub(facet->a, from);
    *t = sag_dot(normal, p) / sag_dot(normal, wi);
    const sag_vec3 q = sag_sub(sag_scale(wi, *t), p);
    const double scale = 1 / sag_dot(normal, normal);
    *u = sagi_clamp(sag_dot(normal, sag_cross(q, facet->f)) * scale, 0, 1);
    *v = sagi_clamp(sag_dot(normal, sag_cross(facet->e, q)) * scale, 0, 1);
    const double sum = *u + *v;
    if (!facet->parallelogram && sum > 1) *u /= sum, *v /= sum;
}
