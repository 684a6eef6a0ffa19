// SPDX-License-Identifier: MIT
// Which points a closed shape consists of, by the signs of its equations: the oracle of the solids. It shares
// no code with the library. A sign is found in doubles with a running bound of the error, and where that does
// not settle it in exact fractions (GMP), so that millions of questions take seconds and none is answered
// wrongly.
#ifndef TESTS_SUPPORT_REGION_H
#define TESTS_SUPPORT_REGION_H

#include <gmp.h>
#include <sagitta/shapes.h>

// Signs, so that min is "and", max is "or", − is "not" and −a·b is "exclusive or", unknown included.
typedef enum membership { MEMBER_OUT = -1, MEMBER_UNKNOWN = 0, MEMBER_IN = 1 } membership;

// A number that is within e of v.
typedef struct approx {
    double v, e;
} approx;

// The point o + t·d: that very point, or where `exact` is not set (a map was applied) one near it.
typedef struct spot {
    approx x[3];
    double reach[3]; // |o| + |t·d| of each coordinate or more
    bool exact;
    sag_vec3 origin, direction;
    double t;
} spot;

spot spot_on(const sag_ray *ray, double t);
spot spot_at(sag_vec3 point);
// Any point within `radius` of the given one in each coordinate.
spot spot_around(sag_vec3 point, double radius);

// The way back from a space to that of one of its parts, its coefficients known to an ulp.
typedef struct inverse_map {
    double m[3][4];
} inverse_map;

// The exact inverse of an affine map, rounded.
void inverse_map_make(inverse_map *inverse, const sag_affine *map);
// A spot in the part's space: not exact any more. Its error covers what a ray suffers that is brought there
// in double precision by an inverse that is good to some ulp.
spot spot_map(const inverse_map *inverse, const spot *from);

// A polynomial of second degree in x − center: a b c d e f g h i j as in sag_quadric.
typedef struct rule {
    mpq_t q[10];
    double v[10];  // cut to 53 bits
    unsigned used; // bit i: q[i] is not 0
    sag_vec3 center;
} rule;

enum { REGION_MAX_CLAUSES = 3 };

// The union of the clauses, each of which is where all its rules are ≤ 0; or a torus; or what a mesh
// surrounds.
typedef struct shape_region {
    uint32_t clause_count;
    uint32_t clause_end[REGION_MAX_CLAUSES]; // where in rules the next clause begins
    rule *rules;
    bool faces_belong; // points on the surface, decided exactly, are in
    const sag_torus *torus;
    const sag_mesh *mesh;
    sag_vec3 mesh_center;
    double mesh_size;
} shape_region;

// The region of a whole, closed shape; torus and mesh must stay where they are. A spindle torus counts the
// lens in its middle as inside.
void region_make(shape_region *region, sag_shape_kind kind, const void *shape);
void region_clear(shape_region *region);
// Quick: in doubles.
membership region_filter(const shape_region *region, const spot *at);
// In fractions: right for every exact spot; MEMBER_UNKNOWN on a surface whose points may count as either, and
// for spots that are not exact.
membership region_exact(const shape_region *region, const spot *at);

// Of region_mesh.c: the parity of the crossings of the way from the spot to far outside.
membership region_mesh_filter(const shape_region *region, const spot *at);
membership region_mesh_exact(const shape_region *region, const spot *at);

#endif
