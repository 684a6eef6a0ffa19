// SPDX-License-Identifier: MIT
// The sums S(x, y) over all that is left of x and above y are known at the corners of the cells and bilinear
// between; the integral over a window is S at its four corners. For a given window the share left of x is
// linear in each column, so x is found by halving the columns and solving within one; then y in the same way
// within that column, where the density does not depend on x. In the whole square the row comes first, by the
// sums of rows, then x within it: what is looked at lies together. There, as the window is always the same,
// a guide says for each of as many equal shares as there are cells in which cell it begins (Chen & Asau,
// "On Generating Random Variates from an Empirical Distribution", AIIE Transactions 6(2), 1974): from there
// it is two steps on the average, however uneven the cells are, for as many shares as cells are passed in
// all.
#include "window.h"

#include <string.h>

bool sagi_window_table_init(sagi_window_table *table, const sag_context *context, const double *weights,
                            uint32_t width, uint32_t height) {
    *table = (sagi_window_table){.width = width, .height = height};
    const size_t stride = (size_t)width + 1, count = stride * ((size_t)height + 1);
    table->sums = sag_allocate(context, count * sizeof *table->sums);
    table->rows = sag_allocate(context, ((size_t)height + 1) * sizeof *table->rows);
    if (!table->sums || !table->rows) {
        sagi_window_table_clear(table, context);
        return false;
    }
    const double area = 1.0 / width / height;
    memset(table->sums, 0, stride * sizeof *table->sums);
    for (uint32_t y = 0; y < height; y++) {
        const double *above = table->sums + y * stride;
        double *row = table->sums + (y + 1) * stride, sum = 0;
        row[0] = 0;
        for (uint32_t x = 0; x < width; x++) {
            sum += weights[(size_t)y * width + x] * area;
            row[x + 1] = above[x + 1] + sum;
        }
    }
    for (uint32_t y = 0; y <= height; y++) table->rows[y] = table->sums[y * stride + width];
    return true;
}

// Of a row that grows from low[0] − high[0] = 0 (find_between): the cells in which shares begin.
static void guide_along(uint16_t *guide, const double *low, const double *high, uint32_t count) {
    const double all = low[count] - (high ? high[count] : 0);
    uint32_t cell = 0;
    for (uint32_t k = 0; k < count; k++) {
        const double target = k * (1.0 / count) * all;
        while (cell + 1 < count && low[cell + 1] - (high ? high[cell + 1] : 0) <= target) cell++;
        guide[k] = (uint16_t)cell;
    }
}

static size_t guide_count(const sagi_window_table *t) { return t->height * ((size_t)t->width + 1); }

bool sagi_window_table_guide(sagi_window_table *t, const sag_context *context) {
    if (t->width > 1u << 16 || t->height > 1u << 16) return true;
    t->guide = sag_allocate(context, guide_count(t) * sizeof *t->guide);
    if (!t->guide) return false;
    guide_along(t->guide, t->rows, NULL, t->height);
    for (uint32_t y = 0; y < t->height; y++) {
        const double *above = t->sums + y * ((size_t)t->width + 1);
        guide_along(t->guide + t->height + y * (size_t)t->width, above + t->width + 1, above, t->width);
    }
    return true;
}

void sagi_window_table_clear(sagi_window_table *table, const sag_context *context) {
    if (table->guide) sag_release(context, table->guide, guide_count(table) * sizeof *table->guide);
    const size_t count = ((size_t)table->width + 1) * ((size_t)table->height + 1);
    sag_release(context, table->sums, count * sizeof *table->sums);
    sag_release(context, table->rows, ((size_t)table->height + 1) * sizeof *table->rows);
    *table = (sagi_window_table){.width = 0};
}

// S, x and y in cells.
static double sum_at(const sagi_window_table *t, double x, double y) {
    const uint32_t i = x < t->width ? (uint32_t)x : t->width - 1,
                   j = y < t->height ? (uint32_t)y : t->height - 1;
    const double dx = x - i, dy = y - j;
    const double *p = t->sums + (size_t)j * (t->width + 1) + i, *q = p + t->width + 1;
    return (1 - dy) * ((1 - dx) * p[0] + dx * p[1]) + dy * ((1 - dx) * q[0] + dx * q[1]);
}

static double integral(const sagi_window_table *t, double x0, double y0, double x1, double y1) {
    return fmax(0, (sum_at(t, x1, y1) - sum_at(t, x0, y1)) + (sum_at(t, x0, y0) - sum_at(t, x1, y0)));
}

double sagi_window_integral(const sagi_window_table *t, const sagi_window *w) {
    return integral(t, w->low.x * t->width, w->low.y * t->height, w->high.x * t->width,
                    w->high.y * t->height);
}

// Part of a window, for one axis: what is before `at`, in cells.
typedef struct slice {
    const sagi_window_table *table;
    double x0, y0, x1, y1;
    bool along_y;
} slice;
static double before(const slice *s, double at) {
    return s->along_y ? integral(s->table, s->x0, s->y0, s->x1, at)
                      : integral(s->table, s->x0, s->y0, at, s->y1);
}

