// SPDX-License-Identifier: MIT
// Where to cut a range of primitives in two.
//
// The surface area heuristic: a random ray that meets a convex box meets a convex box inside it with
// probability area(inside)/area(outside). So a node split into L and R costs, but for a constant,
//     n_L A_L + n_R A_R,
// A being areas and the children taken for leaves (MacDonald & Booth, "Heuristics for Ray Tracing Using Space
// Subdivision", 1990). Splitting goes on down to single primitives, or to what had better be tested at once;
// which leaves are put together is decided afterwards, when everything above and below is known (forest.c).
// Only cuts between equal bins of the centroids' extent are tried (Wald, "On fast Construction of SAH-based
// Bounding Volume Hierarchies", 2007).
//
// Bins hold minima, maxima and counts. All three are the same in whatever order primitives are added, so a
// range may be binned in pieces by several threads and merged: the tree does not depend on their number.
#include "bvh/binary.h"
#include <string.h>

// What may be one leaf, at one price for any number of primitives, is cut only when the halves' areas add up
// to less than this share of the whole: when it is a longish thing, not a patch of a surface. (Cutting
// whenever it fits down to two makes trees 0.2 % cheaper, with 8 % more memory and more work for builders.)
#define LEAF_SHARE 0.85f

// A range's primitives stop being worth 16 bins when they are few.
static int bin_count(uint32_t count) { return count > 24 ? SAGI_MAX_BINS : 8; }

void sagi_bins_init(sagi_bins *bins, const sagi_range *range) {
    bins->count = bin_count(range->count);
    for (int axis = 0; axis < 3; axis++) {
        float lo = range->centroids.lo[axis], extent = range->centroids.hi[axis] - lo;
        // A hair less than bins/extent, so that the largest centroid falls in the last bin: the product is
        // at most bins (1 − 2⁻²⁰)(1 + 2⁻²⁴)³ < bins. An extent so small that the quotient overflows is none.
        float scale = (float)bins->count * (1 - 0x1p-20f) / extent;
        bins->origin[axis] = lo;
        bins->scale[axis] = extent > 0 && scale < 0x1p120f ? scale : 0;
    }
    bins->origin[3] = bins->scale[3] = 0;
    sagi_lanes none_lo = sagi_lanes_fill(INFINITY), none_hi = sagi_lanes_fill(-INFINITY);
    for (int axis = 0; axis < 3; axis++)
        for (int b = 0; b < bins->count; b++) {
            sagi_lanes_store(bins->lo[axis][b], none_lo), sagi_lanes_store(bins->hi[axis][b], none_hi);
            bins->held[axis][b] = 0;
        }
}

static inline void extend(sagi_bins *bins, int axis, int b, sagi_lanes lo, sagi_lanes hi, uint32_t count) {
    float *own_lo = bins->lo[axis][b], *own_hi = bins->hi[axis][b];
    sagi_lanes_store(own_lo, sagi_lanes_min(lo, sagi_lanes_load(own_lo)));
    sagi_lanes_store(own_hi, sagi_lanes_max(hi, sagi_lanes_load(own_hi)));
    bins->held[axis][b] += count;
}

void sagi_bins_add(sagi_bins *bins, const sagi_bvh_primitive *primitives, uint32_t count) {
    sagi_lanes origin = sagi_lanes_load(bins->origin), scale = sagi_lanes_load(bins->scale);
    for (uint32_t i = 0; i < count; i++) {
        sagi_lanes lo = sagi_lower(&primitives[i]), hi = sagi_upper(&primitives[i]);
        int bin[4];
        sagi_lanes_to_int(bin, sagi_lanes_mul(sagi_lanes_sub(sagi_lanes_add(lo, hi), origin), scale));
        for (int axis = 0; axis < 3; axis++) extend(bins, axis, bin[axis], lo, hi, 1);
    }
}

void sagi_bins_merge(sagi_bins *bins, const sagi_bins *other) {
    for (int axis = 0; axis < 3; axis++)
        for (int b = 0; b < bins->count; b++)
            extend(bins, axis, b, sagi_lanes_load(other->lo[axis][b]), sagi_lanes_load(other->hi[axis][b]),
                   other->held[axis][b]);
}

