// SPDX-License-Identifier: MIT
// Where to cut space. A cut between primitives leaves a long or large one in one box, however much of that is
// empty; a cut of space takes it apart: each side's box is only as large as the part of it there (Stich,
// Friedrich & Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009). A primitive that spans
// several bins is chopped at each plane between them.
//
// As with bins of centroids (split.c) all that is kept are minima, maxima and counts, so a range may be
// binned in pieces and merged in any order.
#include "bvh/spatial.h"

void sagi_spatial_bins_init(sagi_spatial_bins *bins, const sagi_float_box *box) {
    for (int axis = 0; axis < 3; axis++) {
        // Planes must be apart in float, or they cut nothing.
        float lo = box->lo[axis], step = (box->hi[axis] - lo) / SAGI_SPATIAL_BINS;
        bool apart = step > sagi_float_max(fabsf(lo), fabsf(box->hi[axis])) * 0x1p-20f && step > 0x1p-100f;
        bins->origin[axis] = lo;
        bins->step[axis] = apart ? step : 0;
        for (int b = 0; b < SAGI_SPATIAL_BINS; b++) {
            bins->box[axis][b] = sagi_float_box_empty();
            bins->begin[axis][b] = bins->end[axis][b] = 0;
        }
    }
}

static inline float plane_of(const sagi_spatial_bins *bins, int axis, int b) {
    return bins->origin[axis] + (float)b * bins->step[axis];
}

static inline int bin_of(const sagi_spatial_bins *bins, int axis, float x) {
    int b = (int)((x - bins->origin[axis]) / bins->step[axis]);
    return b < 0 ? 0 : b < SAGI_SPATIAL_BINS ? b : SAGI_SPATIAL_BINS - 1;
}

// A point of a primitive, no farther out than its box.
static inline void add_point(sagi_float_box *to, const sagi_bvh_primitive *p, const float point[3]) {
    for (int k = 0; k < 3; k++) {
        float x = sagi_float_min(sagi_float_max(point[k], p->lo[k]), p->hi[k]);
        to->lo[k] = sagi_float_min(to->lo[k], x), to->hi[k] = sagi_float_max(to->hi[k], x);
    }
}

// The points of an edge on the planes between bins, and where the primitive's box ends, to the bins on their
// sides.
static void add_edge(sagi_spatial_bins *bins, const sagi_bvh_primitive *p, const float a[3], const float b[3],
                     int axis, int first, int last) {
    float lo = sagi_float_min(a[axis], b[axis]), hi = sagi_float_max(a[axis], b[axis]);
    float inverse = 1 / (b[axis] - a[axis]);
    for (int plane = first; plane <= last + 1; plane++) {
        float x = plane == first      ? p->lo[axis]
                  : plane == last + 1 ? p->hi[axis]
                                      : plane_of(bins, axis, plane);
        if (!(x > lo && x < hi)) continue;
        float r = (x - a[axis]) * inverse, point[3];
        for (int k = 0; k < 3; k++) point[k] = a[k] + r * (b[k] - a[k]);
        if (plane > first) add_point(&bins->box[axis][plane - 1], p, point);
        if (plane <= last) add_point(&bins->box[axis][plane], p, point);
    }
}

// A triangle that spans bins first to last: each takes the box of the part in it. (In float: this only finds
// a plane. What is cut there in the end is cut by clip.c.)
static void add_triangle(sagi_spatial_bins *bins, const sagi_bvh_primitive *p, const float corner[3][3],
                         int axis, int first, int last) {
    for (int i = 0; i < 3; i++) {
        const float *a = corner[i], *b = corner[(i + 1) % 3];
        if (a[axis] >= p->lo[axis] && a[axis] <= p->hi[axis])
            add_point(&bins->box[axis][bin_of(bins, axis, a[axis])], p, a);
        add_edge(bins, p, a, b, axis, first, last);
    }
    bins->begin[axis][first]++, bins->end[axis][last]++;
}

static void add(sagi_spatial_bins *bins, const sagi_clipper *clipper, const sagi_bvh_primitive *p) {
    double corner[3][3];
    float rounded[3][3];
    bool cut = clipper->corners(clipper->user, p, corner);
    for (int i = 0; cut && i < 3; i++)
        for (int k = 0; k < 3; k++) rounded[i][k] = (float)corner[i][k];
    for (int axis = 0; axis < 3; axis++) {
        if (!(bins->step[axis] > 0)) continue;
        int first = bin_of(bins, axis, p->lo[axis]), last = bin_of(bins, axis, p->hi[axis]);
        if (first != last && cut) {
            add_triangle(bins, p, rounded, axis, first, last);
            continue;
        }
        if (first != last) first = bin_of(bins, axis, 0.5f * (p->lo[axis] + p->hi[axis]));
        sagi_float_box_extend(&bins->box[axis][first], p->lo, p->hi);
        bins->begin[axis][first]++, bins->end[axis][first]++;
    }
}

void sagi_spatial_bins_add(sagi_spatial_bins *bins, const sagi_clipper *clipper,
                           const sagi_bvh_primitive *primitives, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) add(bins, clipper, &primitives[i]);
}

void sagi_spatial_bins_merge(sagi_spatial_bins *bins, const sagi_spatial_bins *other) {
    for (int axis = 0; axis < 3; axis++)
        for (int b = 0; b < SAGI_SPATIAL_BINS; b++) {
            sagi_float_box_extend(&bins->box[axis][b], other->box[axis][b].lo, other->box[axis][b].hi);
            bins->begin[axis][b] += other->begin[axis][b], bins->end[axis][b] += other->end[axis][b];
        }
}

static void choose_on_axis(const sagi_spatial_bins *bins, int axis, uint32_t most, sagi_plane_split *best) {
    sagi_float_box right[SAGI_SPATIAL_BINS], box = sagi_float_box_empty();
    uint32_t right_count[SAGI_SPATIAL_BINS], count = 0;
    for (int b = SAGI_SPATIAL_BINS - 1; b > 0; b--) {
        sagi_float_box_extend(&box, bins->box[axis][b].lo, bins->box[axis][b].hi);
        right[b] = box, right_count[b] = count += bins->end[axis][b];
    }
    box = sagi_float_box_empty(), count = 0;
    for (int b = 1; b < SAGI_SPATIAL_BINS; b++) {
        sagi_float_box_extend(&box, bins->box[axis][b - 1].lo, bins->box[axis][b - 1].hi);
        count += bins->begin[axis][b - 1];
        if (count == 0 || right_count[b] == 0 || (uint64_t)count + right_count[b] > most) continue;
        float cost = (float)count * sagi_float_box_half_area(&box) +
                     (float)right_count[b] * sagi_float_box_half_area(&right[b]);
        if (cost < best->cost)
            *best =
                (sagi_plane_split){cost, axis, plane_of(bins, axis, b), count, right_count[b], box, right[b]};
    }
}

sagi_plane_split sagi_spatial_bins_choose(const sagi_spatial_bins *bins, uint32_t most) {
    sagi_plane_split best = {.cost = INFINITY};
    for (int axis = 0; axis < 3; axis++)
        if (bins->step[axis] > 0) choose_on_axis(bins, axis, most, &best);
    return best;
}
