// SPDX-License-Identifier: MIT
// Coordinates of directions d (x, y along the window's edges, z outward, z > 0):
//     u = ½ + atan2(x, z)/π,   v = ½ + atan2(y, z)/π.
// An edge along y is seen at one x/z all along, so from any point the window is a rectangle [low, high] in
// (u, v). With dω = cos³θ dA on the plane z = 1 and dA = sec²α sec²β dα dβ,
//     dω = π² (1 − x²)(1 − y²)/z du dv
// for a unit d. The picture is brought to these coordinates once; a direction is drawn from the part of it
// that is within the rectangle, in proportion to brightness times dω/(du dv) (window.c).
#include "portal.h"

#include "math/elementary.h"
#include "warp.h"

#define CONSTANT_SIZE 64u // cells a side to weigh a light that is the same everywhere

bool sagi_portal_is_rectangle(const sag_vec3 p[4]) {
    sag_vec3 edge[4];
    for (int i = 0; i < 4; i++) {
        edge[i] = sag_sub(p[(i + 1) % 4], p[i]);
        if (!(sag_dot(edge[i], edge[i]) > 0) || !sag_is_finite(edge[i])) return false;
        edge[i] = sag_normalize(edge[i]);
    }
    bool right = fabs(sag_dot(edge[0], edge[2]) + 1) <= 1e-3 && fabs(sag_dot(edge[1], edge[3]) + 1) <= 1e-3;
    for (int i = 0; i < 4; i++) right &= fabs(sag_dot(edge[i], edge[(i + 1) % 4])) <= 1e-3;
    return right;
}

// The direction of a point, and dω/(du dv) there.
static sag_vec3 direction_of(const sagi_portal *p, sag_vec2 uv, double *stretch) {
    const double x = sagi_tan((uv.x - 0.5) * SAGI_RENDER_PI), y = sagi_tan((uv.y - 0.5) * SAGI_RENDER_PI);
    const sag_vec3 d = sag_normalize(sag_vec3_make(x, y, 1));
    *stretch = SAGI_RENDER_PI * SAGI_RENDER_PI * (1 - d.x * d.x) * (1 - d.y * d.y) / d.z;
    return sag_add(sag_add(sag_scale(p->x, d.x), sag_scale(p->y, d.y)), sag_scale(p->z, d.z));
}

// The point of a direction of any length; false where it does not look outward.
static bool point_of(const sagi_portal *p, sag_vec3 d, sag_vec2 *uv, double *stretch) {
    const double x = sag_dot(d, p->x), y = sag_dot(d, p->y), z = sag_dot(d, p->z);
    if (!(z > 0)) return false;
    *uv = (sag_vec2){sagi_clamp(0.5 + sagi_atan2(x, z) * SAGI_INV_PI, 0, 1),
                     sagi_clamp(0.5 + sagi_atan2(y, z) * SAGI_INV_PI, 0, 1)};
    if (stretch) *stretch = SAGI_RENDER_PI * SAGI_RENDER_PI * (1 - x * x) * (1 - y * y) / z;
    return true;
}

static bool window_from(const sagi_portal *p, sag_vec3 from, sagi_window *window) {
    sag_vec2 a, b;
    if (!point_of(p, sag_sub(p->low, from), &a, NULL) || !point_of(p, sag_sub(p->high, from), &b, NULL))
        return false;
    *window = (sagi_window){{fmin(a.x, b.x), fmin(a.y, b.y)}, {fmax(a.x, b.x), fmax(a.y, b.y)}};
    return true;
}

// The texel at x, y of an equal-area picture; beyond an edge the sphere goes on at the mirrored place of that
// edge.
static sag_rgb equal_area_texel(const sag_image *image, int64_t x, int64_t y) {
    const int64_t n = image->width;
    if (x < 0 || x >= n) {
        x = x < 0 ? -1 - x : 2 * n - 1 - x;
        y = n - 1 - y;
    }
    if (y < 0 || y >= n) {
        y = y < 0 ? -1 - y : 2 * n - 1 - y;
        x = n - 1 - x;
    }
    const float *p = image->pixels + ((size_t)y * image->width + (size_t)x) * image->channels;
    return image->channels < 3 ? sagi_rgb_grey(p[0]) : sagi_rgb(p[0], p[1], p[2]);
}

