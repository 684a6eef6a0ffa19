// SPDX-License-Identifier: MIT
// The first crossing of a ray and a closed quadric of the common kind: an ellipsoid, or a cylinder, cone,
// paraboloid or hyperboloid closed by caps. What quadric_solve.c and axial.c do with intervals of t, done
// with as little as the nearest crossing needs:
//
//   · The coefficients are worked out once for the shape, not for each ray.
//   · Roots are known as doubles to within a slack. Where that is enough to say that the interval between the
//     roots and the one between the planes do not meet, or not in the ray's range, it is a miss; where it is
//     enough to say that the ray comes in by a cap, the cap's t is the answer.
//   · Only a root by which the ray comes in is made certain to the last bit, never the one by which it
//   leaves.
//
// The slack of a root t of a t² + 2bt + c, the coefficients being off by their errors: the polynomial there
// is off by E = a_error t² + 2 b_error |t| + c_error, and its slope is at least 1.4 times the root of the
// discriminant all the way to the true root (which D > 64 d_error sees to, and |a| > 64 a_error). So t is off
// by less than E over that root, and by 2⁻⁵⁰ |t| for roundings. Of which nappe an interval is, which the
// general way tells by roots that may be coarse, is decided with the coarser slack of that.
//
// Whatever is closer than the slack, starts inside, or is not of the usual size, is "unknown": then the
// shape's own verb is asked. The steps are those of the general way, one by one, and so the answer is the
// same to the bit (tests/unit/test_outline.c).
#ifndef SAGI_SHAPES_OUTLINE_H
#define SAGI_SHAPES_OUTLINE_H

#include "shapes/axial.h"
#include "shapes/quadric_steps.h"

typedef struct sagi_outline {
    sagi_quadric_form form; // without cross terms, exponent 0; `exact` and `shape` are not there
    double z_min, z_max;    // ±∞: not cut
    bool below;             // of the two nappes the one below form.center.z
} sagi_outline;

// False when the shape has none.
bool sagi_shape_outline(sag_shape_kind kind, const void *shape, sagi_outline *outline);
// Whether shapes of this kind may have one.
bool sagi_shape_has_outline(sag_shape_kind kind);

bool sagi_outline_make(const sagi_quadric_form *form, double z_min, double z_max, sagi_outline *outline);
bool sagi_cylinder_outline(const sag_cylinder *cylinder, sagi_outline *outline);
bool sagi_cone_outline(const sag_cone *cone, sagi_outline *outline);
bool sagi_paraboloid_outline(const sag_paraboloid *paraboloid, sagi_outline *outline);
bool sagi_hyperboloid_outline(const sag_hyperboloid *hyperboloid, sagi_outline *outline);
bool sagi_ellipsoid_outline(const sag_ellipsoid *ellipsoid, sagi_outline *outline);

typedef enum sagi_first { SAGI_FIRST_NONE, SAGI_FIRST_HIT, SAGI_FIRST_UNKNOWN } sagi_first;

// A valid ray as a polynomial, and the intervals inside of {F ≤ 0}: from `enter` to `leave`, each a root
// (known to ±slack) or infinite. `coarse` is what quadric_solve.c has in place of the slack.
typedef struct sagi_first_search {
    const sagi_outline *outline;
    const sag_ray *ray;
    sagi_local_ray local;
    sagi_polynomial p;
    double slack, coarse;
    sagi_axial_cut cut;
} sagi_first_search;

// Whether an interval is of the wanted nappe: -1 no, 1 yes, 0 not known. As `is_below` in cone.c: of one
// between roots the middle tells.
static inline int sagi_first_nappe(const sagi_first_search *s, double enter, double leave) {
    const double up = s->ray->direction.z, o = s->ray->origin.z, apex = s->outline->form.center.z;
    if (leave == INFINITY) return up < 0 ? 1 : -1;
    if (enter == -INFINITY) return up > 0 ? 1 : -1;
    const double step = (enter * 0.5 + leave * 0.5) * up, middle = (o - apex) + step;
    const double doubt = s->coarse * fabs(up) + 8 * SAGI_EPSILON * (fabs(o) + fabs(apex) + fabs(step));
    return middle < -doubt ? 1 : middle > doubt ? -1 : 0;
}

