// SPDX-License-Identifier: MIT
// What stands in a leaf: references, those of one kind of shape side by side. Part of kernel.inl.
//
// The switch below is the second of the two places that list the shapes (the first is src/shapes/table.c). It
// has no default, so the compiler names a kind that is missing.

static inline bool mesh_run(question asked, level *here, const sagi_bvh_reference *refs, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const sagi_item *item = &here->world->items[refs[i].geometry];
        if (sees(here, item) && triangle(asked, here, item, refs[i])) return true;
    }
    return false;
}

// The ray in the space of the geometry of a run, with the t_max that is known by now; worked out again only
// when the geometry changes.
typedef struct local_ray {
    const sagi_item *item;
    bool valid;
    sag_ray ray;
} local_ray;

static inline const sag_ray *local(const level *here, const sagi_item *item, local_ray *at) {
    if (at->item != item) {
        at->item = item;
        at->valid = true;
        at->ray = *here->ray;
        if (item->place != NULL) {
            at->ray = sagi_ray_transform(&item->place->to_object, here->ray);
            at->valid = sagi_ray_is_valid(&at->ray);
        }
    }
    at->ray.t_max = here->t_max;
    return at->valid ? &at->ray : NULL;
}

static inline bool spheres_run(question asked, level *here, const sagi_bvh_reference *refs, uint32_t count) {
    local_ray at = {.item = NULL};
    for (uint32_t i = 0; i < count; i++) {
        const sagi_item *item = &here->world->items[refs[i].geometry];
        if (!sees(here, item)) continue;
        const sag_ray *ray = local(here, item, &at);
        if (ray == NULL) continue;
        sag_vec3 center;
        double radius, t[2];
        sagi_spheres_get(item->shape, refs[i].primitive, &center, &radius);
        int found = asked == ALL ? sagi_sphere_crossings(center, radius, ray, t)
                                 : sagi_sphere_hit(center, radius, ray, t);
        for (int k = 0; k < found; k++)
            if (accept(asked, here, refs[i].geometry, refs[i].primitive, t[k], 0, 0)) return true;
    }
    return false;
}

// Hands what a user's callback reports on to accept.
typedef struct user_sink {
    question asked;
    level *here;
    uint32_t geometry;
    bool over;
} user_sink;

static double user_take(void *argument, uint32_t primitive, double t, double u, double v) {
    user_sink *sink = argument;
    sink->over |= accept(sink->asked, sink->here, sink->geometry, primitive, t, u, v);
    return sink->here->t_max;
}

// User-defined primitives: one call of the callback for those of one geometry.
static inline bool user_run(question asked, level *here, const sagi_bvh_reference *refs, uint32_t count) {
    local_ray at = {.item = NULL};
    for (uint32_t i = 0, n; i < count; i += n) {
        uint32_t primitives[SAGI_BVH_MAX_LEAF], geometry = refs[i].geometry;
        for (n = 0; n < SAGI_BVH_MAX_LEAF && i + n < count && refs[i + n].geometry == geometry; n++)
            primitives[n] = refs[i + n].primitive;
        const sagi_item *item = &here->world->items[geometry];
        const sag_ray *ray = sees(here, item) ? local(here, item, &at) : NULL;
        if (ray == NULL) continue;
        const sag_user *user = item->shape;
        user_sink sink = {asked, here, geometry, false};
        sag_user_report report = {ray->t_min, ray->t_max, user_take, &sink};
        user->crossings(user->user, primitives, n, ray, &report);
        if (sink.over) return true;
    }
    return false;
}

// Instances: the same search in the child's world, with the ray brought to its space. As deep as
// SAG_MAX_INSTANCE_DEPTH at most, which commit saw to.
static inline bool instance_run(question asked, level *here, const sagi_bvh_reference *refs, uint32_t count) {
    search *s = here->search;
    for (uint32_t i = 0; i < count; i++) {
        const sagi_item *item = &here->world->items[refs[i].geometry];
        local_ray at = {.item = NULL};
        if (asked == CLOSEST && s->later != NULL && can_wait(item) && sees(here, item) &&
            put_off(here, refs[i].geometry))
            continue;
        const sag_ray *ray = sees(here, item) ? local(here, item, &at) : NULL;
        if (ray == NULL) continue;
        level below;
        enter(&below, item->child, ray, s);
        s->path[s->path_length++] = refs[i].geometry;
        bool over = below.world->solid != NULL ? search_solid(asked, &below)
                    : asked == CLOSEST         ? walk_closest(&below)
                    : asked == ANY             ? walk_any(&below)
                                               : walk_all(&below);
        s->path_length--;
        if (over) return true;
        lower_t_max(here, below.t_max);
    }
    return false;
}

