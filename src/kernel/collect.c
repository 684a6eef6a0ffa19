// SPDX-License-Identifier: MIT
// The order of hits, and keeping the first of them. A heap (Williams, "Algorithm 232: Heapsort", CACM 7(6),
// 1964) lives in the caller's array: no memory is asked for, n hits cost n log(capacity).
//
// Repeats. A primitive in several leaves is crossed once, but found in each of them, with the same bits. The
// heap keeps the first of all that is found, repeats included. Without these the kept are a beginning of the
// sorted crossings: whatever comes before the last of them was kept, as the heap gives up only what comes
// last. So they are counted, and the next walk takes what comes after that last one. Each walk goes on by one
// at least, so there is an end.
#include "kernel/kernel.h"

int sagi_hit_compare_paths(const sag_hit *a, const sag_hit *b) {
    for (uint32_t i = 0; i < a->instance_depth && i < b->instance_depth; i++)
        if (a->instance_path[i] != b->instance_path[i])
            return a->instance_path[i] < b->instance_path[i] ? -1 : 1;
    return a->instance_depth == b->instance_depth ? 0 : a->instance_depth < b->instance_depth ? -1 : 1;
}

bool sagi_hit_before(const sag_hit *a, const sag_hit *b) {
    if (a->t != b->t) return a->t < b->t;
    int paths = sagi_hit_compare_paths(a, b);
    if (paths != 0) return paths < 0;
    if (a->geometry != b->geometry) return a->geometry < b->geometry;
    return a->primitive < b->primitive;
}

// Puts `hit` into the hole at `place` of a heap of `count`, moving later children up.
static void sift_down(sag_hit *hits, size_t count, size_t place, sag_hit hit) {
    for (size_t child; (child = 2 * place + 1) < count; place = child) {
        if (child + 1 < count && sagi_hit_before(&hits[child], &hits[child + 1])) child++;
        if (!sagi_hit_before(&hit, &hits[child])) break;
        hits[place] = hits[child];
    }
    hits[place] = hit;
}

void sagi_collector_add(sagi_collector *c, const sag_hit *hit) {
    size_t place = c->count++;
    if (place >= c->capacity) {
        if (c->capacity > 0 && sagi_hit_before(hit, &c->hits[0])) sift_down(c->hits, c->capacity, 0, *hit);
        return;
    }
    for (; place > 0 && sagi_hit_before(&c->hits[(place - 1) / 2], hit); place = (place - 1) / 2)
        c->hits[place] = c->hits[(place - 1) / 2];
    c->hits[place] = *hit;
}

void sagi_collector_finish(sagi_collector *c) {
    for (size_t n = c->count < c->capacity ? c->count : c->capacity; n > 1; n--) {
        sag_hit last = c->hits[n - 1];
        c->hits[n - 1] = c->hits[0];
        sift_down(c->hits, n - 1, 0, last);
    }
}

void sagi_repeats_add(sagi_repeats *r, const sag_hit *hit) {
    if (r->again && !sagi_hit_before(&r->last, hit)) return;
    sagi_collector first = {r->kept, SAGI_REPEATS_KEPT, r->count};
    sagi_collector_add(&first, hit);
    r->count = first.count;
}

bool sagi_repeats_hand_on(sagi_repeats *r, sagi_collector *collector) {
    sagi_collector first = {r->kept, SAGI_REPEATS_KEPT, r->count};
    sagi_collector_finish(&first);
    size_t kept = r->count < SAGI_REPEATS_KEPT ? r->count : SAGI_REPEATS_KEPT;
    for (size_t i = 0; i < kept; i++)
        if (i == 0 || sagi_hit_before(&r->kept[i - 1], &r->kept[i]))
            sagi_collector_add(collector, &r->kept[i]);
    if (r->count <= SAGI_REPEATS_KEPT) return false;
    r->again = true;
    r->last = r->kept[SAGI_REPEATS_KEPT - 1];
    r->count = 0;
    return true;
}
