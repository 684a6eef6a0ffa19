// SPDX-License-Identifier: MIT
// Where Sagitta and Embree answer differently, exact arithmetic says who is right.
//
// They differ when one hits and the other misses, or when they name different primitives at distances that
// float can tell apart. Of each such ray every primitive that anybody named is examined exactly (exact.c).
// When that shows no true hit where somebody claimed one, the truth may be a primitive that nobody named:
// then all primitives of the model are gone through, those that certainly miss being turned away in double.
//
//   Sagitta is right when the primitive named is hit by its own rule, at t within 4 ulp and in range, and no
//   primitive examined is hit before it; or when nothing was named and nothing is hit.
//   Embree is right when the closed primitive named is touched and nothing is hit before it by more than
//   float can tell; or when nothing was named and nothing is hit. So it is never blamed for an edge or a
//   vertex that it gives to another triangle than Sagitta does.
//   Both right, and different: a tie.
#include "exact.h"
#include <stdlib.h>
#include <string.h>

enum { MOST_SEARCHES = 200, MOST_NAMED = 8 };

typedef struct judge {
    const model *m;
    const sag_ray *ray;
    bool any;         // only whether something is hit counts
    double tolerance; // of t, for float
    exact_hit nearest, now;
    bool found; // nearest is one
} judge;

static double float_tolerance(const model *m, const sag_ray *ray, double t) {
    double size = sag_length(sag_sub(ray->origin, m->center)) + sag_length(m->center) + m->radius;
    double length = sag_length(ray->direction);
    return 0x1p-20 * (size / length + (isfinite(t) ? fabs(t) : 0));
}

static bool differ(const model *m, const ray_set *set, const sag_ray *ray, answer a, answer b) {
    if (a.primitive == SAG_INVALID_ID || b.primitive == SAG_INVALID_ID || set->occluded)
        return (a.primitive == SAG_INVALID_ID) != (b.primitive == SAG_INVALID_ID);
    return a.primitive != b.primitive && fabs(a.t - b.t) > float_tolerance(m, ray, a.t);
}

static void examine(judge *j, uint32_t primitive) {
    exact_examine(&j->now, j->m, j->ray, primitive);
    if (!j->now.hit || (j->found && mpf_cmp(j->now.t, j->nearest.t) >= 0)) return;
    exact_copy(&j->nearest, &j->now);
    j->found = true;
}

// How far the exact t of `h` lies beyond x.
static double beyond(const exact_hit *h, double x) {
    mpf_t difference, of_x;
    mpf_init2(difference, 4096);
    mpf_init2(of_x, 4096);
    mpf_set_d(of_x, x);
    mpf_sub(difference, h->t, of_x);
    double distance = mpf_get_d(difference);
    mpf_clear(difference);
    mpf_clear(of_x);
    return distance;
}

static bool sagitta_is_right(judge *j, answer a) {
    if (a.primitive == SAG_INVALID_ID) return !j->found;
    exact_examine(&j->now, j->m, j->ray, a.primitive);
    if (!j->now.touched || (!j->now.hit && j->m->sphere_count == 0)) return false;
    double ulp = nextafter(fabs(a.t), INFINITY) - fabs(a.t);
    if (j->any) return true;
    return fabs(beyond(&j->now, a.t)) <= 4 * ulp && (!j->found || beyond(&j->nearest, a.t) >= -4 * ulp);
}

static bool embree_is_right(judge *j, answer a) {
    if (a.primitive == SAG_INVALID_ID) return !j->found;
    exact_examine(&j->now, j->m, j->ray, a.primitive);
    if (!j->now.touched) return false;
    return j->any || !j->found || beyond(&j->nearest, a.t) >= -j->tolerance;
}

typedef struct search {
    const model *m;
    const sag_ray *ray;
    unsigned char *worth; // a look
} search;

static void look(void *argument, size_t first, size_t end) {
    const search *s = argument;
    for (size_t i = first; i < end; i++) s->worth[i] = exact_worth_a_look(s->m, s->ray, (uint32_t)i);
}

static void search_all(judge *j) {
    uint32_t count = model_primitives(j->m);
    search s = {j->m, j->ray, need(count)};
    crew_run(2, count, look, &s);
    for (uint32_t i = 0; i < count; i++)
        if (s.worth[i]) examine(j, i);
    free(s.worth);
}

