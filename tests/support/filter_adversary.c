// SPDX-License-Identifier: MIT
// Blocks in whole numbers. A block of 2¹⁷ to 2²⁰ numbers across stands on a grid of steps of 2 to 16 of them,
// so that all of its corners can be half a step off to the same side, which is what a bound has to bear; and
// rays through points of whole numbers meet vertices, edges and faces exactly, or miss them by a fraction of
// a step.
#include "support/filter_adversary.h"
#include <string.h>

const char *const adversary_names[ADVERSARY_KINDS] = {"random", "midpoints", "diagonals", "flat",
                                                      "fans",   "slivers",   "doubled",   "sizes"};

static int64_t between(rng *r, int64_t low, int64_t high) {
    return low + (int64_t)(rng_bits(r) % (uint64_t)(high - low + 1));
}
static lattice3 point(rng *r, int64_t size) {
    lattice3 p;
    for (int k = 0; k < 3; k++) p.x[k] = between(r, 0, size);
    return p;
}

static void random_corners(rng *r, lattice3 c[3], int64_t size) {
    for (int i = 0; i < 3; i++) c[i] = point(r, size);
}

// All corners at the same fraction of a step.
static void midpoints(rng *r, lattice3 c[3], int64_t size, int64_t step, int64_t rest) {
    random_corners(r, c, size - step);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) c[i].x[k] = c[i].x[k] / step * step + rest;
}

// Edges from corner to corner of the block's cube, as long as they can be.
static void diagonals(rng *r, lattice3 c[3], int64_t size, int64_t step, int64_t rest) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int64_t near = rng_one_in(r, 2) ? 0 : between(r, 0, 8);
            c[i].x[k] = (rng_one_in(r, 2) ? near : size / step - 1 - near) * step + rest;
        }
}

// Right-angled, in a face of the cube, legs along its edges: the box is as tight as it can be.
static void flat(rng *r, lattice3 c[3], int64_t size) {
    int axis = (int)rng_below(r, 3), j = (axis + 1) % 3, k = (axis + 2) % 3;
    int64_t level = between(r, 0, size), low = between(r, 0, size / 2), high = between(r, low + 1, size);
    for (int i = 0; i < 3; i++) c[i].x[axis] = level, c[i].x[j] = c[i].x[k] = low;
    c[1].x[j] = high, c[2].x[k] = rng_one_in(r, 2) ? high : between(r, low + 1, size);
}

static void sliver(rng *r, lattice3 c[3], int64_t size) {
    c[0] = point(r, size), c[1] = point(r, size);
    int64_t n = between(r, 1, 1000), of = between(r, n, 1000), width = rng_one_in(r, 3) ? size >> 12 : 2;
    for (int k = 0; k < 3; k++)
        c[2].x[k] = c[0].x[k] + (c[1].x[k] - c[0].x[k]) * n / of + between(r, -width, width);
}

static void triangle(rng *r, int kind, exact_block *b, uint32_t i, int64_t size, int64_t step, int64_t rest) {
    lattice3 *c = b->corner_of[i];
    switch (kind) {
    case 1: midpoints(r, c, size, step, rest); break;
    case 2: diagonals(r, c, size, step, rest); break;
    case 3: flat(r, c, size); break;
    case 4: // around the first vertex; each begins where the last one ended
        random_corners(r, c, size);
        if (i > 0) c[0] = b->corner_of[0][0], c[1] = b->corner_of[i - 1][2];
        if (i > 2 && i + 1 == b->count) c[2] = b->corner_of[0][1];
        break;
    case 5: sliver(r, c, size); break;
    case 6: // the one before again, from behind or a hair off
        random_corners(r, c, size);
        if (i % 2 == 0) break;
        memcpy(c, b->corner_of[i - 1], sizeof b->corner_of[0]);
        if (rng_one_in(r, 2)) c[1] = b->corner_of[i - 1][2], c[2] = b->corner_of[i - 1][1];
        if (rng_one_in(r, 2)) c[rng_below(r, 3)].x[rng_below(r, 3)] += between(r, -2, 2);
        break;
    case 7: // one of full size, the others some whole numbers across, at its corners or anywhere
        random_corners(r, c, size);
        if (i == 0) break;
        c[0] = rng_one_in(r, 2) ? b->corner_of[0][rng_below(r, 3)] : c[0];
        for (int j = 1; j < 3; j++)
            for (int k = 0; k < 3; k++) c[j].x[k] = c[0].x[k] + between(r, -3, 3);
        break;
    default: random_corners(r, c, size);
    }
}

