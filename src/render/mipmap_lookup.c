// SPDX-License-Identifier: MIT
// Looking up a mipmap.
//
// The footprint is how far (s, t) moves from one pixel to the next, in x and in y of the picture: two sides
// of a parallelogram. All filters but EWA take the largest change of either coordinate, doubled, for the side
// of a square, and the finest level whose texels are at least half as wide: floor(log2(side × texels)), so
// that neighbouring pixels' squares overlap. (pbrt-v4's rule.) Blurred where the footprint is long and
// narrow, never aliased.
//
// EWA (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989) takes the footprint for an
// ellipse with the two changes as half axes, of the level at which the shorter one is 1 to 2 texels long, and
// the texels within, each widened by one for its own reconstruction, with weights exp(−2 r²) − exp(−2). An
// ellipse much longer than wide is widened, so that the count of texels has a bound.
//
// Texture coordinates have t upward, pictures have rows from the top.
#include "mipmap.h"

#include "color.h"

static int64_t repeated(int64_t i, int64_t n) {
    if (i >= 0 && i < n) return i;
    i %= n;
    return i < 0 ? i + n : i;
}

// Across an edge of the octahedral square lies the point mirrored along that edge (Clarberg 2008).
static void wrap_octahedral(int64_t *x, int64_t *y, int64_t width, int64_t height) {
    *x = repeated(*x, 2 * width);
    *y = repeated(*y, 2 * height);
    if (*x >= width) *x = 2 * width - 1 - *x, *y = repeated(height - 1 - *y, 2 * height);
    if (*y >= height) *y = 2 * height - 1 - *y, *x = width - 1 - *x;
}

// Brings the texel into the level. False when there is none.
static bool wrap_texel(int64_t *x, int64_t *y, const sagi_level *level, sag_wrap wrap) {
    const int64_t width = level->width, height = level->height;
    if ((uint64_t)*x < (uint64_t)width && (uint64_t)*y < (uint64_t)height) return true;
    switch (wrap) {
    case SAG_WRAP_REPEAT: *x = repeated(*x, width), *y = repeated(*y, height); return true;
    case SAG_WRAP_CLAMP:
        *x = *x < 0 ? 0 : *x < width ? *x : width - 1;
        *y = *y < 0 ? 0 : *y < height ? *y : height - 1;
        return true;
    case SAG_WRAP_OCTAHEDRAL: wrap_octahedral(x, y, width, height); return true;
    case SAG_WRAP_BLACK: break;
    }
    return false;
}

static sagi_texel three(float r, float g, float b) { return (sagi_texel){r, g, b, (r + g + b) / 3}; }

// The texel whose numbers start at `i`.
static sagi_texel fetch(const sagi_mipmap *m, size_t i) {
    switch (m->kind) {
    case SAGI_TEXEL_BYTE: {
        const uint8_t *p = (const uint8_t *)m->texels + i;
        const float r = m->decode[p[0]];
        if (m->channels == 1) return (sagi_texel){r, r, r, r};
        if (m->channels == 3) return three(r, m->decode[p[1]], m->decode[p[2]]);
        return (sagi_texel){r, m->decode[p[1]], m->decode[p[2]], m->decode[p[3]]};
    }
    case SAGI_TEXEL_HALF: {
        const uint16_t *p = (const uint16_t *)m->texels + i;
        const float r = sagi_half_to_float(p[0]);
        if (m->channels == 1) return (sagi_texel){r, r, r, r};
        const float g = sagi_half_to_float(p[1]), b = sagi_half_to_float(p[2]);
        return m->channels == 3 ? three(r, g, b) : (sagi_texel){r, g, b, sagi_half_to_float(p[3])};
    }
    case SAGI_TEXEL_FLOAT: {
        const float *p = (const float *)m->texels + i;
        if (m->channels == 1) return (sagi_texel){p[0], p[0], p[0], p[0]};
        return m->channels == 3 ? three(p[0], p[1], p[2]) : (sagi_texel){p[0], p[1], p[2], p[3]};
    }
    }
    return (sagi_texel){0};
}

