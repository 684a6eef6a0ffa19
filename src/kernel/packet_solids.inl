// SPDX-License-Identifier: MIT
// Sixteen rays of a packet (packet.inl) and a dented solid (solid/dented.h). Part of kernel.inl.
//
// In floats, eight rays at a time, we find bounds of where each ray enters what the convex parts have in
// common, and where it leaves that. Where no dent is at the one, that is the boundary, and its t is the
// part's own (exactly as in solid_parts.inl). Where it certainly is in a dent, it goes on to where it leaves
// the dent. The rest (edges, rims, grazing rays, rays that begin within) is asked singly.
//
// Units. The solid's are those of dented.h: X = k(M p + m − C), M and m the instance's map. The packet's ray
// is at X(σ) = B + σV, σ counting from the τ = `begin` at which the packet comes to the solid's box, in units
// that bring |V| about 1. With D = c + δ (packet.inl) and A = k/k' M 2⁻ʲ, k' the world's scale, B and V are
//     B = X(P) + σ₀ A c + σ₀ A δ,   V = A c + A δ,   σ = 2ʲ τ:
// what has to do with P and c in double, what has to do with δ in floats. We require
//     |B|∞ ≤ 8,   ⅛ ≤ |V|² ≤ 3,   |σ₀ A δ|∞ ≤ 8,   |A δ|∞ ≤ 1,   h ≤ 2⁻¹⁸,
// h bounding the doubles' roundings, and that of the ray which is asked in the end, by 2⁻⁴⁸ of all the terms.
//
// Errors of length, with v = 2⁻²⁴. B: h, 16v, and 6v · 8 for σ₀Aδ: E₀ < 2⁻¹⁷. V: 8v a coordinate. The solid
// is within |X|∞ ≤ 1 and so met at |σ| ≤ 9√3/|V| < 48, where V's error comes to 48 · 8√3 v < 2⁻¹⁴. Centres
// and radii: 8v. A ball: l = c − B, σ₁ = l·V/V·V, w = l − σ₁V, rounded by less than 160v together in |w|. So
// |w| is off by less than G = 2⁻¹³ in all, and σ₁ by G/|V| and its own roundings, less than T = 2⁻¹¹.
// Crossings are at σ₁ ± √((r² − w²)/V·V), with r² − w² off by 2rG + 2G², and 2⁻¹⁷ for roundings where r is up
// to 8: G(2r + 3G + ⅛). A plane: (a − B)/Vᵢ, off by G/|Vᵢ| and 16v of itself over again by 1/|Vᵢ|, |Vᵢ| ≥
// 2⁻⁸.
//
// What the ray meets closer together than 2⁻⁴⁸ of its coordinates counts as one place (solid.inl). That is
// below h, so what these bounds keep apart is apart.

typedef struct packet_line { // eight rays
    f8x3 b, v;
    sagi_f8 inverse; // 1/V·V
    sagi_i8 odd;     // not within the bounds above
} packet_line;

typedef struct packet_span { // bounds of where they enter and leave a part
    sagi_f8 in[2], out[2];
    sagi_i8 doubt; // whether they meet it
} packet_span;

#define DENTED_G 0x1p-13F
#define DENTED_T 0x1p-11F

SAGI_INLINE f8x3 fill_part(const float a[3]) {
    return (f8x3){sagi_f8_fill(a[0]), sagi_f8_fill(a[1]), sagi_f8_fill(a[2])};
}

SAGI_INLINE packet_span span_of_box(const packet_line *line, const sagi_dented_part *part) {
    const sagi_f8 *b = &line->b.x, *v = &line->v.x;
    packet_span span = {{sagi_f8_fill(-INFINITY), sagi_f8_fill(-INFINITY)},
                        {sagi_f8_fill(INFINITY), sagi_f8_fill(INFINITY)},
                        {0}};
    for (int k = 0; k < 3; k++) {
        const sagi_f8 inverse = 1 / v[k], size = sagi_f8_abs(inverse);
        const sagi_f8 x = (sagi_f8_fill(part->lo[k]) - b[k]) * inverse,
                      y = (sagi_f8_fill(part->hi[k]) - b[k]) * inverse;
        const sagi_f8 near = sagi_f8_min(x, y), far = sagi_f8_max(x, y);
        const sagi_f8 e = sagi_f8_fma(sagi_f8_abs(near), sagi_f8_fill(0x1p-20F), sagi_f8_fill(DENTED_G)) *
                          size,
                      f = sagi_f8_fma(sagi_f8_abs(far), sagi_f8_fill(0x1p-20F), sagi_f8_fill(DENTED_G)) *
                          size;
        span.in[0] = sagi_f8_max(span.in[0], near - e), span.in[1] = sagi_f8_max(span.in[1], near + e);
        span.out[0] = sagi_f8_min(span.out[0], far - f), span.out[1] = sagi_f8_min(span.out[1], far + f);
        span.doubt |= sagi_f8_above(size, 0x1p8F);
    }
    return span;
}

