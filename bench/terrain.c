// SPDX-License-Identifier: MIT
// A landscape of any number of triangles: a square grid, lifted by eleven octaves of value noise, each twice
// as fine and 0.48 times as high as the one before, the lower half of it folded up into ridges. Large, of
// one level of detail, and without anything in front of anything: what height data and scans are like.
#include "bench.h"
#include <stdio.h>

static double lattice(int64_t x, int64_t y, uint64_t octave) {
    uint64_t state = (uint64_t)x * 0x8DA6B343u + (uint64_t)y * 0xD8163841u + octave * 0xCB1AB31Fu;
    return random_unit(&state);
}

static double smooth(double s) { return s * s * s * (s * (6 * s - 15) + 10); }

static double noise(double x, double y, uint64_t octave) {
    double fx = floor(x), fy = floor(y), u = smooth(x - fx), v = smooth(y - fy);
    int64_t i = (int64_t)fx, j = (int64_t)fy;
    double low = lattice(i, j, octave) * (1 - u) + lattice(i + 1, j, octave) * u;
    double high = lattice(i, j + 1, octave) * (1 - u) + lattice(i + 1, j + 1, octave) * u;
    return low * (1 - v) + high * v;
}

static double height(double x, double y) {
    double sum = 0, weight = 0.18, scale = 4;
    for (uint64_t octave = 0; octave < 11; octave++, weight *= 0.48, scale *= 2.03) {
        double n = noise(scale * x, scale * y, octave);
        sum += weight * (octave < 5 ? fabs(2 * n - 1) : n);
    }
    return sum;
}

typedef struct grid {
    model *m;
    size_t n; // squares along a side
} grid;

static void rows(void *argument, size_t first, size_t end) {
    const grid *g = argument;
    for (size_t at = first; at < end; at++) {
        size_t i = at / (g->n + 1), j = at % (g->n + 1);
        double x = (double)i / (double)g->n, z = (double)j / (double)g->n;
        float *p = g->m->positions + 3 * at;
        p[0] = (float)(x - 0.5);
        p[1] = (float)height(x, z);
        p[2] = (float)(z - 0.5);
    }
}

void model_make_terrain(model *m, uint32_t triangle_count) {
    size_t n = (size_t)ceil(sqrt(triangle_count / 2.0));
    *m = (model){.vertex_count = (uint32_t)((n + 1) * (n + 1)), .triangle_count = (uint32_t)(2 * n * n)};
    snprintf(m->name, sizeof m->name, "terrain");
    m->positions = need((size_t)m->vertex_count * 3 * sizeof *m->positions);
    m->triangles = need((size_t)m->triangle_count * 3 * sizeof *m->triangles);
    grid g = {m, n};
    crew_run(4, m->vertex_count, rows, &g);
    uint32_t *t = m->triangles;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            uint32_t a = (uint32_t)(i * (n + 1) + j), b = a + 1, c = a + (uint32_t)n + 1, d = c + 1;
            uint32_t corners[6] = {a, b, c, b, d, c};
            for (int k = 0; k < 6; k++) *t++ = corners[k];
        }
    model_measure(m);
}
