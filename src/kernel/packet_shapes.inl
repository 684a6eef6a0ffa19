// SPDX-License-Identifier: MIT
// Sixteen rays of a packet (packet.inl) and references, each to a shape of any kind. Part of kernel.inl.
//
// There is no box of the packet's to tell which ray meets a shape, but four rays at a time ask closed
// quadrics (shapes/outline_four.h) for about as much as four boxes would take. All other shapes are asked ray
// by ray.

// Whether a hit of one ray at t is its nearest so far, and is to be written to p->hits: which holds its t
// from then on. (Of hits at the same t, sagi_hit_before tells: packet_found.)
static inline bool packet_comes_first(packet *p, uint32_t ray, double t) {
    const size_t group = ray / 8, lane = ray % 8;
    const double tau = t * p->unit;
    const float earliest = (float)(tau * (1 - 0x1p-22)), latest = (float)(tau * (1 + 0x1p-22) + 0x1p-70);
    if (p->nearest[group][lane] == PACKET_FOUND) {
        if (!(t <= p->t_max[ray / 4][ray % 4])) return false;
    } else if (!(latest < p->earliest[group][lane])) {
        if (!(earliest > p->limit[group][lane])) leave_undecided(p, group, 1U << lane, 0, NULL, 0);
        return false;
    }
    p->nearest[group][lane] = PACKET_FOUND;
    p->earliest[group][lane] = earliest;
    p->limit[group][lane] = sagi_float_min(p->limit[group][lane], latest);
    p->t_max[ray / 4][ray % 4] = t;
    return true;
}

// Takes note of a hit of one ray.
static void packet_found(packet *p, uint32_t ray, const sag_hit *hit) {
    const bool second = p->nearest[ray / 8][ray % 8] == PACKET_FOUND && hit->t == p->hits[ray].t;
    if (packet_comes_first(p, ray, hit->t) && !(second && sagi_hit_before(&p->hits[ray], hit)))
        p->hits[ray] = *hit;
}

// Asks shapes for these rays, one by one.
static __attribute__((noinline)) void packet_ask(packet *p, const sagi_bvh_reference *refs, uint32_t count,
                                                 uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(rays);
        sag_hit hit;
        search s;
        s.best = &hit, s.found = false, s.both_sides = false, s.path_length = 0, s.grain = s.reach = 0;
        s.later = NULL, s.known = NULL;
        level here;
        enter(&here, p->world, &p->rays[i], &s);
        here.t_max = p->t_max[i / 4][i % 4];
        list(CLOSEST, &here, refs, count);
        if (s.found) packet_found(p, i, &hit);
    }
}

static inline uint32_t rays_left(const packet *p, float begin) {
    uint32_t rays = 0;
    for (size_t i = 0; i < PACKET_GROUPS; i++)
        rays |= sagi_i8_mask(sagi_f8_at_most(sagi_f8_fill(begin), p->limit[i])) << 8 * i;
    return rays;
}

// The directions of four rays in the space of a geometry, as sagi_ray_transform has them.
SAGI_INLINE void directions_of(const packet *p, const sagi_place *place, size_t four, sagi_d4 d[3]) {
    const sagi_d4 *way = p->way[four];
    for (int k = 0; k < 3; k++) {
        if (place == NULL) {
            d[k] = way[k];
            continue;
        }
        const double *row = place->to_object.m[k];
        d[k] = sagi_d4_fill(row[0]) * way[0] + sagi_d4_fill(row[1]) * way[1] + sagi_d4_fill(row[2]) * way[2];
    }
}

static __attribute__((noinline)) void turn_directions(packet *p) {
    p->turned = true;
    for (size_t i = 0; i < PACKET_RAYS / 4; i++) {
        sagi_d4 row[2][4], unused;
        for (size_t k = 0; k < 4; k++) { // a ray begins with origin, direction, t_min, t_max
            const char *ray = (const char *)&p->rays[4 * i + k];
            row[0][k] = sagi_d4_load(ray), row[1][k] = sagi_d4_load(ray + sizeof(sagi_d4));
        }
        (void)sagi_d4_columns(row[0], &p->way[i][0]);
        const sagi_d4x3 rest = sagi_d4_columns(row[1], &unused);
        p->way[i][1] = rest.x, p->way[i][2] = rest.y;
        p->t_max[i] = unused;
    }
}

