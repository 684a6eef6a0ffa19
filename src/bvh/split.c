// SPDX-License-Identifier: MIT
// Where to cut a range of primitives in two.
//
// The surface area heuristic: a random ray that meets a convex box meets a convex box inside it with
// probability area(inside)/area(outside). So a node split into L and R costs, but for a constant,
//     n_L A_L + n_R A_R,
// n counting (see weight_of), A being areas and the children taken for leaves (MacDonald & Booth, "Heuristics
// for Ray Tracing Using Space Subdivision", 1990). Splitting goes on down to single primitives, or to what
// had better be tested at once; which leaves are put together is decided afterwards, when everything above
// and below is known (forest.c). Only cuts between equal bins of the centroids' extent are tried (Wald, "On
// fast Construction of SAH-based Bounding Volume Hierarchies", 2007).
//
// Bins hold minima, maxima and counts. All three are the same in whatever order primitives are added, so a
// range may be binned in pieces by several threads and merged: the tree does not depend on their number.
#include "bvh/binary.h"
#include <string.h>

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
            sagi_lanes_store(bins->at[axis][b].lo, none_lo), sagi_lanes_store(bins->at[axis][b].hi, none_hi);
            bins->held[axis][b] = 0;
        }
}

static inline void extend(sagi_bins *bins, int axis, int b, sagi_lanes lo, sagi_lanes hi, uint32_t count) {
    sagi_bin *bin = &bins->at[axis][b];
    sagi_lanes_store(bin->lo, sagi_lanes_min(lo, sagi_lanes_load(bin->lo)));
    sagi_lanes_store(bin->hi, sagi_lanes_max(hi, sagi_lanes_load(bin->hi)));
    bins->held[axis][b] += count;
}

void sagi_bins_add(sagi_bins *bins, const sagi_bvh_primitive *primitives, uint32_t count) {
    sagi_lanes origin = sagi_lanes_load(bins->origin), scale = sagi_lanes_load(bins->scale);
    for (uint32_t i = 0; i < count; i++) {
        sagi_lanes lo = sagi_lower(&primitives[i]), hi = sagi_upper(&primitives[i]);
        int bin[4];
        sagi_lanes centroid = sagi_lanes_clear(sagi_lanes_add(lo, hi));
        sagi_lanes_to_int(bin, sagi_lanes_mul(sagi_lanes_sub(centroid, origin), scale));
        for (int axis = 0; axis < 3; axis++) extend(bins, axis, bin[axis], lo, hi, 1);
    }
}

void sagi_bins_merge(sagi_bins *bins, const sagi_bins *other) {
    for (int axis = 0; axis < 3; axis++)
        for (int b = 0; b < bins->count; b++)
            extend(bins, axis, b, sagi_lanes_load(other->at[axis][b].lo),
                   sagi_lanes_load(other->at[axis][b].hi), other->held[axis][b]);
}

// Half the surfaces of boxes of the extents given, four at once, and each times its count. Boxes are
// thickened a little: what is flat or straight is still cut where it is best. An empty box gives NaN.
static inline sagi_lanes weighed(const float extent[4][4], const float count[4], float thickness) {
    sagi_lanes e[4];
    for (int i = 0; i < 4; i++) e[i] = sagi_lanes_load(extent[i]);
    sagi_lanes_transpose(e);
    sagi_lanes xy = sagi_lanes_add(e[0], e[1]), t = sagi_lanes_fill(thickness);
    sagi_lanes area = sagi_lanes_add(sagi_lanes_mul(e[0], e[1]), sagi_lanes_mul(xy, e[2]));
    area = sagi_lanes_add(area, sagi_lanes_mul(sagi_lanes_add(xy, e[2]), t));
    return sagi_lanes_mul(area, sagi_lanes_load(count));
}

// What is on one side of each cut of an axis: cut b is between the bins b − 1 and b.
typedef struct side {
    float extent[SAGI_MAX_BINS][4], count[SAGI_MAX_BINS];
} side;

// The box of bins that are passed by one after the other.
typedef struct sweep {
    sagi_lanes lo, hi;
    uint32_t count;
} sweep;

