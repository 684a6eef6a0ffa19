// SPDX-License-Identifier: MIT
// Writing a block of spheres (kernel/block.h).
//
// A centre (p − C)·scale errs by 2⁻⁵² in world units at most, which is 2⁻¹² grid steps at most; subtracting
// the grid's zero may add as much, scaling is exact, and so is the radius but for the rounding to the grid,
// which costs half a step: SAGI_GRID_ERROR. The grid holds centre − radius and centre + radius, so a radius
// is at most 32768 steps.
#include "kernel/grid.h"
#include "scene/scene.h"
#include "shapes/spheres.h"

// Coordinate by coordinate like the block; the last row is the radii.
typedef double balls[4][SAGI_BVH_WIDTH];

static void read_balls(const sagi_snapshot *s, const sagi_bvh_primitive *p, uint32_t count, balls at) {
    const sag_vec3 origin = s->world.origin;
    const double scale = s->world.scale;
    for (uint32_t j = 0; j < count; j++) {
        const uint32_t number = p[j].primitive;
        const sagi_ball ball = p[0].geometry == SAGI_LONE_SPHERES
                                   ? sagi_sphere_ball(s->items[number].shape)
                                   : sagi_spheres_ball(s->items[p[0].geometry].shape, number);
        at[0][j] = (ball.center[0] - origin.x) * scale, at[1][j] = (ball.center[1] - origin.y) * scale;
        at[2][j] = (ball.center[2] - origin.z) * scale, at[3][j] = ball.radius * scale;
    }
}

void sagi_sphere_leaf_write(const sagi_snapshot *s, const sagi_bvh_primitive *p, uint32_t count,
                            sagi_block *block) {
    const uint32_t length = sagi_sphere_row_length(count);
    sagi_block head = {.kind = SAGI_BLOCK_SPHERES, .count = (uint8_t)count, .geometry = p[0].geometry};
    double zero[4] = {0}, extent = 0;
    balls at;
    read_balls(s, p, count, at);
    for (int k = 0; k < 3; k++) {
        double least = at[k][0] - at[3][0], most = at[k][0] + at[3][0];
        for (uint32_t j = 1; j < count; j++) {
            double lo = at[k][j] - at[3][j], hi = at[k][j] + at[3][j];
            least = lo < least ? lo : least, most = hi > most ? hi : most;
        }
        zero[k] = sagi_grid_zero(&head, k, least);
        double reach = most - zero[k];
        extent = reach > extent ? reach : extent;
    }
    double steps = sagi_grid_steps(&head, extent);
    *block = head;
    uint16_t *row = (uint16_t *)(void *)(block + 1);
    for (int k = 0; k < 4; k++, row += length)
        for (uint32_t j = 0; j < count; j++) row[j] = (uint16_t)(int32_t)((at[k][j] - zero[k]) * steps + 0.5);
    uint32_t *primitive = (uint32_t *)(void *)row;
    for (uint32_t j = 0; j < count; j++) primitive[j] = p[j].primitive;
}
