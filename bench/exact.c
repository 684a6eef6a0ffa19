// SPDX-License-Identifier: MIT
// A float is an integer times 2⁻¹⁴⁹. So all coordinates, times 2¹⁴⁹, are integers, the ray o + t d and the
// primitive grow alike, t stays what it is, and GMP's integers do everything without rounding.
//
// Triangle a b c: the edge functions e(p, q) = d · ((p − o) × (q − o)) of its three edges say on which side
// the ray's line passes. All of one sign, or zero: the line touches the closed triangle. Where one is 0,
// Sagitta's rule moves the origin by (ε, ε², ε³), which gives e the sign of the first component of
// d × (q − p) that is not 0. The plane is met at t = a' · (b' × c')/(e₀ + e₁ + e₂) with a' = a − o and so on.
//
// Sphere, centre c, radius r, with l = c − o: (d·d) t² − 2 (d·l) t + (l·l − r²) = 0.
#include "exact.h"
#include <stdlib.h>

enum { BITS = 4096, FLOAT_EXPONENT = 149 };

typedef struct vector {
    mpz_t x[3];
} vector;

// Scratch of one examination.
typedef struct scratch {
    vector o, d, p[3], cross;
    mpz_t e[3], sum, number, product;
} scratch;

static void open_scratch(scratch *s) {
    vector *vectors[] = {&s->o, &s->d, &s->p[0], &s->p[1], &s->p[2], &s->cross};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        for (int k = 0; k < 3; k++) mpz_init(vectors[i]->x[k]);
    for (int k = 0; k < 3; k++) mpz_init(s->e[k]);
    mpz_inits(s->sum, s->number, s->product, NULL);
}

static void close_scratch(scratch *s) {
    vector *vectors[] = {&s->o, &s->d, &s->p[0], &s->p[1], &s->p[2], &s->cross};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        for (int k = 0; k < 3; k++) mpz_clear(vectors[i]->x[k]);
    for (int k = 0; k < 3; k++) mpz_clear(s->e[k]);
    mpz_clears(s->sum, s->number, s->product, NULL);
}

void exact_init(exact_hit *h) {
    h->touched = h->hit = false;
    mpf_init2(h->t, BITS);
}

void exact_clear(exact_hit *h) { mpf_clear(h->t); }

void exact_copy(exact_hit *to, const exact_hit *from) {
    to->touched = from->touched;
    to->hit = from->hit;
    mpf_set(to->t, from->t);
}

static void set(mpz_t z, double x) { mpz_set_d(z, ldexp(x, FLOAT_EXPONENT)); }

static void set_vector(vector *v, double x, double y, double z) {
    set(v->x[0], x);
    set(v->x[1], y);
    set(v->x[2], z);
}

static void subtract(vector *v, const vector *w) {
    for (int k = 0; k < 3; k++) mpz_sub(v->x[k], v->x[k], w->x[k]);
}

static void cross(vector *r, const vector *a, const vector *b) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(r->x[i], a->x[j], b->x[k]);
        mpz_submul(r->x[i], a->x[k], b->x[j]);
    }
}

static void dot(mpz_t r, const vector *a, const vector *b) {
    mpz_mul(r, a->x[0], b->x[0]);
    mpz_addmul(r, a->x[1], b->x[1]);
    mpz_addmul(r, a->x[2], b->x[2]);
}

static bool in_range(const mpf_t t, const sag_ray *ray) {
    return mpf_cmp_d(t, ray->t_min) >= 0 && (isinf(ray->t_max) || mpf_cmp_d(t, ray->t_max) <= 0);
}

// The sign of e(p, q), or when that is 0 the one that moving the origin gives it.
static int sign_of_edge(scratch *s, const mpz_t e, const vector *p, const vector *q) {
    if (mpz_sgn(e) != 0) return mpz_sgn(e);
    vector way;
    for (int k = 0; k < 3; k++) {
        mpz_init(way.x[k]);
        mpz_sub(way.x[k], q->x[k], p->x[k]);
    }
    cross(&s->cross, &s->d, &way);
    int sign = 0;
    for (int k = 0; k < 3; k++) {
        if (sign == 0) sign = mpz_sgn(s->cross.x[k]);
        mpz_clear(way.x[k]);
    }
    return sign;
}