// Takes note of what four rays have found; returns those that have to ask again.
static inline uint32_t take_four(packet *p, size_t four, uint32_t geometry, const sagi_outline_four *found) {
    const search here = {.path_length = 0};
    for (uint32_t left = sagi_d4_signs((sagi_d4)found->hit); left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const uint32_t ray = (uint32_t)(4 * four) + (uint32_t)i, primitive = (uint32_t)found->primitive[i];
        const double t = found->t[i];
        if (__builtin_expect(p->nearest[ray / 8][ray % 8] == PACKET_FOUND && t == p->hits[ray].t, 0)) {
            sag_hit hit;
            write_hit(&here, geometry, primitive, t, 0, 0, &hit);
            packet_found(p, ray, &hit);
        } else if (packet_comes_first(p, ray, t)) {
            write_hit(&here, geometry, primitive, t, 0, 0, &p->hits[ray]);
        }
    }
    return sagi_d4_signs((sagi_d4)found->unknown) << 4 * four;
}

// Asks a shape with a way of four for these rays; returns those that have to be asked alone.
static __attribute__((noinline)) uint32_t packet_ask_four(packet *p, uint32_t geometry, uint32_t rays) {
    const sagi_item *item = &p->world->items[geometry];
    const bool torus = item->kind == SAG_SHAPE_TORUS;
    sag_vec3 origin = p->rays->origin;
    if (item->place != NULL) origin = sagi_affine_point(&item->place->to_object, origin);
    sagi_outline_origin quadric_from = {.usual = false};
    sagi_torus_origin torus_from = {.usual = false};
    if (torus)
        torus_from = sagi_torus_origin_make(item->shape, origin, p->rays->t_min);
    else
        quadric_from = sagi_outline_origin_make(item->outline, origin, p->rays->t_min);
    uint32_t alone = 0;
    for (size_t i = 0; i < PACKET_RAYS / 4; i++) {
        const uint32_t here = rays >> 4 * i & 15;
        if (here == 0) continue;
        sagi_outline_four four;
        directions_of(p, item->place, i, four.d);
        four.t_max = p->t_max[i];
        if (torus)
            sagi_torus_first4(&torus_from, &four, sagi_l4_from_mask(here));
        else
            sagi_outline_first4(&quadric_from, &four, sagi_l4_from_mask(here));
        alone |= take_four(p, i, geometry, &four);
    }
    return alone;
}

#include "kernel/packet_solids.inl"

static inline bool goes_together(const sagi_item *item) {
    return item->outline != NULL || item->kind == SAG_SHAPE_TORUS ||
           (item->kind == SAG_SHAPE_INSTANCE && item->child->dented != NULL);
}

// References of a leaf that a ray meets at τ = begin at the earliest. Those that no way of several rays is
// known for are asked together.
static __attribute__((noinline)) void packet_references(packet *p, const sagi_bvh_reference *refs,
                                                        uint32_t count, float begin) {
    p->work++;
    if (!p->turned) turn_directions(p);
    for (uint32_t i = 0, n; i < count; i += n) {
        n = 1;
        const uint32_t rays = rays_left(p, begin);
        if (rays == 0) return;
        const sagi_item *item = &p->world->items[refs[i].geometry];
        if (goes_together(item)) {
            if ((p->mask & item->mask) == 0) continue;
            const uint32_t alone = item->kind == SAG_SHAPE_INSTANCE
                                       ? packet_dented(p, refs[i].geometry, begin, rays)
                                       : packet_ask_four(p, refs[i].geometry, rays);
            if (alone != 0) packet_ask(p, refs + i, 1, alone);
            continue;
        }
        while (i + n < count && !goes_together(&p->world->items[refs[i + n].geometry])) n++;
        if (!put_off_all(p->later, p->world, p->mask, refs + i, n, p->rays, rays))
            packet_ask(p, refs + i, n, rays);
    }
}