void adversary_block(rng *r, int kind, exact_block *b) {
    memset(b, 0, sizeof *b);
    b->lattice = true;
    b->exponent = (int)between(r, -60, 20);
    b->count = rng_one_in(r, 4) ? 9 + rng_below(r, 15) : 1 + rng_below(r, 8);
    int bits =
        (kind == 1 || kind == 2) || rng_one_in(r, 2) ? 17 + (int)rng_below(r, 4) : 2 + (int)rng_below(r, 22);
    int64_t size = (int64_t)1 << bits, step = bits > 16 ? 1 << (bits - 16) : 1;
    size += rng_one_in(r, 2) ? between(r, -size / 8, 0) : between(r, 0, size / 2);
    if (size > (int64_t)1 << bits) step *= 2;
    int64_t rest = rng_one_in(r, 2) ? step / 2 : between(r, 0, step - 1);
    lattice3 move = {{0, 0, 0}};
    bool far = rng_one_in(r, 3);
    if (far) move = point(r, (int64_t)1 << 26);
    for (uint32_t i = 0; i < b->count; i++) {
        triangle(r, kind, b, i, size, step, rest);
    }
    for (uint32_t i = 0; i < b->count; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) b->corner_of[i][j].x[k] += move.x[k];
    // Something small far away makes the world large, so that the block's grid is fine beside it.
    if (b->count > 1 && rng_one_in(r, 3)) {
        lattice3 away = point(r, (int64_t)1 << (22 + rng_below(r, 6)));
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                b->corner_of[b->count - 1][j].x[k] = (k == 0 ? -away.x[k] : away.x[k]) + between(r, 0, 9);
    }
    for (uint32_t i = 0; i < b->count; i++)
        for (int j = 0; j < 3; j++) {
            const int64_t *x = b->corner_of[i][j].x;
            b->at[i][j] = sag_vec3_make(ldexp((double)x[0], b->exponent), ldexp((double)x[1], b->exponent),
                                        ldexp((double)x[2], b->exponent));
        }
}

static double reach(const exact_block *b) {
    double most = 0;
    for (uint32_t i = 0; i < b->count; i++)
        for (int j = 0; j < 3; j++) {
            sag_vec3 d = sag_sub(b->at[i][j], b->at[0][0]);
            most = fmax(most, fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))));
        }
    return most > 0 ? most : ldexp(1, b->exponent);
}

// Some doubles up or down; from 0 not to the least double, whose products are 0 (triangle_test.c has the
// range in which decisions are exact).
static double nudged(rng *r, double x) {
    if (x == 0) return rng_one_in(r, 2) ? 0 : rng_one_in(r, 2) ? 0x1p-300 : -0x1p-300;
    for (uint32_t n = rng_below(r, 4); n > 0; n--) x = nextafter(x, rng_one_in(r, 2) ? INFINITY : -INFINITY);
    return x;
}
static sag_vec3 nudged3(rng *r, sag_vec3 a) {
    return sag_vec3_make(nudged(r, a.x), nudged(r, a.y), nudged(r, a.z));
}

void adversary_disturb(rng *r, exact_block *b) {
    double size = reach(b), stretch = rng_uniform(r, 1, 2);
    sag_vec3 move = {0, 0, 0};
    uint32_t how = rng_below(r, 4); // 0, 1: by a rounding here and there
    if (how > 1) move = rng_vec3(r, size * (rng_one_in(r, 2) ? 1 : rng_log_uniform(r, 1, 1e6)));
    b->lattice = false;
    for (uint32_t i = 0; i < b->count; i++)
        for (int j = 0; j < 3; j++) {
            sag_vec3 p = sag_add(move, how == 0 ? b->at[i][j] : sag_scale(b->at[i][j], stretch));
            b->at[i][j] = rng_one_in(r, 2) ? nudged3(r, p) : p;
        }
}

