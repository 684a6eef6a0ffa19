// SPDX-License-Identifier: MIT
// Gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002).
//
// At each point of the integer lattice stands a gradient, one of the twelve directions to the edges' middles
// of a cube, chosen by a permutation of 256 numbers that the three coordinates go through in turn. The noise
// is what the eight gradients around p, each a linear function that is 0 at its own lattice point, say at p,
// blended with the weight 6t⁵ − 15t⁴ + 10t³ along each axis: its first and second derivatives vanish at both
// ends, so neither shading nor bumps show the lattice.
//
// One octave has its power below one cycle a unit. Octave i of the sums is 1.99ⁱ times finer: not 2, so that
// the lattices, where all octaves are 0, do not coincide. An octave whose cells are less than two footprints
// wide cannot be shown by the pixels: with a footprint of length l, the first −1 − log2 l octaves are kept,
// the next is faded in over the fraction (pbrt-v4's rule, so that scenes made for it look the same; so are
// the four directions that fill up the table of sixteen).
#include "noise.h"

#include "color.h"

#include <math.h>

// Perlin's permutation, from his reference implementation.
static const uint8_t permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,
    69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,
    94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136,
    171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122,
    60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161,
    1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124, 123, 5,   202, 38,  147, 118, 126,
    255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189, 28,  42,  223, 183, 170, 213,
    119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,   129, 22,  39,  253,
    19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,  242, 193,
    238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,
    222, 114, 67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

static uint32_t permuted(uint32_t i) { return permutation[i & 255]; }

// The gradient that `h` chooses, times the offset.
static double gradient(uint32_t h, double x, double y, double z) {
    h &= 15;
    const double u = h < 8 || h == 12 || h == 13 ? x : y;
    const double v = h < 4 || h == 12 || h == 13 ? y : z;
    return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

static double weight(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

static double lerp(double t, double a, double b) { return (1 - t) * a + t * b; }

// The cell of x, modulo 256, and the place within it.
static uint32_t cell(double x, double *offset) {
    const double floored = floor(x);
    *offset = x - floored;
    return (uint32_t)(floored - 256 * floor(floored / 256));
}

double sagi_noise(sag_vec3 p) {
    if (!(isfinite(p.x) && isfinite(p.y) && isfinite(p.z))) return 0;
    double x, y, z;
    const uint32_t i = cell(p.x, &x), j = cell(p.y, &y), k = cell(p.z, &z);
    const uint32_t a = permuted(i) + j, b = permuted(i + 1) + j;
    const uint32_t aa = permuted(a) + k, ab = permuted(a + 1) + k;
    const uint32_t ba = permuted(b) + k, bb = permuted(b + 1) + k;
    const double u = weight(x), v = weight(y);
    const double x00 = lerp(u, gradient(permuted(aa), x, y, z), gradient(permuted(ba), x - 1, y, z));
    const double x10 = lerp(u, gradient(permuted(ab), x, y - 1, z), gradient(permuted(bb), x - 1, y - 1, z));
    const double x01 =
        lerp(u, gradient(permuted(aa + 1), x, y, z - 1), gradient(permuted(ba + 1), x - 1, y, z - 1));
    const double x11 =
        lerp(u, gradient(permuted(ab + 1), x, y - 1, z - 1), gradient(permuted(bb + 1), x - 1, y - 1, z - 1));
    return lerp(weight(z), lerp(v, x00, x10), lerp(v, x01, x11));
}

double sagi_noise_2d(double x, double y) { return sagi_noise((sag_vec3){x, y, 0.5}); }

// How many octaves the footprint leaves.
static double octaves_left(sag_vec3 dpdx, sag_vec3 dpdy, int octaves) {
    const double square = fmax(sag_dot(dpdx, dpdx), sag_dot(dpdy, dpdy));
    return sagi_clamp(-1 - sagi_log2(square) / 2, 0, octaves);
}

static double smooth_step(double x, double low, double high) {
    const double t = sagi_clamp((x - low) / (high - low), 0, 1);
    return t * t * (3 - 2 * t);
}

#define STEP 1.99

double sagi_noise_fbm(sag_vec3 p, sag_vec3 dpdx, sag_vec3 dpdy, double omega, int octaves) {
    const double n = octaves_left(dpdx, dpdy, octaves), whole = floor(n);
    double sum = 0, frequency = 1, amplitude = 1;
    for (int i = 0; i < (int)whole; i++, frequency *= STEP, amplitude *= omega)
        sum += amplitude * sagi_noise(sag_scale(p, frequency));
    const double fade = smooth_step(n - whole, 0.3, 0.7);
    if (fade > 0) sum += amplitude * fade * sagi_noise(sag_scale(p, frequency));
    return sum;
}

// What pbrt-v4 takes for the mean of |noise|.
#define MEAN_SIZE 0.2

double sagi_noise_turbulence(sag_vec3 p, sag_vec3 dpdx, sag_vec3 dpdy, double omega, int octaves) {
    const double n = octaves_left(dpdx, dpdy, octaves), whole = floor(n);
    double sum = 0, frequency = 1, amplitude = 1;
    for (int i = 0; i < (int)whole; i++, frequency *= STEP, amplitude *= omega)
        sum += amplitude * fabs(sagi_noise(sag_scale(p, frequency)));
    // As pbrt-v4: the octave that fades is there beside the mean of all that are left out, itself included.
    const double fade = smooth_step(n - whole, 0.3, 0.7);
    sum += amplitude * lerp(fade, MEAN_SIZE, fabs(sagi_noise(sag_scale(p, frequency))));
    for (int i = (int)whole; i < octaves; i++, amplitude *= omega) sum += amplitude * MEAN_SIZE;
    return sum;
}
