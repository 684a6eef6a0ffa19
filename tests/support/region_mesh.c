// SPDX-License-Identifier: MIT
// Whether a closed mesh surrounds a point: the parity of the triangles that the way from it to a point far
// outside pierces. A triangle a b c is pierced by p q when p and q are on different sides of its plane and
// the volumes of p q a b, p q b c and p q c a have one sign. Where a sign is 0 the way meets an edge, and
// another point q is taken.
#include "support/region.h"
#include <float.h>

#define U     0x1p-53
#define WAYS  4
#define SLACK (1 + 0x1p-20)

static sag_vec3 vertex(const sag_mesh *m, uint32_t i) {
    if (m->positions_f64)
        return (sag_vec3){m->positions_f64[3 * (size_t)i], m->positions_f64[3 * (size_t)i + 1],
                          m->positions_f64[3 * (size_t)i + 2]};
    return (sag_vec3){m->positions_f32[3 * (size_t)i], m->positions_f32[3 * (size_t)i + 1],
                      m->positions_f32[3 * (size_t)i + 2]};
}

static sag_vec3 far_point(const shape_region *region, int way) {
    static const sag_vec3 directions[WAYS] = {
        {3.1, 1.7, 0.97}, {-0.618, 2.9, 1.37}, {1.213, -0.713, -3.3}, {-2.77, -1.931, 0.541}};
    return sag_madd(region->mesh_center, region->mesh_size, directions[way]);
}

static approx minus(approx a, approx b) {
    double v = a.v - b.v;
    return (approx){v, a.e + b.e + U * fabs(v)};
}
static approx mul(approx a, approx b) {
    double v = a.v * b.v;
    return (approx){v, fabs(a.v) * b.e + fabs(b.v) * a.e + a.e * b.e + U * fabs(v) + DBL_MIN};
}

// The sign of (u × v)·w.
static int volume_sign(const approx u[3], const approx v[3], const approx w[3]) {
    approx sum = {0, 0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        approx term = mul(minus(mul(u[j], v[k]), mul(u[k], v[j])), w[i]);
        term.v = -term.v;
        sum = minus(sum, term);
    }
    double bound = sum.e * SLACK;
    return sum.v > bound ? 1 : sum.v < -bound ? -1 : 0;
}

static void from_spot(approx out[3], sag_vec3 a, const spot *at) {
    for (int i = 0; i < 3; i++) out[i] = minus((approx){sag_component(a, i), 0}, at->x[i]);
}

// 1 pierced, 0 not, −1 not known.
static int pierced(const sag_vec3 corner[3], const spot *p, const approx way[3], sag_vec3 q) {
    approx w[3][3], edge[2][3], to_p[3], to_q[3];
    int side[3];
    for (int i = 0; i < 3; i++) from_spot(w[i], corner[i], p);
    for (int i = 0; i < 3; i++) side[i] = volume_sign(w[i], w[(i + 1) % 3], way);
    int least = 1, most = -1;
    for (int i = 0; i < 3; i++) {
        if (side[i] < least) least = side[i];
        if (side[i] > most) most = side[i];
    }
    if (least < 0 && most > 0) return 0;
    for (int i = 0; i < 3; i++) {
        approx a = {sag_component(corner[0], i), 0};
        to_p[i] = minus((approx){0, 0}, w[0][i]);
        to_q[i] = minus((approx){sag_component(q, i), 0}, a);
        for (int k = 0; k < 2; k++) edge[k][i] = minus((approx){sag_component(corner[k + 1], i), 0}, a);
    }
    int sp = volume_sign(edge[0], edge[1], to_p), sq = volume_sign(edge[0], edge[1], to_q);
    if (sp && sp == sq) return 0;
    return sp && sq && (least > 0 || most < 0) ? 1 : -1;
}

