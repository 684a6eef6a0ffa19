// SPDX-License-Identifier: MIT
// Which geometries share a tree, and what a commit has to do for each such group.
//
// Geometries that are not expected to change share one tree, which is best to trace. One that is (sag_update)
// has a tree of its own, so that a change to it costs what it costs alone; but small ones, instances above
// all, would be a crowd of tiny trees: they share a second one, which is soon built. Groups whose members are
// what they were at the last commit keep their tree, as long as it is in the same units.
//
// Units: boxes are in [−1, 1] relative to the scene's origin and size. Both are kept from commit to commit
// while everything fits; then kept trees need not be touched. So that it fits for a while, a scene in which
// something is expected to change begins with twice the room.
#include "scene/structure.h"
#include <float.h>
#include <string.h>

#define FEW          256u   // primitives: no tree of their own. SAGI_FILE_VERSION goes up with a change
#define LEAST_EXTENT 0x1p-8 // of what units are kept for: below it, boxes would lose too many of their bits

static sagi_group_class class_of(const sagi_snapshot *s, uint32_t id) {
    if (s->entries[id].update == SAG_UPDATE_STATIC) return SAGI_GROUP_UNCHANGING;
    return sagi_primitive_count(s, id) < FEW ? SAGI_GROUP_SMALL : SAGI_GROUP_LARGE;
}

static void fill_groups(sagi_snapshot *s, bool single, const uint32_t count[3]) {
    uint32_t next[3] = {0, count[0], count[0] + count[1]};
    sagi_group *g = s->groups;
    for (int shared = SAGI_GROUP_UNCHANGING; shared <= SAGI_GROUP_SMALL; shared++)
        if (count[shared] > 0)
            *g++ = (sagi_group){.class = (sagi_group_class)shared,
                                .member_first = next[shared],
                                .member_count = count[shared]};
    for (uint32_t id = 0; id < s->count; id++) {
        if (!s->entries[id].present) continue;
        sagi_group_class class = single ? SAGI_GROUP_UNCHANGING : class_of(s, id);
        if (class == SAGI_GROUP_LARGE)
            *g++ = (sagi_group){.class = class,
                                .member_first = next[class],
                                .member_count = 1,
                                .may_refit = s->entries[id].update == SAG_UPDATE_REFIT};
        s->members[next[class]++] = id;
    }
}

sag_status sagi_groups_form(sagi_snapshot *s, bool single) {
    uint32_t count[3] = {0, 0, 0};
    for (uint32_t id = 0; id < s->count; id++)
        if (s->entries[id].present) count[single ? SAGI_GROUP_UNCHANGING : class_of(s, id)]++;
    s->member_count = count[0] + count[1] + count[2];
    s->group_count = (count[0] > 0) + (count[1] > 0) + count[2];
    if (s->member_count == 0) return SAG_OK;
    s->groups = sag_allocate(s->context, s->group_count * sizeof *s->groups);
    s->members = sag_allocate(s->context, s->member_count * sizeof *s->members);
    if (s->groups == NULL || s->members == NULL) {
        sagi_groups_release(s);
        return SAG_ERROR_MEMORY;
    }
    fill_groups(s, single, count);
    return SAG_OK;
}

void sagi_groups_release(sagi_snapshot *s) {
    sag_release(s->context, s->groups, s->group_count * sizeof *s->groups);
    sag_release(s->context, s->members, s->member_count * sizeof *s->members);
    s->groups = NULL, s->members = NULL;
    s->group_count = s->member_count = 0;
}

// The old group of the same members; NULL when there is none. Large ones are in order of their ids: *at is
// where the search for the next goes on.
static const sagi_group *find_before(const sagi_snapshot *s, const sagi_group *g, const sagi_snapshot *old,
                                     uint32_t *at) {
    const uint32_t *members = s->members + g->member_first;
    for (; *at < old->group_count; (*at)++) {
        const sagi_group *b = &old->groups[*at];
        const uint32_t *others = old->members + b->member_first;
        if (b->class > g->class || (b->class == SAGI_GROUP_LARGE && others[0] > members[0])) break;
        if (b->class == g->class && b->member_count == g->member_count &&
            memcmp(members, others, g->member_count * sizeof *members) == 0)
            return b;
    }
    return NULL;
}

static bool is_as_before(const sagi_snapshot *s, const sagi_group *g, const sagi_snapshot *old) {
    for (uint32_t i = 0; i < g->member_count; i++)
        if (!sagi_geometry_is_as_before(s, old, s->members[g->member_first + i])) return false;
    return true;
}

