// SPDX-License-Identifier: MIT
// Many rays and a mesh with parts cut out of it (solid/carved.h). Part of kernel.inl.
//
// A ray that comes to such a solid in a batch does not ask it at once: it puts the question off and goes on
// with the rest of the scene (put_off). When all rays of the crowd are through, those that have asked the
// same solid are brought to its space and traced through the mesh as a batch of their own, packets included.
// Then one look at the cutters, all of them as balls, says for most rays that they were right to do so:
//
//   · The ray begins outside of the mesh's box, so it is out of the mesh and of the solid.
//   · It does not meet the mesh: then it stays out of it, whatever the cutters do.
//   · It first meets the mesh at t, at a place where no cutter is. So t is the solid's first boundary, and
//   the
//     hit is the mesh's: before it the ray is out of the mesh, whatever the cutters do.
//
// The others go the way of single rays (solid.inl), and so do those for which t is not one crossing and
// alone: as there, the mesh's batch takes note of other crossings within twice the tolerance (search.near),
// and a packet answers only where hits are that far apart for certain (packet_make). The answers are the same
// bits, in any order: of two hits sagi_hit_before tells.
//
// Out of a cutter. With p = o + t d we ask for |c − p|² > r² + 2⁻³⁶ S², S² = |o|² + |t d|² + |c − p|² + r².
// All of it is calculated in double to some 2⁻⁴⁸ S², what is in doubt for the coincidence of crossings is
// 2⁻⁴⁷ S of length, and boxes and balls are off by less than that: 2⁻³⁶ pays for everything together.

#define TOGETHER 256

typedef struct carved_batch {
    uint32_t count;
    sag_ray rays[TOGETHER]; // in the solid's space; t_max a little later
    double t_max[TOGETHER]; // as it was
    uint32_t number[TOGETHER], geometry[TOGETHER];
    sag_hit hits[TOGETHER];
    bool doubtful[TOGETHER];
} carved_batch;

static double reach_of(const sag_ray *ray) {
    const sagi_d4 o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin));
    const sagi_d4 d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction));
    return largest_of_three(sagi_d4_abs(o)) / largest_of_three(sagi_d4_abs(d));
}

// Whether the ray begins outside of the world's box for certain.
static inline bool begins_outside(const sagi_world *world, const sag_ray *ray) {
    const sagi_d4 o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin));
    const sagi_d4 d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction));
    const sagi_d4 p = o + sagi_d4_fill(ray->t_min) * d, c = world->center, one = sagi_d4_fill(1);
    const sagi_d4 scale = sagi_d4_fill(world->scale), q = (p - c) * scale;
    const sagi_d4 room =
        (one + (sagi_d4_abs(p) + sagi_d4_abs(c) + sagi_d4_abs(o)) * scale) * sagi_d4_fill(0x1p-30);
    const sagi_l4 out = sagi_d4_less(q + room, world->lower) | sagi_d4_less(world->upper, q - room);
    return (sagi_d4_signs((sagi_d4)out) & 7) != 0;
}

// Whether the ray is out of all cutters at t for certain.
static inline bool is_out_of_cutters(const sagi_carved *carved, const sag_ray *ray, double t) {
    const sag_vec3 o = ray->origin, d = ray->direction, p = sag_madd(o, t, d);
    const double size = sag_dot(o, o) + t * t * sag_dot(d, d);
    if (!(size < 0x1p200)) return false;
    const sagi_d4 grain = sagi_d4_fill(0x1p-36), most = sagi_d4_fill(size), x = sagi_d4_fill(p.x),
                  y = sagi_d4_fill(p.y), z = sagi_d4_fill(p.z);
    for (uint32_t i = 0; i < carved->four_count; i++) {
        const sagi_carved_four *four = &carved->fours[i];
        const sagi_d4 lx = four->x - x, ly = four->y - y, lz = four->z - z;
        const sagi_d4 away = lx * lx + ly * ly + lz * lz;
        const sagi_l4 out = sagi_d4_less(four->squared + grain * (most + away + four->squared), away);
        if (sagi_d4_signs((sagi_d4)out) != 15) return false;
    }
    return true;
}

// A hit of the solid's world, as one of the scene it stands in.
static void hand_up(const sag_hit *found, uint32_t geometry, sag_hit *hit) {
    sag_hit up = *found;
    if (geometry != SAG_INVALID_ID) {
        for (uint32_t i = up.instance_depth++; i > 0; i--) up.instance_path[i] = up.instance_path[i - 1];
        up.instance_path[0] = geometry;
    }
    if (hit->geometry == SAG_INVALID_ID || sagi_hit_before(&up, hit)) *hit = up;
}

