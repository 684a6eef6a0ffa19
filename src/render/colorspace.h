// SPDX-License-Identifier: MIT
// Colour spaces, and reflectances for their colours.
#ifndef SAGI_RENDER_COLORSPACE_H
#define SAGI_RENDER_COLORSPACE_H

#include "spectrum_data.h"

#include <stdbool.h>

#define SAGI_COLOR_SPACE_COUNT 4
// Nodes of a table of coefficients: along the largest component, and along the others' ratios to it. A colour
// from the table comes back from its spectrum within 0.005 in sRGB where all components are in 0.05 … 0.65,
// on the mean within 0.0005 and without a bias; the worst, near the primaries, within 0.02. Test:
// tests/render/test_spectrum.c.
#define SAGI_COLOR_LEVELS 32
#define SAGI_COLOR_RATIOS 20

// Linear RGB: three primaries and a white, which is the light that makes (1, 1, 1).
typedef struct sagi_color_space {
    double primaries[3][2]; // x, y
    double white[3];        // X, Y = 1, Z
    double to_xyz[3][3], from_xyz[3][3];
    float illuminant[SAGI_WAVELENGTH_COUNT]; // at luminance 1
} sagi_color_space;

// One table for each component that may be the largest: [largest][its value z, rising][last/z][next/z]. What
// it holds is c √z, which is smooth down to black.
typedef float sagi_coefficients __attribute__((vector_size(16))); // and 0
typedef sagi_coefficients sagi_color_table[3][SAGI_COLOR_LEVELS][SAGI_COLOR_RATIOS][SAGI_COLOR_RATIOS];

// The sum of y: light of this power at every nanometre has luminance 1 (a candela's 683 lm/W left aside).
double sagi_luminance_norm(void);
// From the primaries' chromaticities and the light that is white, any amount of it.
void sagi_color_space_init(sagi_color_space *space, const double primaries[3][2],
                           const float illuminant[SAGI_WAVELENGTH_COUNT]);
void sagi_matrix_multiply(const double a[3][3], const double b[3][3], double product[3][3]);
void sagi_matrix_apply(const double m[3][3], const double v[3], double product[3]);
// False for a singular one.
bool sagi_matrix_invert(const double m[3][3], double inverse[3][3]);

// The same colour in another space (an index each); a white is not adapted.
void sagi_color_convert(int from, int to, const double rgb[3], double converted[3]);

// x, y, z of the white light that is reflected at each of `count` wavelengths, and how far along it is, 0
// … 1.
typedef double sagi_color_sums __attribute__((vector_size(32)));
typedef struct sagi_color_basis {
    sagi_color_sums at[SAGI_WAVELENGTH_COUNT];
    int count;
} sagi_color_basis;
// What is the same for all colours of a space.
typedef struct sagi_color_solver {
    const sagi_color_space *space;
    sagi_color_basis fine, rough;
} sagi_color_solver;

// Integrates in steps of so many nm (a divisor of 470).
void sagi_color_solver_init(sagi_color_solver *solver, const sagi_color_space *space, int step_nm);
// The coefficients of a reflectance that has the linear colour rgb, each in [0, 1], under the space's white;
// see rgb_solve.c. `c` goes in as the first guess.
void sagi_color_solve(const sagi_color_solver *solver, const double rgb[3], double c[3]);
// Values of the largest component in the tables, from 0 to 1: nodes are nearer to each other at the ends.
static inline double sagi_color_level(int i) {
    const double x = i * (1.0 / (SAGI_COLOR_LEVELS - 1));
    return x * x * (3 - 2 * x);
}

// Written when the library is built (src/tables): the spaces by sag_color_space, and their tables.
extern const sagi_color_space sagi_color_spaces[SAGI_COLOR_SPACE_COUNT];
extern const sagi_color_table sagi_color_tables[SAGI_COLOR_SPACE_COUNT];
// sagi_color_level of each level, and the highest level not above i/SAGI_COLOR_GUIDE, but for the last.
#define SAGI_COLOR_GUIDE 64
extern const float sagi_color_levels[SAGI_COLOR_LEVELS];
extern const unsigned char sagi_color_guide[SAGI_COLOR_GUIDE + 1];

#endif
