// SPDX-License-Identifier: MIT
#include "support/span_truth.h"
#include "kernel/kernel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void span_truth_begin(span_truth *w, const sag_ray *ray) {
    w->count = 0, w->depth = 0, w->ray = *ray;
    memset(w->path, 0xFF, sizeof w->path);
}

sag_hit span_truth_hit(const span_truth *w, uint32_t geometry, sag_hit hit) {
    hit.geometry = geometry;
    hit.instance_depth = w->depth;
    memcpy(hit.instance_path, w->path, sizeof w->path);
    return hit;
}

static void add(span_truth *w, sag_hit enter, sag_hit leave) {
    assert_true(w->count < MAX_TRUE_SPANS);
    w->spans[w->count++] = (sag_span){enter, leave};
}

void span_truth_add(span_truth *w, uint32_t geometry, const sag_hit *hits, size_t count, bool inside) {
    const double t_min = w->ray.t_min, t_max = w->ray.t_max;
    const sag_hit none = {.primitive = SAG_INVALID_ID};
    sag_hit enter = span_truth_hit(w, geometry, none);
    enter.t = t_min;
    for (size_t i = 0, n; i < count && hits[i].t <= t_max; i += n) {
        for (n = 1; i + n < count && hits[i + n].t == hits[i].t;) n++;
        if (n % 2 == 0) continue;
        if (inside && hits[i].t > enter.t) add(w, enter, hits[i]);
        inside = !inside;
        if (!inside) continue;
        enter = hits[i].t < t_min ? span_truth_hit(w, geometry, none) : hits[i];
        if (hits[i].t < t_min) enter.t = t_min;
    }
    if (!inside || !(enter.t < t_max || t_min == t_max)) return;
    sag_hit leave = span_truth_hit(w, geometry, none);
    leave.t = t_max;
    add(w, enter, leave);
}

static int compare(const void *x, const void *y) {
    const sag_span *a = x, *b = y;
    if (sagi_hit_before(&a->enter, &b->enter)) return -1;
    if (sagi_hit_before(&b->enter, &a->enter)) return 1;
    return sagi_hit_before(&a->leave, &b->leave) ? -1 : sagi_hit_before(&b->leave, &a->leave);
}

static void assert_same_hits(const sag_hit *a, const sag_hit *b) {
    assert_true(a->t == b->t && a->u == b->u && a->v == b->v);
    assert_int_equal(a->primitive, b->primitive);
    assert_int_equal(a->geometry, b->geometry);
    assert_int_equal(a->flipped, b->flipped);
    assert_int_equal(a->instance_depth, b->instance_depth);
    assert_memory_equal(a->instance_path, b->instance_path, sizeof a->instance_path);
}

void span_truth_assert(span_truth *w, const sag_scene *scene, rng *r) {
    static sag_span spans[MAX_TRUE_SPANS + 1];
    const size_t room[4] = {MAX_TRUE_SPANS, 0, 1, w->count > 0 ? rng_below(r, (uint32_t)w->count + 1) : 0};
    qsort(w->spans, w->count, sizeof *w->spans, compare);
    for (int k = 0; k < 4; k++) {
        memset(spans, 0xAB, (w->count + 1) * sizeof *spans);
        assert_int_equal(sag_scene_spans(scene, &w->ray, room[k] > 0 ? spans : NULL, room[k]), w->count);
        for (size_t i = 0; i < w->count && i < room[k]; i++) {
            assert_same_hits(&spans[i].enter, &w->spans[i].enter);
            assert_same_hits(&spans[i].leave, &w->spans[i].leave);
        }
        for (size_t i = room[k] * sizeof *spans; room[k] < w->count && i < (room[k] + 1) * sizeof *spans; i++)
            assert_int_equal(((unsigned char *)spans)[i], 0xAB); // nothing beyond
    }
}
