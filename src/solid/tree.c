// SPDX-License-Identifier: MIT
// From the steps of a description to the tree (tree.h).
//
// The steps are operands first. A stack gives every step the one that takes it as an operand; then, from the
// last step to the first, so that parents come before their operands, every operation becomes a node or part
// of the node above, where that does not matter:
//
//     A ∪ (B ∪ C) = A ∪ B ∪ C, likewise for ∩ and xor;   (A − B) − C = A − B − C;   A − (B ∪ C) = A − B − C;
//
// and an operation of one operand is that operand. The order of the parts stays.
#include "solid/tree.h"
#include <string.h>

typedef struct step {
    uint32_t parent; // the step that takes it
    uint32_t node;   // that its operands belong to
    bool first;      // the first operand of its parent
    bool leads;      // what is its first operand is the first operand of the node
} step;

typedef struct compiler {
    const sag_solid *from;
    step *steps;
    sagi_solid_node *nodes;
    uint32_t node_count, part_count, depth;
} compiler;

static sag_status wrong(sag_error *error, uint32_t i, const char *what) {
    return sag_error_set(error, SAG_ERROR_ARGUMENT, "step %u of the solid: %s", (unsigned)i, what);
}

// Finds the parents. The stack of what waits to be taken lies in the steps themselves: `node` is the one
// below.
static sag_status find_parents(compiler *c, sag_error *error) {
    uint32_t top = SAG_INVALID_ID, height = 0, count = c->from->step_count;
    for (uint32_t i = 0; i < count; i++) {
        sag_solid_step s = c->from->steps[i];
        c->steps[i] = (step){.parent = SAG_INVALID_ID};
        if (s.operation == SAG_SOLID_PART) {
            c->part_count++;
        } else {
            if ((unsigned)s.operation > SAG_SOLID_XOR) return wrong(error, i, "no operation");
            if (s.number < 1) return wrong(error, i, "an operation without operands");
            if (s.number > height) return wrong(error, i, "fewer operands than it says are there");
            for (uint32_t k = 0; k < s.number; k++) {
                step *operand = &c->steps[top];
                operand->parent = i, operand->first = k + 1 == s.number;
                top = operand->node;
            }
            height -= s.number;
        }
        c->steps[i].node = top, top = i, height++;
    }
    if (count == 0) return sag_error_set(error, SAG_ERROR_ARGUMENT, "a solid without steps");
    if (height != 1) return wrong(error, count - 1, "the last, and more than one result is left");
    return SAG_OK;
}

// Whether an operand's own operands may be its parent node's.
static bool melts(sag_solid_operation operation, uint8_t above, bool leads) {
    switch (operation) {
    case SAG_SOLID_UNION: return above == SAG_SOLID_UNION || (above == SAG_SOLID_DIFFERENCE && !leads);
    case SAG_SOLID_INTERSECTION: return above == SAG_SOLID_INTERSECTION;
    case SAG_SOLID_DIFFERENCE: return above == SAG_SOLID_DIFFERENCE && leads;
    case SAG_SOLID_XOR: return above == SAG_SOLID_XOR;
    case SAG_SOLID_PART: break;
    }
    return false;
}

static uint32_t add_node(compiler *c, sag_solid_operation operation, uint32_t parent, bool leads) {
    sagi_solid_node *node = &c->nodes[c->node_count];
    *node = (sagi_solid_node){.parent = parent, .operation = (uint8_t)operation, .weight = 1};
    if (parent != SAG_INVALID_ID) {
        c->nodes[parent].operands++;
        if (leads && c->nodes[parent].operation == SAG_SOLID_DIFFERENCE) node->weight = -1;
    }
    uint32_t depth = 1;
    for (uint32_t n = parent; n != SAG_INVALID_ID && depth <= SAG_SOLID_MAX_DEPTH; n = c->nodes[n].parent)
        depth++;
    if (depth > c->depth) c->depth = depth;
    return c->node_count++;
}

// Where a step stands: the node above it, and whether it is that node's first operand.
static uint32_t place_of(const compiler *c, uint32_t i, bool *leads) {
    const step *s = &c->steps[i];
    if (s->parent == SAG_INVALID_ID) return SAG_INVALID_ID;
    *leads = s->first && c->steps[s->parent].leads;
    return c->steps[s->parent].node;
}