static int64_t divisor(int64_t a, int64_t b) {
    for (; b != 0;) {
        int64_t c = a % b;
        a = b, b = c;
    }
    return a < 0 ? -a : a;
}

// A point to aim at: a vertex, a point of an edge (exactly, or to the next whole number), of the face, or a
// bit beside; the second of the two is another such point.
static lattice3 target(rng *r, const exact_block *b, uint32_t triangle_number) {
    const lattice3 *c = b->corner_of[triangle_number];
    uint32_t i = rng_below(r, 3), how = rng_below(r, 8);
    lattice3 p = c[i], q = c[(i + 1) % 3], s = c[(i + 2) % 3];
    int64_t common = 0;
    for (int k = 0; k < 3; k++) common = divisor(common, q.x[k] - p.x[k]);
    if (how < 3 && common > 1) { // on the edge
        int64_t at = between(r, 0, common);
        for (int k = 0; k < 3; k++) p.x[k] += (q.x[k] - p.x[k]) / common * at;
    } else if (how < 6) { // in the face, or on the edge by rounding
        int64_t u = between(r, 0, 1 << 20), v = how == 5 ? 0 : between(r, 0, (1 << 20) - u);
        for (int k = 0; k < 3; k++)
            p.x[k] += ((q.x[k] - p.x[k]) * u + (s.x[k] - p.x[k]) * v + (1 << 19)) >> 20;
    }
    int64_t beside = rng_one_in(r, 2) ? 0 : rng_one_in(r, 2) ? 1 : 1 << rng_below(r, 6);
    for (int k = 0; k < 3; k++) p.x[k] += between(r, -beside, beside);
    return p;
}

static lattice3 direction(rng *r, const exact_block *b, uint32_t i, const lattice3 *p) {
    lattice3 d = {{0, 0, 0}}, q;
    uint32_t how = rng_below(r, 10), k = rng_below(r, 3);
    int64_t size = how < 3 ? 1 : how == 3 ? 9 : how == 4 ? 1 << 10 : 1 << 18;
    switch (how) {
    case 0: d.x[k] = rng_one_in(r, 2) ? 1 : -1; break;
    case 6: // along an edge, or nearly
        for (int j = 0; j < 3; j++)
            d.x[j] = b->corner_of[i][k].x[j] - b->corner_of[i][(k + 1) % 3].x[j] +
                     between(r, -1, 1) * rng_below(r, 2);
        break;
    case 7: // to a point of another triangle
        q = target(r, b, rng_below(r, b->count));
        for (int j = 0; j < 3; j++) d.x[j] = q.x[j] - p->x[j];
        break;
    case 8: // nearly along an axis
        d.x[k] = between(r, 1, 1 << 28), d.x[(k + 1) % 3] = between(r, -1, 1);
        break;
    case 9: // nearly along a diagonal
        for (int j = 0; j < 3; j++) d.x[j] = (rng_one_in(r, 2) ? 1 << 16 : -(1 << 16)) + between(r, -2, 2);
        break;
    default:
        for (int j = 0; j < 3; j++) d.x[j] = between(r, -size, size);
    }
    if (d.x[0] == 0 && d.x[1] == 0 && d.x[2] == 0) d.x[k] = 1;
    return d;
}

// t_min and t_max about the t of the point aimed at.
static void limit(rng *r, sag_ray *ray, double t) {
    ray->t_min = rng_one_in(r, 2) ? 0 : -INFINITY, ray->t_max = INFINITY;
    double around = rng_one_in(r, 2) ? nudged(r, t) : t * (1 + rng_double(r, -50, -18));
    switch (rng_below(r, 5)) {
    case 0: ray->t_min = around; break;
    case 1: ray->t_max = around; break;
    case 2: ray->t_min = t, ray->t_max = rng_one_in(r, 2) ? t : around; break;
    default: return;
    }
    if (!(ray->t_min <= ray->t_max)) ray->t_min = -INFINITY;
}

static double scaled(int64_t x, int exponent) { return ldexp((double)x, exponent); }

