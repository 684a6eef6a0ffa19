// SPDX-License-Identifier: MIT
// The crossings of the parts divide a ray into elementary intervals. In the middle of each, and at another
// place in it, the truth is asked (solid_model_at) and compared with what the boundaries say that the library
// found: the solid begins where sag_surface_at says that the ray arrives at the front. Between two such
// places where only one group of crossings lies, the rule of solid.h also says to which part the boundary
// belongs.
//
// An interval is left out when it is shorter than some times the tolerance of solid.h; a question is
// undecided when a map comes in and the point is so near to a surface that the rounding of the map matters.
#include "support/solid_check.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define MAX_MESSAGES 20

static void *room(void *old, size_t bytes) {
    void *p = realloc(old, bytes ? bytes : 1);
    if (!p) abort();
    return p;
}

static bool without_maps(const solid_model *model) {
    for (uint32_t i = 0; i < model->part_count; i++) {
        const model_part *part = model->parts[i];
        if (part->mapped || (part->child && !without_maps(part->child))) return false;
    }
    return true;
}

void solid_world_make(solid_world *w, sag_context *context, solid_model *model, const sag_affine *map,
                      double size) {
    *w = (solid_world){.model = model, .scene = sag_scene_create(context), .size = size};
    w->map = w->back = sag_affine_identity();
    if (map) {
        w->map = *map, w->mapped = true;
        assert_true(sag_affine_inverse(map, &w->back));
        inverse_map_make(&w->inverse, map);
    }
    w->exact = !map && without_maps(model);
    w->instance = sag_add_instance(w->scene, model->scene, &w->map);
    sag_error error = {0};
    if (sag_scene_commit(w->scene, &error) != SAG_OK) fail_msg("%s", error.message);
    for (int i = 0; i < 3; i++) w->states[i] = room(NULL, (model->state_count + 1) * sizeof(membership));
}

void solid_world_free(solid_world *w) {
    sag_scene_destroy(w->scene);
    solid_model_destroy(w->model);
    for (int i = 0; i < 3; i++) free(w->states[i]);
    free(w->crossings), free(w->hits), free(w->enters);
}

static membership truth_at(const solid_world *w, const spot *where, membership *states) {
    spot mapped;
    if (w->mapped) mapped = spot_map(&w->inverse, where);
    return solid_model_at(w->model, w->mapped ? &mapped : where, states);
}

// Says what is wrong, at first; counts.
static void wrong(solid_tally *tally, const sag_ray *ray, const char *what, double t) {
    if (++tally->wrong > MAX_MESSAGES) return;
    print_message("solid %llu: %s at t = %.17g\n", (unsigned long long)tally->seed, what, t);
    if (ray)
        print_message("  o %a %a %a d %a %a %a t %a %a\n", ray->origin.x, ray->origin.y, ray->origin.z,
                      ray->direction.x, ray->direction.y, ray->direction.z, ray->t_min, ray->t_max);
}

static double largest(sag_vec3 v) { return sag_max_component(sag_abs(v)); }

// solid.h's tolerance, as a length of t.
static double tolerance(const sag_ray *ray, double t) {
    sag_vec3 reach = sag_add(sag_abs(ray->origin), sag_scale(sag_abs(ray->direction), fabs(t)));
    return 0x1p-49 * largest(reach) / largest(ray->direction);
}

static bool same_hit(const sag_hit *a, const sag_hit *b) {
    return a->t == b->t && a->primitive == b->primitive && a->geometry == b->geometry && a->u == b->u &&
           a->v == b->v && a->instance_depth == b->instance_depth && a->flipped == b->flipped &&
           !memcmp(a->instance_path, b->instance_path, a->instance_depth * sizeof a->instance_path[0]);
}

