// SPDX-License-Identifier: MIT
// One ray against many triangles in exact whole numbers, fast enough for millions of decisions: an oracle
// that shares neither code nor method of calculation with the library or with exact_triangle.h.
//
// Coordinates that are whole numbers below 2²⁹ times a power of two take the machine's 128-bit integers;
// any other doubles take GMP's.
#ifndef TESTS_SUPPORT_EXACT_BLOCK_H
#define TESTS_SUPPORT_EXACT_BLOCK_H

#include <sagitta/shapes.h>

enum { EXACT_BLOCK_MAX = 24 };

typedef struct lattice3 {
    int64_t x[3];
} lattice3;

typedef struct exact_block {
    uint32_t count;
    bool lattice; // at is corner_of times 2^exponent, exactly, and |corner_of| < 2²⁹
    int exponent;
    lattice3 corner_of[EXACT_BLOCK_MAX][3];
    sag_vec3 at[EXACT_BLOCK_MAX][3];
} exact_block;

typedef struct exact_line {
    bool lattice; // the ray's origin is origin times 2^(the block's exponent), its direction direction times
                  // 2^exponent; all below 2²⁹
    int exponent;
    lattice3 origin, direction;
    sag_ray ray;
} exact_line;

// Takes a block for the calls that follow.
void exact_block_use(const exact_block *block);
// Which way the line of the ray pierces triangle i of it: as sagi_triangle_side, ties included. t_min and
// t_max are not looked at.
int exact_block_side(const exact_line *line, uint32_t i);
// Whether t is within 4 units of its last place of the true one; after exact_block_side for this triangle
// said that it is hit.
bool exact_block_time(double t);
// Whether it is so large that it may be no double.
bool exact_block_time_is_huge(void);
// Gives GMP's memory back.
void exact_block_end(void);

#endif