static sagi_texel texel_of(const sagi_mipmap *m, const sagi_level *level, int64_t x, int64_t y,
                           sag_wrap wrap) {
    if (!wrap_texel(&x, &y, level, wrap)) return (sagi_texel){0};
    return fetch(m, level->first + ((size_t)y * level->width + (size_t)x) * m->channels);
}

sagi_texel sagi_mipmap_texel(const sagi_mipmap *mipmap, uint32_t level, int64_t x, int64_t y, sag_wrap wrap) {
    return texel_of(mipmap, &mipmap->levels[level], x, y, wrap);
}

// The coordinates as they are looked up: t downward, small enough for whole numbers.
typedef struct place {
    double s, t;
} place;

static place place_of(const sagi_spot_2d *at, sag_wrap wrap) {
    if (wrap == SAG_WRAP_REPEAT) return (place){at->s - floor(at->s), 1 - (at->t - floor(at->t))};
    return (place){sagi_clamp(at->s, -1e6, 1e6), 1 - sagi_clamp(at->t, -1e6, 1e6)};
}

// The four texels from (i, j) on, by rows.
static void four_texels(const sagi_mipmap *m, const sagi_level *level, int64_t i, int64_t j, sag_wrap wrap,
                        sagi_texel four[4]) {
    if (i >= 0 && j >= 0 && i + 1 < level->width && j + 1 < level->height) {
        const size_t at = level->first + ((size_t)j * level->width + (size_t)i) * m->channels;
        const size_t below = at + (size_t)level->width * m->channels;
        four[0] = fetch(m, at), four[1] = fetch(m, at + m->channels);
        four[2] = fetch(m, below), four[3] = fetch(m, below + m->channels);
        return;
    }
    for (int k = 0; k < 4; k++) four[k] = texel_of(m, level, i + (k & 1), j + (k >> 1), wrap);
}

static sagi_texel bilinear(const sagi_mipmap *m, uint32_t l, place at, sag_wrap wrap) {
    const sagi_level *level = &m->levels[l];
    const double x = at.s * level->width - 0.5, y = at.t * level->height - 0.5;
    const double x0 = floor(x), y0 = floor(y);
    const float dx = (float)(x - x0), dy = (float)(y - y0);
    sagi_texel four[4];
    four_texels(m, level, (int64_t)x0, (int64_t)y0, wrap, four);
    const sagi_texel top = four[0] * (1 - dx) + four[1] * dx, bottom = four[2] * (1 - dx) + four[3] * dx;
    return top * (1 - dy) + bottom * dy;
}

static sagi_texel point(const sagi_mipmap *m, uint32_t l, place at, sag_wrap wrap) {
    const sagi_level *level = &m->levels[l];
    return texel_of(m, level, (int64_t)floor(at.s * level->width), (int64_t)floor(at.t * level->height),
                    wrap);
}

static double wide(const sagi_mipmap *m) {
    return m->levels[0].width > m->levels[0].height ? m->levels[0].width : m->levels[0].height;
}

static sagi_texel by_square(const sagi_mipmap *m, const sagi_lookup *how, const sagi_spot_2d *at) {
    const place p = place_of(at, how->wrap);
    const double side =
        2 * fmax(fmax(fabs(at->dsdx), fabs(at->dsdy)), fmax(fabs(at->dtdx), fabs(at->dtdy))) * wide(m);
    const uint32_t top = m->level_count - 1;
    double level = 0;
    if (side >= 2) level = sagi_log2(side);
    if (level >= top) return fetch(m, m->levels[top].first);
    const uint32_t l = (uint32_t)level;
    if (how->filter == SAG_LOOKUP_POINT) return point(m, l, p, how->wrap);
    const sagi_texel fine = bilinear(m, l, p, how->wrap);
    if (how->filter == SAG_LOOKUP_BILINEAR || l == 0) return fine;
    const float part = (float)(level - l);
    return fine * (1 - part) + bilinear(m, l + 1, p, how->wrap) * part;
}

typedef struct axis {
    double s, t;
} axis;

