// SPDX-License-Identifier: MIT
// Sixteen rays of a packet (packet.inl) and references, each to a shape of any kind. Part of kernel.inl.

// Takes note of a hit of one ray.
static void packet_found(packet *p, uint32_t ray, const sag_hit *hit) {
    const size_t group = ray / 8, lane = ray % 8;
    const double tau = hit->t * p->unit;
    const float earliest = (float)(tau * (1 - 0x1p-22)), latest = (float)(tau * (1 + 0x1p-22) + 0x1p-70);
    if (p->nearest[group][lane] == PACKET_FOUND) {
        if (!sagi_hit_before(hit, &p->hits[ray])) return;
    } else if (!(latest < p->earliest[group][lane])) {
        if (earliest > p->limit[group][lane]) return;
        leave_undecided(p, group, 1U << lane, 0, NULL, 0);
        return;
    }
    p->hits[ray] = *hit;
    p->nearest[group][lane] = PACKET_FOUND;
    p->earliest[group][lane] = earliest;
    p->limit[group][lane] = sagi_float_min(p->limit[group][lane], latest);
    p->t_max[ray / 4][ray % 4] = hit->t;
}

// Asks shapes for these rays, one by one.
static __attribute__((noinline)) void packet_ask(packet *p, const sagi_bvh_reference *refs, uint32_t count,
                                                 uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(rays);
        sag_hit hit;
        search s;
        s.best = &hit, s.found = false, s.both_sides = false, s.path_length = 0, s.grain = s.reach = 0;
        s.later = NULL;
        level here;
        enter(&here, p->world, &p->rays[i], &s);
        here.t_max = p->t_max[i / 4][i % 4];
        list(CLOSEST, &here, refs, count);
        if (s.found) packet_found(p, i, &hit);
    }
}

static __attribute__((noinline)) void packet_references(packet *p, const sagi_bvh_reference *refs,
                                                        uint32_t count, float begin) {
    uint32_t rays = 0;
    for (size_t i = 0; i < PACKET_GROUPS; i++)
        rays |= sagi_i8_mask(sagi_f8_at_most(sagi_f8_fill(begin), p->limit[i])) << 8 * i;
    p->work++;
    if (!put_off_all(p->later, p->world, p->mask, refs, count, p->rays, rays))
        packet_ask(p, refs, count, rays);
}
