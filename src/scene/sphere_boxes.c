// SPDX-License-Identifier: MIT
// The spheres of a set without a transform on their way to the tree: the two rounds of structure.c for many
// at a time, as mesh_boxes.c has them for triangles.
#include "scene/scene.h"
#include "shapes/spheres.h"

// The centre and the radius; false when the sphere is not there (sagi_spheres_get).
static inline bool examine(const sag_spheres *set, uint32_t i, sagi_d4 *at) {
    *at = sagi_spheres_load(set, i);
    const double most = SAG_MAX_COORDINATE;
    return (*at)[3] > 0 && (*at)[3] <= most && fabs((*at)[0]) <= most && fabs((*at)[1]) <= most &&
           fabs((*at)[2]) <= most;
}

static inline sagi_d4 radius_of(sagi_d4 at) { return sagi_d4_fill(at[3]); }

// Rounding a bound outward keeps the order of bounds, so it is done once at the end.
void sagi_sphere_survey(const sag_spheres *set, uint32_t first, uint32_t count, sagi_survey *survey) {
    sagi_d4 lo = sagi_d4_fill(INFINITY), hi = sagi_d4_fill(-INFINITY), at;
    uint64_t good = 0;
    for (uint32_t i = first; i < first + count; i++) {
        if (!examine(set, i, &at)) continue;
        good++;
        lo = sagi_d4_min(at - radius_of(at), lo), hi = sagi_d4_max(at + radius_of(at), hi);
    }
    survey->good += good, survey->not_finite += count - good;
    if (good == 0) return;
    const sag_box3 box = {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    survey->bounds = sag_box3_union(survey->bounds, sagi_box3_round_out(box, 1));
}

// (x − origin)·scale: x, centre ∓ radius, is rounded once, the difference again, each by 2⁻⁵³ of itself at
// most; the conversion to float by half a step between floats, or anything below 2⁻¹²⁶. A step outward is
// |f| 2⁻²³ + 2⁻¹²⁶; so rounded it is at least one step.
static inline sagi_f4 place(sagi_d4 x, sagi_d4 origin, sagi_d4 scale, double outward) {
    sagi_d4 out = sagi_d4_fill(outward);
    sagi_d4 d = (x + out * sagi_d4_abs(x) - origin) * scale;
    sagi_f4 f = sagi_d4_to_f4(d + out * sagi_d4_abs(d));
    sagi_f4 step = (sagi_f4)((sagi_w4)f & INT32_MAX) * 0x1p-23F + 0x1p-126F;
    return outward < 0 ? f - step : f + step;
}

sagi_bvh_primitive *sagi_sphere_boxes(const sagi_world *world, uint32_t geometry, uint32_t first,
                                      uint32_t count, sagi_bvh_primitive *out) {
    const sag_spheres *set = world->items[geometry].shape;
    const sagi_d4 origin = {world->origin.x, world->origin.y, world->origin.z, 0};
    const sagi_d4 scale = sagi_d4_fill(world->scale);
    sagi_d4 at;
    for (uint32_t i = first; i < first + count; i++) {
        if (!examine(set, i, &at)) continue;
        sagi_f4 lo = place(at - radius_of(at), origin, scale, -0x1p-52);
        sagi_f4 hi = place(at + radius_of(at), origin, scale, 0x1p-52);
        *out++ = (sagi_bvh_primitive){
            .lo = {lo[0], lo[1], lo[2]}, .geometry = geometry, .hi = {hi[0], hi[1], hi[2]}, .primitive = i};
    }
    return out;
}