SAGI_INLINE packet_span span_of_ball(const packet_line *line, const sagi_dented_part *part) {
    const f8x3 v = line->v, b = line->b;
    const float r = part->hi[0];
    const f8x3 lo = fill_part(part->lo), l = sub8(&lo, &b);
    const sagi_f8 time = dot8(&l, &v) * line->inverse, none = sagi_f8_fill(0);
    const f8x3 w = {sagi_f8_fma(time, -v.x, l.x), sagi_f8_fma(time, -v.y, l.y), sagi_f8_fma(time, -v.z, l.z)};
    const sagi_f8 s = sagi_f8_fill(r * r) - dot8(&w, &w);
    const sagi_f8 doubt = sagi_f8_fill(DENTED_G * (2 * r + 3 * DENTED_G + 0.125F));
    const sagi_f8 most = sagi_f8_sqrt(sagi_f8_max(s + doubt, none) * line->inverse) + DENTED_T;
    const sagi_f8 least = sagi_f8_sqrt(sagi_f8_max(s - doubt, none) * line->inverse) - DENTED_T;
    const sagi_i8 missed = sagi_f8_less(s, -doubt);
    packet_span span = {{time - most, time - least}, {time + least, time + most}, sagi_f8_less(s, doubt)};
    span.in[0] = sagi_f8_select(missed, sagi_f8_fill(INFINITY), span.in[0]); // later than any way out
    return span;
}

SAGI_INLINE packet_span span_of_part(const packet_line *line, const sagi_dented_part *part) {
    return part->is_ball ? span_of_ball(line, part) : span_of_box(line, part);
}

// Whether points are in a part, each somewhere within `room`: |x|₂.
SAGI_INLINE void place_in_part(const f8x3 *x, sagi_f8 room, const sagi_dented_part *part, sagi_i8 *in,
                               sagi_i8 *out) {
    if (part->is_ball) {
        const f8x3 lo = fill_part(part->lo), l = sub8(&lo, x);
        const sagi_f8 q = dot8(&l, &l), radius = sagi_f8_fill(part->hi[0]), outer = radius + room,
                      inner = radius - room;
        *out = sagi_f8_less(outer * outer, q);
        *in = sagi_f8_less(q, inner * inner) & sagi_f8_above(inner, 0);
        return;
    }
    sagi_f8 depth = sagi_f8_fill(INFINITY);
    const sagi_f8 *at = &x->x;
    for (int k = 0; k < 3; k++)
        depth = sagi_f8_min(
            depth, sagi_f8_min(at[k] - sagi_f8_fill(part->lo[k]), sagi_f8_fill(part->hi[k]) - at[k]));
    *out = sagi_f8_less(depth, -room), *in = sagi_f8_less(room, depth);
}

// Where eight rays come upon the solid: between in[0] and in[1], the part in `owner`. `certain`: those that
// do, `asked`: those of which it is not certain. `first`: what is at an earlier σ is before t_min; `last`:
// what is later does not matter.
typedef struct packet_dent {
    sagi_f8 in[2];
    sagi_i8 owner, certain, asked;
} packet_dent;