// A shape's verb for the question, on the ray in its space.
#define ASK(X)                                                                                               \
    (asked == ANY       ? (size_t)sag_##X##_occluded(shape, ray)                                             \
     : asked == CLOSEST ? (size_t)sag_##X##_hit(shape, ray, hits)                                            \
                        : sag_##X##_crossings(shape, ray, hits, SAGI_MAX_CROSSINGS))

// How many crossings; writes them to hits[SAGI_MAX_CROSSINGS], except for ANY.
static inline size_t ask(question asked, sag_shape_kind kind, const void *shape, const sag_ray *ray,
                         sag_hit *hits) {
    switch (kind) {
    case SAG_SHAPE_PLANE: return ASK(plane);
    case SAG_SHAPE_DISK: return ASK(disk);
    case SAG_SHAPE_RECTANGLE: return ASK(rectangle);
    case SAG_SHAPE_POLYGON: return ASK(polygon);
    case SAG_SHAPE_SPHERE: return ASK(sphere);
    case SAG_SHAPE_ELLIPSOID: return ASK(ellipsoid);
    case SAG_SHAPE_CYLINDER: return ASK(cylinder);
    case SAG_SHAPE_CONE: return ASK(cone);
    case SAG_SHAPE_PARABOLOID: return ASK(paraboloid);
    case SAG_SHAPE_HYPERBOLOID: return ASK(hyperboloid);
    case SAG_SHAPE_HYPERBOLOID2: return ASK(hyperboloid2);
    case SAG_SHAPE_QUADRIC: return ASK(quadric);
    case SAG_SHAPE_BOX: return ASK(box);
    case SAG_SHAPE_ORIENTED_BOX: return ASK(oriented_box);
    case SAG_SHAPE_POLYHEDRON: return ASK(polyhedron);
    case SAG_SHAPE_CAPSULE: return ASK(capsule);
    case SAG_SHAPE_TRIANGLE: return ASK(triangle);
    case SAG_SHAPE_BILINEAR_PATCH: return ASK(bilinear_patch);
    case SAG_SHAPE_TORUS: return ASK(torus);
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_SPHERES:
    case SAG_SHAPE_USER:
    case SAG_SHAPE_INSTANCE: break; // these have runs of their own
    }
    return 0;
}

static inline bool single_run(question asked, level *here, sag_shape_kind kind,
                              const sagi_bvh_reference *refs, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const sagi_item *item = &here->world->items[refs[i].geometry];
        local_ray at = {.item = NULL};
        const sag_ray *ray = sees(here, item) ? local(here, item, &at) : NULL;
        if (ray == NULL) continue;
        if (asked != ALL && item->outline != NULL) {
            double t;
            uint32_t primitive;
            const sagi_first first = sagi_outline_first(item->outline, ray, &t, &primitive);
            if (first == SAGI_FIRST_NONE) continue;
            if (first == SAGI_FIRST_HIT) {
                if (accept(asked, here, refs[i].geometry, primitive, t, 0, 0)) return true;
                continue;
            }
        }
        sag_hit hits[SAGI_MAX_CROSSINGS];
        size_t found = ask(asked, kind, item->shape, ray, hits);
        if (asked == ANY && found > 0) return here->search->found = true;
        for (size_t k = 0; k < found && k < SAGI_MAX_CROSSINGS; k++)
            if (accept(asked, here, refs[i].geometry, hits[k].primitive, hits[k].t, hits[k].u, hits[k].v))
                return true;
    }
    return false;
}

// References of one kind; true when the search is over.
static inline bool run(question asked, level *here, sag_shape_kind kind, const sagi_bvh_reference *refs,
                       uint32_t count) {
    if (kind == SAG_SHAPE_MESH) return mesh_run(asked, here, refs, count);
    if (kind == SAG_SHAPE_SPHERES) return spheres_run(asked, here, refs, count);
    if (kind == SAG_SHAPE_USER) return user_run(asked, here, refs, count);
    if (kind == SAG_SHAPE_INSTANCE) return instance_run(asked, here, refs, count);
    return single_run(asked, here, kind, refs, count);
}

// Cuts references into runs of one kind. bench/dispatch defines SAGI_KERNEL_OTHER_LIST and measures other
// ways in its place.
#ifdef SAGI_KERNEL_OTHER_LIST
static bool list(question asked, level *here, const sagi_bvh_reference *refs, uint32_t count);
#else
static __attribute__((noinline)) bool list(question asked, level *here, const sagi_bvh_reference *refs,
                                           uint32_t count) {
    for (uint32_t i = 0, n; i < count; i += n) {
        uint8_t kind = here->world->items[refs[i].geometry].kind;
        for (n = 1; i + n < count && here->world->items[refs[i + n].geometry].kind == kind; n++) {
        }
        if (run(asked, here, (sag_shape_kind)kind, refs + i, n)) return true;
    }
    return false;
}
#endif

// A leaf of the tree that the ray meets at τ = begin at the earliest. Shapes are asked with the t_max that is
// known by then.
SAGI_INLINE bool other_than_triangles(question asked, level *here, const sagi_block *block, float begin) {
    if (block->kind == SAGI_BLOCK_SPHERES) return sphere_block(asked, here, block, begin);
    if (asked == CLOSEST) settle(here);
    return list(asked, here, ((const sagi_reference_block *)(const void *)block)->reference, block->count);
}
SAGI_INLINE bool leaf(question asked, level *here, const sagi_block *block, float begin) {
    if (block->kind == SAGI_BLOCK_TRIANGLES)
        return triangle_block(asked, here, (const sagi_triangle_block *)(const void *)block, begin);
    return other_than_triangles(asked, here, block, begin);
}
