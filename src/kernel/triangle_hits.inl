// SPDX-License-Identifier: MIT
// What follows from what a block of triangles has answered (triangles.inl). Part of kernel.inl.
//
// A certain hit bounds at once what still matters, by the latest time it may have; who it is, and its t, u
// and v, are looked up where the walk ends, for the nearest alone: so it waits as a candidate (mostly the
// only one, which settle_last solves straight). The uncertain are decided one by one, exactly, as they come.

static inline const sagi_item *item_of(const level *here, const sagi_block *head) {
    return &here->world->items[head->geometry];
}

typedef struct mesh_corners {
    sag_vec3 a, b, c;
} mesh_corners;

// A mesh whose transform mirrors it has its vertices where they stand, but the sense of rotation that says
// which side is the front is the one before: the second and third vertex change places, and so do their
// weights in the hit.
static inline mesh_corners corners_of(const sagi_item *item, uint32_t primitive) {
    const sag_mesh *mesh = item->shape;
    const uint32_t *corner = mesh->triangles + 3 * (size_t)primitive;
    return (mesh_corners){sagi_mesh_vertex(mesh, corner[0]),
                          sagi_mesh_vertex(mesh, corner[item->mirrored ? 2 : 1]),
                          sagi_mesh_vertex(mesh, corner[item->mirrored ? 1 : 2])};
}

// The corners of a triangle that has them in its block.
SAGI_INLINE void block_corners(const sagi_world *world, const sagi_triangle_block *block, size_t lane,
                               sagi_d4 corner[3]) {
    const block_constants *k = sagi_hidden(&in_blocks);
    const sagi_fine_grid grid = {grid_zero(k, block->head.base), world->center, k->fine[block->head.exponent],
                                 world->unit};
    sagi_exact_corners(&k->rest, block, lane, &grid, corner);
}

// Asks for the memory that a solution will need, as soon as a triangle is known to be met: the rest of its
// corners or, where vertices are doubles, their numbers.
SAGI_INLINE void fetch_rest(const sag_mesh *mesh, const sagi_triangle_block *block, size_t lane) {
    __builtin_prefetch(mesh->positions_f32 != NULL
                           ? (const void *)block->rest
                           : (const void *)(mesh->triangles + 3 * (size_t)block->primitive[lane]));
}
// And a while later: the vertices, if the block has not got them.
static inline void fetch_corners(const level *here, const candidate *c) {
    const sagi_triangle_block *block = (const sagi_triangle_block *)(const void *)c->block;
    if (sagi_has_exact_corners(block, c->lane)) return;
    const sag_mesh *mesh = item_of(here, c->block)->shape;
    const uint32_t *corner = mesh->triangles + 3 * (size_t)block->primitive[c->lane];
    for (int i = 0; i < 3; i++) {
        size_t at = 3 * (size_t)corner[i];
        __builtin_prefetch(mesh->positions_f64 ? (const void *)(mesh->positions_f64 + at)
                                               : (const void *)(mesh->positions_f32 + at));
    }
}

// One of four hits that are solved at once.
static inline void put_corners(sagi_triangle_four *four, uint32_t i, const sagi_world *world,
                               const sagi_triangle_block *block, size_t lane) {
    const sagi_item *item = &world->items[block->head.geometry];
    sagi_d4 corner[3];
    if (sagi_has_exact_corners(block, lane))
        block_corners(world, block, lane, corner);
    else
        sagi_mesh_corners(item->shape, block->primitive[lane], item->mirrored, corner);
    for (int k = 0; k < 3; k++) four->corner[k][i] = corner[k];
}

static inline sagi_triangle_ray triangle_ray_of(const level *here) {
    sagi_triangle_ray ray = sagi_triangle_prepare(here->ray);
    ray.t_max = here->t_max;
    return ray;
}