static sag_rgb look_up(const sag_image *image, sag_vec3 d) {
    const sag_vec2 p = sagi_equal_area_from_sphere(d);
    const double x = p.x * image->width - 0.5, y = p.y * image->height - 0.5, dx = x - floor(x),
                 dy = y - floor(y);
    const int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    const sag_rgb above = sagi_rgb_add(sagi_rgb_scale(equal_area_texel(image, i, j), 1 - dx),
                                       sagi_rgb_scale(equal_area_texel(image, i + 1, j), dx));
    const sag_rgb below = sagi_rgb_add(sagi_rgb_scale(equal_area_texel(image, i, j + 1), 1 - dx),
                                       sagi_rgb_scale(equal_area_texel(image, i + 1, j + 1), dx));
    return sagi_rgb_add(sagi_rgb_scale(above, 1 - dy), sagi_rgb_scale(below, dy));
}

bool sagi_portal_init(sagi_portal *portal, const sag_context *context, const sag_vec3 corners[4],
                      const sag_image *image, const sag_affine *from_world) {
    *portal = (sagi_portal){.low = corners[0], .high = corners[2]};
    portal->x = sag_normalize(sag_sub(corners[3], corners[0]));
    portal->y = sag_normalize(sag_sub(corners[1], corners[0]));
    portal->z = sag_normalize(sag_cross(portal->x, portal->y));
    const uint32_t size = image->pixels ? image->width : CONSTANT_SIZE;
    const size_t count = (size_t)size * size;
    if (image->pixels) portal->texels = sag_allocate(context, count * sizeof *portal->texels);
    portal->size = portal->texels ? size : 0;
    double *weights = sag_allocate(context, count * sizeof *weights);
    bool made = weights && (portal->texels || !image->pixels);
    for (size_t i = 0; i < count && made; i++) {
        double stretch;
        const sag_vec2 at = {((double)(i % size) + 0.5) / size, ((double)(i / size) + 0.5) / size};
        const sag_vec3 d = direction_of(portal, at, &stretch);
        weights[i] = stretch;
        if (!portal->texels) continue;
        portal->texels[i] = look_up(image, sag_normalize(sag_affine_vector(from_world, d)));
        const double brightness = sagi_rgb_mean(portal->texels[i]);
        weights[i] *= brightness > 0 && isfinite(brightness) ? brightness : 0;
    }
    made = made && sagi_window_table_init(&portal->table, context, weights, size, size);
    sag_release(context, weights, count * sizeof *weights);
    return made;
}

void sagi_portal_clear(sagi_portal *portal, const sag_context *context) {
    const size_t count = (size_t)portal->size * portal->size;
    if (portal->texels) sag_release(context, portal->texels, count * sizeof *portal->texels);
    sagi_window_table_clear(&portal->table, context);
    *portal = (sagi_portal){.size = 0};
}

bool sagi_portal_look(const sagi_portal *p, sag_vec3 from, sag_vec3 wi, sag_rgb *texel) {
    sag_vec2 uv;
    sagi_window w;
    if (!point_of(p, wi, &uv, NULL) || !window_from(p, from, &w)) return false;
    if (!(uv.x >= w.low.x && uv.x <= w.high.x && uv.y >= w.low.y && uv.y <= w.high.y)) return false;
    *texel = (sag_rgb){1, 1, 1};
    if (p->size == 0) return true;
    const double last = p->size - 1.0;
    *texel = p->texels[(size_t)fmin(uv.y * p->size, last) * p->size + (size_t)fmin(uv.x * p->size, last)];
    return true;
}

bool sagi_portal_sample(const sagi_portal *p, sag_vec3 from, sag_vec2 u, sag_vec3 *wi) {
    sag_vec2 uv;
    sagi_window window;
    double stretch;
    if (!window_from(p, from, &window) || !sagi_window_sample(&p->table, &window, u, &uv)) return false;
    *wi = direction_of(p, uv, &stretch);
    return stretch > 0;
}

double sagi_portal_pdf(const sagi_portal *p, sag_vec3 from, sag_vec3 wi) {
    sag_vec2 uv;
    sagi_window window;
    double stretch;
    if (!point_of(p, wi, &uv, &stretch) || !window_from(p, from, &window) || !(stretch > 0)) return 0;
    return sagi_window_pdf(&p->table, &window, uv) / stretch;
}