// Where the share u of the slice is; *cell is the cell it lies in.
static double find(const slice *s, double u, double low, double high, uint32_t *cell) {
    const double target = u * before(s, high);
    uint32_t first = (uint32_t)low, last = (uint32_t)ceil(high) - 1; // cells
    while (first < last) {
        const uint32_t middle = first + (last - first) / 2; // its end is within the window
        if (before(s, middle + 1.0) > target)
            last = middle;
        else
            first = middle + 1;
    }
    const double start = fmax(low, first), end = fmin(high, first + 1.0);
    const double a = before(s, start), b = before(s, end);
    *cell = first;
    const double share = (target - a) / (b - a);
    return start + (end - start) * (share > 0 ? fmin(share, 1) : 0);
}

bool sagi_window_sample(const sagi_window_table *t, const sagi_window *w, sag_vec2 u, sag_vec2 *p) {
    const double x0 = w->low.x * t->width, x1 = w->high.x * t->width, y0 = w->low.y * t->height,
                 y1 = w->high.y * t->height;
    if (!(integral(t, x0, y0, x1, y1) > 0)) return false;
    uint32_t column, row;
    const slice across = {t, x0, y0, x1, y1, false};
    const double x = find(&across, u.x, x0, x1, &column);
    const slice down = {t, column, y0, column + 1.0, y1, true};
    if (!(before(&down, y1) > 0)) return false;
    const double y = find(&down, u.y, y0, y1, &row);
    *p = (sag_vec2){x / t->width, y / t->height};
    return true;
}

// The place where the share u of what grows from low[0] − high[0] = 0 to low[count] − high[count] is reached;
// *cell is the cell it lies in. `high` and `guide` may be NULL.
static inline double find_between(const double *low, const double *high, const uint16_t *guide,
                                  uint32_t count, double u, uint32_t *cell) {
#define BEFORE(i) (low[i] - (high ? high[i] : 0))
    const double target = u * BEFORE(count);
    uint32_t first = 0, last = count - 1;
    if (guide) {
        const double share = u * count;
        first = guide[share < last ? (uint32_t)share : last];
        while (first > 0 && BEFORE(first) > target) first--; // where u · count is rounded up
        while (first < last && !(BEFORE(first + 1) > target)) first++;
        last = first;
    }
    while (first < last) {
        const uint32_t middle = first + (last - first) / 2;
        if (BEFORE(middle + 1) > target)
            last = middle;
        else
            first = middle + 1;
    }
    const double a = BEFORE(first), share = (target - a) / (BEFORE(first + 1) - a);
#undef BEFORE
    *cell = first;
    return first + (share > 0 ? fmin(share, 1) : 0);
}

// What is in the cell between these places of two rows.
static inline double cell_at(const double *above, const double *below) {
    const double here = (below[1] - below[0]) - (above[1] - above[0]);
    return here > 0 ? here : 0;
}

bool sagi_window_sample_whole(const sagi_window_table *t, sag_vec2 u, sag_vec2 *p, double *pdf,
                              size_t *cell) {
    if (!(t->rows[t->height] > 0)) return false;
    uint32_t row, column;
    const double y = find_between(t->rows, NULL, t->guide, t->height, u.y, &row);
    const double *above = t->sums + (size_t)row * (t->width + 1), *below = above + t->width + 1;
    if (!(below[t->width] - above[t->width] > 0)) return false;
    const uint16_t *guide = t->guide ? t->guide + t->height + (size_t)row * t->width : NULL;
    const double x = find_between(below, above, guide, t->width, u.x, &column);
    *p = (sag_vec2){x / t->width, y / t->height};
    *pdf = cell_at(above + column, below + column) * t->width * t->height / t->rows[t->height];
    *cell = (size_t)row * t->width + column;
    return true;
}

double sagi_window_pdf_whole(const sagi_window_table *t, size_t cell) {
    if (!(t->rows[t->height] > 0)) return 0;
    const double *above = t->sums + cell + cell / t->width; // rows are longer by one
    return cell_at(above, above + t->width + 1) * t->width * t->height / t->rows[t->height];
}

double sagi_window_pdf(const sagi_window_table *t, const sagi_window *w, sag_vec2 p) {
    if (!(p.x >= w->low.x && p.x <= w->high.x && p.y >= w->low.y && p.y <= w->high.y)) return 0;
    const double all = sagi_window_integral(t, w);
    const double x = fmin(floor(p.x * t->width), t->width - 1.0),
                 y = fmin(floor(p.y * t->height), t->height - 1.0);
    const double *above = t->sums + (size_t)y * (t->width + 1) + (size_t)x, *below = above + t->width + 1;
    return all > 0 ? cell_at(above, below) * t->width * t->height / all : 0;
}