static void plan(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs, bool no_refits) {
    for (uint32_t i = 0, at = 0; i < s->group_count; i++) {
        sagi_group *g = &s->groups[i];
        jobs[i] = (sagi_job){.work = {.snapshot = s, .group = g}};
        const sagi_group *b = old != NULL && old->quality == s->quality ? find_before(s, g, old, &at) : NULL;
        if (b == NULL) continue;
        jobs[i].before = b;
        bool wanted_anew = b->is_refitted && !g->may_refit;
        if (is_as_before(s, g, old) && !wanted_anew)
            jobs[i].plan = SAGI_KEEP;
        else if (g->may_refit && !no_refits &&
                 s->items[s->members[g->member_first]].kind == old->items[s->members[g->member_first]].kind)
            jobs[i].plan = SAGI_REFIT;
    }
}

// Whether the good primitives can be those that were. There are as many; if each that is in the tree is good,
// which sagi_refit sees, they are.
static bool may_be_same(const sagi_survey *now, const sagi_survey *before) {
    return now->good > 0 && now->good == before->good && now->unbounded == 0 && before->unbounded == 0;
}

// What is found out about the primitives; a kept group's are as they were.
static sag_status survey(sagi_snapshot *s, sagi_job *jobs) {
    for (uint32_t i = 0; i < s->group_count; i++) {
        sagi_job *j = &jobs[i];
        sag_status status = SAG_OK;
        if (j->plan == SAGI_KEEP)
            s->groups[i].found = j->before->found;
        else if (j->work.first == NULL)
            status = sagi_structure_survey(&j->work);
        if (status != SAG_OK) return status;
        if (j->plan == SAGI_REFIT && !may_be_same(&s->groups[i].found, &j->before->found))
            j->plan = SAGI_BUILD;
    }
    return SAG_OK;
}

static sag_status sum_up(sagi_snapshot *s) {
    uint64_t good = 0, unbounded = 0;
    sag_scene_stats *t = &s->stats;
    t->bounds = sag_box3_empty();
    t->dropped_not_finite = t->dropped_degenerate = 0;
    for (uint32_t i = 0; i < s->group_count; i++) {
        sagi_group *g = &s->groups[i];
        g->unbounded_first = unbounded;
        good += g->found.good, unbounded += g->found.unbounded;
        t->dropped_not_finite += g->found.not_finite;
        t->dropped_degenerate += g->found.degenerate;
        t->bounds = sag_box3_union(t->bounds, g->found.bounds);
    }
    t->primitive_count = good + unbounded;
    return good > INT32_MAX || t->primitive_count > UINT32_MAX ? SAG_ERROR_ARGUMENT : SAG_OK;
}

static double reach_from(const sag_box3 *b, sag_vec3 origin) {
    return fmax(sag_max_component(sag_sub(b->max, origin)), sag_max_component(sag_sub(origin, b->min)));
}

// A multiple of the unit nearby.
static double rounded(double x, double unit) { return nearbyint(x / unit) * unit; }

// The world's units: its middle, and the power of two that brings everything within [−1, 1]. The middle is
// rounded a little, so that it is a round number where vertices are: else fine grids around it might have all
// of them between their lines (kernel/corners.h).
static void choose_units(sagi_snapshot *s) {
    const sag_box3 *b = &s->stats.bounds;
    s->world.origin = (sag_vec3){0, 0, 0};
    s->world.scale = 1;
    if (sag_box3_is_empty(b)) return;
    int exponent;
    const sag_vec3 middle = sag_scale(sag_add(b->min, b->max), 0.5);
    const double unit = frexp(reach_from(b, middle), &exponent) > 0 ? ldexp(1, exponent - 16) : 0;
    s->world.origin = unit >= DBL_MIN ? (sag_vec3){rounded(middle.x, unit), rounded(middle.y, unit),
                                                   rounded(middle.z, unit)}
                                      : middle;
    frexp(reach_from(b, s->world.origin), &exponent);
    if (s->group_count > 0 && s->groups[s->group_count - 1].class != SAGI_GROUP_UNCHANGING) exponent++;
    s->world.scale = ldexp(1, -(exponent < -900 ? -900 : exponent));
}

