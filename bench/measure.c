// SPDX-License-Identifier: MIT
// One set of rays through every contender. A repeat lets each run once, and the next repeat starts with the
// next contender, so that a machine that slows down or speeds up does so for all of them; the median of the
// repeats counts. The first round is not timed: it warms everything up and brings the answers to compare.
#include "bench.h"
#include <stdlib.h>

enum { MOST_REPEATS = 101 };

typedef struct contender {
    void (*reset)(void *run);
    double (*trace)(void *run); // seconds
    void *run;                  // NULL: takes no part
    double seconds[MOST_REPEATS];
} contender;

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, by_size);
    return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

static size_t count_differing(const subject_run *single, const subject_run *batch) {
    size_t differing = 0;
    for (size_t i = 0; i < single->set->count; i++)
        if (single->set->occluded) {
            differing += single->dark[i] != batch->dark[i];
        } else {
            const sag_hit *a = &single->hits[i], *b = &batch->hits[i];
            bool missed = a->geometry == SAG_INVALID_ID && b->geometry == SAG_INVALID_ID;
            differing += !missed && !(a->t == b->t && a->u == b->u && a->v == b->v &&
                                      a->primitive == b->primitive && a->geometry == b->geometry);
        }
    return differing;
}

static void race(contender c[CONTENDER_COUNT], uint32_t repeats) {
    for (uint32_t repeat = 0; repeat < repeats; repeat++)
        for (uint32_t k = 0; k < CONTENDER_COUNT; k++) {
            contender *now = &c[(repeat + k) % CONTENDER_COUNT];
            if (now->run == NULL) continue;
            now->reset(now->run);
            now->seconds[repeat] = now->trace(now->run);
        }
}

static void compare(result *r, const model *m, const ray_set *set, const subject_run *single,
                    const subject_run *batch, const peer *fast, const peer *robust, const peer_run *fast_run,
                    const peer_run *robust_run, bool plant) {
    answer *answers = need(set->count * sizeof *answers);
    subject_answers(single, answers);
    for (size_t i = 0; i < set->count; i++) r->met += answers[i].primitive != SAG_INVALID_ID;
    if (plant && fast != NULL) r->planted = plant_errors(m, set, answers);
    r->batch_differs = count_differing(single, batch);
    if (fast != NULL) {
        answer *of_fast = need(set->count * sizeof *of_fast),
               *of_robust = need(set->count * sizeof *of_robust);
        peer_answers(fast_run, of_fast);
        peer_answers(robust_run, of_robust);
        r->settled = settle(m, set, single->scene, fast, robust, answers, of_fast, of_robust);
        free(of_fast);
        free(of_robust);
    }
    free(answers);
}

void measure_set(result *r, const model *m, const ray_set *set, const subject *s, const peer *fast,
                 const peer *robust, uint32_t repeats, bool plant) {
    if (repeats > MOST_REPEATS) repeats = MOST_REPEATS;
    r->rays = set->count;
    if (set->count == 0) return;
    subject_run single, batch;
    subject_run_init(&single, s, set, r->threads);
    subject_run_init(&batch, s, set, r->threads);
    peer_run *fast_run = fast != NULL ? peer_run_create(fast, set, r->threads, PEER_SINGLE) : NULL;
    peer_run *robust_run = robust != NULL ? peer_run_create(robust, set, r->threads, PEER_SINGLE) : NULL;
    bool packets = fast != NULL && set->packets;
    peer_run *packet_run = packets ? peer_run_create(fast, set, r->threads, PEER_PACKET) : NULL;
    peer_run *coherent_run = packets ? peer_run_create(fast, set, r->threads, PEER_COHERENT) : NULL;
    contender *c = need(CONTENDER_COUNT * sizeof *c);
    c[SAGITTA_SINGLE] = (contender){.reset = subject_reset, .trace = subject_single, .run = &single};
    c[SAGITTA_BATCH] = (contender){.reset = subject_reset, .trace = subject_batch, .run = &batch};
    c[EMBREE_FAST] = (contender){.reset = peer_reset, .trace = peer_trace, .run = fast_run};
    c[EMBREE_ROBUST] = (contender){.reset = peer_reset, .trace = peer_trace, .run = robust_run};
    c[EMBREE_PACKET] = (contender){.reset = peer_reset, .trace = peer_trace, .run = packet_run};
    c[EMBREE_COHERENT] = (contender){.reset = peer_reset, .trace = peer_trace, .run = coherent_run};

    race(c, 1);
    compare(r, m, set, &single, &batch, fast, robust, fast_run, robust_run, plant);
    race(c, repeats);
    for (int i = 0; i < CONTENDER_COUNT && repeats > 0; i++)
        if (c[i].run != NULL) r->mrays[i] = (double)set->count / 1e6 / median(c[i].seconds, repeats);

    free(c);
    peer_run_destroy(coherent_run);
    peer_run_destroy(packet_run);
    peer_run_destroy(robust_run);
    peer_run_destroy(fast_run);
    subject_run_clear(&batch);
    subject_run_clear(&single);
}