static void examine_triangle(exact_hit *h, scratch *s, const model *m, const sag_ray *ray,
                             uint32_t primitive) {
    for (int i = 0; i < 3; i++) {
        const float *p = m->positions + 3 * (size_t)m->triangles[3 * (size_t)primitive + (size_t)i];
        set_vector(&s->p[i], p[0], p[1], p[2]);
        subtract(&s->p[i], &s->o);
    }
    bool negative = false, positive = false;
    int sign[3];
    mpz_set_ui(s->sum, 0);
    for (int i = 0; i < 3; i++) {
        const vector *p = &s->p[(i + 1) % 3], *q = &s->p[(i + 2) % 3];
        cross(&s->cross, p, q);
        dot(s->e[i], &s->d, &s->cross);
        mpz_add(s->sum, s->sum, s->e[i]);
        negative |= mpz_sgn(s->e[i]) < 0;
        positive |= mpz_sgn(s->e[i]) > 0;
        sign[i] = sign_of_edge(s, s->e[i], p, q);
    }
    if (negative == positive) return; // outside, or the ray lies in the plane
    cross(&s->cross, &s->p[1], &s->p[2]);
    dot(s->number, &s->p[0], &s->cross);
    mpf_t denominator;
    mpf_init2(denominator, BITS);
    mpf_set_z(h->t, s->number);
    mpf_set_z(denominator, s->sum);
    mpf_div(h->t, h->t, denominator);
    mpf_clear(denominator);
    h->touched = in_range(h->t, ray);
    h->hit = h->touched && sign[0] == sign[1] && sign[1] == sign[2];
}

static void examine_sphere(exact_hit *h, scratch *s, const model *m, const sag_ray *ray, uint32_t primitive) {
    const float *ball = m->spheres + 4 * (size_t)primitive;
    set_vector(&s->p[0], ball[0], ball[1], ball[2]);
    subtract(&s->p[0], &s->o);
    dot(s->e[0], &s->d, &s->d);       // A
    dot(s->e[1], &s->d, &s->p[0]);    // B
    dot(s->e[2], &s->p[0], &s->p[0]); // C + r²
    set(s->product, (double)ball[3]);
    mpz_submul(s->e[2], s->product, s->product);
    mpz_mul(s->number, s->e[1], s->e[1]);
    mpz_submul(s->number, s->e[0], s->e[2]);
    if (mpz_sgn(s->number) < 0) return;
    mpf_t root, half, square;
    mpf_inits(root, half, square, NULL);
    mpf_set_prec(root, BITS);
    mpf_set_prec(half, BITS);
    mpf_set_prec(square, BITS);
    mpf_set_z(root, s->number);
    mpf_sqrt(root, root);
    mpf_set_z(half, s->e[1]);
    mpf_set_z(square, s->e[0]);
    mpf_sub(h->t, half, root);
    mpf_div(h->t, h->t, square);
    h->touched = in_range(h->t, ray);
    if (!h->touched) {
        mpf_add(h->t, half, root);
        mpf_div(h->t, h->t, square);
        h->touched = in_range(h->t, ray);
    }
    h->hit = h->touched && mpz_sgn(s->number) > 0; // a line that only grazes may count either way
    mpf_clears(root, half, square, NULL);
}

void exact_examine(exact_hit *h, const model *m, const sag_ray *ray, uint32_t primitive) {
    scratch s;
    open_scratch(&s);
    h->touched = h->hit = false;
    set_vector(&s.o, ray->origin.x, ray->origin.y, ray->origin.z);
    set_vector(&s.d, ray->direction.x, ray->direction.y, ray->direction.z);
    if (m->sphere_count > 0)
        examine_sphere(h, &s, m, ray, primitive);
    else
        examine_triangle(h, &s, m, ray, primitive);
    close_scratch(&s);
}

// Roundings in double are below 2⁻⁵⁰ of |d|₁ |p − o|₁ |q − o|₁, the sum of the products' magnitudes; 2⁻⁴⁵ is
// plenty.
static double norm1(sag_vec3 v) { return fabs(v.x) + fabs(v.y) + fabs(v.z); }

bool exact_worth_a_look(const model *m, const sag_ray *ray, uint32_t primitive) {
    sag_vec3 d = ray->direction;
    if (m->sphere_count > 0) {
        const float *s = m->spheres + 4 * (size_t)primitive;
        sag_vec3 l = sag_sub(sag_vec3_make(s[0], s[1], s[2]), ray->origin), c = sag_cross(d, l);
        double r = (double)s[3], size = norm1(d) * norm1(l);
        return !(sag_dot(c, c) > sag_dot(d, d) * r * r + 0x1p-40 * size * size); // |d × l| = |d| distance
    }
    sag_vec3 p[3];
    for (int i = 0; i < 3; i++) {
        const float *v = m->positions + 3 * (size_t)m->triangles[3 * (size_t)primitive + (size_t)i];
        p[i] = sag_sub(sag_vec3_make(v[0], v[1], v[2]), ray->origin);
    }
    bool negative = false, positive = false;
    for (int i = 0; i < 3; i++) {
        sag_vec3 a = p[i], b = p[(i + 1) % 3];
        double e = sag_dot(d, sag_cross(a, b)), bound = 0x1p-45 * norm1(d) * norm1(a) * norm1(b);
        negative |= e < -bound;
        positive |= e > bound;
    }
    return !(negative && positive);
}