// All queries agree with sag_intersect_all; returns how many boundaries there are, in w->hits.
static size_t ask(solid_world *w, const sag_ray *ray, rng *r, solid_tally *tally) {
    size_t count = sag_intersect_all(w->scene, ray, w->hits, w->hit_capacity);
    if (count > w->hit_capacity) {
        w->hit_capacity = 2 * count;
        w->hits = room(w->hits, w->hit_capacity * sizeof *w->hits);
        w->enters = room(w->enters, w->hit_capacity);
        if (sag_intersect_all(w->scene, ray, w->hits, w->hit_capacity) != count)
            wrong(tally, ray, "another count", 0);
    }
    sag_hit first = {0}, some[4];
    bool hit = sag_intersect(w->scene, ray, &first);
    if (hit != (count > 0) || (hit && !same_hit(&first, &w->hits[0])))
        wrong(tally, ray, "the closest is not the first of all", hit ? first.t : -1);
    if (sag_occluded(w->scene, ray) != hit) wrong(tally, ray, "occluded is not closest", 0);
    if (sag_count_crossings(w->scene, ray) != count) wrong(tally, ray, "the count is another", 0);
    if (rng_one_in(r, 4)) {
        size_t few = rng_below(r, 5);
        if (sag_intersect_all(w->scene, ray, some, few) != count) wrong(tally, ray, "few: another count", 0);
        for (size_t i = 0; i < few && i < count; i++)
            if (!same_hit(&some[i], &w->hits[i])) wrong(tally, ray, "few: another hit", some[i].t);
    }
    return count;
}

// The boundaries are in order, in range, enter and leave in turn, and name parts that are there.
static void check_order(solid_world *w, const sag_ray *ray, size_t count, solid_tally *tally) {
    for (size_t i = 0; i < count; i++) {
        const sag_hit *h = &w->hits[i];
        sag_surface s;
        uint32_t state;
        sag_surface_at(w->scene, ray, h, &s);
        bool enters = s.side == SAG_SIDE_FRONT;
        double cosine = sag_dot(s.geometric_normal, ray->direction) / sag_length(ray->direction);
        w->enters[i] = fabs(cosine) > 1e-6 ? enters : -1;
        if (w->enters[i] >= 0 && (cosine < 0) != enters)
            wrong(tally, ray, "the side is not the normal's", h->t);
        if (!(h->t >= ray->t_min && h->t <= ray->t_max)) wrong(tally, ray, "out of range", h->t);
        if (i && !(h->t > w->hits[i - 1].t)) wrong(tally, ray, "not in order", h->t);
        if (h->instance_depth < 1 || h->instance_path[0] != w->instance ||
            !solid_model_find(w->model, h->instance_path + 1, h->instance_depth - 1, h->geometry, &state))
            wrong(tally, ray, "names no part", h->t);
    }
    // Where a ray runs along a surface, the others have to say.
    for (size_t i = 1; i < count; i++) {
        if (w->enters[i] < 0 && w->enters[i - 1] >= 0) w->enters[i] = !w->enters[i - 1];
        if (w->enters[count - i] >= 0 && w->enters[count - 1 - i] < 0)
            w->enters[count - 1 - i] = !w->enters[count - i];
    }
    for (size_t i = 1; i < count; i++)
        if (w->enters[i] >= 0 && w->enters[i] == w->enters[i - 1])
            wrong(tally, ray, "entered or left twice", w->hits[i].t);
    tally->boundaries += count;
}

// The spans are those between the boundaries. A ray without any is inside from end to end or nowhere:
// *constant becomes which.
static void check_spans(solid_world *w, const sag_ray *ray, size_t count, membership *constant,
                        solid_tally *tally) {
    sag_span spans[4];
    size_t found = sag_scene_spans(w->scene, ray, spans, 4);
    if (!count) {
        bool whole = found == 1 && spans[0].enter.t == ray->t_min && spans[0].leave.t == ray->t_max;
        if (found > 1 || (found == 1 && !whole)) wrong(tally, ray, "spans without boundaries", 0);
        *constant = found ? MEMBER_IN : MEMBER_OUT;
        return;
    }
    if (w->enters[0] < 0 || w->hits[0].t == ray->t_min || w->hits[count - 1].t == ray->t_max) return;
    bool before = !w->enters[0], after = w->enters[count - 1];
    size_t expected = (count + before + after) / 2;
    if (found != expected) wrong(tally, ray, "another number of spans", (double)found);
    for (size_t i = 0; i < found && i < expected && i < 4; i++) {
        const sag_hit *enter = before && i == 0 ? NULL : &w->hits[2 * i - before];
        const sag_hit *leave = 2 * i + 1 - before < count ? &w->hits[2 * i + 1 - before] : NULL;
        if (enter ? !same_hit(&spans[i].enter, enter)
                  : spans[i].enter.t != ray->t_min || spans[i].enter.primitive != SAG_INVALID_ID)
            wrong(tally, ray, "a span's beginning", spans[i].enter.t);
        if (leave ? !same_hit(&spans[i].leave, leave)
                  : spans[i].leave.t != ray->t_max || spans[i].leave.primitive != SAG_INVALID_ID)
            wrong(tally, ray, "a span's end", spans[i].leave.t);
    }
}

