// SPDX-License-Identifier: MIT
// How thick a body is.
//
// The points where three families of parallel lines cross the surface, each with the weight
// w = (area of the family's rectangle)/(|n_x| + |n_y| + |n_z|), are spread evenly over its area (lines.c).
// From each a ray goes straight inward, against the normal, and the way to the next boundary is the thickness
// there: the ray method of engineers' thickness analyses. At a sharp edge it goes to nothing, as the wall
// does; the smallest one found says how near to the edge a point fell, percentiles are what to judge by.
//
// The ray starts outside of the surface's error bound (sag_spawn_ray), so it does not meet the wall it
// leaves; the distance counts from the point itself. A point of which the inward ray meets nothing (it fell
// on an edge, and the ray left through a neighbour within rounding) is left out.
//
// The mean's interval: Student's, of the 32 randomisations' own weighted means.
#include "measure/measure.h"
#include <string.h>

#define FAMILIES (SAGI_REPLICATES * SAGI_AXES)

typedef struct sample {
    double thickness, weight;
    sag_vec3 point;
} sample;

typedef struct piece {
    sample *samples;
    size_t count, capacity;
    bool failed;
} piece;

typedef struct work {
    const sagi_target *target;
    uint64_t seed;
    uint32_t lines;
    piece pieces[FAMILIES];
} work;

static bool keep(const sag_context *context, piece *p, const sample *s) {
    if (p->count == p->capacity) {
        const size_t capacity = p->capacity == 0 ? 256 : 2 * p->capacity;
        sample *samples = sag_allocate(context, capacity * sizeof *samples);
        if (samples == NULL) return false;
        if (p->count > 0) memcpy(samples, p->samples, p->count * sizeof *samples);
        sag_release(context, p->samples, p->capacity * sizeof *samples);
        p->samples = samples, p->capacity = capacity;
    }
    p->samples[p->count++] = *s;
    return true;
}

// Looks inward from a boundary of the line; false: nothing is met.
static bool look_inward(const sagi_target *target, const sag_ray *line, const sagi_boundary *boundary,
                        sagi_line_buffer *inner, sample *found) {
    sag_surface s;
    sagi_target_surface(target, line, &boundary->hit, &s);
    // Which side is in is known from the line, whatever the normal says.
    const bool out_ahead = sag_dot(s.geometric_normal, line->direction) > 0;
    const sag_vec3 inward =
        out_ahead == boundary->entering ? s.geometric_normal : sag_neg(s.geometric_normal);
    sag_ray ray = sag_spawn_ray(&s, inward);
    const double start = sag_length(sag_sub(ray.origin, s.position));
    double end;
    if (!sagi_target_inward(target, &ray, inner, &end)) return false;
    const sag_vec3 n = sag_abs(s.geometric_normal);
    *found = (sample){start + end, 1 / (n.x + n.y + n.z), s.position};
    return isfinite(found->thickness) && isfinite(found->weight);
}

static void sample_family(void *argument, size_t index) {
    work *w = argument;
    piece *p = &w->pieces[index];
    const sagi_target *t = w->target;
    const int axis = (int)(index % SAGI_AXES);
    const sag_vec3 size = sag_sub(t->box.max, t->box.min);
    const double faces[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    const double largest = fmax(faces[0], fmax(faces[1], faces[2]));
    const uint64_t key = sagi_line_key(w->seed, (uint32_t)(index / SAGI_AXES), axis);
    sagi_line_buffer buffer = {.context = t->context}, inner = {.context = t->context};
    for (uint32_t i = 0; i < w->lines && !p->failed; i++) {
        double at[3];
        const sag_ray line = sagi_line(&t->box, key, axis, i, at);
        const size_t count = sagi_target_cross(t, &line, &buffer);
        for (size_t k = 0; k < count; k++) {
            sample found;
            if (!look_inward(t, &line, &buffer.boundaries[k], &inner, &found)) continue;
            found.weight *= faces[axis] / largest;
            p->failed |= !keep(t->context, p, &found);
        }
        p->failed |= buffer.failed || inner.failed;
    }
    sagi_line_buffer_release(&buffer);
    sagi_line_buffer_release(&inner);
}

// ---- what they say

// In order of thickness; a heap sort, which needs no memory.
static void sift_down(sample *s, size_t at, size_t count) {
    const sample moved = s[at];
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        if (child + 1 < count && s[child + 1].thickness > s[child].thickness) child++;
        if (s[child].thickness <= moved.thickness) break;
        s[at] = s[child];
    }
    s[at] = moved;
}

