// SPDX-License-Identifier: MIT
// Reinsertion (Bittner, Hapala & Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies",
// CGF 32(1), 2013; Meister & Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
// 37(2), 2018). The cost of a binary tree is the sum of its inner nodes' areas. A subtree x is taken out (its
// parent goes, the sibling takes the parent's place) and put back where that costs least: next to some node
// y, with the parent, now around x and y, in y's place.
//
// Looking for y. Going up from x, at each ancestor the subtree on the other side is searched; what has been
// gained by then is the area of x's parent and what the ancestors passed have shrunk by. Going down, each
// node passed has to grow around x, and that growth is taken off. Below a node at which what is left does not
// exceed the best y's gain by the area of x, nothing better can come: around x and y is at least x.
//
// A round looks for places for all nodes, all threads at once in a tree that stands still, then takes the
// moves one after the other, the most gainful first, leaving out those that touch nodes which others have
// moved. So the tree does not depend on the number of threads.
#include "bvh/reinsert.h"
#include <string.h>
#define ROUNDS 3
#define SEARCH 128 // nodes that may wait in a search; more are not looked at
#define CHUNK  512u

typedef struct move {
    uint32_t from, to; // children, as in sagi_loose_node
    float gain;
} move;

typedef struct optimizer {
    sagi_loose_tree *tree;
    uint32_t *leaf_parent; // of each reference
    uint8_t *touched[2];   // of inner nodes, of references
    move *moves;
    uint32_t count, end, least;
} optimizer;

static uint32_t parent_of(const optimizer *o, uint32_t child) {
    return child & SAGI_LOOSE_LEAF ? o->leaf_parent[child & ~SAGI_LOOSE_LEAF] : o->tree->nodes[child].parent;
}

static int side_of(const optimizer *o, uint32_t parent, uint32_t child) {
    return o->tree->nodes[parent].child[1] == child;
}

static uint32_t sibling_of(const optimizer *o, uint32_t child) {
    uint32_t parent = parent_of(o, child);
    return o->tree->nodes[parent].child[!side_of(o, parent, child)];
}

static float union_area(const sagi_float_box *a, const sagi_float_box *b) {
    sagi_float_box both = sagi_float_box_union(a, b);
    return sagi_float_box_half_area(&both);
}

// Searches the subtree of `start` for a better place than best's.
static void search_below(const optimizer *o, uint32_t start, float gained, const sagi_float_box *box,
                         float area, move *best) {
    struct {
        uint32_t child;
        float gained;
    } stack[SEARCH];
    int waiting = 0;
    stack[waiting].child = start, stack[waiting++].gained = gained;
    while (waiting > 0) {
        uint32_t child = stack[--waiting].child;
        float before = stack[waiting].gained;
        if (sagi_loose_count(o->tree, child) < o->least) continue;
        if (!(before - area > best->gain)) continue;
        sagi_float_box own = sagi_loose_box(o->tree, child);
        float here = before - union_area(&own, box);
        if (here > best->gain) best->to = child, best->gain = here;
        float below = here + sagi_float_box_half_area(&own);
        if (child & SAGI_LOOSE_LEAF || !(below - area > best->gain) || waiting + 2 > SEARCH) continue;
        for (int side = 0; side < 2; side++) {
            stack[waiting].child = o->tree->nodes[child].child[side];
            stack[waiting++].gained = below;
        }
    }
}

static void find_place(const optimizer *o, move *m) {
    const sagi_loose_node *nodes = o->tree->nodes;
    const sagi_float_box box = sagi_loose_box(o->tree, m->from);
    float area = sagi_float_box_half_area(&box);
    uint32_t home = parent_of(o, m->from), sibling = sibling_of(o, m->from);
    sagi_float_box around = sagi_loose_box(o->tree, sibling); // what the ancestor shrinks to
    float gained = sagi_float_box_half_area(&nodes[home].box);
    m->gain = 0;
    for (uint32_t pivot = home;;) {
        search_below(o, sibling, gained, &box, area, m);
        if (pivot != home) {
            sagi_float_box other = sagi_loose_box(o->tree, sibling);
            sagi_float_box_extend(&around, other.lo, other.hi);
            gained += sagi_float_box_half_area(&nodes[pivot].box) - sagi_float_box_half_area(&around);
        }
        if (nodes[pivot].parent == SAGI_LOOSE_NONE) break;
        sibling = sibling_of(o, pivot);
        pivot = nodes[pivot].parent;
    }
    // Next to the sibling, or to the parent: that is where it is.
    if (m->gain > 0 && (m->to == sibling_of(o, m->from) || m->to == home)) m->gain = 0;
}

static void find_places(void *argument, size_t index) {
    const optimizer *o = argument;
    uint32_t i = (uint32_t)index * CHUNK, end = o->count - i < CHUNK ? o->count : i + CHUNK;
    for (; i < end; i++) find_place(o, &o->moves[i]);
}

// Every child large enough to be moved, and not one of the root's, as a move to nowhere yet.
static void choose_candidates(optimizer *o) {
    o->count = 0;
    for (uint32_t i = 0; i < o->end; i++) {
        const sagi_loose_node *n = &o->tree->nodes[i];
        if (n->count == 0 || n->parent == SAGI_LOOSE_NONE) continue;
        for (int side = 0; side < 2; side++)
            if (sagi_loose_count(o->tree, n->child[side]) >= o->least)
                o->moves[o->count++] = (move){.from = n->child[side]};
    }
}