static sag_status make_nodes(compiler *c, sag_error *error) {
    for (uint32_t i = c->from->step_count; i-- > 0;) {
        sag_solid_step s = c->from->steps[i];
        bool leads = true;
        uint32_t above = place_of(c, i, &leads);
        if (s.operation == SAG_SOLID_PART) {
            if (above == SAG_INVALID_ID) above = add_node(c, SAG_SOLID_UNION, above, leads);
            c->steps[i].node = above, c->steps[i].leads = leads;
            c->nodes[above].operands++;
            continue;
        }
        c->steps[i].node = above, c->steps[i].leads = leads; // of one operand
        if (s.number == 1) continue;
        if (above == SAG_INVALID_ID || !melts(s.operation, c->nodes[above].operation, leads)) {
            c->steps[i].node = add_node(c, s.operation, above, leads);
            c->steps[i].leads = true;
            if (c->depth > SAG_SOLID_MAX_DEPTH)
                return wrong(error, i, "operations nest deeper than 64 levels");
        }
    }
    return SAG_OK;
}

size_t sagi_solid_bytes(const sagi_solid *s) {
    return sizeof *s + s->node_count * sizeof(sagi_solid_node) + s->part_count * sizeof(sagi_solid_part) +
           s->geometry_count * sizeof(uint32_t);
}

static sag_status write_contents(const compiler *c, sagi_solid *s, sag_error *error) {
    sagi_solid_node *nodes = (sagi_solid_node *)(void *)(s + 1);
    sagi_solid_part *part = (sagi_solid_part *)(void *)(nodes + s->node_count);
    uint32_t *part_of = (uint32_t *)(void *)(part + s->part_count);
    memcpy(nodes, c->nodes, s->node_count * sizeof *nodes);
    for (uint32_t g = 0; g < s->geometry_count; g++) part_of[g] = SAG_INVALID_ID;
    for (uint32_t i = 0, n = 0; i < c->from->step_count; i++) {
        if (c->from->steps[i].operation != SAG_SOLID_PART) continue;
        uint32_t geometry = c->from->steps[i].number;
        if (geometry >= s->geometry_count) return wrong(error, i, "a geometry that is not there");
        if (part_of[geometry] != SAG_INVALID_ID) return wrong(error, i, "a geometry for the second time");
        part_of[geometry] = n;
        const step *at = &c->steps[i];
        bool leads = at->leads && c->nodes[at->node].operation == SAG_SOLID_DIFFERENCE;
        part[n++] = (sagi_solid_part){.geometry = geometry, .parent = at->node, .weight = leads ? -1 : 1};
    }
    return SAG_OK;
}

sag_status sagi_solid_compile(const sag_context *context, const sag_solid *from, uint32_t geometry_count,
                              sagi_solid **solid, sag_error *error) {
    size_t count = from->step_count;
    compiler c = {.from = from};
    c.steps = sag_allocate(context, count * sizeof *c.steps);
    c.nodes = sag_allocate(context, (count + 1) * sizeof *c.nodes);
    sagi_solid *s = NULL;
    sag_status status = SAG_OK;
    if ((count > 0 && c.steps == NULL) || c.nodes == NULL) {
        sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a solid");
        status = SAG_ERROR_MEMORY;
    }
    if (status == SAG_OK) status = find_parents(&c, error);
    if (status == SAG_OK) status = make_nodes(&c, error);
    if (status == SAG_OK && solid != NULL) {
        sagi_solid head = {c.node_count, c.part_count, geometry_count, c.depth};
        s = sag_allocate(context, sagi_solid_bytes(&head));
        if (s == NULL) {
            status = sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a solid");
        } else {
            *s = head;
            status = write_contents(&c, s, error);
            if (status != SAG_OK) sag_release(context, s, sagi_solid_bytes(s));
        }
    }
    sag_release(context, c.steps, count * sizeof *c.steps);
    sag_release(context, c.nodes, (count + 1) * sizeof *c.nodes);
    if (status == SAG_OK && solid != NULL) *solid = s;
    return status;
}

// From the last step to the first, as the tree was made: nodes come with rising numbers, parts with falling
// ones. The operand that is next at a node is the last part that is left, if it is the node's, or else the
// node that this part is somewhere below.
void sagi_solid_describe(const sagi_solid *s, sag_solid_step *steps) {
    const sagi_solid_node *nodes = sagi_solid_nodes(s);
    const sagi_solid_part *parts = sagi_solid_parts(s);
    uint32_t left[SAG_SOLID_MAX_DEPTH] = {0}; // operands to come, of the node at hand and those above it
    uint32_t part = s->part_count, count = s->node_count + s->part_count, at = 0, height = 0;
    for (uint32_t i = count, node = 0; i-- > 0;) {
        if (height > 0) left[height - 1]--;
        if (height > 0 && parts[part - 1].parent == at) {
            steps[i] = (sag_solid_step){SAG_SOLID_PART, parts[--part].geometry};
        } else {
            at = node++;
            steps[i] = (sag_solid_step){(sag_solid_operation)nodes[at].operation, nodes[at].operands};
            left[height++] = nodes[at].operands;
        }
        for (; height > 0 && left[height - 1] == 0; height--) at = nodes[at].parent;
    }
}
