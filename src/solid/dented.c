// SPDX-License-Identifier: MIT
// Dented solids (dented.h): which trees are such, and their parts in floats.
#include "solid/dented.h"

bool sagi_dented_tree(const sagi_solid *solid, uint32_t *first) {
    const sagi_solid_node *nodes = sagi_solid_nodes(solid);
    *first = 0;
    if (solid->part_count < 1 || solid->part_count > SAGI_DENTED_MOST || solid->node_count > 2) return false;
    if (solid->node_count == 1 && nodes[0].operation == SAG_SOLID_INTERSECTION) return true;
    if (nodes[0].operation != SAG_SOLID_DIFFERENCE) return false;
    if (solid->node_count == 1) {
        *first = SAG_INVALID_ID;
        return true;
    }
    *first = 1;
    return nodes[1].operation == SAG_SOLID_INTERSECTION && nodes[1].weight < 0;
}

bool sagi_dented_begin(sagi_dented *dented, const sag_box3 *box) {
    const sag_vec3 lo = box->min, hi = box->max;
    const sag_vec3 half = {(hi.x - lo.x) / 2, (hi.y - lo.y) / 2, (hi.z - lo.z) / 2};
    const double size = fmax(half.x, fmax(half.y, half.z));
    if (!(size > 0x1p-200 && size < 0x1p200)) return false;
    int exponent;
    frexp(size * (1 + 0x1p-40), &exponent);
    *dented =
        (sagi_dented){.origin = {lo.x + half.x, lo.y + half.y, lo.z + half.z}, .scale = ldexp(1, -exponent)};
    return true;
}

static bool put(const sagi_dented *dented, sag_vec3 p, float out[3]) {
    const double x[3] = {(p.x - dented->origin.x) * dented->scale, (p.y - dented->origin.y) * dented->scale,
                         (p.z - dented->origin.z) * dented->scale};
    for (int k = 0; k < 3; k++) {
        if (!(fabs(x[k]) <= 8)) return false;
        out[k] = (float)x[k];
    }
    return true;
}

bool sagi_dented_add(sagi_dented *dented, uint32_t part, const sag_box3 *box, const sag_sphere *ball) {
    sagi_dented_part *to = &dented->parts[dented->count++];
    to->part = part, to->is_ball = ball != NULL;
    if (ball == NULL) return put(dented, box->min, to->lo) && put(dented, box->max, to->hi);
    to->hi[0] = (float)(ball->radius * dented->scale), to->hi[1] = to->hi[2] = 0;
    return put(dented, ball->center, to->lo) && to->hi[0] <= 8;
}
