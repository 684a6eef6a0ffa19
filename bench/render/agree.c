// SPDX-License-Identifier: MIT
// Two pictures of one scene: means, and means of blocks, which noise hardly touches.
#include "render.h"
#include <math.h>

enum { BLOCK = 8 };

static const float *at(const sag_image *image, uint32_t x, uint32_t y) {
    return image->pixels + ((size_t)y * image->width + x) * image->channels;
}

static double luminance(const double c[3]) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

// The mean colour of [x0, x1) × [y0, y1).
static void mean_of(const sag_image *image, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1,
                    double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            for (int c = 0; c < 3; c++) sum[c] += (double)at(image, x, y)[c];
    for (int c = 0; c < 3; c++) sum[c] /= (double)(x1 - x0) * (y1 - y0);
}

bool agree(const sag_image *ours, const sag_image *theirs, agreement *a) {
    *a = (agreement){0};
    if (ours->width != theirs->width || ours->height != theirs->height || ours->channels < 3 ||
        theirs->channels < 3)
        return false;
    const uint32_t width = ours->width, height = ours->height;
    double mine[3], wanted[3], blocks = 0, squares = 0;
    mean_of(ours, 0, width, 0, height, mine);
    mean_of(theirs, 0, width, 0, height, wanted);
    for (int c = 0; c < 3; c++) a->channels[c] = mine[c] / wanted[c];
    const double mean = luminance(wanted);
    a->luminance = luminance(mine) / mean;
    uint32_t count = 0;
    for (uint32_t y = 0; y < height; y += BLOCK)
        for (uint32_t x = 0; x < width; x += BLOCK) {
            const uint32_t x1 = x + BLOCK < width ? x + BLOCK : width,
                           y1 = y + BLOCK < height ? y + BLOCK : height;
            double b[3], t[3];
            mean_of(ours, x, x1, y, y1, b);
            mean_of(theirs, x, x1, y, y1, t);
            blocks += fabs(luminance(b) - luminance(t));
            count++;
        }
    a->blocks = blocks / count / mean;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            double d[3];
            for (int c = 0; c < 3; c++) d[c] = (double)at(ours, x, y)[c] - (double)at(theirs, x, y)[c];
            squares += luminance(d) * luminance(d);
        }
    a->error = sqrt(squares / ((double)width * height)) / mean;
    return true;
}