// From the middle of the scene, where the float ray's own place says nothing of how exact it has to be, to a
// point and as far beyond.
static lattice3 middle_of(const exact_block *b) {
    lattice3 middle;
    for (int k = 0; k < 3; k++) {
        int64_t lo = b->corner_of[0][0].x[k], hi = lo;
        for (uint32_t i = 0; i < b->count; i++)
            for (int j = 0; j < 3; j++) {
                int64_t x = b->corner_of[i][j].x[k];
                lo = x < lo ? x : lo, hi = x > hi ? x : hi;
            }
        middle.x[k] = lo + (hi - lo) / 2;
    }
    return middle;
}

static void lattice_line(rng *r, const exact_block *b, exact_line *l) {
    uint32_t i = rng_below(r, b->count);
    lattice3 p = target(r, b, i);
    l->direction = direction(r, b, i, &p);
    l->exponent = rng_one_in(r, 4) ? (int)between(r, -900, 880) : (int)between(r, -30, 30);
    int64_t most = INT64_MAX, steps = 0;
    for (int k = 0; k < 3; k++) {
        int64_t size = llabs(l->direction.x[k]), room = ((int64_t)1 << 29) - 1 - llabs(p.x[k]);
        if (size != 0 && room / size < most) most = room / size;
    }
    if (!rng_one_in(r, 6)) steps = between(r, 0, most >> rng_below(r, 30));
    if (rng_one_in(r, 3)) steps = -steps;
    for (int k = 0; k < 3; k++) l->origin.x[k] = p.x[k] - steps * l->direction.x[k];
    if (rng_one_in(r, 8)) {
        l->origin = middle_of(b), steps = 1;
        for (int k = 0; k < 3; k++) l->direction.x[k] = p.x[k] - l->origin.x[k];
        if (l->direction.x[0] == 0 && l->direction.x[1] == 0) l->direction.x[0] = 1;
    }
    if (rng_one_in(r, 16)) l->origin.x[rng_below(r, 3)] += l->origin.x[0] > 0 ? -1 : 1;
    l->lattice = true;
    l->ray = (sag_ray){.mask = 0};
    const int64_t *o = l->origin.x, *d = l->direction.x;
    l->ray.origin =
        sag_vec3_make(scaled(o[0], b->exponent), scaled(o[1], b->exponent), scaled(o[2], b->exponent));
    l->ray.direction =
        sag_vec3_make(scaled(d[0], l->exponent), scaled(d[1], l->exponent), scaled(d[2], l->exponent));
    limit(r, &l->ray, ldexp((double)steps, b->exponent - l->exponent));
}

// Aimed at the block from 1e-12 to 1e30 of its sizes away, along directions of any length.
static void free_line(rng *r, const exact_block *b, exact_line *l) {
    uint32_t i = rng_below(r, b->count), j = rng_below(r, 3), how = rng_below(r, 8);
    double size = reach(b), u = rng_one_in(r, 2) ? 0 : rng_unit(r),
           v = rng_one_in(r, 2) ? 0 : rng_unit(r) * (1 - u);
    const sag_vec3 *c = b->at[i];
    sag_vec3 p = c[j], q = c[(j + 1) % 3], s = c[(j + 2) % 3];
    sag_vec3 aim = sag_madd(sag_madd(p, u, sag_sub(q, p)), v, sag_sub(s, p)), d = rng_direction(r);
    if (how == 0) d = sag_sub(q, p);
    if (how == 1) d = sag_sub(b->at[rng_below(r, b->count)][rng_below(r, 3)], aim);
    if (how == 2) d = sag_vec3_make(j == 0, j == 1, j == 2);
    if (how == 3) *(j == 0 ? &d.x : j == 1 ? &d.y : &d.z) *= rng_double(r, -70, -10);
    if (how == 4) d = sag_madd(sag_sub(q, p), rng_double(r, -60, -20) * size, d); // nearly in the plane
    double length = sag_length(d);
    if (!(length > 0)) d = sag_vec3_make(0, 0, 1), length = 1;
    d = sag_scale(d, 1 / length);
    double away = rng_one_in(r, 8) ? 0 : size * rng_log_uniform(r, 1e-12, rng_one_in(r, 4) ? 1e30 : 1e3);
    l->lattice = false;
    sag_vec3 o = sag_madd(aim, -away, d);
    if (rng_one_in(r, 3)) o = nudged3(r, o);
    if (rng_one_in(r, 2) && away > 0) d = sag_scale(sag_sub(aim, o), 1 / away);
    if (!(sag_dot(d, d) > 0)) d = sag_vec3_make(1, 0, 0);
    double stretch = rng_one_in(r, 2) ? 1 : rng_log_uniform(r, 1e-200, 1e200);
    if (rng_one_in(r, 8))
        stretch = rng_one_in(r, 2) ? rng_log_uniform(r, 1e-280, 1e-250) : rng_log_uniform(r, 1e250, 1e300);
    l->ray = (sag_ray){.origin = o, .direction = sag_scale(d, stretch)};
    limit(r, &l->ray, away / stretch);
}

