// SPDX-License-Identifier: MIT
// Whether a tree from outside may be walked. Its numbers may be anything, and still no query may leave the
// arrays, go on for ever or overflow its stack. First each node by itself, on all threads: where its children
// begin, what its leaves hold. Then a walk from the root that counts: a tree visits no more nodes than there
// are and ends within SAGI_BVH_MAX_DEPTH levels; what runs in circles or meets again does not.
// Then each group, from which the next commit may take over its part: it must be a tree of its own, of its
// own geometries. (That boxes hold what they should is not looked at. It costs hits, not safety, and the
// checksum speaks for it.)
#include "kernel/block.h"
#include "scene/file.h"
#include <string.h>

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

// One that is there, and that a commit would have put into the tree (or, unbounded, beside it). Triangles of
// a mesh are not looked at, which would cost more than all else: their indices are in range, and a triangle
// of whatever numbers is safe to ask (tests/unit/test_invalid_shapes.c).
static bool is_primitive(const sagi_snapshot *s, sagi_bvh_reference r, sagi_primitive_state wanted) {
    sag_box3 box;
    if (r.geometry >= s->count || r.primitive >= sagi_primitive_count(s, r.geometry)) return false;
    return (s->items[r.geometry].kind == SAG_SHAPE_MESH && wanted == SAGI_PRIMITIVE_GOOD) ||
           sagi_primitive_box(s, r.geometry, r.primitive, &box) == wanted;
}

static bool is_triangles(const sagi_snapshot *s, const sagi_triangle_block *block) {
    const sagi_block *head = &block->head;
    if (head->geometry >= s->count || s->items[head->geometry].kind != SAG_SHAPE_MESH) return false;
    for (uint32_t i = head->count; i < SAGI_BVH_WIDTH; i++)
        if (block->primitive[i] != 0 || block->rest[i] != 0) return false;
    return head->exponent <= SAGI_GRID_MAX_EXPONENT && head->base >> (3 * SAGI_GRID_BASE_BITS) == 0;
}

static bool is_spheres(const sagi_snapshot *s, const sagi_block *head) {
    if (s->solid != NULL) return false;
    if (head->geometry == SAGI_LONE_SPHERES) {
        for (uint32_t i = 0; i < head->count; i++) {
            const uint32_t geometry = sagi_sphere_primitives(head)[i];
            if (geometry >= s->count || !sagi_is_lone_sphere(&s->items[geometry])) return false;
        }
    } else if (head->geometry >= s->count || s->items[head->geometry].kind != SAG_SHAPE_SPHERES ||
               s->items[head->geometry].place != NULL) {
        return false;
    }
    uint32_t length = sagi_sphere_row_length(head->count);
    for (uint32_t i = head->count; i < length; i++)
        if (sagi_sphere_primitives(head)[i] != 0) return false;
    return head->exponent <= SAGI_GRID_MAX_EXPONENT && head->base >> (3 * SAGI_GRID_BASE_BITS) == 0;
}

static bool is_leaf(const sagi_snapshot *s, uint32_t child) {
    uint32_t first = sagi_bvh_unit(child), units = s->world.tree.unit_count;
    if (first >= units) return false;
    const sagi_block *block = sagi_leaf(&s->world.tree, child);
    if (s->solid != NULL && block->kind != SAGI_BLOCK_REFERENCES) return false;
    if (block->kind != SAGI_BLOCK_TRIANGLES && block->kind != SAGI_BLOCK_REFERENCES &&
        block->kind != SAGI_BLOCK_SPHERES)
        return false;
    if (block->count < 1 || block->count > SAGI_BVH_MAX_LEAF) return false;
    if (sagi_block_bytes((sagi_block_kind)block->kind, block->count) > (units - first) * SAGI_BVH_UNIT)
        return false;
    if (block->kind == SAGI_BLOCK_TRIANGLES && !is_triangles(s, (const void *)block)) return false;
    if (block->kind == SAGI_BLOCK_SPHERES && !is_spheres(s, block)) return false;
    for (uint32_t i = 0; i < block->count; i++)
        if (!is_primitive(s, sagi_block_reference(block, i), SAGI_PRIMITIVE_GOOD)) return false;
    return true;
}

static bool is_node(const sagi_bvh *tree, uint32_t child) {
    const uint32_t number = sagi_bvh_number(child);
    return number < tree->node_count && sagi_bvh_child_node(number) == child;
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
            if (sagi_bvh_is_leaf(child) && !is_leaf(c->snapshot, child)) atomic_store(&c->bad_leaf, true);
            if (!sagi_bvh_is_leaf(child) && !is_node(tree, child)) atomic_store(&c->bad_node, true);
        }
}