// One triangle by the exact test.
static __attribute__((noinline)) bool triangle(question asked, level *here, const sagi_item *item,
                                               sagi_bvh_reference r) {
    const sag_mesh *mesh = item->shape;
    const bool one_sided = mesh->one_sided && !here->search->both_sides;
    mesh_corners at = corners_of(item, r.primitive);
    sagi_triangle_ray ray = triangle_ray_of(here);
    double t, u, v;
    SAGI_KERNEL_COUNT(exact_tests);
    if (!sagi_triangle_hit(&ray, &at.a, &at.b, &at.c, one_sided, &t, &u, &v)) return false;
    return accept(asked, here, r.geometry, r.primitive, t, item->mirrored ? v : u, item->mirrored ? u : v);
}

// Whether the time of an uncertain one is, for certain, not in range.
static __attribute__((noinline)) bool is_beyond(const level *here, const sagi_item *item,
                                                uint32_t primitive) {
    sagi_d4 corner[3];
    sagi_mesh_corners(item->shape, primitive, item->mirrored, corner);
    return sagi_triangle_is_beyond(here->ray, here->t_max, corner);
}

// One that is certainly hit.
static __attribute__((noinline)) bool certain_triangle(question asked, level *here,
                                                       const sagi_triangle_block *block, uint32_t lane) {
    const sagi_item *item = item_of(here, &block->head);
    sagi_d4 corner[3];
    sagi_mesh_corners(item->shape, block->primitive[lane], item->mirrored, corner);
    double t, u, v;
    SAGI_KERNEL_COUNT(solved);
    if (!sagi_triangle_solve_here(here->ray, here->t_max, corner[0], corner[1], corner[2], &t, &u, &v))
        return false;
    return accept(asked, here, block->head.geometry, block->primitive[lane], t, item->mirrored ? v : u,
                  item->mirrored ? u : v);
}

static inline bool sphere(question asked, level *here, const sagi_block *block, uint32_t lane);
static bool last_sphere(level *here, const candidate *c);

// CLOSEST: finds t, u and v of the candidates that may still be the nearest.
static __attribute__((noinline)) void settle(level *here) {
    for (uint32_t i = 0; i < here->candidate_count; i++) {
        const candidate *c = &here->candidates[i];
        if (!(c->earliest <= here->limit)) continue;
        if (c->block->kind == SAGI_BLOCK_TRIANGLES)
            certain_triangle(CLOSEST, here, (const sagi_triangle_block *)(const void *)c->block, c->lane);
        else
            sphere(CLOSEST, here, c->block, c->lane);
    }
    here->candidate_count = 0;
}

// What a search's found, odd, near, both_sides and path_length say in one number: 0 where there is no hit yet
// and no instance around.
SAGI_INLINE uint64_t state_of(const search *s) {
    _Static_assert(offsetof(search, path_length) == offsetof(search, found) + 4 &&
                       offsetof(search, both_sides) == offsetof(search, found) + 3,
                   "they stand side by side");
    uint64_t state;
    memcpy(&state, &s->found, sizeof state);
    return state;
}

// Whether all there is is one triangle that is certainly hit.
SAGI_INLINE bool is_lone(const level *here) { return here->lone && state_of(here->search) == 0; }

// Its hit.
SAGI_INLINE void take_lone(level *here, const sagi_triangle_block *block, size_t lane, sagi_d4 tuv) {
    search *s = here->search;
    SAGI_KERNEL_COUNT(solved);
    write_triangle(tuv, block->head.geometry, block->primitive[lane], s->best);
    s->found = s->odd = true, s->near = s->both_sides = false;
    here->t_max = tuv[0] + room_of(s, tuv[0]);
}

// By the mesh's vertices; false where they are doubles, and so perhaps those of a mirrored mesh, or it takes
// more than the quick solution.
SAGI_INLINE bool settle_lone(level *here) {
    const candidate *c = &here->candidates[0];
    const sagi_triangle_block *block = (const sagi_triangle_block *)(const void *)c->block;
    const sag_mesh *mesh = here->lone_mesh;
    if (mesh->positions_f64 != NULL) return false;
    const uint32_t *corner = mesh->triangles + 3 * (size_t)block->primitive[c->lane];
    const size_t at[3] = {3 * (size_t)corner[0], 3 * (size_t)corner[1], 3 * (size_t)corner[2]};
    const float *vertex = mesh->positions_f32;
    sagi_d4 tuv;
    if (!sagi_triangle_solve_quick(here->ray, here->t_max, sagi_d4_load4_float(vertex + at[0]),
                                   sagi_d4_load4_float(vertex + at[1]), sagi_d4_load4_float(vertex + at[2]),
                                   &tuv))
        return false;
    take_lone(here, block, c->lane, tuv);
    return true;
}

