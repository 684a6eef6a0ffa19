// SPDX-License-Identifier: MIT
// Where the parts of a solid matter (tree.h). Parents have lower numbers than their nodes: from the last node
// to the first every box is complete when its parent asks for it, and back again every node's box is clipped
// before its operands are.
#include "solid/tree.h"

static sag_box3 common(sag_box3 a, sag_box3 b) {
    return (sag_box3){{fmax(a.min.x, b.min.x), fmax(a.min.y, b.min.y), fmax(a.min.z, b.min.z)},
                      {fmin(a.max.x, b.max.x), fmin(a.max.y, b.max.y), fmin(a.max.z, b.max.z)}};
}

static bool adds(uint8_t operation) { return operation == SAG_SOLID_UNION || operation == SAG_SOLID_XOR; }

static void take(const sagi_solid_node *node, sag_box3 *box, sag_box3 operand, int weight) {
    if (adds(node->operation))
        *box = sag_box3_union(*box, operand);
    else if (node->operation == SAG_SOLID_INTERSECTION || weight < 0)
        *box = common(*box, operand);
}

void sagi_solid_clip_boxes(const sagi_solid *solid, sag_box3 *box, sag_box3 *node_box) {
    const sagi_solid_node *nodes = sagi_solid_nodes(solid);
    const sagi_solid_part *parts = sagi_solid_parts(solid);
    const sag_box3 all = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    for (uint32_t n = 0; n < solid->node_count; n++)
        node_box[n] = adds(nodes[n].operation) ? sag_box3_empty() : all;
    for (uint32_t i = 0; i < solid->part_count; i++)
        take(&nodes[parts[i].parent], &node_box[parts[i].parent], box[i], parts[i].weight);
    for (uint32_t n = solid->node_count; n-- > 1;)
        take(&nodes[nodes[n].parent], &node_box[nodes[n].parent], node_box[n], nodes[n].weight);
    for (uint32_t n = 1; n < solid->node_count; n++)
        node_box[n] = common(node_box[n], node_box[nodes[n].parent]);
    for (uint32_t i = 0; i < solid->part_count; i++) box[i] = common(box[i], node_box[parts[i].parent]);
}
