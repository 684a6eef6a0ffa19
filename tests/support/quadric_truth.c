// SPDX-License-Identifier: MIT
#include "support/quadric_truth.h"

#define RN MPFR_RNDN
#define PI 3.14159265358979323846

static mpfr_ptr *scratch(quadric_truth *w, size_t *count) {
    static mpfr_ptr all[32];
    size_t n = 0;
    for (int i = 0; i < 10; i++) all[n++] = w->q[i];
    for (int i = 0; i < 3; i++) all[n++] = w->o[i];
    for (int i = 0; i < 3; i++) all[n++] = w->d[i];
    all[n++] = w->a, all[n++] = w->b, all[n++] = w->c, all[n++] = w->root[0], all[n++] = w->root[1];
    all[n++] = w->t, all[n++] = w->x, all[n++] = w->y, all[n++] = w->z;
    *count = n;
    return all;
}

void quadric_truth_init(quadric_truth *w) {
    size_t n;
    mpfr_ptr *all = scratch(w, &n);
    for (size_t i = 0; i < n; i++) mpfr_init2(all[i], TRUTH_BITS);
    quadric_truth_reset(w);
}

void quadric_truth_clear(quadric_truth *w) {
    size_t n;
    mpfr_ptr *all = scratch(w, &n);
    for (size_t i = 0; i < n; i++) mpfr_clear(all[i]);
}

void quadric_truth_reset(quadric_truth *w) {
    for (int i = 0; i < 10; i++) mpfr_set_zero(w->q[i], 1);
    w->center = w->slab_center = (sag_vec3){0, 0, 0};
    for (int i = 0; i < 3; i++) w->lo[i] = -INFINITY, w->hi[i] = INFINITY;
    w->phi_max = 0;
    w->closed = false;
}

// out += k · q · u · v
static void add_term(quadric_truth *w, mpfr_t out, int k, mpfr_t q, mpfr_t u, mpfr_t v) {
    if (mpfr_zero_p(q)) return;
    mpfr_mul(w->t, q, u, RN);
    if (v) mpfr_mul(w->t, w->t, v, RN);
    mpfr_mul_si(w->t, w->t, k, RN);
    mpfr_add(out, out, w->t, RN);
}

// out = uᵀ Q v
static void form(quadric_truth *w, mpfr_t out, mpfr_t u[3], mpfr_t v[3]) {
    static const int cross[3] = {5, 4, 3}; // yz, xz, xy
    mpfr_set_zero(out, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        add_term(w, out, 1, w->q[i], u[i], v[i]);
        add_term(w, out, 1, w->q[cross[i]], u[j], v[k]);
        add_term(w, out, 1, w->q[cross[i]], u[k], v[j]);
    }
}

// The polynomial a t² + 2 b t + c of the ray.
static void expand(quadric_truth *w, const sag_ray *ray) {
    const double o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double center[3] = {w->center.x, w->center.y, w->center.z};
    for (int i = 0; i < 3; i++) {
        mpfr_set_d(w->o[i], o[i], RN);
        mpfr_sub_d(w->o[i], w->o[i], center[i], RN);
        mpfr_set_d(w->d[i], d[i], RN);
    }
    form(w, w->a, w->d, w->d);
    form(w, w->b, w->o, w->d);
    form(w, w->c, w->o, w->o);
    for (int i = 0; i < 3; i++) {
        add_term(w, w->b, 1, w->q[6 + i], w->d[i], NULL);
        add_term(w, w->c, 2, w->q[6 + i], w->o[i], NULL);
    }
    mpfr_add(w->c, w->c, w->q[9], RN);
}