// exp(−2x) − exp(−2) for x = r² in [0, 1], to within 5e-6: (1 − x) times the polynomial that agrees with the
// quotient at the six Chebyshev nodes, so that it is 0 at the rim.
static float gaussian(float x) {
    const float low = 0.86465999F - 1.1349939F * x, middle = 0.86060244F - 0.45061317F * x;
    const float high = 0.16036308F - 0.029351514F * x, x2 = x * x;
    return (1 - x) * (low + x2 * (middle + x2 * high));
}

static sagi_texel ellipse(const sagi_mipmap *m, uint32_t l, place at, axis major, axis minor, sag_wrap wrap) {
    const uint32_t top = m->level_count - 1;
    if (l > top) return fetch(m, m->levels[top].first);
    const sagi_level *level = &m->levels[l];
    const double w = level->width, h = level->height;
    const double s = at.s * w - 0.5, t = at.t * h - 0.5;
    major.s *= w, major.t *= h, minor.s *= w, minor.t *= h;
    // a x² + b x y + c y² < 1 within.
    double a = major.t * major.t + minor.t * minor.t + 1;
    double b = -2 * (major.s * major.t + minor.s * minor.t);
    double c = major.s * major.s + minor.s * minor.s + 1;
    const double inverse = 1 / (a * c - b * b / 4);
    a *= inverse, b *= inverse, c *= inverse;
    const double det = 4 * a * c - b * b, half_width = 2 * sqrt(c / det), half_height = 2 * sqrt(a / det);
    const int64_t x0 = (int64_t)ceil(s - half_width), x1 = (int64_t)floor(s + half_width);
    const int64_t y0 = (int64_t)ceil(t - half_height), y1 = (int64_t)floor(t + half_height);
    sagi_texel sum = {0};
    float weights = 0;
    for (int64_t y = y0; y <= y1; y++) {
        const double dy = (double)y - t;
        for (int64_t x = x0; x <= x1; x++) {
            const double dx = (double)x - s, r2 = a * dx * dx + b * dx * dy + c * dy * dy;
            if (!(r2 < 1)) continue;
            const float weight = gaussian((float)r2);
            sum += texel_of(m, level, x, y, wrap) * weight;
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : bilinear(m, l, at, wrap);
}

static sagi_texel by_ellipse(const sagi_mipmap *m, const sagi_lookup *how, const sagi_spot_2d *at) {
    const place p = place_of(at, how->wrap);
    axis major = {at->dsdx, at->dtdx}, minor = {at->dsdy, at->dtdy};
    double longer = sqrt(major.s * major.s + major.t * major.t);
    double shorter = sqrt(minor.s * minor.s + minor.t * minor.t);
    if (longer < shorter) {
        const axis swap_axis = major;
        const double swap_length = longer;
        major = minor, minor = swap_axis, longer = shorter, shorter = swap_length;
    }
    if (!(shorter > 0)) return bilinear(m, 0, p, how->wrap);
    if (shorter * how->max_anisotropy < longer) {
        const double scale = longer / (shorter * how->max_anisotropy);
        minor.s *= scale, minor.t *= scale, shorter *= scale;
    }
    const double level = fmax(0, sagi_log2(shorter * wide(m)));
    if (level >= m->level_count) return fetch(m, m->levels[m->level_count - 1].first);
    const uint32_t l = (uint32_t)level;
    const float part = (float)(level - l);
    const sagi_texel fine = ellipse(m, l, p, major, minor, how->wrap);
    if (!(part > 0)) return fine;
    return fine * (1 - part) + ellipse(m, l + 1, p, major, minor, how->wrap) * part;
}

sagi_texel sagi_mipmap_lookup(const sagi_mipmap *mipmap, const sagi_lookup *how, const sagi_spot_2d *at) {
    if (mipmap->level_count == 0 || !isfinite(at->s) || !isfinite(at->t)) return (sagi_texel){0};
    if (how->filter == SAG_LOOKUP_EWA) return by_ellipse(mipmap, how, at);
    return by_square(mipmap, how, at);
}
