// SPDX-License-Identifier: MIT
// Crossings at one place (solid.inl). Part of kernel.inl. Some are known roughly at first: where their order
// and distance is not certain they are made exact, so that the groups are those of exact crossings.

// Makes all crossings exact that might be in a group with the next one, if there are such; whether there were
// any.
static __attribute__((noinline)) bool make_exact(solid_walk *w) {
    solid_event near[SOLID_GROUP];
    uint32_t count = 0;
    const double end = end_of_next(w);
    for (uint32_t i = w->event_count; i-- > 0 && count < SOLID_GROUP;) {
        const solid_event e = w->events[i];
        if (e.t - w->most_error > end) break;
        if (e.error == 0 || e.t - e.error > end) continue;
        near[count++] = e;
        for (uint32_t k = i + 1; k < w->event_count; k++) w->events[k - 1] = w->events[k];
        w->event_count--;
    }
    for (uint32_t i = 0; i < count; i++) {
        refine(w, &near[i]);
        add_event(w, &near[i]);
    }
    return count > 0;
}

// As know_next, and what is in a group with the next crossing is exact.
static __attribute__((noinline, hot)) bool know_group(solid_walk *w) {
    while (know_next(w)) {
        if (w->most_error == 0 || w->event_count == 1) return true;
        if ((next_event(w) - 1)->t - w->most_error > end_of_next(w) || !make_exact(w)) return true;
    }
    return false;
}

// Crossings at one place, taken: the first few of them.
typedef struct solid_group {
    uint32_t count; // of all
    solid_event at[SOLID_GROUP];
} solid_group;

static __attribute__((noinline)) void pay(solid_walk *w) {
    while (w->owed_count > 0) ask_again(w, &w->owed[--w->owed_count]);
}

// Up to the end of the crossing at hand all are known; only one that joins it asks for more.
SAGI_INLINE void take_group(solid_walk *w, solid_group *group) {
    group->count = 0;
    for (;;) {
        const solid_event e = w->events[--w->event_count];
        if (group->count < SOLID_GROUP) group->at[group->count] = e;
        group->count++;
        toggle(w, e.part, e.entering);
        w->done = e.t;
        if (e.again && !e.near && w->owed_count < SOLID_OWED)
            w->owed[w->owed_count++] = e;
        else if (e.again)
            ask_again(w, &e);
        if (w->event_count == 0 && w->events_cut) refill_events(w);
        if (w->event_count == 0 || !(next_event(w)->t - w->done <= tolerance(w, w->done))) return;
        if (w->owed_count > 0) pay(w);
        if (!know_group(w)) return;
    }
}

static __attribute__((noinline, cold)) solid_event choose_from_all(solid_walk *w, double from, double to);

// The group's first crossing of the part, where it crosses an odd number of times, else NULL; *next becomes
// the part after it.
static inline solid_event *crossing_of(solid_group *group, uint32_t part, uint32_t *next) {
    solid_event *e = NULL;
    bool odd = false;
    *next = SAG_INVALID_ID;
    for (uint32_t i = group->count; i-- > 0;) {
        if (group->at[i].part > part && group->at[i].part < *next) *next = group->at[i].part;
        if (group->at[i].part == part) e = &group->at[i], odd = !odd;
    }
    return odd ? e : NULL;
}

// Whose the boundary is: the first part whose crossing alone would have changed the solid, or where there is
// none, the first whose crossing does after those of the parts before it. `first` is the t of the group's
// first crossing.
static __attribute__((noinline)) solid_event *choose(solid_walk *w, solid_group *group, double first) {
    const bool after = w->value;
    if (group->count > SOLID_GROUP) {
        group->at[0] = choose_from_all(w, sagi_next_down(first), w->done);
        return &group->at[0];
    }
    for (uint32_t i = 0; i < group->count; i++) toggle(w, group->at[i].part, !group->at[i].entering);
    solid_event *owner = NULL;
    for (int together = 0; together < 2 && owner == NULL; together++) {
        uint32_t taken = 0;
        for (uint32_t part = 0, next; part != SAG_INVALID_ID && owner == NULL; part = next) {
            solid_event *e = crossing_of(group, part, &next);
            if (e == NULL) continue;
            toggle(w, part, e->entering);
            if (w->value == after) owner = e;
            if (!together || owner != NULL)
                toggle(w, part, !e->entering);
            else
                taken = part + 1;
        }
        for (uint32_t part = 0, next; part < taken; part = next) { // as they were
            solid_event *e = crossing_of(group, part, &next);
            if (e != NULL) toggle(w, part, !e->entering);
        }
    }
    for (uint32_t i = 0; i < group->count; i++) toggle(w, group->at[i].part, group->at[i].entering);
    return owner != NULL ? owner : &group->at[0];
}