// The number of real roots, a double one counted twice; root[] in order.
static int solve(quadric_truth *w) {
    if (mpfr_zero_p(w->a)) {
        if (mpfr_zero_p(w->b)) return 0;
        mpfr_div(w->root[0], w->c, w->b, RN);
        mpfr_div_si(w->root[0], w->root[0], -2, RN);
        return 1;
    }
    mpfr_sqr(w->x, w->b, RN);
    mpfr_mul(w->y, w->a, w->c, RN);
    mpfr_sub(w->x, w->x, w->y, RN);
    if (mpfr_sgn(w->x) < 0) return 0;
    mpfr_sqrt(w->x, w->x, RN);
    // q = −(b + sign(b) √D)
    if (mpfr_sgn(w->b) < 0)
        mpfr_sub(w->y, w->x, w->b, RN);
    else
        mpfr_add(w->y, w->b, w->x, RN), mpfr_neg(w->y, w->y, RN);
    mpfr_div(w->root[0], w->y, w->a, RN);
    if (mpfr_zero_p(w->y))
        mpfr_set(w->root[1], w->root[0], RN);
    else
        mpfr_div(w->root[1], w->c, w->y, RN);
    if (mpfr_greater_p(w->root[0], w->root[1])) mpfr_swap(w->root[0], w->root[1]);
    return 2;
}

static double ulp_of(double x) {
    x = fabs(x);
    return nextafter(x, INFINITY) - x;
}

double ulps_between(double t, double exact) {
    if (t == exact) return 0;
    return fabs(t - exact) / ulp_of(exact);
}

// −1 below, 1 above, 0 too near to tell: within 6 ulp.
static int compare(double t, double edge) {
    if (isinf(edge)) return edge > 0 ? -1 : 1;
    double margin = 6 * fmax(ulp_of(t), ulp_of(edge));
    return t < edge - margin ? -1 : t > edge + margin ? 1 : 0;
}

// Where the ray passes the plane yᵢ = at; false when it runs along it, and then *inside tells the side's
// answer.
static bool plane_t(quadric_truth *w, int axis, double at, double *t) {
    if (mpfr_zero_p(w->d[axis])) return false;
    mpfr_set_d(w->x, at, RN);
    mpfr_add_d(w->x, w->x, sag_component(w->slab_center, axis), RN);
    mpfr_sub_d(w->x, w->x, sag_component(w->center, axis), RN);
    mpfr_sub(w->x, w->x, w->o[axis], RN);
    mpfr_div(w->x, w->x, w->d[axis], RN);
    *t = mpfr_get_d(w->x, RN);
    return true;
}

// 1 kept, −1 dropped, 0 cannot tell, by the slabs other than the plane `skip` (axis, or −1).
static int slabs(quadric_truth *w, double t, int skip) {
    int verdict = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (axis == skip || (isinf(w->lo[axis]) && isinf(w->hi[axis]))) continue;
        double t0, t1;
        if (!plane_t(w, axis, w->lo[axis], &t0) || !plane_t(w, axis, w->hi[axis], &t1)) {
            mpfr_add_d(w->x, w->o[axis], sag_component(w->center, axis), RN);
            mpfr_sub_d(w->x, w->x, sag_component(w->slab_center, axis), RN);
            if (mpfr_cmp_d(w->x, w->lo[axis]) < 0 || mpfr_cmp_d(w->x, w->hi[axis]) > 0) return -1;
            continue;
        }
        if (t0 > t1) {
            double swap = t0;
            t0 = t1, t1 = swap;
        }
        int above = compare(t, t0), below = compare(t, t1);
        if (above < 0 || below > 0) return -1;
        if (above == 0 || below == 0) verdict = 0;
    }
    return verdict;
}

// The same for the sweep, at root number i or at the value in w->x.
static int sweep(quadric_truth *w, mpfr_t t) {
    if (w->phi_max == 0) return 1;
    mpfr_mul(w->y, t, w->d[0], RN), mpfr_add(w->y, w->y, w->o[0], RN);
    mpfr_mul(w->z, t, w->d[1], RN), mpfr_add(w->z, w->z, w->o[1], RN);
    double x = mpfr_get_d(w->y, RN), y = mpfr_get_d(w->z, RN), phi = atan2(y, x);
    // How far the rounding of t moves the point.
    double blur = 6 * ulp_of(mpfr_get_d(t, RN)) * hypot(mpfr_get_d(w->d[0], RN), mpfr_get_d(w->d[1], RN));
    double margin = blur / hypot(x, y) + 1e-14;
    if (!(margin < 0.1)) return 0;
    if (phi < 0) phi += 2 * PI;
    if (phi < margin || phi > 2 * PI - margin || fabs(phi - w->phi_max) < margin) return 0;
    return phi < w->phi_max ? 1 : -1;
}

