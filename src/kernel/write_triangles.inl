// SPDX-License-Identifier: MIT
// Writing a block of triangles (block.h, corners.h). Part of kernel.inl, since it would be two fifths of the
// time to build a tree; with registers for four doubles it is a tenth.
//
// A vertex (p − C)·scale errs by 2⁻⁵² in world units at most, which is 2⁻¹² grid steps at most; subtracting
// the grid's zero may add as much, scaling is exact and rounding to the grid costs half a step and 2⁻¹²:
// SAGI_GRID_ERROR. The finer grid of corners.h is rounded to as well, and read back.
//
// Numbers are rounded by adding 2⁵²: from there on doubles are whole numbers, and the last bits of the sum
// are the number. What stands in the middle of two is rounded to the even one, but corners.h wants the upper
// one: so 2⁻¹² is added first, less than there is between numbers of the finer grid. Nothing here depends on
// the instruction set.

// Coordinate k of corner i of all triangles.
typedef struct block_vertices {
    sagi_d4 at[3][3][2]; // [i][k][half]
} block_vertices;

// The first three numbers of four vectors, which come as rows, as columns.
SAGI_INLINE void turn_rows(const sagi_d4 row[4], sagi_d4 *x, sagi_d4 *y, sagi_d4 *z) {
    const sagi_d4 x01 = SAGI_D4_SHUFFLE2(row[0], row[1], 0, 4, 2, 6); // x₀ x₁ z₀ z₁
    const sagi_d4 y01 = SAGI_D4_SHUFFLE2(row[0], row[1], 1, 5, 3, 7); // y₀ y₁ · ·
    const sagi_d4 x23 = SAGI_D4_SHUFFLE2(row[2], row[3], 0, 4, 2, 6);
    const sagi_d4 y23 = SAGI_D4_SHUFFLE2(row[2], row[3], 1, 5, 3, 7);
    *x = SAGI_D4_SHUFFLE2(x01, x23, 0, 1, 4, 5), *z = SAGI_D4_SHUFFLE2(x01, x23, 2, 3, 6, 7);
    *y = SAGI_D4_SHUFFLE2(y01, y23, 0, 1, 4, 5);
}

// Where there are fewer triangles, the first is repeated.
SAGI_INLINE void read_vertices(const sagi_item *item, const sagi_bvh_primitive *p, uint32_t count,
                               block_vertices *out) {
    for (uint32_t half = 0; half < 2; half++) {
        sagi_d4 row[3][4];
        for (uint32_t j = 0; j < 4; j++) {
            sagi_d4 corner[3];
            const uint32_t lane = 4 * half + j;
            sagi_mesh_corners(item->shape, p[lane < count ? lane : 0].primitive, item->mirrored, corner);
            for (int i = 0; i < 3; i++) row[i][j] = corner[i];
        }
        for (int i = 0; i < 3; i++)
            turn_rows(row[i], &out->at[i][0][half], &out->at[i][1][half], &out->at[i][2][half]);
    }
}

SAGI_INLINE double least_of_four(sagi_d4 a) {
    a = sagi_d4_min(a, sagi_d4_turn(a));
    return lesser(a[0], a[1]);
}
SAGI_INLINE double most_of_four(sagi_d4 a) {
    a = sagi_d4_max(a, sagi_d4_turn(a));
    return greater(a[0], a[1]);
}

// The grid, and what makes numbers of it coordinates again.
typedef struct block_grid {
    double zero[3], steps, fine_steps, fine_step, unit, origin[3];
} block_grid;

// Its zero below all corners, its step the smallest power of two with which 16 bits reach the farthest of
// them. Corners are in world units, above −1 and below 1.
SAGI_INLINE void choose_grid(const block_vertices *v, sagi_block *head, block_grid *g) {
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        sagi_d4 lo = v->at[0][k][0], hi = lo;
        for (int i = 0; i < 3; i++)
            for (int half = 0; half < 2; half++)
                lo = sagi_d4_min(lo, v->at[i][k][half]), hi = sagi_d4_max(hi, v->at[i][k][half]);
        g->zero[k] = sagi_grid_zero(head, k, least_of_four(lo));
        extent = greater(extent, most_of_four(hi) - g->zero[k]);
    }
    g->steps = sagi_grid_steps(head, extent);
    g->fine_steps = g->steps * (1 << SAGI_REST_BITS), g->fine_step = 1 / g->fine_steps;
}

