// SPDX-License-Identifier: MIT
// The boolean tree of a solid, as the kernels read it. It knows parts and booleans, not shapes.
//
// The state of a ray at some place is which parts it is in. Of every node only one number is kept: how many
// of its operands are "in", where the first operand of a difference counts −1 and all others +1. So
//
//     union         number > 0            intersection  number = how many operands there are
//     exclusive or  number is odd         difference    number = −1   (in the first, in none of the others)
//
// and with all numbers 0, in no part, every node is "out": nothing has to be known of parts that are not met.
// When a part's state changes, its node's number does, and only as long as the nodes' values change, those
// above: a crossing costs a step or two, whatever the size of the tree. Numbers are sums, so several changes
// at one place may be made in any order.
#ifndef SAGI_SOLID_TREE_H
#define SAGI_SOLID_TREE_H

#include <sagitta/solid.h>

typedef struct sagi_solid_node {
    uint32_t parent;   // a lower number; SAG_INVALID_ID for the root, node 0
    uint32_t operands; // parts and nodes
    uint8_t operation; // sag_solid_operation, not SAG_SOLID_PART
    int8_t weight;     // what its being in counts for its parent
    uint16_t unused;
} sagi_solid_node;

// Parts are numbered in the order of the steps.
typedef struct sagi_solid_part {
    uint32_t geometry;
    uint32_t parent;
    int32_t weight;
} sagi_solid_part;

// One block of memory: this, then the nodes, the parts, and the part that each geometry is (SAG_INVALID_ID:
// none).
typedef struct sagi_solid {
    uint32_t node_count, part_count, geometry_count;
    uint32_t depth; // levels of nodes
} sagi_solid;

static inline const sagi_solid_node *sagi_solid_nodes(const sagi_solid *s) {
    return (const sagi_solid_node *)(const void *)(s + 1);
}
static inline const sagi_solid_part *sagi_solid_parts(const sagi_solid *s) {
    return (const sagi_solid_part *)(const void *)(sagi_solid_nodes(s) + s->node_count);
}
static inline const uint32_t *sagi_solid_part_of(const sagi_solid *s) {
    return (const uint32_t *)(const void *)(sagi_solid_parts(s) + s->part_count);
}
size_t sagi_solid_bytes(const sagi_solid *s);

static inline bool sagi_solid_value(const sagi_solid_node *node, int32_t number) {
    switch (node->operation) {
    case SAG_SOLID_INTERSECTION: return number == (int32_t)node->operands;
    case SAG_SOLID_DIFFERENCE: return number == -1;
    case SAG_SOLID_XOR: return (number & 1) != 0;
    default: return number > 0; // a union
    }
}

// Makes it from a description for a scene of so many geometries; release with its sagi_solid_bytes. With
// solid == NULL it only says whether the steps are a tree.
// SAG_ERROR_ARGUMENT, for steps that are no tree or nest too deep, a geometry of a higher number or one that
// comes twice; SAG_ERROR_MEMORY.
sag_status sagi_solid_compile(const sag_context *context, const sag_solid *steps, uint32_t geometry_count,
                              sagi_solid **solid, sag_error *error);

// Writes a description that makes this tree again: node_count + part_count steps.
void sagi_solid_describe(const sagi_solid *solid, sag_solid_step *steps);

// Writes to box[part_count], which has each part's own box, where the part matters: its box and those of all
// the nodes above it in common. (A union's is around its operands', as an exclusive or's; an intersection's
// is what they have in common; a difference's is its first operand's.) Elsewhere a part counts as "out" as
// well as for what it is: outside of a node's box at least one of the parts that the box comes from is out,
// and whatever the others say, the node is out. `node_box` is scratch for node_count boxes.
void sagi_solid_clip_boxes(const sagi_solid *solid, sag_box3 *box, sag_box3 *node_box);

#endif