void adversary_line(rng *r, const exact_block *b, exact_line *l) {
    if (b->lattice && !rng_one_in(r, 8))
        lattice_line(r, b, l);
    else
        free_line(r, b, l);
}

// All of them have directions of the same signs, none with a 0, which differ by a sixteenth at most.
static bool together(const lattice3 *d, const lattice3 *first) {
    int64_t largest = 0;
    for (int k = 0; k < 3; k++) largest = llabs(first->x[k]) > largest ? llabs(first->x[k]) : largest;
    for (int k = 0; k < 3; k++) {
        if (llabs(d->x[k]) >= (int64_t)1 << 29) return false;
        if (d->x[k] == 0 || (d->x[k] < 0) != (first->x[k] < 0)) return false;
        if (llabs(d->x[k] - first->x[k]) > largest >> 6) return false;
    }
    return true;
}

void adversary_bundle(rng *r, const exact_block *b, exact_line *lines, int count) {
    uint32_t i = rng_below(r, b->count);
    lattice3 p = target(r, b, i), o;
    // From near to far, but so that directions are below 2²⁹; and lines end between whole numbers, too.
    int64_t size = (int64_t)1 << (4 + rng_below(r, 24)), finer = 0;
    for (int k = 0; k < 3; k++) {
        int64_t away = between(r, size / 8, size);
        o.x[k] = p.x[k] + (rng_one_in(r, 2) ? away : -away);
        if (llabs(o.x[k]) >= (int64_t)1 << 28) o.x[k] = p.x[k] + (p.x[k] > 0 ? -away : away);
    }
    for (; size << finer < (int64_t)1 << 27; finer++) {
    }
    finer = between(r, 0, finer);
    for (int n = 0; n < count; n++) {
        exact_line *l = &lines[n];
        *l = (exact_line){.lattice = b->lattice, .origin = o, .exponent = -20 - (int)finer};
        for (int tries = 0; tries < 20; tries++) {
            lattice3 q = target(r, b, rng_one_in(r, 3) ? rng_below(r, b->count) : i);
            for (int k = 0; k < 3; k++)
                l->direction.x[k] =
                    (q.x[k] - o.x[k]) * ((int64_t)1 << finer) + between(r, -1, 1) * (finer > 2);
            if (together(&l->direction, &lines[0].direction)) break;
            for (int k = 0; k < 3; k++) // the last one again; the first is below 2²⁸
                l->direction.x[k] =
                    n > 0 ? lines[n - 1].direction.x[k] : (p.x[k] - o.x[k]) * ((int64_t)1 << finer);
        }
        const int64_t *d = l->direction.x;
        l->ray.direction =
            sag_vec3_make(scaled(d[0], l->exponent), scaled(d[1], l->exponent), scaled(d[2], l->exponent));
        l->ray.origin = sag_vec3_make(scaled(o.x[0], b->exponent), scaled(o.x[1], b->exponent),
                                      scaled(o.x[2], b->exponent));
        if (n == 0) limit(r, &l->ray, ldexp(1, b->exponent + 20));
        if (!(lines[0].ray.t_min >= 0)) lines[0].ray.t_min = 0;
        l->ray.t_min = lines[0].ray.t_min, l->ray.t_max = lines[0].ray.t_max;
        if (!(l->ray.t_min <= l->ray.t_max)) l->ray.t_max = INFINITY;
    }
}