SAGI_INLINE packet_dent meet_dented(const sagi_dented *solid, const packet_line *line, float first,
                                    sagi_f8 last) {
    packet_dent d;
    const sagi_f8 infinite = sagi_f8_fill(INFINITY);
    sagi_f8 out[2] = {infinite, infinite};
    sagi_i8 doubt = line->odd;
    d.in[0] = d.in[1] = -infinite;
    d.owner = sagi_i8_fill(-1);
    for (uint32_t i = 0; i < solid->convex_count; i++) {
        const packet_span s = span_of_part(line, &solid->parts[i]);
        const sagi_i8 after = sagi_f8_less(d.in[1], s.in[0]), before = sagi_f8_less(s.in[1], d.in[0]);
        d.owner = (after & sagi_i8_fill((int32_t)i)) | (~after & (d.owner | ~before));
        d.in[0] = sagi_f8_max(d.in[0], s.in[0]), d.in[1] = sagi_f8_max(d.in[1], s.in[1]);
        out[0] = sagi_f8_min(out[0], s.out[0]), out[1] = sagi_f8_min(out[1], s.out[1]);
        doubt |= s.doubt;
    }
    sagi_i8 missed =
        sagi_f8_less(out[1], d.in[0]) | sagi_f8_below(out[1], first - DENTED_T) | sagi_f8_less(last, d.in[0]);
    missed &= ~line->odd;
    doubt |= sagi_i8_above(sagi_i8_fill(0), d.owner) | ~sagi_f8_above(d.in[0], first + DENTED_T);
    sagi_i8 moved = ~(missed | doubt); // since when they were last asked for dents
    for (int pass = 0; pass < 4 && sagi_i8_mask(moved) != 0; pass++) {
        const sagi_f8 middle = (d.in[0] + d.in[1]) * 0.5F;
        const f8x3 x = {sagi_f8_fma(middle, line->v.x, line->b.x), sagi_f8_fma(middle, line->v.y, line->b.y),
                        sagi_f8_fma(middle, line->v.z, line->b.z)};
        const sagi_f8 room = (d.in[1] - d.in[0]) + 2 * DENTED_G; // half of it, times |V|
        sagi_i8 again = {0};
        for (uint32_t i = solid->convex_count; i < solid->count; i++) {
            sagi_i8 inside, outside;
            place_in_part(&x, room, &solid->parts[i], &inside, &outside);
            const sagi_i8 near =
                moved & ~outside & ~again & ~sagi_i8_equal(d.owner, sagi_i8_fill((int32_t)i));
            if (sagi_i8_mask(near) == 0) continue;
            const packet_span s = span_of_part(line, &solid->parts[i]);
            const sagi_i8 on = near & inside & ~s.doubt & sagi_f8_less(d.in[1], s.out[0]);
            doubt |= near & ~on, again |= on;
            d.owner = (on & sagi_i8_fill((int32_t)i)) | (~on & d.owner);
            d.in[0] = sagi_f8_select(on, s.out[0], d.in[0]), d.in[1] = sagi_f8_select(on, s.out[1], d.in[1]);
        }
        moved = again & ~doubt;
    }
    doubt |= moved;
    const sagi_i8 beyond = sagi_f8_less(out[1], d.in[0]) | sagi_f8_less(last, d.in[0]);
    d.asked = ~missed & (doubt | (~beyond & ~sagi_f8_less(d.in[1], out[0])));
    d.certain = ~missed & ~d.asked & ~beyond;
    return d;
}

// One ray's hit, once it is known which part it is; false: it has to be asked after all. As in solid.inl, for
// the same bits: open_roughly, then report.
static __attribute__((noinline)) bool dented_hit(const packet *p, uint32_t ray, uint32_t geometry,
                                                 uint32_t part, bool dent, sag_hit *hit) {
    const sagi_item *item = &p->world->items[geometry];
    level below;
    solid_walk w;
    below.world = item->child;
    w.here = &below, w.solid = item->child->solid, w.parts = sagi_solid_parts(w.solid);
    w.line = item->place != NULL ? sagi_ray_transform(&item->place->to_object, &p->rays[ray]) : p->rays[ray];
    if (!sagi_ray_is_valid(&w.line)) return false;
    w.line.t_min = -INFINITY, w.line.t_max = INFINITY;
    place_line(&w);
    quick_crossings q;
    if (!quick_shape(&w, item_of_part(&w, part), true, &q) || q.count != 2) return false;
    solid_event e = {q.t[dent], q.error, part, q.primitive[dent], dent, !dent, false, false};
    if (e.error > 0) refine(&w, &e);
    search s;
    s.path_length = 1, s.path[0] = geometry;
    write_hit(&s, w.parts[part].geometry, e.primitive, e.t, 0, 0, hit);
    hit->flipped = dent;
    return true;
}

// What of four rays is the same, or side by side.
typedef struct dented_four {
    sag_vec3 o; // in the solid's space
    sagi_d4 d[3], t;
    sagi_l4 primitive, good;
} dented_four;

