// SPDX-License-Identifier: MIT
#include "shapes/clip.h"

// A bound of the span while it is looked for: t in [low, high]. `refined` says that cut holds t already.
typedef struct end {
    uint32_t face;
    double low, high;
    bool refined;
    sagi_cut cut;
} end;

// The interval of num/den for a den of certain sign.
static void set_interval(end *e, const sagi_clip_face *f) {
    double t = f->num / f->den;
    // |num/den − n/d| ≤ (num_error + |t| den_error)/(|den| − den_error), and the roundings of t and the
    // bound.
    double error = (f->num_error + fabs(t) * f->den_error) / (fabs(f->den) - f->den_error);
    error = error * (1 + 0x1p-40) + 0x1p-51 * fabs(t);
    e->low = t - error, e->high = t + error;
}

static void refine(const sagi_clip_solid *solid, const sag_ray *ray, end *e) {
    if (e->refined) return;
    sagi_clip_dd f;
    solid->accurate(solid->solid, ray, e->face, &f);
    if (!sagi_cut_ratio(f.num, f.num_error, f.den, f.den_error, &e->cut)) {
        sagi_clip_real r;
        solid->exact(solid->solid, ray, e->face, &r);
        e->cut = sagi_cut_real(r.num, r.den);
    }
    e->refined = true;
}

// The sign of a's t − b's t: exact.
static int compare(const sagi_clip_solid *solid, const sag_ray *ray, end *a, end *b) {
    if (a->low > b->high) return 1;
    if (a->high < b->low) return -1;
    refine(solid, ray, a), refine(solid, ray, b);
    double difference = (a->cut.t.hi - b->cut.t.hi) + (a->cut.t.lo - b->cut.t.lo);
    double error = a->cut.error + b->cut.error + 0x1p-100 * (fabs(a->cut.t.hi) + fabs(b->cut.t.hi)) +
                   0x1p-52 * fabs(difference);
    if (fabs(difference) > error) return difference > 0 ? 1 : -1;
    sagi_clip_real x, y;
    solid->exact(solid->solid, ray, a->face, &x), solid->exact(solid->solid, ray, b->face, &y);
    int sign = sagi_real_compare(sagi_real_mul(x.num, y.den), sagi_real_mul(y.num, x.den));
    return sagi_real_sign(&x.den) == sagi_real_sign(&y.den) ? sign : -sign;
}

// Takes one face into account; false when it rules the whole ray out.
static bool clip_by(const sagi_clip_solid *solid, const sag_ray *ray, uint32_t face, end *enter, end *leave) {
    sagi_clip_face f;
    solid->quick(solid->solid, ray, face, &f);
    if (isnan(f.num)) return false;
    end e = {.face = face};
    int side = fabs(f.den) > f.den_error ? (f.den > 0 ? 1 : -1) : 0;
    if (side != 0 && isinf(f.num / f.den) && isfinite(f.num)) {
        // Nearly along the face: met beyond all numbers, if not on the wrong side of it.
        sagi_clip_real r;
        solid->exact(solid->solid, ray, face, &r);
        return sagi_real_sign(&r.num) >= 0;
    }
    if (side != 0) {
        set_interval(&e, &f);
    } else {
        sagi_clip_real r;
        solid->exact(solid->solid, ray, face, &r);
        side = sagi_real_sign(&r.den);
        if (side == 0) return sagi_real_sign(&r.num) >= 0;
        e.cut = sagi_cut_real(r.num, r.den), e.refined = true;
        e.low = e.cut.t.hi - 0x1p-51 * fabs(e.cut.t.hi), e.high = e.cut.t.hi + 0x1p-51 * fabs(e.cut.t.hi);
    }
    if (!(e.low <= e.high)) return false; // NaN in the solid, or numbers beyond all range
    if (side > 0 && e.high < ray->t_min) return false;
    if (side < 0 && e.low > ray->t_max) return false;
    end *bound = side > 0 ? leave : enter;
    if (bound->face == SAGI_CLIP_NO_FACE || side * compare(solid, ray, &e, bound) < 0) *bound = e;
    return true;
}

bool sagi_clip_find(const sagi_clip_solid *solid, const sag_ray *ray, sagi_clip_span *span) {
    double scale = sagi_power_scale(ray->direction);
    sag_ray scaled = *ray;
    scaled.direction = sag_scale(ray->direction, scale);
    scaled.t_min = ray->t_min / scale, scaled.t_max = ray->t_max / scale;
    end enter = {.face = SAGI_CLIP_NO_FACE}, leave = {.face = SAGI_CLIP_NO_FACE};
    for (uint32_t i = 0; i < solid->face_count; i++)
        if (!clip_by(solid, &scaled, i, &enter, &leave)) return false;
    bool both = enter.face != SAGI_CLIP_NO_FACE && leave.face != SAGI_CLIP_NO_FACE;
    if (both && compare(solid, &scaled, &enter, &leave) > 0) return false;
    if (enter.face != SAGI_CLIP_NO_FACE) refine(solid, &scaled, &enter);
    if (leave.face != SAGI_CLIP_NO_FACE) refine(solid, &scaled, &leave);
    *span = (sagi_clip_span){enter.cut, leave.cut, enter.face, leave.face};
    if (both && span->enter.t.hi > span->leave.t.hi) span->enter = span->leave; // equal but for rounding
    sagi_cut *cuts[2] = {&span->enter, &span->leave};
    for (int i = 0; i < 2; i++) cuts[i]->t.hi *= scale, cuts[i]->t.lo *= scale, cuts[i]->error *= scale;
    return true;
}

// Along the unit normal num changes by den per distance.
void sagi_clip_clear(const sagi_clip_solid *solid, uint32_t face, sag_surface *surface) {
    const sag_ray across = sag_ray_make(surface->position, surface->geometric_normal);
    sagi_clip_face f;
    solid->quick(solid->solid, &across, face, &f);
    if (f.den > f.den_error) sagi_clear_distance(1.5 * f.num_error / f.den, surface);
}

sagi_crossings sagi_clip_crossings(const sagi_clip_span *span, const sag_ray *ray) {
    sagi_crossings list = {0};
    double enter = span->enter.t.hi, leave = span->leave.t.hi;
    if (span->enter_face != SAGI_CLIP_NO_FACE && sagi_in_range(ray, enter) && isfinite(enter))
        sagi_crossings_add(&list, enter, 0, 0, span->enter_face);
    if (span->leave_face != SAGI_CLIP_NO_FACE && sagi_in_range(ray, leave) && isfinite(leave))
        sagi_crossings_add(&list, leave, 0, 0, span->leave_face);
    return list;
}