// What comes of one interval; NONE also when it leaves the search to the next one.
static inline sagi_first sagi_first_of_interval(const sagi_first_search *s, double enter, double leave,
                                                double sign, double *t, uint32_t *primitive) {
    const sagi_axial_cut *c = &s->cut;
    const double slack = s->slack, t_min = s->ray->t_min, t_max = s->ray->t_max;
    if (c->enter > c->leave || leave + slack < c->enter || enter - slack > c->leave) return SAGI_FIRST_NONE;
    if (leave + slack < t_min || c->leave < t_min) return SAGI_FIRST_NONE; // it is all behind
    if (c->enter > enter + slack) {                                        // by a cap
        if (!(c->enter < leave - slack) || !(c->enter >= t_min)) return SAGI_FIRST_UNKNOWN;
        if (!(c->enter <= t_max) || isinf(c->enter)) return SAGI_FIRST_NONE;
        *t = c->enter, *primitive = c->enter_cap;
        return SAGI_FIRST_HIT;
    }
    if (!(c->enter < enter - slack) || !(enter + slack < c->leave)) return SAGI_FIRST_UNKNOWN;
    if (enter - slack > t_max) return SAGI_FIRST_NONE;
    double root = enter;
    if (!sagi_quadric_polish(&s->outline->form, &s->local, &s->p, sign, &root) || !(root >= t_min))
        return SAGI_FIRST_UNKNOWN;
    if (!(root <= t_max)) return SAGI_FIRST_NONE;
    *t = root, *primitive = SAGI_CURVED;
    return SAGI_FIRST_HIT;
}

// The nearest crossing in [t_min, t_max]; *t and *primitive are written when there is one.
static inline sagi_first sagi_outline_first(const sagi_outline *outline, const sag_ray *ray, double *t,
                                            uint32_t *primitive) {
    const sagi_quadric_form *form = &outline->form;
    const sag_vec3 at = ray->origin, c = form->center, way = ray->direction;
    sagi_first_search s = {.outline = outline, .ray = ray};
    s.local.origin[0] = sagi_two_sum(at.x, -c.x), s.local.origin[1] = sagi_two_sum(at.y, -c.y);
    s.local.origin[2] = sagi_two_sum(at.z, -c.z);
    s.local.direction[0] = way.x, s.local.direction[1] = way.y, s.local.direction[2] = way.z;
    s.local.t_min = ray->t_min, s.local.t_max = ray->t_max, s.local.exponent = 0;
    const double o[3] = {s.local.origin[0].hi, s.local.origin[1].hi, s.local.origin[2].hi};
    double size = fabs(way.x) > fabs(way.y) ? fabs(way.x) : fabs(way.y),
           far = fabs(o[0]) + fabs(o[1]) + fabs(o[2]);
    size = fabs(way.z) > size ? fabs(way.z) : size;
    if (!(size > 0x1p-60 && size < 0x1p60 && far < SAGI_QUADRIC_FARTHEST)) return SAGI_FIRST_UNKNOWN;
    sagi_polynomial *p = &s.p;
    sagi_quadric_square_term(form, s.local.direction, p);
    sagi_quadric_expand(form, o, s.local.direction, p);
    if (!(fabs(p->a) > p->a_error)) return SAGI_FIRST_UNKNOWN;
    const double sign = p->a > 0 ? 1 : -1;
    const bool behind = ray->t_min >= 0 && sign * p->c > p->c_error && sign * p->b > p->b_error;
    double d_error, d = sagi_quadric_discriminant(p, &d_error);
    if (behind || d < -d_error) return p->a > 0 ? SAGI_FIRST_NONE : SAGI_FIRST_UNKNOWN;
    if (!(d > SAGI_QUADRIC_GUARD * d_error)) return SAGI_FIRST_UNKNOWN;
    const double root = sqrt(d), q = -(p->b + copysign(root, p->b));
    // As quadric_solve.c has it, a shift of 0 added.
    const double ta = 0 + q / p->a, tb = 0 + p->c / q, t0 = ta < tb ? ta : tb, t1 = ta < tb ? tb : ta;
    s.coarse = (root * 0x1p-5 + p->b_error) / fabs(p->a);
    const double reach = fabs(t0) > fabs(t1) ? fabs(t0) : fabs(t1);
    const double fine = ((p->a_error * reach + 2 * p->b_error) * reach + p->c_error) / root + 0x1p-50 * reach;
    s.slack = fabs(p->a) > 64 * p->a_error && fine < s.coarse ? fine : s.coarse;
    s.cut = sagi_cut_slab(outline->z_min, outline->z_max, at.z, way.z);
    if (!isfinite(t0) || !isfinite(t1) || !isfinite(s.slack)) return SAGI_FIRST_UNKNOWN;
    const double enter[2] = {p->a > 0 ? t0 : -INFINITY, t1}, leave[2] = {p->a > 0 ? t1 : t0, INFINITY};
    for (int i = 0; i < (p->a > 0 ? 1 : 2); i++) {
        const int nappe = outline->below ? sagi_first_nappe(&s, enter[i], leave[i]) : 1;
        if (nappe == 0) return SAGI_FIRST_UNKNOWN;
        if (nappe < 0) continue;
        const sagi_first first =
            sagi_first_of_interval(&s, enter[i], leave[i], i == 0 ? -sign : sign, t, primitive);
        if (first != SAGI_FIRST_NONE) return first;
    }
    return SAGI_FIRST_NONE;
}

#endif