static bool is_place(sag_vec3 p) { return sag_is_finite(p) && sag_max_component(sag_abs(p)) <= 0x1p111; }

// A child that is there: with nodes checked, one whose box is not empty.
static bool is_there(const sagi_bvh_node *node, int i) { return node->plane[0][i] <= node->plane[3][i]; }

// From a root whose nodes are [first, first + count) and units [unit_first, unit_first + unit_count).
typedef struct range {
    uint32_t first, count, unit_first, unit_count, leaf_count, depth;
} range;

static const char *check_walk(const sagi_bvh *tree, range r) {
    struct {
        uint32_t node, level;
    } stack[SAGI_BVH_STACK_SIZE];
    uint32_t visited = 0, leaves = 0, depth = 0;
    int height = 0;
    stack[height].node = r.first, stack[height++].level = 1;
    while (height > 0) {
        uint32_t level = stack[--height].level;
        const sagi_bvh_node *node = &tree->nodes[stack[height].node];
        if (visited++ == r.count) return "the nodes are no tree";
        if (level > SAGI_BVH_MAX_DEPTH) return "the tree is too deep";
        if (level > depth) depth = level;
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i)) continue;
            uint32_t child = node->child[i];
            bool leaf = sagi_bvh_is_leaf(child);
            uint32_t at = leaf ? sagi_bvh_unit(child) : sagi_bvh_number(child);
            if (leaf ? at < r.unit_first || at - r.unit_first >= r.unit_count
                     : at < r.first || at - r.first >= r.count)
                return "a tree that leads out of its group";
            if (leaf)
                leaves++;
            else
                stack[height].node = at, stack[height++].level = level + 1;
        }
    }
    return visited == r.count && leaves == r.leaf_count && depth == r.depth
               ? NULL
               : "nodes, leaves or levels are not as many as they should be";
}

static const char *check_units(const sagi_snapshot *s) {
    const sagi_world *w = &s->world;
    const sag_box3 *b = &s->stats.bounds;
    int exponent;
    if (!is_place(w->origin)) return "the origin is not a place";
    if (frexp(w->scale, &exponent) != 0.5 || exponent < -901 || exponent > 901)
        return "the scale is no power of two";
    if (sag_box3_is_empty(b) ? w->tree.node_count > 0 : !is_place(b->min) || !is_place(b->max))
        return "the bounds are no box";
    if (w->tree.node_count == 0) return is_no_box(w->tree.box.lo, w->tree.box.hi) ? NULL : "a box of nothing";
    return is_box(w->tree.box.lo, w->tree.box.hi) ? NULL : "the tree's box is none";
}

static bool is_inside(uint64_t first, uint64_t count, uint64_t all) {
    return first <= all && count <= all - first;
}

// Only an own tree of one geometry is refitted; in a shared one every primitive is some member's: else it
// would be kept when that changes.
static bool is_of_member(const sagi_snapshot *s, const sagi_group *g, uint32_t geometry) {
    uint32_t low = g->member_first, high = g->member_first + g->member_count;
    while (high - low > 1) { // members are in order
        uint32_t middle = low + (high - low) / 2;
        if (s->members[middle] <= geometry)
            low = middle;
        else
            high = middle;
    }
    return s->members[low] == geometry;
}

static bool is_block_of_members(const sagi_snapshot *s, const sagi_group *g, const sagi_block *block) {
    const bool several = block->kind == SAGI_BLOCK_REFERENCES || block->geometry == SAGI_LONE_SPHERES;
    for (uint32_t i = 0; i < (several ? block->count : 1U); i++)
        if (!is_of_member(s, g, sagi_block_reference(block, i).geometry)) return false;
    return true;
}

static bool has_only_own_leaves(const sagi_snapshot *s, const sagi_group *g) {
    for (uint32_t n = g->node_first; n < g->node_first + g->tree.node_count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_bvh_node *node = &s->world.tree.nodes[n];
            if (!is_there(node, i) || !sagi_bvh_is_leaf(node->child[i])) continue;
            const sagi_block *block = sagi_leaf(&s->world.tree, node->child[i]);
            size_t end = sagi_bvh_unit(node->child[i]) * SAGI_BVH_UNIT +
                         sagi_block_bytes((sagi_block_kind)block->kind, block->count);
            if (end > ((size_t)g->unit_first + g->tree.unit_count) * SAGI_BVH_UNIT) return false;
            if (!is_block_of_members(s, g, block)) return false;
        }
    return true;
}