static void sort(sample *s, size_t count) {
    for (size_t i = count / 2; i-- > 0;) sift_down(s, i, count);
    for (size_t end = count; end-- > 1;) {
        const sample top = s[0];
        s[0] = s[end], s[end] = top;
        sift_down(s, 0, end);
    }
}

static void summarize(const sample *s, size_t count, sag_thickness *t) {
    static const double share[SAG_THICKNESS_PERCENTILES] = {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};
    double total = 0, below = 0;
    for (size_t i = 0; i < count; i++) total += s[i].weight;
    t->sample_count = count;
    t->min = s[0].thickness, t->max = s[count - 1].thickness, t->thinnest = s[0].point;
    int next = 0;
    for (size_t i = 0; i < count; i++) {
        below += s[i].weight;
        while (next < SAG_THICKNESS_PERCENTILES && below >= share[next] * total)
            t->percentiles[next++] = s[i].thickness;
        const double place = t->max > 0 ? s[i].thickness / t->max * SAG_THICKNESS_BINS : 0;
        const int bin = place < SAG_THICKNESS_BINS ? (int)place : SAG_THICKNESS_BINS - 1;
        t->histogram[bin] += s[i].weight / total;
    }
    while (next < SAG_THICKNESS_PERCENTILES) t->percentiles[next++] = t->max;
}

static sag_estimate mean_of(const work *w, double confidence) {
    double means[SAGI_REPLICATES];
    int count = 0;
    for (int r = 0; r < SAGI_REPLICATES; r++) {
        double sum = 0, weight = 0;
        for (int axis = 0; axis < SAGI_AXES; axis++) {
            const piece *p = &w->pieces[r * SAGI_AXES + axis];
            for (size_t i = 0; i < p->count; i++)
                sum += p->samples[i].weight * p->samples[i].thickness, weight += p->samples[i].weight;
        }
        if (weight > 0) means[count++] = sum / weight;
    }
    if (count < 2) return (sag_estimate){count > 0 ? means[0] : 0, INFINITY};
    return sagi_mean_estimate(means, count, confidence);
}

static bool gather(work *w, double confidence, sagi_result *result) {
    const sag_context *context = w->target->context;
    size_t count = 0;
    for (int i = 0; i < FAMILIES; i++) {
        if (w->pieces[i].failed) return false;
        count += w->pieces[i].count;
    }
    if (count == 0) return true;
    sample *all = sag_allocate(context, count * sizeof *all);
    if (all == NULL) return false;
    size_t end = 0;
    for (int i = 0; i < FAMILIES; i++) {
        if (w->pieces[i].count > 0) memcpy(all + end, w->pieces[i].samples, w->pieces[i].count * sizeof *all);
        end += w->pieces[i].count;
    }
    sort(all, count);
    summarize(all, count, &result->thickness);
    result->thickness.mean = mean_of(w, confidence);
    sag_release(context, all, count * sizeof *all);
    return true;
}

bool sagi_sample_thickness(const sagi_target *target, uint64_t seed, uint32_t lines, sagi_reporter *reporter,
                           sagi_result *result) {
    work *w = sag_allocate(target->context, sizeof *w);
    if (w == NULL) return false;
    *w = (work){.target = target, .seed = seed, .lines = lines};
    sag_parallel_for(target->context, FAMILIES, sample_family, w);
    const bool good = gather(w, reporter->options->confidence, result);
    for (int i = 0; i < FAMILIES; i++)
        sag_release(target->context, w->pieces[i].samples, w->pieces[i].capacity * sizeof(sample));
    sag_release(target->context, w, sizeof *w);
    const uint64_t rays = (uint64_t)FAMILIES * lines + result->thickness.sample_count;
    result->rays += rays;
    return good && sagi_report(reporter, 1, rays);
}
