// SPDX-License-Identifier: MIT
// Which shapes bound a volume, and where a line is before it meets them. For solids and spans: inside is
// where the number of crossings on the way from −∞ is odd, or even for a line that comes from inside.
#ifndef SAGI_SHAPES_CLOSED_H
#define SAGI_SHAPES_CLOSED_H

#include <sagitta/shapes.h>

// What is not closed or whole about a valid shape, to go on after "geometry 3, a cylinder, "; NULL when it is
// closed. Not for meshes and instances.
const char *sagi_shape_flaw(sag_shape_kind kind, const void *shape);

// Whether the ray's line, from t = −∞ on, comes from inside of a closed shape: false but for the unbounded
// ones, planes and some polyhedra. The ray must be valid; its range does not matter. Together with the
// crossings that `crossings` finds from −∞ to ∞ it says what is inside.
bool sagi_shape_begins_inside(sag_shape_kind kind, const void *shape, const sag_ray *ray);

// A spindle torus is one body, the lens in its middle included: its inner sheet is a surface that rays hit,
// but no boundary. Of all crossings of the ray's whole line with a torus, in order, takes out those with that
// sheet; returns how many are left.
size_t sagi_torus_leave_outer(const sag_torus *torus, const sag_ray *ray, sag_hit *hits, size_t count);

// Whether each edge of the mesh has an even number of triangles: then every line crosses the mesh an even
// number of times, and inside is where that number is odd, whatever way round the triangles are. Edges are
// the same when their ends' positions are. Triangles without area count, for they join their neighbours;
// those with a vertex that is not finite do not. Needs no memory. (mesh_closed.c)
bool sagi_mesh_is_closed(const sag_mesh *mesh);

// An edge with an odd number of triangles, and how many such edges there are.
typedef struct sagi_odd_edges {
    uint64_t count;
    uint32_t vertex[2]; // the edge found first: the lowest indices of its positions
    uint32_t triangles; // of this edge
    uint32_t on_it;     // a vertex that lies on the edge between its ends, as nearly as floats allow, or
                        // SAG_INVALID_ID
} sagi_odd_edges;
// The same question with an answer that can be told to somebody (mesh_check.c). SAG_ERROR_MEMORY, or
// SAG_ERROR_ARGUMENT for more triangles than it can count (sag_mesh_check).
sag_status sagi_mesh_find_odd_edges(const sag_context *context, const sag_mesh *mesh, sagi_odd_edges *odd);

#endif