static const char *check_group(const sagi_snapshot *s, const sagi_group *g) {
    const sagi_bvh *t = &g->tree, *all = &s->world.tree;
    const sag_box3 *b = &g->found.bounds;
    if (!is_inside(g->unbounded_first, g->found.unbounded, s->world.unbounded_count) ||
        !is_inside(g->node_first, t->node_count, all->node_count) ||
        !is_inside(g->unit_first, t->unit_count, all->unit_count))
        return "a group that leads out of the scene";
    if (g->found.good > s->stats.primitive_count || g->found.unbounded > s->stats.primitive_count)
        return "a group of too many primitives";
    for (uint64_t i = 0; i < g->found.unbounded; i++)
        if (!is_of_member(s, g, s->unbounded[g->unbounded_first + i].geometry))
            return "a group with another's primitives";
    if ((t->node_count > 0) != (g->found.good > 0) || (g->found.good > 0) == sag_box3_is_empty(b))
        return "a group with a tree of nothing";
    if (t->node_count == 0)
        return t->unit_count == 0 && is_no_box(t->box.lo, t->box.hi) ? NULL : "leaves without a tree";
    if (!is_place(b->min) || !is_place(b->max) || !is_box(t->box.lo, t->box.hi))
        return "a group's box that is none";
    range r = {g->node_first, t->node_count, g->unit_first, t->unit_count, t->leaf_count, t->depth};
    const char *wrong = check_walk(all, r);
    if (wrong != NULL) return wrong;
    return has_only_own_leaves(s, g) ? NULL : "a group with another's primitives";
}

// Adds a geometry to the set; false when it is there already.
static bool put(uint8_t *set, uint32_t geometry) {
    uint8_t bit = (uint8_t)(1u << geometry % 8), was = set[geometry / 8];
    set[geometry / 8] = was | bit;
    return (was & bit) == 0;
}

// Each part of a solid once: a query that takes a place up again where it left it goes by that.
static sag_status check_parts(const sagi_snapshot *s, const char **flaw) {
    size_t bytes = (size_t)s->count / 8 + 1;
    uint8_t *set = sag_allocate(s->context, bytes);
    if (set == NULL) return SAG_ERROR_MEMORY;
    memset(set, 0, bytes);
    bool once = true;
    for (uint32_t i = 0; i < s->world.unbounded_count; i++) once &= put(set, s->unbounded[i].geometry);
    for (uint32_t n = 0; n < s->world.tree.node_count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_bvh_node *node = &s->world.tree.nodes[n];
            if (!is_there(node, i) || !sagi_bvh_is_leaf(node->child[i])) continue;
            const sagi_block *block = sagi_leaf(&s->world.tree, node->child[i]);
            for (uint32_t k = 0; k < block->count; k++)
                once &= put(set, sagi_block_reference(block, k).geometry);
        }
    sag_release(s->context, set, bytes);
    if (once) return SAG_OK;
    *flaw = "a part of a solid in two places";
    return SAG_ERROR_FORMAT;
}

static const char *check_tree(const sagi_snapshot *s) {
    const sagi_bvh *tree = &s->world.tree;
    checker c = {.snapshot = s};
    const char *wrong = check_units(s);
    if (wrong != NULL) return wrong;
    for (uint32_t i = 0; i < s->world.unbounded_count; i++)
        if (!is_primitive(s, s->unbounded[i], SAGI_PRIMITIVE_UNBOUNDED))
            return "an unbounded primitive that is none";
    if (tree->node_count == 0 && tree->unit_count > 0) return "leaves without a tree";
    sag_parallel_for(s->context, (tree->node_count + NODES_AT_A_TIME - 1) / NODES_AT_A_TIME, check_nodes, &c);
    if (atomic_load(&c.bad_node)) return "a node that is none";
    if (atomic_load(&c.bad_leaf)) return "a leaf that is none";
    range all = {0, tree->node_count, 0, tree->unit_count, tree->leaf_count, tree->depth};
    if (tree->node_count > 0) wrong = check_walk(tree, all);
    for (uint32_t i = 0; i < s->group_count && wrong == NULL; i++) wrong = check_group(s, &s->groups[i]);
    return wrong;
}

sag_status sagi_snapshot_check(const sagi_snapshot *s, const char **flaw) {
    *flaw = check_tree(s);
    if (*flaw != NULL) return SAG_ERROR_FORMAT;
    return s->solid != NULL ? check_parts(s, flaw) : SAG_OK;
}
