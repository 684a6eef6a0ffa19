// SPDX-License-Identifier: MIT
// The spheres of a set without a transform on their way to the tree: the two rounds of structure.c for many
// at a time, as mesh_boxes.c has them for triangles.
#include "scene/scene.h"
#include "shapes/spheres.h"

// Whether the sphere is there (sagi_spheres_get). Numbers stay scalars: put together as a vector and taken
// apart again they would go through memory, and without AVX wait there.
static inline bool is_good(const sagi_ball *b) {
    const double most = SAG_MAX_COORDINATE;
    return b->radius > 0 && b->radius <= most && fabs(b->center[0]) <= most && fabs(b->center[1]) <= most &&
           fabs(b->center[2]) <= most;
}

// Rounding a bound outward keeps the order of bounds, so it is done once at the end.
void sagi_sphere_survey(const sag_spheres *set, uint32_t first, uint32_t count, sagi_survey *survey) {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    uint64_t good = 0;
    for (uint32_t i = first; i < first + count; i++) {
        const sagi_ball b = sagi_spheres_ball(set, i);
        if (!is_good(&b)) continue;
        good++;
        for (int k = 0; k < 3; k++) {
            double below = b.center[k] - b.radius, above = b.center[k] + b.radius;
            lo[k] = below < lo[k] ? below : lo[k], hi[k] = above > hi[k] ? above : hi[k];
        }
    }
    survey->good += good, survey->not_finite += count - good;
    if (good == 0) return;
    const sag_box3 box = {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    survey->bounds = sag_box3_union(survey->bounds, sagi_box3_round_out(box, 1));
}

// (x − origin)·scale: x, centre ∓ radius, is rounded once, the difference again, each by 2⁻⁵³ of itself at
// most; the conversion to float by half a step between floats, or anything below 2⁻¹²⁶. A step outward is
// |f| 2⁻²³ + 2⁻¹²⁶; so rounded it is at least one step.
static inline float place(double x, double origin, double scale, double outward) {
    double d = (x + outward * fabs(x) - origin) * scale;
    float f = (float)(d + outward * fabs(d)), step = fabsf(f) * 0x1p-23F + 0x1p-126F;
    return outward < 0 ? f - step : f + step;
}

sagi_bvh_primitive *sagi_sphere_boxes(const sagi_world *world, uint32_t geometry, uint32_t first,
                                      uint32_t count, sagi_bvh_primitive *out) {
    const sag_spheres *set = world->items[geometry].shape;
    const double origin[3] = {world->origin.x, world->origin.y, world->origin.z}, scale = world->scale;
    for (uint32_t i = first; i < first + count; i++) {
        const sagi_ball b = sagi_spheres_ball(set, i);
        if (!is_good(&b)) continue;
        sagi_bvh_primitive p = {.geometry = geometry, .primitive = i};
        for (int k = 0; k < 3; k++) {
            p.lo[k] = place(b.center[k] - b.radius, origin[k], scale, -0x1p-52);
            p.hi[k] = place(b.center[k] + b.radius, origin[k], scale, 0x1p-52);
        }
        *out++ = p;
    }
    return out;
}