// The first crossing of a box, or where the ray leaves a dent that is one: quick_box for four rays.
SAGI_INLINE void box_for_four(dented_four *four, const sag_box *box, bool dent) {
    const double lo[3] = {box->min.x, box->min.y, box->min.z}, hi[3] = {box->max.x, box->max.y, box->max.z},
                 o[3] = {four->o.x, four->o.y, four->o.z};
    sagi_d4 t0, t1;
    sagi_l4 enter = {0}, leave = {0}, sign[3];
    four->good = (sagi_l4){-1, -1, -1, -1};
    for (int k = 0; k < 3; k++) {
        const sagi_d4 d = four->d[k], a = sagi_d4_fill(lo[k] - o[k]) / d, b = sagi_d4_fill(hi[k] - o[k]) / d;
        const sagi_l4 down = sagi_d4_below(d, 0);
        const sagi_d4 near = sagi_d4_select(down, b, a), far = sagi_d4_select(down, a, b);
        sign[k] = down & 1;
        four->good &= down | sagi_d4_above(d, 0);
        if (k == 0) {
            t0 = near, t1 = far;
            continue;
        }
        const sagi_l4 after = sagi_d4_less(t0, near), sooner = sagi_d4_less(far, t1),
                      number = sagi_l4_fill(k);
        t0 = sagi_d4_select(after, near, t0), enter = (after & number) | (~after & enter);
        t1 = sagi_d4_select(sooner, far, t1), leave = (sooner & number) | (~sooner & leave);
    }
    const sagi_d4 error =
        sagi_d4_fill(4 * SAGI_EPSILON) * (sagi_d4_abs(t0) + sagi_d4_abs(t1)) + sagi_d4_fill(0x1p-1022);
    four->good &= sagi_d4_less(error, t1 - t0) & sagi_d4_below(t1 - t0, INFINITY);
    const sagi_l4 face = dent ? leave : enter;
    const sagi_l4 down = (sagi_l4_equal(face, sagi_l4_fill(0)) & sign[0]) |
                         (sagi_l4_equal(face, sagi_l4_fill(1)) & sign[1]) |
                         (sagi_l4_equal(face, sagi_l4_fill(2)) & sign[2]);
    four->primitive = 2 * face + (dent ? 1 - down : down), four->t = dent ? t1 : t0;
}

// The first crossing of a ball, as refine has it.
static inline void ball_for_four(dented_four *four, const sag_sphere *ball, uint32_t lanes) {
    sag_ray rays[4];
    sagi_sphere_four by;
    const sagi_d4 at = sagi_sphere_load(ball);
    for (int i = 0; i < 4; i++) {
        rays[i] = (sag_ray){four->o, {four->d[0][i], four->d[1][i], four->d[2][i]}, -INFINITY, INFINITY, 0};
        by.ray[i] = &rays[i], by.at[i] = at;
    }
    four->good = sagi_l4_from_mask(sagi_sphere_solve4(&by, lanes));
    four->t = by.t, four->primitive = (sagi_l4){0};
}

// The hits of four rays, `lanes` of which have this part for certain; returns those that have to be asked
// after all.
static __attribute__((noinline)) uint32_t dented_hits(packet *p, uint32_t geometry, sag_vec3 origin, size_t i,
                                                      uint32_t lanes, uint32_t part, bool dent) {
    const sagi_item *item = &p->world->items[geometry];
    const sagi_world *solid = item->child;
    const uint32_t id = sagi_solid_parts(solid->solid)[part].geometry;
    uint32_t asked = 0;
    sag_hit hit;
    dented_four four = {.o = origin};
    directions_of(p, item->place, i, four.d);
    if (solid->items[id].kind == SAG_SHAPE_BOX)
        box_for_four(&four, solid->items[id].shape, dent);
    else if (!dent)
        ball_for_four(&four, solid->items[id].shape, lanes);
    else
        four.good = (sagi_l4){0};
    const search s = {.path_length = 1, .path = {geometry}};
    for (uint32_t left = lanes; left != 0; left &= left - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(left), ray = 4 * (uint32_t)i + lane;
        if (four.good[lane] != 0) {
            write_hit(&s, id, (uint32_t)four.primitive[lane], four.t[lane], 0, 0, &hit);
            hit.flipped = dent;
        } else if (!dented_hit(p, ray, geometry, part, dent, &hit)) {
            asked |= 1U << ray;
            continue;
        }
        if (hit.t <= p->t_max[i][lane]) packet_found(p, ray, &hit);
    }
    return asked;
}

