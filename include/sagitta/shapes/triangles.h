// SPDX-License-Identifier: MIT
/// @file triangles.h
/// Triangles: one, a mesh of many, and the bilinear patch.
#ifndef SAGITTA_SHAPES_TRIANGLES_H
#define SAGITTA_SHAPES_TRIANGLES_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The triangle a b c. Whether a ray meets it is decided exactly for the numbers given. A ray that meets an
/// edge or vertex exactly belongs to it or to its neighbour by a rule that depends on the ray and the
/// positions alone, so that of the triangles of a closed mesh exactly one takes it (docs/numerics.md). A ray
/// in the triangle's plane misses; so does one whose t is beyond the doubles. Exactness needs that within
/// each of direction, vertex minus origin, and edge no coordinate but 0 is smaller than 1e-280 of the
/// largest; smaller ones count as 0. t is within 4 ulp (measured: 0.8), u and v within 2^-42 (tests/oracle).
/// p = (1 − β − γ) a + β b + γ c; hit.u = β, hit.v = γ, which are the texture coordinates too. The normal is
/// (b − a) × (c − a). A triangle without area is an error.
typedef struct sag_triangle {
    sag_vec3 a, b, c;
    bool one_sided; ///< only rays that arrive at the front (against the normal) meet it
} sag_triangle;