// What the boundaries say of a place between them; unknown when there are none.
static membership said(const solid_world *w, size_t count, double t) {
    if (!count) return MEMBER_UNKNOWN;
    size_t i = 0;
    while (i < count && w->hits[i].t < t) i++;
    if (w->enters[0] < 0) return MEMBER_UNKNOWN;
    bool in = i ? w->enters[i - 1] : !w->enters[0];
    return in ? MEMBER_IN : MEMBER_OUT;
}

// Between two places that were decided, with all states known: one group of crossings [first, end) and so at
// most one boundary, which must be that of the rule.
static void check_owner(solid_world *w, const sag_ray *ray, size_t count, size_t first, size_t end,
                        double from, double to, const membership *before, const membership *after,
                        solid_tally *tally) {
    const model_crossing *c = w->crossings;
    if (first >= end || c[end - 1].t - c[first].t > 0.125 * tolerance(ray, c[first].t)) return;
    for (uint32_t i = 0; i < w->model->state_count; i++)
        if (before[i] == MEMBER_UNKNOWN || after[i] == MEMBER_UNKNOWN) return;
    const sag_hit *found = NULL;
    for (size_t i = 0; i < count; i++) {
        if (!(w->hits[i].t > from && w->hits[i].t < to)) continue;
        if (found) wrong(tally, ray, "two boundaries where faces coincide", w->hits[i].t);
        found = &w->hits[i];
    }
    membership was = solid_model_value(w->model, before), is = solid_model_value(w->model, after);
    if (was == is) {
        if (found) wrong(tally, ray, "a boundary where nothing changes", found->t);
        return;
    }
    if (!found) return; // counted as a wrong decision already, or at an end of the range
    uint32_t owner = solid_model_owner(w->model, before, after), named = UINT32_MAX;
    solid_model_find(w->model, found->instance_path + 1, found->instance_depth - 1, found->geometry, &named);
    if (named != owner) wrong(tally, ray, "the boundary of another part", found->t);
    bool turned = (named < w->model->state_count ? after[named] : is) != is;
    if (named == owner && found->flipped != turned) wrong(tally, ray, "flipped is wrong", found->t);
    bool known = false;
    for (size_t i = first; i < end; i++)
        known |=
            c[i].state == owner && (!w->exact || (c[i].primitive == found->primitive &&
                                                  fabs(c[i].t - found->t) <= 0.125 * tolerance(ray, c[i].t)));
    if (!known && named == owner) wrong(tally, ray, "no such crossing of the part", found->t);
    tally->owners++;
}

// A ray that leaves the boundary begins where it goes to: outward its first hit enters the solid, inward it
// leaves it.
static void check_spawned(solid_world *w, const sag_surface *s, rng *r, solid_tally *tally) {
    for (int outward = 0; outward < 2; outward++) {
        sag_vec3 n = outward ? s->geometric_normal : sag_neg(s->geometric_normal);
        sag_vec3 d = sag_add(n, sag_scale(rng_direction(r), 0.8));
        sag_ray ray = sag_spawn_ray(s, d);
        sag_hit hit;
        sag_surface next;
        if (!sag_intersect(w->scene, &ray, &hit)) continue;
        sag_surface_at(w->scene, &ray, &hit, &next);
        if ((next.side == SAG_SIDE_FRONT) != outward)
            wrong(tally, &ray, outward ? "spawned outward it leaves" : "spawned inward it enters", hit.t);
    }
}

// A step inward from a boundary is in, a step outward is out, unless something else is near.
static void check_normal(solid_world *w, const sag_ray *ray, const sag_hit *hit, rng *r, solid_tally *tally) {
    sag_surface s;
    sag_surface_at(w->scene, ray, hit, &s);
    int inside = 0, outside = 0, places = 0;
    double blur = 0x1p-44 * (largest(s.position) + w->size);
    for (int k = 0; k < 3; k++) {
        double h = ldexp(w->size, -14 - 6 * k);
        if (h < 16 * blur) break;
        spot in = spot_around(sag_madd(s.position, -h, s.geometric_normal), blur);
        spot out = spot_around(sag_madd(s.position, h, s.geometric_normal), blur);
        inside += truth_at(w, &in, w->states[2]), outside += truth_at(w, &out, w->states[2]);
        places++;
    }
    if (places < 3) return;
    if (inside == -3 || outside == 3) wrong(tally, ray, "the normal does not point out of it", hit->t);
    tally->normals++;
    if (inside == 3 && outside == -3) check_spawned(w, &s, r, tally);
}

