// SPDX-License-Identifier: MIT
// Many rays on one thread. Part of kernel.inl.

static void intersect_batch(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!intersect(world, &rays[i], &hits[i]))
            hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
}

static void occluded_batch(const sagi_world *world, const sag_ray *rays, bool *dark, size_t count) {
    for (size_t i = 0; i < count; i++) dark[i] = occluded(world, &rays[i]);
}