membership region_mesh_filter(const shape_region *region, const spot *at) {
    const sag_mesh *m = region->mesh;
    for (int i = 0; i < 3; i++) {
        double off = fabs(at->x[i].v - sag_component(region->mesh_center, i));
        if (off > (region->mesh_size + at->x[i].e) * SLACK) return MEMBER_OUT;
    }
    sag_vec3 q = far_point(region, 0);
    approx way[3];
    from_spot(way, q, at);
    bool odd = false;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *t = m->triangles + 3 * (size_t)i;
        const sag_vec3 corner[3] = {vertex(m, t[0]), vertex(m, t[1]), vertex(m, t[2])};
        int yes = pierced(corner, at, way, q);
        if (yes < 0) return MEMBER_UNKNOWN;
        odd ^= yes == 1;
    }
    return odd ? MEMBER_IN : MEMBER_OUT;
}

typedef struct exact_work {
    mpq_t p[3], q[3], corner[3][3], u[3], v[3], w[3], x, y, sum;
} exact_work;

static void for_all_numbers(exact_work *k, void (*act)(mpq_t)) {
    for (int i = 0; i < 3; i++) {
        act(k->p[i]), act(k->q[i]), act(k->u[i]), act(k->v[i]), act(k->w[i]);
        for (int j = 0; j < 3; j++) act(k->corner[j][i]);
    }
    act(k->x), act(k->y), act(k->sum);
}
static void number_init(mpq_t x) { mpq_init(x); }
static void number_clear(mpq_t x) { mpq_clear(x); }

// The sign of the volume of a b c d.
static int orientation(exact_work *k, mpq_t a[3], mpq_t b[3], mpq_t c[3], mpq_t d[3]) {
    for (int i = 0; i < 3; i++)
        mpq_sub(k->u[i], b[i], a[i]), mpq_sub(k->v[i], c[i], a[i]), mpq_sub(k->w[i], d[i], a[i]);
    mpq_set_ui(k->sum, 0, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        mpq_mul(k->x, k->u[j], k->v[l]), mpq_mul(k->y, k->u[l], k->v[j]), mpq_sub(k->x, k->x, k->y);
        mpq_mul(k->x, k->x, k->w[i]), mpq_add(k->sum, k->sum, k->x);
    }
    return mpq_sgn(k->sum);
}

static void set_point(mpq_t out[3], sag_vec3 v) {
    for (int i = 0; i < 3; i++) mpq_set_d(out[i], sag_component(v, i));
}

static int pierced_exactly(exact_work *k) {
    int sp = orientation(k, k->corner[0], k->corner[1], k->corner[2], k->p);
    int sq = orientation(k, k->corner[0], k->corner[1], k->corner[2], k->q);
    if (sp == sq && sp) return 0;
    int side[3], sum = 0;
    bool zero = sp == 0 || sq == 0;
    for (int i = 0; i < 3; i++) {
        side[i] = orientation(k, k->p, k->q, k->corner[i], k->corner[(i + 1) % 3]);
        sum += side[i], zero |= side[i] == 0;
    }
    for (int i = 0; i < 3; i++)
        if (side[i] * side[(i + 1) % 3] < 0) return 0;
    return zero ? -1 : sum == 3 || sum == -3;
}

membership region_mesh_exact(const shape_region *region, const spot *at) {
    const sag_mesh *m = region->mesh;
    exact_work k;
    for_all_numbers(&k, number_init);
    for (int i = 0; i < 3; i++) {
        mpq_set_d(k.p[i], at->t), mpq_set_d(k.x, sag_component(at->direction, i));
        mpq_mul(k.p[i], k.p[i], k.x);
        mpq_set_d(k.x, sag_component(at->origin, i)), mpq_add(k.p[i], k.p[i], k.x);
    }
    membership result = MEMBER_UNKNOWN;
    for (int way = 0; way < WAYS && result == MEMBER_UNKNOWN; way++) {
        set_point(k.q, far_point(region, way));
        bool odd = false, known = true;
        for (uint32_t i = 0; i < m->triangle_count && known; i++) {
            for (int j = 0; j < 3; j++) set_point(k.corner[j], vertex(m, m->triangles[3 * (size_t)i + j]));
            int yes = pierced_exactly(&k);
            known = yes >= 0, odd ^= yes == 1;
        }
        if (known) result = odd ? MEMBER_IN : MEMBER_OUT;
    }
    for_all_numbers(&k, number_clear);
    return result;
}
