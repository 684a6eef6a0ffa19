// SPDX-License-Identifier: MIT
// Many rays on one thread. Part of kernel.inl.
#include "kernel/packet.inl"

static void intersect_batch(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count) {
    packet_luck luck = {0};
    for (size_t i = 0; i < count;) {
        if (count - i >= PACKET_RAYS && packet_intersect(world, rays + i, hits + i, &luck)) {
            i += PACKET_RAYS;
            continue;
        }
        for (size_t end = i + PACKET_RAYS < count ? i + PACKET_RAYS : count; i < end; i++)
            if (!intersect(world, &rays[i], &hits[i]))
                hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
    }
}

static void occluded_batch(const sagi_world *world, const sag_ray *rays, bool *dark, size_t count) {
    for (size_t i = 0; i < count; i++) dark[i] = occluded(world, &rays[i]);
}