// CLOSEST: settle where nothing is to come any more, of whatever is left.
static __attribute__((noinline)) void settle_left(level *here) {
    if (is_lone(here) && settle_lone(here)) return;
    search *s = here->search;
    const candidate *c = &here->candidates[0];
    if (here->candidate_count != 1 || s->found || c->block->kind != SAGI_BLOCK_TRIANGLES) {
        if (here->candidate_count != 1 || s->found || c->block->kind != SAGI_BLOCK_SPHERES ||
            !last_sphere(here, c))
            settle(here);
        return;
    }
    const sagi_item *item = item_of(here, c->block);
    const uint32_t primitive = ((const sagi_triangle_block *)(const void *)c->block)->primitive[c->lane];
    sagi_d4 corner[3];
    sagi_mesh_corners(item->shape, primitive, item->mirrored, corner);
    double t, u, v;
    SAGI_KERNEL_COUNT(solved);
    if (!sagi_triangle_solve_here(here->ray, here->t_max, corner[0], corner[1], corner[2], &t, &u, &v))
        return;
    write_hit(s, c->block->geometry, primitive, t, item->mirrored ? v : u, item->mirrored ? u : v, s->best);
    s->found = s->odd = true, s->near = false;
    here->t_max = t + room_of(s, t);
}

// The same. Mostly there is one triangle, and no hit yet, and its block has the corners.
SAGI_INLINE void settle_last(level *here) {
    const candidate *c = &here->candidates[0];
    const sagi_triangle_block *block = (const sagi_triangle_block *)(const void *)c->block;
    sagi_d4 corner[3], tuv;
    if (__builtin_expect(!is_lone(here), 0) || __builtin_expect(!sagi_has_exact_corners(block, c->lane), 0)) {
        settle_left(here);
        return;
    }
    block_corners(here->world, block, c->lane, corner);
    if (__builtin_expect(
            !sagi_triangle_solve_quick(here->ray, here->t_max, corner[0], corner[1], corner[2], &tuv), 0)) {
        settle_left(here);
        return;
    }
    take_lone(here, block, c->lane, tuv);
}

// CLOSEST: a certain hit bounds what still matters, though its t is not known yet. False when it does not
// matter itself.
static inline bool add_candidate(level *here, const sagi_block *block, uint32_t lane, float earliest,
                                 float latest) {
    here->limit = sagi_float_min(here->limit, latest);
    if (!(earliest <= here->limit)) return false;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < here->candidate_count; i++)
        if (here->candidates[i].earliest <= here->limit) here->candidates[kept++] = here->candidates[i];
    here->candidate_count = kept;
    if (kept == MAX_CANDIDATES) settle(here);
    here->candidates[here->candidate_count++] = (candidate){block, lane, earliest};
    here->lone = false;
    return true;
}

// How far apart a grid's lines are, for each sagi_block.exponent.
#define LINE(i)  (1.0F / ((uint64_t)1 << (i)))
#define LINE4(i) LINE(i), LINE((i) + 1), LINE((i) + 2), LINE((i) + 3)
static const float grid_lines[] = {LINE4(0),  LINE4(4),  LINE4(8),  LINE4(12), LINE4(16), LINE4(20),
                                   LINE4(24), LINE4(28), LINE4(32), LINE4(36), LINE(40)};
_Static_assert(sizeof grid_lines == (SAGI_GRID_MAX_EXPONENT + 1) * sizeof(float), "all of them");