// What corners lack, as it comes together.
typedef struct rests {
    sagi_l4 numbers;
    sagi_l4 beyond; // not 0: they do not fit,
    sagi_l4 bad;    // not 0: and read back it is not the vertex
} rests;

// Coordinate k of corner i of four triangles, rounded to both grids; the coarse numbers, as doubles.
SAGI_INLINE sagi_d4 round_four(const block_grid *g, sagi_d4 vertex, sagi_d4 at, int i, int k, rests *to) {
    const sagi_d4 whole = sagi_d4_fill(SAGI_REST_WHOLE), zero = sagi_d4_fill(g->zero[k]);
    const sagi_d4 away = at - zero;
    const sagi_d4 coarse = (away * sagi_d4_fill(g->steps) + sagi_d4_fill(0x1p-12)) + whole;
    const sagi_d4 fine = away * sagi_d4_fill(g->fine_steps) + whole;
    // fine − 128 coarse + 64, of the numbers without the bits of 2⁵².
    const uint64_t middle =
        (SAGI_REST_WHOLE_BITS << SAGI_REST_BITS) - SAGI_REST_WHOLE_BITS + SAGI_REST_MIDDLE;
    typedef uint64_t whole4 __attribute__((vector_size(32)));
    const whole4 n = (whole4)fine - ((whole4)coarse << SAGI_REST_BITS) + middle;
    to->beyond |= (sagi_l4)(n >> SAGI_REST_BITS);
    to->numbers |= sagi_l4_left((sagi_l4)n, (uint64_t)SAGI_REST_SHIFT(i, k));
    const sagi_d4 back = sagi_d4_fill(g->origin[k]) +
                         (zero + (fine - whole) * sagi_d4_fill(g->fine_step)) * sagi_d4_fill(g->unit);
    to->bad |= (sagi_l4)back ^ (sagi_l4)vertex;
    return coarse - whole;
}

// What is beyond count stays as it is: 0.
static void write_triangles(const sagi_world *world, const sagi_bvh_primitive *p, uint32_t count,
                            sagi_triangle_block *block) {
    const sagi_item *item = &world->items[p[0].geometry];
    const bool floats = ((const sag_mesh *)item->shape)->positions_f32 != NULL;
    block_grid g = {.unit = 1 / world->scale, .origin = {world->origin.x, world->origin.y, world->origin.z}};
    block_vertices vertex, v;
    read_vertices(item, p, count, &vertex);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            for (int half = 0; half < 2; half++)
                v.at[i][k][half] =
                    (vertex.at[i][k][half] - sagi_d4_fill(g.origin[k])) * sagi_d4_fill(world->scale);
    sagi_block head = {.kind = SAGI_BLOCK_TRIANGLES, .count = (uint8_t)count, .geometry = p[0].geometry};
    choose_grid(&v, &head, &g);
    sagi_d4 longest = sagi_d4_fill(0); // no coordinate of an edge is longer
    for (uint32_t half = 0; 4 * half < count; half++) {
        const sagi_l4 there = sagi_l4_from_mask(sagi_last_bits(UINT32_MAX, count) >> 4 * half);
        rests rest = {.numbers = {0}};
        for (int k = 0; k < 3; k++) {
            sagi_d4 a = sagi_d4_fill(0);
            for (int i = 0; i < 3; i++) {
                const sagi_d4 coarse = round_four(&g, vertex.at[i][k][half], v.at[i][k][half], i, k, &rest);
                a = i == 0 ? coarse : a;
                longest = sagi_d4_max(longest, sagi_d4_abs(coarse - a));
                const sagi_d4 written = (sagi_d4)((sagi_l4)coarse & there);
                const uint64_t numbers = sagi_d4_to_h4(written);
                memcpy(sagi_block_corner(block, i, k, 4 * (int)half), &numbers, sizeof numbers);
            }
        }
        const sagi_l4 exact =
            there & sagi_l4_equal(rest.bad | rest.beyond, sagi_l4_fill(0)) & sagi_l4_fill(-(int64_t)floats);
        const sagi_l4 numbers = (rest.numbers | sagi_l4_fill((int64_t)SAGI_REST_EXACT)) & exact;
        memcpy(block->rest + 4 * half, &numbers, sizeof numbers);
    }
    for (uint32_t j = 0; j < count; j++) block->primitive[j] = p[j].primitive;
    head.edge = (uint8_t)((int)most_of_four(longest) >> 8);
    block->head = head;
}
