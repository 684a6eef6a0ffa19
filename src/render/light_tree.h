// SPDX-License-Identifier: MIT
// Choosing one of many lights by how much it may matter at a point: a tree of lights (Conty Estévez & Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2), 2018; PBR 4th ed.
// §12.6.3), with four children to a node, weighed at once.
#ifndef SAGI_RENDER_LIGHT_TREE_H
#define SAGI_RENDER_LIGHT_TREE_H

#include "math/simd.h"
#include <sagitta/math.h>

// What the tree knows of a light, or of some: they are within the box; they shine from surfaces whose normals
// are within θo of the axis, and no further than θe from those normals.
typedef struct sagi_light_bounds {
    sag_box3 box;
    sag_vec3 axis;      // unit
    double cos_normals; // cos θo; −1: normals of all directions
    double cos_spread;  // cos θe: 0 for a surface, near 1 for a beam
    double intensity;   // W/sr in the brightest direction; 0: no light at all
    bool two_sided;     // shines to both sides of the normals
} sagi_light_bounds;

// The bounds of two together.
sagi_light_bounds sagi_light_bounds_union(const sagi_light_bounds *a, const sagi_light_bounds *b);

// Four children; those that are not there have intensity 0.
typedef struct sagi_light_node {
    sagi_f4 x, y, z, radius; // of the ball around the box, in the tree's units
    sagi_f4 axis_x, axis_y, axis_z;
    sagi_f4 cos_normals, sin_normals, cos_spread;
    sagi_f4 intensity; // share of the whole; negative when two-sided
    uint32_t child[4]; // a node, or SAGI_LIGHT_LEAF + the light's number
} sagi_light_node;
#define SAGI_LIGHT_LEAF 0x80000000u

typedef struct sagi_light_tree {
    sagi_light_node *nodes; // the root first
    uint64_t *trails;       // by light: which child it is in at each level, two bits each, the root's lowest
    uint32_t node_count, node_capacity, light_count;
    sag_vec3 origin; // the tree's units: (p − origin)·scale
    double scale;
} sagi_light_tree;

// The point that light is wanted at.
typedef struct sagi_light_view {
    sag_vec3 position;
    sag_vec3 normal; // unit; 0: it receives light alike from everywhere
    bool front_only; // light from behind the normal is of no use
} sagi_light_view;

// A tree of lights[0 … count); lights without intensity are not in it. False when memory is short (or there
// are more than 2^31 − 1); clear it then too. No lights: an empty tree.
bool sagi_light_tree_init(sagi_light_tree *tree, const sag_context *context, const sagi_light_bounds *lights,
                          uint32_t count);
void sagi_light_tree_clear(sagi_light_tree *tree, const sag_context *context);
// Chooses a light by *u in [0, 1), which becomes a number in [0, 1) to use again; *probability is that of the
// choice. False: no light of the tree reaches there.
bool sagi_light_tree_sample(const sagi_light_tree *tree, const sagi_light_view *view, double *u,
                            uint32_t *light, double *probability);
// The probability with which that light is chosen: the same bits.
double sagi_light_tree_probability(const sagi_light_tree *tree, const sagi_light_view *view, uint32_t light);

#endif
