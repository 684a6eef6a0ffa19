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

// How many wide nodes and leaves there will be, and the levels. Counting first costs a walk over the tree and
// spares reallocation: the memory asked for is the memory used.
static void count_nodes(const sagi_binary_node *nodes, sagi_bvh *tree) {
    job stack[SAGI_BVH_STACK_SIZE];
    int waiting = 0;
    stack[waiting++] = (job){0, 0, 1};
    while (waiting > 0) {
        job j = stack[--waiting];
        family f = gather(nodes, j.binary);
        tree->node_capacity++;
        if (j.level > tree->depth) tree->depth = j.level;
        for (int i = 0; i < f.count; i++) {
            if (nodes[f.member[i]].count == 0)
                stack[waiting++] = (job){f.member[i], 0, j.level + 1};
            else
                tree->leaf_count++;
        }
    }
}

static int compare_references(const sagi_bvh_reference *a, const sagi_bvh_reference *b) {
    if (a->geometry != b->geometry) return a->geometry < b->geometry ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

// A leaf's references by geometry, so that shapes of one kind stand together, then by primitive. Insertion:
// there are at most SAGI_BVH_MAX_LEAF.
static void write_leaf(const sagi_binary_node *leaf, const sagi_bvh_primitive *primitives,
                       sagi_bvh_reference *references) {
    sagi_bvh_reference *r = references + leaf->link;
    for (uint32_t i = 0; i < leaf->count; i++) {
        const sagi_bvh_primitive *p = &primitives[leaf->link + i];
        sagi_bvh_reference own = {p->geometry, p->primitive};
        uint32_t place = i;
        for (; place > 0 && compare_references(&r[place - 1], &own) > 0; place--) r[place] = r[place - 1];
        r[place] = own;
    }
}

static void write_child(sagi_bvh_node *node, int i, const sagi_binary_node *from) {
    for (int k = 0; k < 3; k++) {
        node->plane[k][i] = from ? from->box.lo[k] : INFINITY;
        node->plane[3 + k][i] = from ? from->box.hi[k] : -INFINITY;
    }
    node->child[i] = from ? from->link : 0;
    node->count[i] = from ? from->count : 0;
}

static void write_nodes(const sagi_binary_node *nodes, const sagi_bvh_primitive *primitives, sagi_bvh *tree) {
    job stack[SAGI_BVH_STACK_SIZE];
    int waiting = 0;
    stack[waiting++] = (job){0, tree->node_count++, 1};
    while (waiting > 0) {
        job j = stack[--waiting];
        family f = gather(nodes, j.binary);
        sagi_bvh_node *node = &tree->nodes[j.wide];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_binary_node *from = i < f.count ? &nodes[f.member[i]] : NULL;
            write_child(node, i, from);
            if (from == NULL) continue;
            if (from->count > 0) {
                write_leaf(from, primitives, tree->references);
            } else {
                node->child[i] = tree->node_count++; // siblings stand side by side
                stack[waiting++] = (job){f.member[i], node->child[i], j.level + 1};
            }
        }
    }
}

sag_status sagi_bvh_collapse(const sag_context *context, const sagi_binary_node *nodes,
                             const sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree) {
    sagi_bvh made = {.reference_count = count, .box = nodes[0].box};
    count_nodes(nodes, &made);
    made.nodes = sag_allocate(context, made.node_capacity * sizeof *made.nodes);
    made.references = sag_allocate(context, count * sizeof *made.references);
    if (made.nodes == NULL || made.references == NULL) {
        sagi_bvh_release(context, &made);
        return SAG_ERROR_MEMORY;
    }
    write_nodes(nodes, primitives, &made);
    *tree = made;
    return SAG_OK;
}