static inline sweep sweep_begin(void) {
    return (sweep){sagi_lanes_fill(INFINITY), sagi_lanes_fill(-INFINITY), 0};
}
static inline void sweep_pass(sweep *s, const sagi_bins *bins, int axis, int b) {
    s->lo = sagi_lanes_min(sagi_lanes_load(bins->at[axis][b].lo), s->lo);
    s->hi = sagi_lanes_max(sagi_lanes_load(bins->at[axis][b].hi), s->hi);
    s->count += bins->held[axis][b];
}
// What so many primitives count for. A place in a leaf that stays empty costs a quarter, too: so ranges are
// cut where leaves of eight will be full. Scans have a tenth to an eighth fewer leaves, rays meet 1 % fewer
// nodes.
static inline float weight_of(uint32_t count) {
    static const float more[SAGI_BVH_MAX_LEAF] = {0, 1.75F, 1.5F, 1.25F, 1, 0.75F, 0.5F, 0.25F};
    return (float)count + more[count % SAGI_BVH_MAX_LEAF];
}
static inline void sweep_note(const sweep *s, side *to, int cut) {
    sagi_lanes_store(to->extent[cut], sagi_lanes_clear(sagi_lanes_sub(s->hi, s->lo)));
    to->count[cut] = weight_of(s->count);
}

// The costs of all cuts; NaN where one side is empty, as for the cut 0.
static void weigh_cuts(const sagi_bins *bins, int axis, float thickness, float cost[SAGI_MAX_BINS]) {
    side left, right;
    sweep l = sweep_begin(), r = sweep_begin();
    for (int b = 0; b < bins->count; b++) {
        sweep_note(&l, &left, b);
        sweep_pass(&l, bins, axis, b);
        sweep_pass(&r, bins, axis, bins->count - 1 - b);
        sweep_note(&r, &right, bins->count - 1 - b);
    }
    for (int b = 0; b < bins->count; b += 4)
        sagi_lanes_store(cost + b, sagi_lanes_add(weighed(left.extent + b, left.count + b, thickness),
                                                  weighed(right.extent + b, right.count + b, thickness)));
}

static uint32_t count_before(const sagi_bins *bins, int axis, int cut) {
    uint32_t count = 0;
    for (int b = 0; b < cut; b++) count += bins->held[axis][b];
    return count;
}

uint32_t sagi_bins_left(const sagi_bins *bins, const sagi_split *split) {
    return count_before(bins, split->axis, split->bin);
}

static sagi_float_box box_between(const sagi_bins *bins, int axis, int begin, int end) {
    sweep s = sweep_begin();
    for (int b = begin; b < end; b++) sweep_pass(&s, bins, axis, b);
    float lo[4], hi[4];
    sagi_lanes_store(lo, s.lo), sagi_lanes_store(hi, s.hi);
    return (sagi_float_box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

// The cheapest cut of all axes that leaves at most `most` primitives on each side; bin 0: there is none.
static sagi_split cheapest_cut(const sagi_bins *bins, const sagi_range *range, uint64_t most) {
    sagi_split best = {.verdict = SAGI_SPLIT};
    float best_cost = INFINITY, size = 0;
    for (int axis = 0; axis < 3; axis++)
        size = sagi_float_max(size, range->box.hi[axis] - range->box.lo[axis]);
    for (int axis = 0; axis < 3; axis++) {
        if (!(bins->scale[axis] > 0)) continue;
        float cost[SAGI_MAX_BINS];
        weigh_cuts(bins, axis, 0x1p-16f * size, cost);
        for (int b = 1; b < bins->count; b++) {
            if (!(cost[b] < best_cost)) continue;
            uint32_t left_count = count_before(bins, axis, b);
            if (left_count > most || range->count - left_count > most) continue;
            best_cost = cost[b];
            best.axis = axis, best.bin = b, best.left_count = left_count;
        }
    }
    if (best.bin == 0) return best;
    best.origin = bins->origin[best.axis], best.scale = bins->scale[best.axis];
    best.left = box_between(bins, best.axis, 0, best.bin);
    best.right = box_between(bins, best.axis, best.bin, bins->count);
    return best;
}

sagi_split sagi_bins_choose(const sagi_bins *bins, const sagi_range *range) {
    const sagi_split leaf = {.verdict = SAGI_MAKE_LEAF}, halve = {.verdict = SAGI_HALVE};
    if (range->depth == SAGI_BVH_MAX_DEPTH) return leaf;
    sagi_split best = cheapest_cut(bins, range, sagi_depth_allows(range->depth + 1));
    if (!range->fits) return best.bin > 0 ? best : halve;
    float halves = sagi_float_box_half_area(&best.left) + sagi_float_box_half_area(&best.right);
    bool cut = best.bin > 0 && halves < SAGI_LEAF_SHARE * sagi_float_box_half_area(&range->box);
    return cut ? best : leaf;
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
