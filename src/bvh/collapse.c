// SPDX-License-Identifier: MIT
// From two children to eight: a wide node takes a binary node's two children and then, as long as there is
// room, puts the two children of the largest inner one in its place. The largest is the one most rays would
// have opened anyway (Wald, Benthin & Boulos, "Getting Rid of Packets", 2008).
#include "bvh/binary.h"
#include <string.h>

// The children of a wide node, as numbers of binary nodes.
typedef struct family {
    int count;
    uint32_t member[SAGI_BVH_WIDTH];
} family;

static family gather(const sagi_binary_node *nodes, uint32_t root) {
    family f = {1, {root}};
    while (f.count < SAGI_BVH_WIDTH) {
        int largest = -1;
        float area = -1;
        for (int i = 0; i < f.count; i++) {
            const sagi_binary_node *n = &nodes[f.member[i]];
            float a = sagi_float_box_half_area(&n->box);
            if (n->count == 0 && a > area) largest = i, area = a;
        }
        if (largest < 0) break;
        uint32_t opened = f.member[largest];
        f.member[largest] = opened + 1;
        f.member[f.count++] = nodes[opened].link;
    }
    return f;
}

// A binary node that becomes the wide node `wide`, `level` levels down.
typedef struct job {
    uint32_t binary, wide, level;
} job;

// How many wide nodes, leaves and units there will be, and the levels. Counting first costs a walk over the
// tree and spares reallocation: the memory asked for is the memory used.
static void count_nodes(const sagi_leaf_maker *maker, const sagi_binary_node *nodes,
                        const sagi_bvh_primitive *primitives, sagi_bvh *tree) {
    job stack[SAGI_BVH_STACK_SIZE];
    int waiting = 0;
    stack[waiting++] = (job){0, 0, 1};
    while (waiting > 0) {
        job j = stack[--waiting];
        family f = gather(nodes, j.binary);
        tree->node_capacity++;
        if (j.level > tree->depth) tree->depth = j.level;
        for (int i = 0; i < f.count; i++) {
            const sagi_binary_node *n = &nodes[f.member[i]];
            if (n->count == 0) {
                stack[waiting++] = (job){f.member[i], 0, j.level + 1};
            } else {
                tree->leaf_count++;
                tree->unit_count += maker->units(maker->user, primitives + n->link, n->count);
            }
        }
    }
}

static void write_box(sagi_bvh_node *node, int i, const sagi_binary_node *from) {
    for (int k = 0; k < 3; k++) {
        node->plane[k][i] = from ? from->box.lo[k] : INFINITY;
        node->plane[3 + k][i] = from ? from->box.hi[k] : -INFINITY;
    }
    node->child[i] = 0;
}

static void write_nodes(const sagi_leaf_maker *maker, const sagi_binary_node *nodes,
                        const sagi_bvh_primitive *primitives, sagi_bvh *tree) {
    job stack[SAGI_BVH_STACK_SIZE];
    int waiting = 0;
    uint32_t units = 0;
    stack[waiting++] = (job){0, tree->node_count++, 1};
    while (waiting > 0) {
        job j = stack[--waiting];
        family f = gather(nodes, j.binary);
        sagi_bvh_node *node = &tree->nodes[j.wide];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_binary_node *from = i < f.count ? &nodes[f.member[i]] : NULL;
            write_box(node, i, from);
            if (from == NULL) continue;
            if (from->count > 0) {
                const sagi_bvh_primitive *first = primitives + from->link;
                node->child[i] = SAGI_BVH_LEAF | units;
                maker->write(maker->user, first, from->count, tree->leaves + units * SAGI_BVH_UNIT);
                units += maker->units(maker->user, first, from->count);
            } else {
                node->child[i] = tree->node_count++; // siblings stand side by side
                stack[waiting++] = (job){f.member[i], node->child[i], j.level + 1};
            }
        }
    }
}

sag_status sagi_bvh_collapse(const sag_context *context, const sagi_leaf_maker *maker,
                             const sagi_binary_node *nodes, const sagi_bvh_primitive *primitives,
                             sagi_bvh *tree) {
    sagi_bvh made = {.box = nodes[0].box};
    count_nodes(maker, nodes, primitives, &made);
    made.nodes = sag_allocate(context, made.node_capacity * sizeof *made.nodes);
    made.leaves = sag_allocate(context, made.unit_count * SAGI_BVH_UNIT);
    if (made.nodes == NULL || made.leaves == NULL) {
        sagi_bvh_release(context, &made);
        return SAG_ERROR_MEMORY;
    }
    write_nodes(maker, nodes, primitives, &made);
    *tree = made;
    return SAG_OK;
}
