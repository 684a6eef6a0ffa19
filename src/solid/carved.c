// SPDX-License-Identifier: MIT
// Balls around cutters (carved.h).
#include "solid/carved.h"

uint32_t sagi_carved_part(const sagi_solid *solid) {
    const sagi_solid_part *parts = sagi_solid_parts(solid);
    if (sagi_solid_nodes(solid)->operation != SAG_SOLID_DIFFERENCE) return SAG_INVALID_ID;
    if (solid->part_count < 2 || solid->part_count - 1 > SAGI_CARVED_MOST) return SAG_INVALID_ID;
    // The first operand is a part, and then the first of all.
    return parts[0].parent == 0 && parts[0].weight < 0 ? 0 : SAG_INVALID_ID;
}

bool sagi_carved_add(sagi_carved *carved, uint32_t number, const sag_box3 *box, sag_vec3 center,
                     double radius) {
    const sag_vec3 lo = box->min, hi = box->max;
    const sag_vec3 middle = {lo.x + (hi.x - lo.x) / 2, lo.y + (hi.y - lo.y) / 2, lo.z + (hi.z - lo.z) / 2};
    const double around = sag_length(sag_sub(hi, middle)) * (1 + 0x1p-40);
    if (!(radius <= around)) center = middle, radius = around;
    const double squared = radius * radius, far = sag_dot(center, center);
    if (!(squared < 0x1p200 && far < 0x1p200)) return false;
    sagi_carved_four *four = &carved->fours[number / 4];
    for (uint32_t i = number % 4; i < 4; i++) { // those that do not follow are the same once more
        four->x[i] = center.x, four->y[i] = center.y, four->z[i] = center.z;
        four->squared[i] = squared;
    }
    carved->four_count = number / 4 + 1;
    return true;
}