// known, or NULL: the ray's first crossing of the mesh, alone, before which it is out of it.
static __attribute__((noinline)) void ask_solid_alone(const sagi_world *solid, sag_ray *ray, double t_max,
                                                      uint32_t geometry, const sag_hit *known, sag_hit *hit) {
    sag_hit found;
    search s;
    level here;
    ray->t_max = lesser(t_max, hit->t);
    s.best = &found, s.found = false, s.both_sides = false, s.path_length = 0, s.grain = s.reach = 0;
    s.later = NULL, s.known = known;
    enter(&here, solid, ray, &s);
    search_solid(CLOSEST, &here);
    if (s.found) hand_up(&found, geometry, hit);
}

// Adds a ray to the batch, or where it cannot be, asks at once. `item`: the solid's instance, if it is one.
static void add_to_carved(carved_batch *b, const sagi_world *solid, const sagi_item *item, uint32_t geometry,
                          const sag_ray *from, uint32_t number, sag_hit *hit) {
    sag_ray *ray = &b->rays[b->count];
    *ray = item != NULL && item->place != NULL ? sagi_ray_transform(&item->place->to_object, from) : *from;
    if (!sagi_ray_is_valid(ray)) return;
    const double t_max = ray->t_max;
    const sag_ray *same = item != NULL && item->place != NULL ? ray : from; // no need to wait for the copy
    if (!begins_outside(solid->items[solid->carved->geometry].child, same)) {
        ask_solid_alone(solid, ray, t_max, geometry, NULL, hit);
        return;
    }
    if (t_max < INFINITY) ray->t_max += 0x1p-46 * (fabs(t_max) + reach_of(ray));
    b->t_max[b->count] = t_max;
    b->number[b->count] = number, b->geometry[b->count] = geometry;
    b->count++;
}

static void intersect_all_of(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count,
                             bool *doubtful);

static void trace_carved(carved_batch *b, const sagi_world *solid, sag_hit *hits) {
    const sagi_carved *carved = solid->carved;
    intersect_all_of(solid->items[carved->geometry].child, b->rays, b->hits, b->count, b->doubtful);
    for (uint32_t i = 0; i < b->count; i++) {
        sag_hit *found = &b->hits[i], *hit = &hits[b->number[i]];
        if (found->geometry == SAG_INVALID_ID || (!b->doubtful[i] && found->t > b->t_max[i])) continue;
        found->geometry = carved->geometry;
        if (b->doubtful[i] || !is_out_of_cutters(carved, &b->rays[i], found->t))
            ask_solid_alone(solid, &b->rays[i], b->t_max[i], b->geometry[i], b->doubtful[i] ? NULL : found,
                            hit);
        else
            hand_up(found, b->geometry[i], hit);
    }
    b->count = 0;
}

// All that the rays have put off: solid by solid, in the order of the rays.
static __attribute__((noinline)) void take_up(const sagi_world *world, later *l, sag_hit *hits) {
    carved_batch b;
    while (l->count > 0) {
        const sagi_world *solid = world->items[l->at[0].geometry].child;
        uint32_t kept = 0;
        b.count = 0;
        for (uint32_t i = 0; i < l->count; i++) {
            const uint32_t geometry = l->at[i].geometry, number = l->at[i].ray;
            const sagi_item *item = &world->items[geometry];
            if (item->child != solid || b.count == TOGETHER)
                l->at[kept++] = l->at[i];
            else
                add_to_carved(&b, solid, item, geometry, &l->rays[number], number, &hits[number]);
        }
        l->count = kept;
        trace_carved(&b, solid, hits);
    }
}

// Rays in the space of a mesh with cutters.
static __attribute__((noinline)) void intersect_carved(const sagi_world *solid, const sag_ray *rays,
                                                       sag_hit *hits, size_t count) {
    carved_batch b;
    for (size_t first = 0, end; first < count; first = end) {
        end = count - first < TOGETHER ? count : first + TOGETHER;
        b.count = 0;
        for (size_t i = first; i < end; i++) {
            hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
            add_to_carved(&b, solid, NULL, SAG_INVALID_ID, &rays[i], (uint32_t)(i - first), &hits[i]);
        }
        trace_carved(&b, solid, hits + first);
    }
}