// The rays' lines in the solid's space, or false.
SAGI_INLINE bool packet_lines(const packet *p, const sagi_dented *solid, const sagi_place *place, float begin,
                              packet_line line[PACKET_GROUPS], float *unit) {
    const double ratio = solid->scale / p->world->scale, k = solid->scale;
    const sag_affine here = sag_affine_identity(), *map = place != NULL ? &place->to_object : &here;
    const double o[3] = {p->rays->origin.x, p->rays->origin.y, p->rays->origin.z};
    const double from[3] = {solid->origin.x, solid->origin.y, solid->origin.z};
    double b[3], v[3], row[3], most_b = 0, most_v = 0, most_row = 0;
    for (int i = 0; i < 3; i++) {
        const double *m = map->m[i];
        b[i] = k * ((m[0] * o[0] + m[1] * o[1] + m[2] * o[2]) + (m[3] - from[i]));
        v[i] = ratio * (m[0] * p->c[0] + m[1] * p->c[1] + m[2] * p->c[2]);
        row[i] = ratio * (fabs(m[0]) + fabs(m[1]) + fabs(m[2]));
        most_b = greater(most_b, k * (fabs(m[0] * o[0]) + fabs(m[1] * o[1]) + fabs(m[2] * o[2]) + fabs(m[3]) +
                                      fabs(from[i])));
        most_v = greater(most_v, fabs(v[i])), most_row = greater(most_row, row[i]);
    }
    if (!(most_v > 0x1p-100 && most_v < 0x1p100)) return false;
    union {
        double value;
        uint64_t bits;
    } u = {.value = most_v};
    const int exponent = (int)(u.bits >> 52) - 1022; // of σ
    const double down = power_of_two(-exponent), start = (double)begin * power_of_two(exponent);
    if (!(0x1p-48 * (most_b + (start + 64) * most_row * down) <= 0x1p-18)) return false;
    const double turn = most_row * down * (double)p->spread;
    if (!(turn <= 1 && start * turn <= 8)) return false;
    float a[3][3], bc[3], vc[3];
    for (int i = 0; i < 3; i++) {
        bc[i] = (float)(b[i] + start * (v[i] * down)), vc[i] = (float)(v[i] * down);
        for (int c = 0; c < 3; c++) a[i][c] = (float)(ratio * down * map->m[i][c]);
        if (!(fabsf(bc[i]) <= 16)) return false;
    }
    *unit = (float)power_of_two(exponent);
    const float s = (float)start;
    for (uint32_t g = 0; g < PACKET_GROUPS; g++) {
        sagi_f8 *to_b = &line[g].b.x, *to_v = &line[g].v.x, far = sagi_f8_fill(0);
        for (int i = 0; i < 3; i++) {
            const sagi_f8 turned =
                sagi_f8_fma(sagi_f8_fill(a[i][2]), p->z[g],
                            sagi_f8_fma(sagi_f8_fill(a[i][1]), p->y[g], sagi_f8_fill(a[i][0]) * p->x[g]));
            to_b[i] = sagi_f8_fma(sagi_f8_fill(s), turned, sagi_f8_fill(bc[i])),
            to_v[i] = sagi_f8_fill(vc[i]) + turned;
            far = sagi_f8_max(far, sagi_f8_abs(to_b[i]));
        }
        const sagi_f8 square = dot8(&line[g].v, &line[g].v);
        line[g].inverse = 1 / square;
        line[g].odd = ~(sagi_f8_at_most(far, sagi_f8_fill(8)) & sagi_f8_above(square, 0x1p-3F) &
                        sagi_f8_below(square, 3));
    }
    return true;
}

// Returns those of the rays that have to be asked one by one.
static __attribute__((noinline)) uint32_t packet_dented(packet *p, uint32_t geometry, float begin,
                                                        uint32_t rays) {
    const sagi_item *item = &p->world->items[geometry];
    const sagi_dented *solid = item->child->dented;
    packet_line line[PACKET_GROUPS];
    float unit;
    if (!packet_lines(p, solid, item->place, begin, line, &unit)) return rays;
    sag_vec3 origin = p->rays->origin;
    if (item->place != NULL) origin = sagi_affine_point(&item->place->to_object, origin);
    uint32_t asked = 0;
    const float first = (float)((p->t_min - (double)begin) * (double)unit);
    for (uint32_t g = 0; g < PACKET_GROUPS; g++) {
        const uint32_t wanted = rays >> 8 * g & 0xFF;
        if (wanted == 0) continue;
        const sagi_f8 last =
            (p->limit[g] - sagi_f8_fill(begin)) * sagi_f8_fill(unit) * (1 + 0x1p-20F) + DENTED_T;
        const packet_dent d = meet_dented(solid, &line[g], first, last);
        asked |= (sagi_i8_mask(d.asked) & wanted) << 8 * g;
        const uint32_t certain = sagi_i8_mask(d.certain) & wanted;
        for (uint32_t half = 0; half < 2; half++)
            for (uint32_t left = certain & 15U << 4 * half, now; left != 0; left &= ~now) { // part by part
                const int32_t which = d.owner[__builtin_ctz(left)];
                now = left & sagi_i8_mask(sagi_i8_equal(d.owner, sagi_i8_fill(which)));
                asked |= dented_hits(p, geometry, origin, 2 * g + half, now >> 4 * half,
                                     solid->parts[which].part, (uint32_t)which >= solid->convex_count);
            }
    }
    return asked;
}