/// The verbs of triangle: see shapes.h.
SAG_API sag_status sag_triangle_validate(const sag_triangle *triangle, sag_error *error);
SAG_API sag_box3 sag_triangle_bounds(const sag_triangle *triangle);
SAG_API bool sag_triangle_hit(const sag_triangle *triangle, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_triangle_occluded(const sag_triangle *triangle, const sag_ray *ray);
SAG_API size_t sag_triangle_crossings(const sag_triangle *triangle, const sag_ray *ray, sag_hit *hits,
                                      size_t capacity);
SAG_API void sag_triangle_surface(const sag_triangle *triangle, const sag_ray *ray, const sag_hit *hit,
                                  sag_surface *surface);
SAG_API double sag_triangle_area(const sag_triangle *triangle);
SAG_API bool sag_triangle_sample(const sag_triangle *triangle, sag_vec2 random, sag_surface *surface);
SAG_API sag_vec3 sag_triangle_closest_point(const sag_triangle *triangle, sag_vec3 point);

/// A mesh of triangles over shared vertices. Exactly one of positions_f32 and positions_f64 is given;
/// positions, normals and texture coordinates are indexed alike. Triangles with a vertex that is NaN,
/// infinite or beyond SAG_MAX_COORDINATE, or without area, are dropped and reported (sag_mesh_check); an
/// index out of range is an error. Hits: as for sag_triangle. With normals the shading normal is
/// interpolated, with texcoords the texture coordinates.
typedef struct sag_mesh {
    const float *positions_f32;  ///< x y z of each vertex, or NULL
    const double *positions_f64; ///< x y z of each vertex, or NULL
    const float *normals_f32;    ///< x y z of each vertex, any length; or NULL
    const float *texcoords_f32;  ///< u v of each vertex; or NULL
    const uint32_t *triangles;   ///< three vertex indices of each triangle
    uint32_t vertex_count;
    uint32_t triangle_count; ///< > 0
    bool one_sided;          ///< as in sag_triangle
} sag_mesh;

/// The verbs of mesh: see shapes.h. They visit every triangle: use a scene for more than a few. contains
/// needs a closed mesh and counts crossings exactly; volume is the signed sum of tetrahedra and speaks of
/// closed meshes only. sample takes time in the number of triangles.
SAG_API sag_status sag_mesh_validate(const sag_mesh *mesh, sag_error *error);
SAG_API sag_box3 sag_mesh_bounds(const sag_mesh *mesh);
SAG_API bool sag_mesh_hit(const sag_mesh *mesh, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_mesh_occluded(const sag_mesh *mesh, const sag_ray *ray);
SAG_API size_t sag_mesh_crossings(const sag_mesh *mesh, const sag_ray *ray, sag_hit *hits, size_t capacity);
SAG_API void sag_mesh_surface(const sag_mesh *mesh, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface);
SAG_API double sag_mesh_area(const sag_mesh *mesh);
SAG_API bool sag_mesh_sample(const sag_mesh *mesh, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_mesh_contains(const sag_mesh *mesh, sag_vec3 point);
SAG_API double sag_mesh_volume(const sag_mesh *mesh);
SAG_API sag_vec3 sag_mesh_closest_point(const sag_mesh *mesh, sag_vec3 point);

/// What is wrong with a mesh, and whether it is closed.
typedef struct sag_mesh_report {
    uint32_t triangle_count;     ///< as given
    uint32_t not_finite_count;   ///< triangles with a NaN, infinite or too large vertex
    uint32_t degenerate_count;   ///< triangles without area (decided exactly), not counting those above
    uint32_t duplicate_count;    ///< triangles over the same three positions as an earlier one, not counting
                                 ///< those above
    uint32_t open_edge_count;    ///< edges of one triangle only, after merging equal positions
    uint32_t crowded_edge_count; ///< edges of three or more triangles
    uint32_t flipped_edge_count; ///< edges that two triangles run through in the same direction
    bool closed; ///< every edge has exactly two triangles, in opposite directions (good ones counted)
    uint32_t open_edge[2]; ///< the vertices of an open edge, when there is one
} sag_mesh_report;

/// Examines a mesh; needs memory of about 40 bytes a triangle from the context. SAG_ERROR_GEOMETRY for an
/// index out of range (the message names the triangle), SAG_ERROR_ARGUMENT for more than 1,431,655,765
/// triangles, SAG_ERROR_MEMORY; *report is written on SAG_OK only. (tests/unit/test_mesh.c)
SAG_API sag_status sag_mesh_check(const sag_context *context, const sag_mesh *mesh, sag_mesh_report *report,
                                  sag_error *error);

/// Vertex normals for a mesh that has none: the sum of the normals of the triangles around a vertex, weighted
/// by their angle there (Thürmer & Wüthrich 1998). Writes 3·vertex_count floats; a vertex without triangles
/// gets (0, 0, 1).
SAG_API void sag_mesh_compute_normals(const sag_mesh *mesh, float *normals_f32);

/// The bilinear patch p(u, v) = (1−u)(1−v) p00 + u(1−v) p10 + (1−u)v p01 + uv p11, u and v in [0, 1]
/// (Reshetov, "Cool Patches", Ray Tracing Gems ch. 8). The normal is dp/du × dp/dv. hit.u, hit.v are u, v. At
/// most two crossings.
typedef struct sag_bilinear_patch {
    sag_vec3 p00, p10, p01, p11; ///< not all on one line
} sag_bilinear_patch;

/// The verbs of bilinear_patch: see shapes.h.
SAG_API sag_status sag_bilinear_patch_validate(const sag_bilinear_patch *bilinear_patch, sag_error *error);
SAG_API sag_box3 sag_bilinear_patch_bounds(const sag_bilinear_patch *bilinear_patch);
SAG_API bool sag_bilinear_patch_hit(const sag_bilinear_patch *bilinear_patch, const sag_ray *ray,
                                    sag_hit *hit);
SAG_API bool sag_bilinear_patch_occluded(const sag_bilinear_patch *bilinear_patch, const sag_ray *ray);
SAG_API size_t sag_bilinear_patch_crossings(const sag_bilinear_patch *bilinear_patch, const sag_ray *ray,
                                            sag_hit *hits, size_t capacity);
SAG_API void sag_bilinear_patch_surface(const sag_bilinear_patch *bilinear_patch, const sag_ray *ray,
                                        const sag_hit *hit, sag_surface *surface);
SAG_API double sag_bilinear_patch_area(const sag_bilinear_patch *bilinear_patch);
SAG_API bool sag_bilinear_patch_sample(const sag_bilinear_patch *bilinear_patch, sag_vec2 random,
                                       sag_surface *surface);

#ifdef __cplusplus
}
#endif
#endif