static void add(expected *e, double t, int verdict) {
    if (verdict < 0) return;
    int i = e->count++;
    for (; i > 0 && e->t[i - 1] > t; i--) e->t[i] = e->t[i - 1], e->optional[i] = e->optional[i - 1];
    e->t[i] = t, e->optional[i] = verdict == 0;
}

static int both(int a, int b) { return a < 0 || b < 0 ? -1 : a < b ? a : b; }

static int in_range(const sag_ray *ray, double t) {
    if (!isfinite(t)) return -1;
    int above = compare(t, ray->t_min), below = compare(t, ray->t_max);
    if (t == ray->t_min && t == 0) above = 1; // an exact 0 is exactly in range
    return above < 0 || below > 0 ? -1 : above == 0 || below == 0 ? 0 : 1;
}

static void add_cap(quadric_truth *w, const sag_ray *ray, double z, const double roots[2], int root_count,
                    expected *e) {
    double t;
    if (!plane_t(w, 2, z, &t)) return;
    // F there: c + t (2b + a t)
    mpfr_mul(w->y, w->a, w->x, RN), mpfr_add(w->y, w->y, w->b, RN), mpfr_add(w->y, w->y, w->b, RN);
    mpfr_mul(w->y, w->y, w->x, RN), mpfr_add(w->y, w->y, w->c, RN);
    int verdict = mpfr_sgn(w->y) <= 0 ? 1 : -1;
    for (int i = 0; i < root_count; i++)
        if (compare(t, roots[i]) == 0) verdict = 0;
    add(e, t, both(verdict, in_range(ray, t)));
}

expected quadric_truth_solve(quadric_truth *w, const sag_ray *ray) {
    expected e = {0};
    if (!sag_ray_is_valid(ray)) return e;
    expand(w, ray);
    int count = solve(w);
    double roots[2] = {0, 0};
    for (int i = 0; i < count; i++) {
        double t = roots[i] = mpfr_get_d(w->root[i], RN);
        int verdict = both(in_range(ray, t), slabs(w, t, -1));
        if (verdict >= 0) verdict = both(verdict, sweep(w, w->root[i]));
        add(&e, t, verdict);
    }
    if (!w->closed) return e;
    add_cap(w, ray, w->lo[2], roots, count, &e);
    add_cap(w, ray, w->hi[2], roots, count, &e);
    return e;
}

int quadric_truth_sign(quadric_truth *w, sag_vec3 point, double *relative) {
    sag_ray ray = sag_ray_make(point, sag_vec3_make(1, 1, 1));
    expand(w, &ray);
    double y[3], sum = fabs(mpfr_get_d(w->q[9], RN));
    for (int i = 0; i < 3; i++) y[i] = fabs(mpfr_get_d(w->o[i], RN));
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += fabs(mpfr_get_d(w->q[i], RN)) * y[i] * y[i] + 2 * fabs(mpfr_get_d(w->q[6 + i], RN)) * y[i] +
               2 * fabs(mpfr_get_d(w->q[5 - i], RN)) * y[j] * y[k];
    }
    if (relative) *relative = fabs(mpfr_get_d(w->c, RN)) / sum;
    return mpfr_sgn(w->c);
}

sag_vec3 quadric_truth_normal(quadric_truth *w, sag_vec3 point) {
    double n[3];
    for (int i = 0; i < 3; i++) { // b of a ray along the axis
        sag_ray ray = sag_ray_make(point, sag_vec3_make(i == 0, i == 1, i == 2));
        expand(w, &ray);
        n[i] = mpfr_get_d(w->b, RN);
    }
    return sag_normalize(sag_vec3_make(n[0], n[1], n[2]));
}
