// SPDX-License-Identifier: MIT
// A block's corners to the last bit. The 16-bit numbers of a block (block.h) are enough to tell what is
// missed and what is hit, but t, u and v are those of the mesh's own vertices, which are far away in memory:
// first the triangle's three indices, then what these say, and a ray at its end waits for both, one after the
// other. So each triangle of a block has 64 bits more: for each coordinate seven, which divide its grid's
// steps by 128, and a last bit that says that these 23-bit numbers are the vertices, exactly.
//
// They mostly are. Floats of at least x are multiples of 2⁻²³x if x is a power of two, so those are on the
// fine grid that are not nearer to 0 than the block is long; and what is not there is seen when the block is
// written, as it is read back then (write_triangles.inl). With n a number of the fine grid, 2⁻ᶠ its step, z
// its zero, C the world's origin and s its scale, a power of two, a coordinate is
//     p = C + (z + n 2⁻ᶠ)/s,
// in doubles: the products are exact, so that with fused operations or without the bits are the same.
#ifndef SAGI_KERNEL_CORNERS_H
#define SAGI_KERNEL_CORNERS_H

#include "kernel/block.h"
#include "math/simd.h"
#include <string.h>

#define SAGI_REST_BITS  7
#define SAGI_REST_EXACT ((uint64_t)1 << 63)
// Where the seven bits of coordinate k of corner i stand: n less 128 times the coarse number, plus 64.
#define SAGI_REST_SHIFT(i, k) (SAGI_REST_BITS * (3 * (i) + (k)))
#define SAGI_REST_MIDDLE      64

// Where a fine grid is.
typedef struct sagi_fine_grid {
    sagi_d4 zero, origin; // z, C
    double step, unit;    // 2⁻ᶠ, 1/s
} sagi_fine_grid;

// Constants, which are best read where they are used.
typedef struct sagi_rest_constants {
    uint64_t mask, whole;
    double minus_whole;
} sagi_rest_constants;
#define SAGI_REST_WHOLE      0x1p52 // its bits, with n for the last ones, are 2⁵² + n
#define SAGI_REST_WHOLE_BITS UINT64_C(0x4330000000000000)
#define SAGI_REST_CONSTANTS                                                                                  \
    { (1 << SAGI_REST_BITS) - 1, SAGI_REST_WHOLE_BITS, -(SAGI_REST_WHOLE + SAGI_REST_MIDDLE) }

typedef int64_t sagi_rest2 __attribute__((vector_size(16)));

// A corner of which `four` holds each coordinate's numbers in four lanes, the one asked for `up` bits below
// the upper end.
SAGI_INLINE sagi_d4 sagi_exact_corner(const sagi_rest_constants *k, const sagi_fine_grid *grid, sagi_l4 four,
                                      uint64_t up, uint64_t rest, uint64_t i) {
    typedef uint64_t whole __attribute__((vector_size(32)));
    const sagi_l4 rests =
        sagi_l4_rights(rest, SAGI_REST_SHIFT(i, 0), SAGI_REST_SHIFT(i, 1), SAGI_REST_SHIFT(i, 2), 0);
    // (The last seven bits of `coarse` are a neighbour's.)
    const sagi_l4 coarse = (sagi_l4)((whole)sagi_l4_left(four, up) >> (48 - SAGI_REST_BITS));
    const sagi_l4 mask = sagi_l4_fill((int64_t)k->mask), fine = (rests & mask) | (coarse & ~mask);
    const sagi_d4 n = (sagi_d4)(fine | sagi_l4_fill((int64_t)k->whole)) + sagi_d4_fill(k->minus_whole);
    return sagi_d4_fma(sagi_d4_fma(n, sagi_d4_fill(grid->step), grid->zero), sagi_d4_fill(grid->unit),
                       grid->origin);
}

SAGI_INLINE bool sagi_has_exact_corners(const sagi_triangle_block *block, size_t lane) {
    return (block->rest[lane] & SAGI_REST_EXACT) != 0;
}

// The corners of the triangle in this lane, which has them. The fourth numbers mean nothing.
SAGI_INLINE void sagi_exact_corners(const sagi_rest_constants *k, const sagi_triangle_block *block,
                                    size_t lane, const sagi_fine_grid *grid, sagi_d4 corner[3]) {
    _Static_assert(SAGI_BVH_WIDTH == 8, "two times four lanes");
    const uint64_t rest = block->rest[lane], up = 48 - 16 * (lane & 3);
    // x, y, z of a and of b, x and y of c, each of four lanes in 64 bits; z of c.
    sagi_rest2 x, y, z, xy, last;
    const char *pair = (const char *)block->pair + 4 * (lane & 4);
    memcpy(&x, pair, 16), memcpy(&y, pair + sizeof block->pair[0], 16);
    memcpy(&z, pair + 2 * sizeof block->pair[0], 16), memcpy(&xy, pair + 3 * sizeof block->pair[0], 16);
    memcpy(&last, (const char *)block->last + 2 * (lane & 4), 16); // (what follows means nothing)
    corner[0] = sagi_exact_corner(k, grid, sagi_l4_of(x[0], y[0], z[0], z[1]), up, rest, 0);
    corner[1] = sagi_exact_corner(k, grid, sagi_l4_of(x[1], y[1], z[1], z[1]), up, rest, 1);
    corner[2] = sagi_exact_corner(k, grid, sagi_l4_of(xy[0], xy[1], last[0], last[1]), up, rest, 2);
}

#endif
