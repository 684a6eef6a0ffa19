// SPDX-License-Identifier: MIT
// Whether a tree from outside may be walked. Its numbers may be anything, and still no query may leave the
// arrays, go on for ever or overflow its stack. First each node by itself, on all threads: where its children
// begin, what its leaves hold. Then a walk from the root that counts: a tree visits no more nodes than there
// are and ends within SAGI_BVH_MAX_DEPTH levels; what runs in circles or meets again does not. (That boxes
// hold what they should is not looked at. It costs hits, not safety, and the checksum speaks for it.)
#include "kernel/block.h"
#include "scene/file.h"

#define NODES_AT_A_TIME 256u

typedef struct checker {
    const sagi_snapshot *snapshot;
    atomic_bool bad_node, bad_leaf;
} checker;

// Boxes lie within [−1, 1], rounded outward.
static bool is_plane(float x) { return fabsf(x) <= 1 + 0x1p-20f; }

static bool is_box(const float lo[3], const float hi[3]) {
    for (int k = 0; k < 3; k++)
        if (!(is_plane(lo[k]) && is_plane(hi[k]) && lo[k] <= hi[k])) return false;
    return true;
}

static bool is_no_box(const float lo[3], const float hi[3]) {
    for (int k = 0; k < 3; k++)
        if (!(lo[k] == INFINITY && hi[k] == -INFINITY)) return false;
    return true;
}

// A primitive that a commit would have put into the tree (or, unbounded, beside it).
static bool is_primitive(const sagi_snapshot *s, sagi_bvh_reference r, sagi_primitive_state wanted) {
    sag_box3 box;
    return r.geometry < s->count && r.primitive < sagi_primitive_count(s, r.geometry) &&
           sagi_primitive_box(s, r.geometry, r.primitive, &box) == wanted;
}

static bool is_triangles(const sagi_snapshot *s, const sagi_triangle_block *block) {
    const sagi_block *head = &block->head;
    if (head->geometry >= s->count || s->items[head->geometry].kind != SAG_SHAPE_MESH) return false;
    for (uint32_t i = head->count; i < SAGI_BVH_WIDTH; i++)
        if (block->primitive[i] != 0) return false;
    return head->exponent <= SAGI_GRID_MAX_EXPONENT && head->base >> (3 * SAGI_GRID_BASE_BITS) == 0;
}

static bool is_leaf(const sagi_snapshot *s, uint32_t child) {
    uint32_t first = child & ~SAGI_BVH_LEAF, units = s->world.tree.unit_count;
    if (first >= units) return false;
    const sagi_block *block = sagi_leaf(&s->world.tree, child);
    if (block->kind != SAGI_BLOCK_TRIANGLES && block->kind != SAGI_BLOCK_REFERENCES) return false;
    if (block->count < 1 || block->count > SAGI_BVH_MAX_LEAF) return false;
    if (sagi_block_bytes((sagi_block_kind)block->kind, block->count) > (units - first) * SAGI_BVH_UNIT)
        return false;
    if (block->kind == SAGI_BLOCK_TRIANGLES && !is_triangles(s, (const void *)block)) return false;
    for (uint32_t i = 0; i < block->count; i++)
        if (!is_primitive(s, sagi_block_reference(block, i), SAGI_PRIMITIVE_GOOD)) return false;
    return true;
}

static void check_nodes(void *argument, size_t index) {
    checker *c = argument;
    const sagi_bvh *tree = &c->snapshot->world.tree;
    uint64_t first = (uint64_t)index * NODES_AT_A_TIME, end = first + NODES_AT_A_TIME;
    for (uint64_t n = first; n < end && n < tree->node_count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_bvh_node *node = &tree->nodes[n];
            float lo[3], hi[3];
            for (int k = 0; k < 3; k++) lo[k] = node->plane[k][i], hi[k] = node->plane[3 + k][i];
            uint32_t child = node->child[i];
            if (is_no_box(lo, hi) ? child != 0 : !is_box(lo, hi)) atomic_store(&c->bad_node, true);
            if (is_no_box(lo, hi)) continue;
            if ((child & SAGI_BVH_LEAF) != 0 && !is_leaf(c->snapshot, child))
                atomic_store(&c->bad_leaf, true);
            if ((child & SAGI_BVH_LEAF) == 0 && child >= tree->node_count) atomic_store(&c->bad_node, true);
        }
}

static bool is_place(sag_vec3 p) { return sag_is_finite(p) && sag_max_component(sag_abs(p)) <= 0x1p111; }

// A child that is there: with nodes checked, one whose box is not empty.
static bool is_there(const sagi_bvh_node *node, int i) { return node->plane[0][i] <= node->plane[3][i]; }

static const char *check_walk(const sagi_bvh *tree) {
    struct {
        uint32_t node, level;
    } stack[SAGI_BVH_STACK_SIZE];
    uint32_t visited = 0, leaves = 0, depth = 0;
    int height = 0;
    stack[height].node = 0, stack[height++].level = 1;
    while (height > 0) {
        uint32_t level = stack[--height].level;
        const sagi_bvh_node *node = &tree->nodes[stack[height].node];
        if (visited++ == tree->node_count) return "the nodes are no tree";
        if (level > SAGI_BVH_MAX_DEPTH) return "the tree is too deep";
        if (level > depth) depth = level;
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i)) continue;
            if ((node->child[i] & SAGI_BVH_LEAF) != 0)
                leaves++;
            else
                stack[height].node = node->child[i], stack[height++].level = level + 1;
        }
    }
    return visited == tree->node_count && leaves == tree->leaf_count && depth == tree->depth
               ? NULL
               : "nodes, leaves or levels are not as many as they should be";
}

static const char *check_units(const sagi_snapshot *s) {
    const sagi_world *w = &s->world;
    const sag_box3 *b = &s->stats.bounds;
    int exponent;
    if (!is_place(w->origin)) return "the origin is not a place";
    if (frexp(w->scale, &exponent) != 0.5 || exponent < -1000 || exponent > 1000)
        return "the scale is no power of two";
    if (sag_box3_is_empty(b) ? w->tree.node_count > 0 : !is_place(b->min) || !is_place(b->max))
        return "the bounds are no box";
    if (w->tree.node_count == 0) return is_no_box(w->tree.box.lo, w->tree.box.hi) ? NULL : "a box of nothing";
    return is_box(w->tree.box.lo, w->tree.box.hi) ? NULL : "the tree's box is none";
}

const char *sagi_snapshot_check(const sagi_snapshot *s) {
    const sagi_bvh *tree = &s->world.tree;
    checker c = {.snapshot = s};
    const char *wrong = check_units(s);
    if (wrong != NULL) return wrong;
    for (uint32_t i = 0; i < s->world.unbounded_count; i++)
        if (!is_primitive(s, s->unbounded[i], SAGI_PRIMITIVE_UNBOUNDED))
            return "an unbounded primitive that is none";
    if (tree->node_count == 0) return tree->unit_count == 0 ? NULL : "leaves without a tree";
    sag_parallel_for(s->context, (tree->node_count + NODES_AT_A_TIME - 1) / NODES_AT_A_TIME, check_nodes, &c);
    if (atomic_load(&c.bad_node)) return "a node that is none";
    if (atomic_load(&c.bad_leaf)) return "a leaf that is none";
    return check_walk(tree);
}
