// SPDX-License-Identifier: MIT
// Questions that rays of a batch put off until all of them are through with the rest: those to solids that
// are meshes with cutters (solid_batch.inl). Part of kernel.inl.
#define CROWD 1024 // rays that are asked together

struct later {
    const sag_ray *rays;
    uint32_t count;
    struct {
        uint32_t ray, geometry; // a ray, and an instance that it comes to
    } at[CROWD];
};

static inline bool can_wait(const sagi_item *item) {
    return item->kind == SAG_SHAPE_INSTANCE && item->child->carved != NULL;
}

// False: it has to be asked at once.
static bool put_off(const level *here, uint32_t geometry) {
    later *l = here->search->later;
    if (here->search->path_length > 0 || l->count == CROWD) return false;
    l->at[l->count].ray = (uint32_t)(here->ray - l->rays), l->at[l->count++].geometry = geometry;
    return true;
}

// The same for all of these and rays from `first` on, by bits; none may be put off where another may not.
static inline bool put_off_all(later *l, const sagi_world *world, uint32_t mask,
                               const sagi_bvh_reference *refs, uint32_t count, const sag_ray *first,
                               uint32_t rays) {
    if (l == NULL || (uint64_t)count * (uint32_t)__builtin_popcount(rays) > CROWD - l->count) return false;
    for (uint32_t k = 0; k < count; k++)
        if (!can_wait(&world->items[refs[k].geometry])) return false;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t geometry = refs[k].geometry;
        if ((mask & world->items[geometry].mask) == 0) continue;
        for (uint32_t left = rays; left != 0; left &= left - 1) {
            l->at[l->count].ray = (uint32_t)(first - l->rays) + (uint32_t)__builtin_ctz(left);
            l->at[l->count++].geometry = geometry;
        }
    }
    return true;
}

// Of what was put off since there were `kept`, that of these rays, which will ask again.
static void forget_put_off(later *l, uint32_t kept, uint32_t first, uint32_t rays) {
    const uint32_t count = l->count;
    l->count = kept;
    for (uint32_t i = kept; i < count; i++)
        if ((rays >> (l->at[i].ray - first) & 1) == 0) l->at[l->count++] = l->at[i];
}