// The primitive behind an any-hit answer is not told; closest-hit calls name one.
static answer named(const ray_set *set, answer told, answer closest) {
    if (!set->occluded || told.primitive == SAG_INVALID_ID) return told;
    return closest;
}

static answer closest_of_sagitta(const sag_scene *scene, const sag_ray *ray) {
    sag_hit hit;
    if (!sag_intersect(scene, ray, &hit)) return (answer){INFINITY, SAG_INVALID_ID};
    return (answer){hit.t, hit.primitive};
}

// An any-hit answer "yes" without any primitive to show for it is judged by what a search finds.
static bool right(judge *j, bool (*rule)(judge *, answer), answer told, answer shown) {
    if (told.primitive != SAG_INVALID_ID && shown.primitive == SAG_INVALID_ID) return j->found;
    return rule(j, shown);
}

static void settle_one(settled *s, judge *j, const ray_set *set, const sag_scene *scene,
                       const peer *const peers[2], answer sagitta, const answer theirs[2]) {
    answer shown = sagitta, shown_theirs[2] = {theirs[0], theirs[1]};
    uint32_t candidates[MOST_NAMED];
    size_t count = 0;
    if (j->any) shown = closest_of_sagitta(scene, j->ray);
    candidates[count++] = shown.primitive;
    for (int i = 0; i < 2; i++) {
        if (j->any) shown_theirs[i] = peer_closest(peers[i], j->ray);
        candidates[count++] = shown_theirs[i].primitive;
    }
    j->found = false;
    bool untrue = false; // somebody claims a hit that is none: then what nobody named may be one
    for (size_t i = 0; i < count; i++) {
        if (candidates[i] == SAG_INVALID_ID) continue;
        examine(j, candidates[i]);
        untrue |= !j->now.hit;
    }
    if (untrue || !j->found) {
        if (s->searched < MOST_SEARCHES) {
            s->searched++;
            search_all(j);
        } else {
            s->unsearched++;
        }
    }
    bool sagitta_right = right(j, sagitta_is_right, sagitta, named(set, sagitta, shown));
    s->sagitta_wrong += !sagitta_right;
    for (int i = 0; i < 2; i++) {
        dispute *d = i == 0 ? &s->fast : &s->robust;
        if (!differ(j->m, set, j->ray, sagitta, theirs[i])) continue;
        bool their_right = right(j, embree_is_right, theirs[i], named(set, theirs[i], shown_theirs[i]));
        d->disagree++;
        d->wrong += !their_right;
        d->ties += sagitta_right && their_right;
    }
}

settled settle(const model *m, const ray_set *set, const sag_scene *scene, const peer *fast,
               const peer *robust, const answer *of_sagitta, const answer *of_fast, const answer *of_robust) {
    settled s = {0};
    judge j = {.m = m, .any = set->occluded};
    const peer *const peers[2] = {fast, robust};
    exact_init(&j.nearest);
    exact_init(&j.now);
    for (size_t i = 0; i < set->count; i++) {
        j.ray = &set->rays[i];
        if (!differ(m, set, j.ray, of_sagitta[i], of_fast[i]) &&
            !differ(m, set, j.ray, of_sagitta[i], of_robust[i]))
            continue;
        j.tolerance = float_tolerance(m, j.ray, of_sagitta[i].t);
        settle_one(&s, &j, set, scene, peers, of_sagitta[i], (const answer[2]){of_fast[i], of_robust[i]});
    }
    exact_clear(&j.nearest);
    exact_clear(&j.now);
    return s;
}

// A wrong answer on every 10,000th ray: a hit lost, one made up, one moved, one given to another primitive.
// What settle must find, each of them.
size_t plant_errors(const model *m, const ray_set *set, answer *answers) {
    enum { EVERY = 10000 };
    size_t planted = 0;
    for (size_t i = 0; i < set->count; i += EVERY, planted++) {
        answer *a = &answers[i];
        if (a->primitive == SAG_INVALID_ID)
            *a = (answer){set->occluded ? 0 : m->radius, 0};
        else if (set->occluded || planted % 3 == 0)
            *a = (answer){INFINITY, SAG_INVALID_ID};
        else if (planted % 3 == 1)
            *a = (answer){a->t * 1.001, (a->primitive + 1) % model_primitives(m)};
        else
            *a = (answer){a->t * 0.9, (a->primitive + model_primitives(m) / 2) % model_primitives(m)};
    }
    return planted;
}