static bool is_better(const move *a, const move *b) {
    return a->gain != b->gain ? a->gain > b->gain : a->from < b->from;
}

// Heapsort: the best first.
static void sift(move *m, uint32_t count, uint32_t place) {
    move hole = m[place];
    for (uint32_t child; (child = 2 * place + 1) < count; place = child) {
        if (child + 1 < count && is_better(&m[child], &m[child + 1])) child++;
        if (!is_better(&hole, &m[child])) break;
        m[place] = m[child];
    }
    m[place] = hole;
}

static void sort_moves(move *m, uint32_t count) {
    for (uint32_t i = count / 2; i-- > 0;) sift(m, count, i);
    for (uint32_t n = count; n > 1;) {
        move last = m[--n];
        m[n] = m[0], m[0] = last;
        sift(m, n, 0);
    }
}

static uint8_t *touched(const optimizer *o, uint32_t child) {
    return child & SAGI_LOOSE_LEAF ? &o->touched[1][child & ~SAGI_LOOSE_LEAF] : &o->touched[0][child];
}

static void hang(const optimizer *o, uint32_t parent, int side, uint32_t child) {
    o->tree->nodes[parent].child[side] = child;
    if (child & SAGI_LOOSE_LEAF)
        o->leaf_parent[child & ~SAGI_LOOSE_LEAF] = parent;
    else
        o->tree->nodes[child].parent = parent;
}

static void refit(const optimizer *o, uint32_t node) {
    sagi_loose_node *nodes = o->tree->nodes;
    for (; node != SAGI_LOOSE_NONE; node = nodes[node].parent) {
        sagi_loose_node *n = &nodes[node];
        sagi_float_box a = sagi_loose_box(o->tree, n->child[0]), b = sagi_loose_box(o->tree, n->child[1]);
        n->box = sagi_float_box_union(&a, &b);
        n->count = sagi_loose_count(o->tree, n->child[0]) + sagi_loose_count(o->tree, n->child[1]);
    }
}

static bool is_below(const optimizer *o, uint32_t child, uint32_t root) {
    for (; child != SAGI_LOOSE_NONE; child = parent_of(o, child))
        if (child == root) return true;
    return false;
}

// Does a move, unless what it was found for has changed: nodes are touched, or the place is below it by now.
static void apply(const optimizer *o, const move *m) {
    uint32_t home = parent_of(o, m->from), above = parent_of(o, home), place = parent_of(o, m->to);
    if (above == SAGI_LOOSE_NONE || place == SAGI_LOOSE_NONE) return;
    uint32_t sibling = sibling_of(o, m->from);
    const uint32_t involved[6] = {m->from, m->to, sibling, home, above, place};
    for (int i = 0; i < 6; i++)
        if (*touched(o, involved[i])) return;
    if (m->to == sibling || m->to == home || is_below(o, m->to, m->from)) return;
    for (int i = 0; i < 6; i++) *touched(o, involved[i]) = 1;
    hang(o, above, side_of(o, above, home), sibling);
    place = parent_of(o, m->to); // it may have been home's
    hang(o, place, side_of(o, place, m->to), home);
    hang(o, home, 0, m->to), hang(o, home, 1, m->from);
    refit(o, above);
    refit(o, home);
}

static void round_of_moves(const sag_context *context, optimizer *o) {
    choose_candidates(o);
    sag_parallel_for(context, o->count / CHUNK + (o->count % CHUNK != 0), find_places, o);
    uint32_t found = 0;
    for (uint32_t i = 0; i < o->count; i++)
        if (o->moves[i].gain > 0) o->moves[found++] = o->moves[i];
    sort_moves(o->moves, found);
    memset(o->touched[0], 0, o->end), memset(o->touched[1], 0, o->end);
    for (uint32_t i = 0; i < found; i++) apply(o, &o->moves[i]);
}

sag_status sagi_reinsert(const sag_context *context, sagi_loose_tree *tree, uint32_t end, uint32_t least) {
    if (tree->count < 4) return SAG_OK;
    optimizer o = {.tree = tree, .end = end, .least = least};
    size_t n = end, most = 2 * n;
    o.leaf_parent = sag_allocate(context, n * sizeof *o.leaf_parent);
    o.moves = sag_allocate(context, most * sizeof *o.moves);
    for (int i = 0; i < 2; i++) o.touched[i] = sag_allocate(context, n);
    sag_status status = SAG_ERROR_MEMORY;
    if (o.leaf_parent != NULL && o.moves != NULL && o.touched[0] != NULL && o.touched[1] != NULL) {
        for (uint32_t i = 0; i < end; i++)
            for (int side = 0; tree->nodes[i].count > 0 && side < 2; side++)
                if (tree->nodes[i].child[side] & SAGI_LOOSE_LEAF)
                    o.leaf_parent[tree->nodes[i].child[side] & ~SAGI_LOOSE_LEAF] = i;
        for (int round = 0; round < ROUNDS; round++) round_of_moves(context, &o);
        status = SAG_OK;
    }
    sag_release(context, o.leaf_parent, n * sizeof *o.leaf_parent);
    sag_release(context, o.moves, most * sizeof *o.moves);
    for (int i = 0; i < 2; i++) sag_release(context, o.touched[i], n);
    return status;
}
