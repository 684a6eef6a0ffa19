// SPDX-License-Identifier: MIT
// Making a binary tree cheaper by moving subtrees.
#ifndef SAGI_BVH_REINSERT_H
#define SAGI_BVH_REINSERT_H

#include "bvh/loose.h"

// Moves subtrees of at least `least` primitives, and never into smaller ones, in a tree whose nodes' numbers
// are below `end`, those with count 0 not being in use. On the context's threads. SAG_ERROR_MEMORY.
sag_status sagi_reinsert(const sag_context *context, sagi_loose_tree *tree, uint32_t end, uint32_t least);

#endif