// Half the surface of the box, thickened a little: what is flat or straight is still cut where it is best.
static float area_of(const sagi_float_box *box, float thickness) {
    float x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1], z = box->hi[2] - box->lo[2];
    return x * y + y * z + z * x + thickness * (x + y + z);
}

// Boxes and counts of everything right of each cut, then from the left the cheapest cut.
static void choose_on_axis(const sagi_bins *bins, int axis, uint64_t most, float thickness, sagi_split *best,
                           float *best_cost) {
    sagi_float_box right[SAGI_MAX_BINS], box = sagi_float_box_empty();
    uint32_t right_count[SAGI_MAX_BINS], count = 0;
    for (int b = bins->count - 1; b > 0; b--) {
        sagi_float_box_extend(&box, bins->lo[axis][b], bins->hi[axis][b]);
        right[b] = box, right_count[b] = count += bins->held[axis][b];
    }
    box = sagi_float_box_empty(), count = 0;
    for (int b = 1; b < bins->count; b++) {
        sagi_float_box_extend(&box, bins->lo[axis][b - 1], bins->hi[axis][b - 1]);
        count += bins->held[axis][b - 1];
        if (count == 0 || right_count[b] == 0 || count > most || right_count[b] > most) continue;
        float cost =
            (float)count * area_of(&box, thickness) + (float)right_count[b] * area_of(&right[b], thickness);
        if (cost < *best_cost) {
            *best_cost = cost;
            *best = (sagi_split){.verdict = SAGI_SPLIT,
                                 .axis = axis,
                                 .bin = b,
                                 .origin = bins->origin[axis],
                                 .scale = bins->scale[axis],
                                 .left_count = count,
                                 .left = box,
                                 .right = right[b]};
        }
    }
}

sagi_split sagi_bins_choose(const sagi_bins *bins, const sagi_range *range) {
    sagi_split best = {.verdict = range->depth == SAGI_BVH_MAX_DEPTH ? SAGI_MAKE_LEAF : SAGI_HALVE};
    if (best.verdict == SAGI_MAKE_LEAF || (range->fits && range->count <= 2))
        return (sagi_split){.verdict = SAGI_MAKE_LEAF};
    float best_cost = INFINITY, size = 0;
    for (int axis = 0; axis < 3; axis++)
        size = sagi_float_max(size, range->box.hi[axis] - range->box.lo[axis]);
    uint64_t most = sagi_depth_allows(range->depth + 1);
    for (int axis = 0; axis < 3; axis++)
        if (bins->scale[axis] > 0) choose_on_axis(bins, axis, most, 0x1p-16f * size, &best, &best_cost);
    if (range->fits) {
        float halves = sagi_float_box_half_area(&best.left) + sagi_float_box_half_area(&best.right);
        if (best.verdict == SAGI_HALVE || !(halves < LEAF_SHARE * sagi_float_box_half_area(&range->box)))
            best.verdict = SAGI_MAKE_LEAF;
    }
    return best;
}

static bool before(const sagi_bvh_primitive *a, const sagi_bvh_primitive *b, int axis) {
    float ca = sagi_centroid(a, axis), cb = sagi_centroid(b, axis);
    if (ca != cb) return ca < cb;
    if (a->geometry != b->geometry) return a->geometry < b->geometry;
    return a->primitive < b->primitive;
}

static void swap(sagi_bvh_primitive *a, sagi_bvh_primitive *b) {
    sagi_bvh_primitive t = *a;
    *a = *b, *b = t;
}

// Hoare's selection: narrows [low, high] around the middle place until it holds what belongs there. The order
// is total, so equal centroids do not slow it down.
void sagi_range_halve(sagi_bvh_primitive *primitives, const sagi_range *range) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (range->centroids.hi[k] - range->centroids.lo[k] >
            range->centroids.hi[axis] - range->centroids.lo[axis])
            axis = k;
    sagi_bvh_primitive *p = primitives + range->first;
    int64_t low = 0, high = (int64_t)range->count - 1, middle = range->count / 2;
    while (low < high) {
        sagi_bvh_primitive pivot = p[low + (high - low) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (before(&p[i], &pivot, axis)) i++;
            while (before(&pivot, &p[j], axis)) j--;
            if (i <= j) swap(&p[i++], &p[j--]);
        }
        if (middle <= j)
            high = j;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}