// Takes over the old units if there is something to keep in them and they still do; else nothing is kept.
static void settle_units(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs) {
    bool any = false;
    for (uint32_t i = 0; i < s->group_count; i++)
        any |= jobs[i].plan != SAGI_BUILD && jobs[i].before->found.good > 0;
    if (any) {
        double reach = reach_from(&s->stats.bounds, old->world.origin) * old->world.scale;
        if (reach <= 1 && reach >= LEAST_EXTENT) {
            s->world.origin = old->world.origin, s->world.scale = old->world.scale;
            return;
        }
    }
    choose_units(s);
    for (uint32_t i = 0; i < s->group_count; i++) jobs[i].plan = SAGI_BUILD;
}

static sag_status take_unbounded(sagi_snapshot *s, const sagi_snapshot *old, const sagi_job *jobs) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < s->group_count; i++) count += s->groups[i].found.unbounded;
    s->unbounded = sag_allocate(s->context, (size_t)count * sizeof *s->unbounded);
    if (count > 0 && s->unbounded == NULL) return SAG_ERROR_MEMORY;
    s->world.unbounded = s->unbounded;
    s->world.unbounded_count = s->unbounded_capacity = (uint32_t)count;
    for (uint32_t i = 0; i < s->group_count; i++) {
        const sagi_group *g = &s->groups[i], *b = jobs[i].before;
        if (jobs[i].plan == SAGI_KEEP && g->found.unbounded > 0)
            memcpy(s->unbounded + g->unbounded_first, old->unbounded + b->unbounded_first,
                   g->found.unbounded * sizeof *s->unbounded);
    }
    return SAG_OK;
}

// What is not to be tried (again).
typedef struct limits {
    bool no_groups; // the groups' trees together would be too deep
    bool no_refits; // of a tree some primitives are not there any more
} limits;

// Everything but the groups themselves; `jobs` is one a group. *again: with these new limits.
static sag_status build(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs, limits *l, bool *again) {
    bool too_deep = false, unlike = false;
    plan(s, old, jobs, l->no_refits);
    sag_status status = survey(s, jobs);
    if (status == SAG_OK) status = sum_up(s);
    if (status == SAG_OK) settle_units(s, old, jobs);
    if (status == SAG_OK) status = survey(s, jobs); // what was to be kept
    if (status == SAG_OK) status = take_unbounded(s, old, jobs);
    for (uint32_t i = 0; i < s->group_count && status == SAG_OK; i++)
        if (jobs[i].plan == SAGI_BUILD) status = sagi_structure_build(&jobs[i].work, &jobs[i].tree);
    if (status == SAG_OK) status = sagi_assemble(s, old, jobs, &too_deep);
    for (uint32_t i = 0; i < s->group_count && status == SAG_OK && !too_deep && !unlike; i++)
        if (jobs[i].plan == SAGI_REFIT) unlike = !sagi_refit(s, &s->groups[i]);
    l->no_groups |= too_deep, l->no_refits |= unlike;
    *again = too_deep || unlike;
    return status;
}

static sag_status form_and_build(sagi_snapshot *s, const sagi_snapshot *old, limits *l, bool *again) {
    *again = false;
    sag_status status = sagi_groups_form(s, l->no_groups);
    if (status != SAG_OK) return status;
    size_t bytes = s->group_count * sizeof(sagi_job);
    sagi_job *jobs = sag_allocate(s->context, bytes);
    if (bytes > 0 && jobs == NULL) return SAG_ERROR_MEMORY;
    status = build(s, old, jobs, l, again);
    for (uint32_t i = 0; i < s->group_count; i++) {
        sagi_structure_release(&jobs[i].work);
        sagi_bvh_release(s->context, &jobs[i].tree);
    }
    sag_release(s->context, jobs, bytes);
    return status;
}

// The second and third attempts are rare: all in one tree is never too deep. The parts of a solid always are.
sag_status sagi_snapshot_build(sagi_snapshot *s, const sagi_snapshot *old) {
    limits l = {s->solid != NULL, false};
    if (s->solid != NULL || (old != NULL && old->solid != NULL)) old = NULL; // not of the same primitives
    bool again;
    sag_status status = form_and_build(s, old, &l, &again);
    while (status == SAG_OK && again) {
        sagi_groups_release(s);
        sagi_bvh_release(s->context, &s->world.tree);
        sag_release(s->context, s->unbounded, s->unbounded_capacity * sizeof *s->unbounded);
        s->unbounded = NULL, s->unbounded_capacity = 0;
        status = form_and_build(s, old, &l, &again);
    }
    if (status == SAG_OK) sagi_snapshot_measure(s);
    return status;
}
