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

#include "math/map.h"
#include "quick.h"
#include "warp.h"

#define LEAST_COSINE 0.01

// Its sine is given: |A·(B×C)|.
static double area(double sine, double ab, double bc, double ca) {
    return 2 * sagi_quick_atan2(sine, 1 + ab + bc + ca);
}

static inline double receive(sag_vec3 normal, bool front_only, sag_vec3 d) {
    double cosine = sag_dot(normal, d);
    if (!front_only) cosine = fabs(cosine);
    return cosine > LEAST_COSINE ? cosine : LEAST_COSINE;
}

// The triangle a, b, c of unit vectors; `receive_a` and so on: the cosines there. Returns what it receives.
static inline double make(sagi_spherical_triangle *t, sag_vec3 a, sag_vec3 b, sag_vec3 c, double receive_a,
                          double receive_b, double receive_c) {
    t->a = a, t->b = b, t->c = c;
    t->ab = sag_dot(a, b), t->bc = sag_dot(b, c), t->ca = sag_dot(c, a);
    t->determinant = fabs(sag_dot(a, sag_cross(b, c)));
    t->solid_angle =
        t->determinant > 0 ? area(t->determinant, t->ab, t->bc, t->ca) : 0; // also when not finite
    t->weights[0] = t->weights[1] = receive_b;
    t->weights[2] = receive_a;
    t->weights[3] = receive_c;
    return t->solid_angle * (2 * receive_b + receive_a + receive_c);
}

static inline sag_vec3 unit(sag_vec3 d) {
    const double squared = sag_dot(d, d);
    return sagi_square_is_safe(squared) ? sag_scale(d, 1 / sqrt(squared)) : sag_normalize(d);
}

void sagi_facet_see(const sagi_facet *facet, sag_vec3 from, sag_vec3 normal, bool front_only,
                    sagi_facet_view *view) {
    const sag_vec3 p = sag_sub(facet->a, from), q = sag_add(p, facet->e), r = sag_add(p, facet->f);
    const sag_vec3 b = unit(p), a = unit(q), c = unit(r);
    const bool facing = normal.x != 0 || normal.y != 0 || normal.z != 0;
    double at_a = 1, at_b = 1, at_c = 1, at_d = 1;
    if (facing) {
        at_a = receive(normal, front_only, a), at_b = receive(normal, front_only, b);
        at_c = receive(normal, front_only, c);
    }
    const double share = make(&view->parts[0], a, b, c, at_a, at_b, at_c);
    view->solid_angle = view->parts[0].solid_angle;
    view->count = 1;
    view->first = 1;
    if (!facet->parallelogram) return;
    const sag_vec3 d = unit(sag_add(q, facet->f));
    if (facing) at_d = receive(normal, front_only, d);
    const double other = make(&view->parts[1], a, d, c, at_a, at_d, at_c);
    view->solid_angle += view->parts[1].solid_angle;
    view->count = 2;
    if (view->solid_angle > 0) view->first = share / (share + other);
}

// The point of the arc from a to the unit vector b at which a·p = z.
static sag_vec3 on_arc(sag_vec3 a, sag_vec3 b, double z) {
    const sag_vec3 across = sag_madd(b, -sag_dot(a, b), a);
    const double squared = sag_dot(across, across);
    const double rest = 1 - z * z;
    if (!(squared > 0)) return a;
    return sag_madd(sag_scale(a, z), sqrt(rest > 0 ? rest / squared : 0), across);
}

static sag_vec3 sample_triangle(const sagi_spherical_triangle *t, sag_vec2 u) {
    // T, G and B·T times |C − (A·C) A|
    const sag_vec3 across = sag_madd(t->c, -t->ca, t->a);
    const double length2 = sag_dot(across, across), length = sqrt(length2);
    // s and c of an angle in [0, π), by that less π/2.
    double s, c;
    sagi_quick_sincos(u.x * t->solid_angle / 2 - 0x1.921fb54442d18p+0, &c, &s);
    c = -c;
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
    sag_vec3 far = sagi_normalize(sag_cross(sag_cross(t->b, wi), sag_cross(t->c, t->a)));
    if (sag_dot(far, sag_add(t->a, t->c)) < 0) far = sag_neg(far);
    const double b_far = sag_dot(t->b, far), sine = fabs(sag_dot(t->a, sag_cross(t->b, far)));
    const double x = sine > 0 ? area(sine, t->ab, b_far, sag_dot(far, t->a)) / t->solid_angle : 0;
    const double y = (1 - sag_dot(t->b, wi)) / (1 - b_far);
    return (sag_vec2){sagi_clamp(x, 0, 1), sagi_clamp(y, 0, 1)};
}

static inline double below_one(double x) { return x < SAGI_ONE_MINUS ? x : SAGI_ONE_MINUS; }

sag_vec3 sagi_facet_sample(const sagi_facet_view *view, sag_vec2 u, double *pdf) {
    double share = view->first;
    const sagi_spherical_triangle *t = &view->parts[0];
    if (view->count == 2) {
        if (u.x < share) {
            u.x = below_one(u.x / share);
        } else {
            u.x = below_one((u.x - share) / (1 - share));
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