// When the candidate in a lane of the block is met. False when that is before the block's box: a triangle
// that stands in several leaves may have it so, and is the matter of the leaf that holds the hit.
SAGI_INLINE bool times_of(const sagi_triangle_block *block, const block_answer *answer, uint32_t lane,
                          float begin, float *earliest, float *latest) {
    // X = ±(b₀ + b₁ x) are the earliest and the latest x ≥ 0.
    float step = (float)power_of_two(-(int)block->head.exponent);
    float t = answer->t[lane], d = answer->d[lane], b0 = answer->b0[lane];
    *latest = (begin + (t + b0) / (d - answer->b1) * step) * (1 + 0x1p-20F);
    *earliest = (begin + sagi_float_max((t - b0) / (d + answer->b1), 0) * step) * (1 - 0x1p-20F);
    return !(t + b0 < 0);
}
// The latest alone, in few instructions; less than begin only where times_of says false.
SAGI_INLINE float latest_of(const sagi_triangle_block *block, const block_answer *answer, size_t lane,
                            float begin) {
    const float x = (answer->t[lane] + answer->b0[lane]) / (answer->d[lane] - answer->b1);
    return (begin + x * grid_lines[block->head.exponent]) * (1 + 0x1p-20F);
}
static inline void add_triangle(level *here, const sagi_triangle_block *block, const block_answer *answer,
                                uint32_t lane, float begin) {
    float earliest, latest;
    if (times_of(block, answer, lane, begin, &earliest, &latest) &&
        add_candidate(here, &block->head, lane, earliest, latest))
        fetch_rest(item_of(here, &block->head)->shape, block, lane);
}

// CLOSEST: the same of a block in which one triangle is met, for certain, while no other waits, as it is
// mostly. False when that is not so.
SAGI_INLINE bool take_only(level *here, const sagi_triangle_block *block, const block_answer *answer,
                           float begin) {
    const sagi_item *item = item_of(here, &block->head);
    const sag_mesh *mesh = item->shape;
    const uint32_t certain = answer->certain;
    if (answer->uncertain != 0 || (certain & (certain - 1)) != 0 || here->candidate_count != 0 ||
        mesh->one_sided || !sees(here, item))
        return false;
    const size_t lane = (size_t)__builtin_ctzll(certain);
    const float latest = latest_of(block, answer, lane, begin);
    if (latest < begin) return true;
    here->limit = sagi_float_min(here->limit, latest);
    here->candidates[0] = (candidate){&block->head, (uint32_t)lane, begin}, here->lone_mesh = mesh;
    here->candidate_count = 1, here->in_tree = here->lone = true;
    fetch_rest(mesh, block, lane);
    return true;
}

// What follows from a block's answer, which is not that all are missed.
SAGI_INLINE bool take_triangles(question asked, level *here, const sagi_triangle_block *block,
                                const block_answer *answer, float begin) {
    const sagi_item *item = item_of(here, &block->head);
    if (!sees(here, item)) return false;
    uint32_t certain = answer->certain;
    bool one_sided = ((const sag_mesh *)item->shape)->one_sided && !here->search->both_sides;
    if (one_sided) certain &= ~answer->back;
    if (asked == ANY && certain != 0) return here->search->found = true;
    for (; certain != 0; certain &= certain - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(certain);
        if (asked == CLOSEST)
            add_triangle(here, block, answer, lane, begin);
        else
            certain_triangle(asked, here, block, lane);
    }
    for (uint32_t left = answer->uncertain; left != 0; left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        SAGI_KERNEL_COUNT(uncertain);
        // Mostly it is the one that a ray leaves or ends on.
        if (is_beyond(here, item, block->primitive[lane])) continue;
        bool over = answer->inside >> lane & 1 && !one_sided
                        ? certain_triangle(asked, here, block, lane)
                        : triangle(asked, here, item,
                                   (sagi_bvh_reference){block->head.geometry, block->primitive[lane]});
        if (over) return true;
    }
    return false;
}

SAGI_INLINE bool triangle_block(question asked, level *here, const sagi_triangle_block *block, float begin) {
    SAGI_KERNEL_COUNT(blocks);
    block_answer answer;
    return meet_triangles(block, &here->tree_ray, begin, here->limit, false, &answer) &&
           take_triangles(asked, here, block, &answer, begin);
}
