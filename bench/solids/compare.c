// SPDX-License-Identifier: MIT
// Two depth images of one scene: POV-Ray's with 16 bits (0 far or nothing, 1 near), Sagitta's with the
// distance itself, brought to the same scale. Where the depth jumps from a pixel to its neighbour, or a
// neighbour sees nothing, a rounding decides which of two surfaces the pixel's ray meets: these silhouettes
// are counted and passed over.
#include "solids.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

typedef struct depths {
    unsigned width, height;
    float *values; // row by row from the top; 0: nothing
} depths;

static bool start(depths *d, unsigned width, unsigned height) {
    if (width == 0 || height == 0 || width > 16384 || height > 16384) return false;
    d->width = width, d->height = height;
    return (d->values = malloc((size_t)width * height * sizeof *d->values)) != NULL;
}

// The next number of a header in which lines may be comments; 0 where there is none.
static unsigned header_number(FILE *file) {
    unsigned number = 0;
    char comment[2];
    while (fscanf(file, " %1[#]", comment) == 1) // NOLINT(cert-err34-c)
        for (int c = fgetc(file); c != '\n' && c != EOF;) c = fgetc(file);
    return fscanf(file, "%u", &number) == 1 ? number : 0; // NOLINT(cert-err34-c)
}

// PPM with 16 bits, the larger byte first.
static bool read_ppm(depths *d, const char *path) {
    FILE *file = fopen(path, "rb");
    bool good = file != NULL && fgetc(file) == 'P' && fgetc(file) == '6';
    const unsigned width = good ? header_number(file) : 0, height = good ? header_number(file) : 0;
    good = good && header_number(file) == 65535 && fgetc(file) != EOF && start(d, width, height);
    for (size_t i = 0; good && i < (size_t)width * height; i++) {
        uint8_t bytes[6];
        good = fread(bytes, 1, 6, file) == 6;
        d->values[i] = (float)(bytes[0] << 8 | bytes[1]) / 65535;
    }
    if (file != NULL) fclose(file);
    return good;
}

// PFM with three equal numbers a pixel, little-endian, the bottom row first.
static bool read_pfm(depths *d, const char *path, const view *v) {
    FILE *file = fopen(path, "rb");
    unsigned width = 0, height = 0;
    double scale = 0;
    bool good = file != NULL && fscanf(file, "PF %u %u %lf", &width, &height, &scale) == 3 && scale < 0 &&
                fgetc(file) != EOF && start(d, width, height);
    for (size_t i = 0; good && i < (size_t)width * height; i++) {
        float colour[3];
        good = fread(colour, sizeof *colour, 3, file) == 3;
        const double distance = (double)colour[0];
        d->values[(height - 1 - i / width) * (size_t)width + i % width] =
            distance > 0 ? (float)((v->far - distance) / (v->far - v->near)) : 0;
    }
    if (file != NULL) fclose(file);
    return good;
}

#define LIMIT (2.0F / 255)

// Whether the depth jumps between this pixel and one of the eight about it.
static bool at_silhouette(const depths *d, unsigned x, unsigned y) {
    const float here = d->values[(size_t)y * d->width + x];
    for (unsigned j = y > 0 ? y - 1 : 0; j <= y + 1 && j < d->height; j++)
        for (unsigned i = x > 0 ? x - 1 : 0; i <= x + 1 && i < d->width; i++) {
            const float there = d->values[(size_t)j * d->width + i];
            if ((here > 0) != (there > 0) || fabsf(here - there) > LIMIT) return true;
        }
    return false;
}

static void compare(const depths *a, const depths *b, likeness *l) {
    size_t both = 0;
    double sum = 0;
    *l = (likeness){.pixels = (size_t)a->width * a->height};
    for (unsigned y = 0; y < a->height; y++)
        for (unsigned x = 0; x < a->width; x++) {
            const size_t i = (size_t)y * a->width + x;
            const float difference = fabsf(a->values[i] - b->values[i]);
            const bool differs = !(difference <= LIMIT),
                       edge = at_silhouette(a, x, y) || at_silhouette(b, x, y);
            l->met += b->values[i] > 0;
            l->silhouettes += edge;
            l->differing_anywhere += differs;
            l->differing += differs && !edge;
            if (!edge && a->values[i] > 0 && b->values[i] > 0) sum += (double)difference * 65535, both++;
        }
    l->mean = both > 0 ? sum / (double)both : 0;
}

bool compare_depths(const scene_kind *kind, const char *of_povray, const char *of_sagitta, likeness *l) {
    depths a = {0}, b = {0};
    const bool good = read_ppm(&a, of_povray) && read_pfm(&b, of_sagitta, &kind->view) &&
                      a.width == b.width && a.height == b.height;
    if (good) compare(&a, &b, l);
    if (!good) fprintf(stderr, "bench-solids: the pictures of %s cannot be compared\n", kind->name);
    free(a.values);
    free(b.values);
    return good;
}
