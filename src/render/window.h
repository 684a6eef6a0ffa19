// SPDX-License-Identifier: MIT
// A density that is constant over each cell of a grid on the unit square, cut to any window of it: Bitterli,
// Novák & Jarosz, "Portal-Masked Environment Map Sampling" (EGSR 2015).
#ifndef SAGI_RENDER_WINDOW_H
#define SAGI_RENDER_WINDOW_H

#include <sagitta/math.h>

typedef struct sagi_window_table {
    uint32_t width, height; // 0: nothing to sample
    double *sums;    // (width + 1)(height + 1): of the cells left of and above each corner, times their area
    double *rows;    // height + 1: of the rows above
    uint16_t *guide; // where to begin in the rows (height numbers) and in each row (width); or NULL
} sagi_window_table;

typedef struct sagi_window {
    sag_vec2 low, high; // in [0, 1]²
} sagi_window;

// From width·height weights ≥ 0, row by row. False when memory is short.
bool sagi_window_table_init(sagi_window_table *table, const sag_context *context, const double *weights,
                            uint32_t width, uint32_t height);
// Makes the sampling of the whole square quicker, for two bytes a cell. False when memory is short; then all
// is as before.
bool sagi_window_table_guide(sagi_window_table *table, const sag_context *context);
void sagi_window_table_clear(sagi_window_table *table, const sag_context *context);
// The integral over a window.
double sagi_window_integral(const sagi_window_table *table, const sagi_window *window);
// A point of the window. False where there is nothing in it.
bool sagi_window_sample(const sagi_window_table *table, const sagi_window *window, sag_vec2 u, sag_vec2 *p);
// A point of the whole square, in fewer steps, its density and its cell (row by row). False where there is
// nothing.
bool sagi_window_sample_whole(const sagi_window_table *table, sag_vec2 u, sag_vec2 *p, double *pdf,
                              size_t *cell);
// The density of a point of the window.
double sagi_window_pdf(const sagi_window_table *table, const sagi_window *window, sag_vec2 p);
// That of every point of a cell as sagi_window_sample_whole draws them: the same bits.
double sagi_window_pdf_whole(const sagi_window_table *table, size_t cell);

#endif
