// SPDX-License-Identifier: MIT
// A random valid shape of any kind that has a struct of its own.
#ifndef TESTS_SUPPORT_RANDOM_SHAPE_H
#define TESTS_SUPPORT_RANDOM_SHAPE_H

#include "support/random.h"
#include <sagitta/scene.h>

// The struct and whatever it points to.
typedef struct random_shape {
    sag_shape_kind kind;
    union {
        sag_plane plane;
        sag_disk disk;
        sag_rectangle rectangle;
        sag_polygon polygon;
        sag_sphere sphere;
        sag_ellipsoid ellipsoid;
        sag_cylinder cylinder;
        sag_cone cone;
        sag_paraboloid paraboloid;
        sag_hyperboloid hyperboloid;
        sag_hyperboloid2 hyperboloid2;
        sag_quadric quadric;
        sag_box box;
        sag_oriented_box oriented_box;
        sag_polyhedron polyhedron;
        sag_capsule capsule;
        sag_triangle triangle;
        sag_bilinear_patch bilinear_patch;
        sag_torus torus;
        sag_spheres spheres;
        sag_mesh mesh;
        sag_user user;
    } as;
    sag_vec3 points[8];
    uint32_t loops[2];
    sag_half_space planes[7];
    float floats[96];
    double doubles[96];
    uint32_t indices[96];
} random_shape;

// Makes one of about the given size within `size` of 0. `kind` is any but SAG_SHAPE_INSTANCE. *shape must not
// move afterwards: it points into itself.
void random_shape_make(rng *r, sag_shape_kind kind, double size, random_shape *shape);

// A random affine map: none, a shift, a similarity, a mirror, or any invertible one, moderately stretched.
// Returns whether it is other than the identity.
bool random_place(rng *r, double size, sag_affine *map);

#endif