void solid_check_point(solid_world *w, sag_vec3 point, solid_tally *tally) {
    // On a surface, to the tolerance of solid.h, a point may count as either.
    spot where = spot_around(point, 0x1p-47 * largest(point));
    membership truth = truth_at(w, &where, w->states[2]);
    if (truth == MEMBER_UNKNOWN) {
        tally->undecided++;
        return;
    }
    tally->decisions++;
    if (sag_contains(w->scene, point) != (truth == MEMBER_IN)) {
        sag_ray at = sag_ray_make(point, (sag_vec3){0, 0, 0});
        wrong(tally, &at, truth == MEMBER_IN ? "contains: is in" : "contains: is out", 0);
    }
}

// One question; returns whether it was decided.
static bool decide(solid_world *w, const sag_ray *ray, size_t count, double t, membership *states,
                   membership constant, solid_tally *tally) {
    spot where = spot_on(ray, t);
    membership truth = truth_at(w, &where, states), found = said(w, count, t);
    if (truth == MEMBER_UNKNOWN || (count && found == MEMBER_UNKNOWN)) {
        tally->undecided++;
        return false;
    }
    if (found == MEMBER_UNKNOWN) found = constant;
    tally->decisions++;
    if (found != truth) wrong(tally, ray, truth == MEMBER_IN ? "is in" : "is out", t);
    return true;
}

void solid_check_ray(solid_world *w, const sag_ray *ray, rng *r, bool random, solid_tally *tally) {
    tally->rays++;
    size_t count = ask(w, ray, r, tally);
    check_order(w, ray, count, tally);
    sag_ray local = w->mapped ? sag_ray_transform(&w->back, ray) : *ray;
    size_t n = solid_model_crossings(w->model, &local, &w->crossings, &w->crossing_capacity);
    double margin = w->exact ? 64 : 4096, unit = w->size / largest(ray->direction), from = 0;
    membership constant = MEMBER_UNKNOWN, *before = w->states[0], *after = w->states[1];
    size_t last_decided = SIZE_MAX;
    check_spans(w, ray, count, &constant, tally);
    for (size_t i = 0; i <= n; i++) {
        double a = i ? w->crossings[i - 1].t : -INFINITY, b = i < n ? w->crossings[i].t : INFINITY;
        double low = fmax(a, ray->t_min), high = fmin(b, ray->t_max);
        if (!(low < high)) continue;
        if (isinf(low)) low = fmin(isinf(high) ? 0 : high, 0) - unit * (1 + rng_unit(r));
        if (isinf(high)) high = fmax(low, 0) + unit * (1 + rng_unit(r));
        double gap = margin * fmax(tolerance(ray, low), tolerance(ray, high));
        if (!(high - low > 4 * gap)) continue;
        double middle = low + 0.5 * (high - low);
        bool decided = decide(w, ray, count, middle, after, constant, tally);
        if (decided && last_decided != SIZE_MAX)
            check_owner(w, ray, count, last_decided, i, from, middle, before, after, tally);
        if (decided) {
            membership *swap = before;
            before = after, after = swap;
            last_decided = i, from = middle;
        }
        double t = low + gap + rng_unit(r) * (high - low - 2 * gap);
        decide(w, ray, count, t, w->states[2], constant, tally);
        if (rng_one_in(r, 16)) solid_check_point(w, sag_ray_at(ray, t), tally);
    }
    for (size_t i = 0; random && i < count; i++)
        if (rng_one_in(r, 4)) check_normal(w, ray, &w->hits[i], r, tally);
}

void solid_tally_finish(const solid_tally *tally, const char *name) {
    print_message(
        "%s: %zu rays, %zu decisions, %zu wrong; %zu undecided; %zu boundaries, of %zu the part and of "
        "%zu the normal\n",
        name, tally->rays, tally->decisions, tally->wrong, tally->undecided, tally->boundaries, tally->owners,
        tally->normals);
    assert_int_equal(tally->wrong, 0);
    assert_true(tally->undecided <= tally->decisions / 10);
}
