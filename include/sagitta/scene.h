// SPDX-License-Identifier: MIT
/// @file scene.h
/// Many shapes under one acceleration structure, and what rays ask of them.
///
/// A scene is built (add, set), committed, then queried. A committed scene does not change: any number of
/// threads query it at once without locks. Changing a geometry needs a new commit, which no query may
/// overlap. Queries cannot fail; those on a scene that was never committed find nothing.
///
/// Hits at equal t are ordered by instance path, geometry, primitive, so the answer never depends on the
/// tree, the instruction set or the number of threads.
#ifndef SAGITTA_SCENE_H
#define SAGITTA_SCENE_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sag_scene sag_scene;

/// An empty scene; NULL when memory is not to be had. The context must outlive it.
SAG_API sag_scene *sag_scene_create(sag_context *context);
/// Gives the scene up: it goes when no instance in another scene refers to it any more. NULL does nothing.
SAG_API void sag_scene_destroy(sag_scene *scene);

/// Add a geometry: everything the description points to is copied, so the caller's arrays may go. Returns its
/// id (ids count up from 0 and are not reused) or SAG_INVALID_ID when the shape is not valid or memory is
/// short; the first such failure is kept and returned, with its message, by the next sag_scene_commit (and
/// then forgotten), so that the calls here need no checks of their own.
SAG_API uint32_t sag_add_plane(sag_scene *scene, const sag_plane *plane);
SAG_API uint32_t sag_add_disk(sag_scene *scene, const sag_disk *disk);
SAG_API uint32_t sag_add_rectangle(sag_scene *scene, const sag_rectangle *rectangle);
SAG_API uint32_t sag_add_polygon(sag_scene *scene, const sag_polygon *polygon);
SAG_API uint32_t sag_add_sphere(sag_scene *scene, const sag_sphere *sphere);
SAG_API uint32_t sag_add_ellipsoid(sag_scene *scene, const sag_ellipsoid *ellipsoid);
SAG_API uint32_t sag_add_cylinder(sag_scene *scene, const sag_cylinder *cylinder);
SAG_API uint32_t sag_add_cone(sag_scene *scene, const sag_cone *cone);
SAG_API uint32_t sag_add_paraboloid(sag_scene *scene, const sag_paraboloid *paraboloid);
SAG_API uint32_t sag_add_hyperboloid(sag_scene *scene, const sag_hyperboloid *hyperboloid);
SAG_API uint32_t sag_add_hyperboloid2(sag_scene *scene, const sag_hyperboloid2 *hyperboloid2);
SAG_API uint32_t sag_add_quadric(sag_scene *scene, const sag_quadric *quadric);
SAG_API uint32_t sag_add_box(sag_scene *scene, const sag_box *box);
SAG_API uint32_t sag_add_oriented_box(sag_scene *scene, const sag_oriented_box *oriented_box);
SAG_API uint32_t sag_add_polyhedron(sag_scene *scene, const sag_polyhedron *polyhedron);
SAG_API uint32_t sag_add_capsule(sag_scene *scene, const sag_capsule *capsule);
SAG_API uint32_t sag_add_triangle(sag_scene *scene, const sag_triangle *triangle);
SAG_API uint32_t sag_add_bilinear_patch(sag_scene *scene, const sag_bilinear_patch *bilinear_patch);
SAG_API uint32_t sag_add_torus(sag_scene *scene, const sag_torus *torus);
SAG_API uint32_t sag_add_spheres(sag_scene *scene, const sag_spheres *spheres);
SAG_API uint32_t sag_add_mesh(sag_scene *scene, const sag_mesh *mesh);
SAG_API uint32_t sag_add_user(sag_scene *scene, const sag_user *user);

/// Places a committed scene inside this one: to_parent maps its space to this one's and must be invertible.
/// Instances nest up to SAG_MAX_INSTANCE_DEPTH deep. The child is kept alive; it must not be changed while
/// the parent is in use.
SAG_API uint32_t sag_add_instance(sag_scene *scene, sag_scene *child, const sag_affine *to_parent);

/// Any kind by its number: `shape` points to the struct that belongs to `kind`. For loaders; not for
/// instances.
SAG_API uint32_t sag_add_shape(sag_scene *scene, sag_shape_kind kind, const void *shape);

/// Places a geometry: to_scene maps the shape's own space to the scene's. NULL: the identity, the default.
/// SAG_ERROR_ARGUMENT for an unknown id, SAG_ERROR_GEOMETRY for a singular map. The ray is brought to the
/// shape's space in double precision; exactness is meant for that ray. (Meshes are moved vertex by vertex at
/// commit instead.)
SAG_API sag_status sag_geometry_set_transform(sag_scene *scene, uint32_t geometry,
                                              const sag_affine *to_scene);
/// Which kinds of ray see the geometry; 0, the default: all.
SAG_API sag_status sag_geometry_set_mask(sag_scene *scene, uint32_t geometry, uint32_t mask);
/// A number of the caller's, handed back in sag_surface; 0 by default.
SAG_API sag_status sag_geometry_set_user_data(sag_scene *scene, uint32_t geometry, uint64_t user_data);
/// Turns geometric and shading normal to the side the ray arrives from (`side` still says which it was). Off
/// by default.
SAG_API sag_status sag_geometry_set_face_forward(sag_scene *scene, uint32_t geometry, bool face_forward);
/// Takes a geometry out of (or back into) the scene without forgetting it. On by default.
SAG_API sag_status sag_geometry_set_enabled(sag_scene *scene, uint32_t geometry, bool enabled);
/// Replaces a geometry's description by another of the same kind, copied as sag_add_shape does: a mesh's
/// vertices, a sphere's radius, anything. Its id, transform, mask and the rest stay. Queries see it after the
/// next commit; the description that sag_geometry_get gave is gone at once. SAG_ERROR_ARGUMENT for an unknown
/// id, an instance, or a kind that is not the geometry's; SAG_ERROR_GEOMETRY for an invalid shape,
/// SAG_ERROR_MEMORY: in all of these nothing is changed, and the error says why.
SAG_API sag_status sag_geometry_set_shape(sag_scene *scene, uint32_t geometry, sag_shape_kind kind,
                                          const void *shape, sag_error *error);

/// What is expected to happen to a geometry between commits, which decides what a commit costs after it has
/// changed: its shape or transform, its being there, the scene that an instance shows. (Mask, user data and
/// facing never cost anything.) Answers do not depend on it, not in a bit (tests/unit/test_update.c).
typedef enum sag_update {
    SAG_UPDATE_STATIC = 0, ///< nothing: fastest to trace. When one such changes, all of them are built anew
    SAG_UPDATE_REBUILD,    ///< changes: it alone is built anew, at the scene's quality
    SAG_UPDATE_REFIT, ///< changes a little: it keeps its tree, whose boxes are renewed. Some times faster
                      ///< than building, but the tree gets worse as parts move away from their
                      ///< neighbours (sag_scene_stats.sah says how much); set SAG_UPDATE_REBUILD for one
                      ///< commit to have it anew. Where the number of primitives changes it is built
} sag_update;

/// SAG_UPDATE_STATIC at first. Takes effect at the next commit, which builds the geometry anew. Geometries of
/// few primitives, instances above all, are together in one tree if they are not static, which is soon built.
/// User-defined shapes are asked for their boxes at every commit: where they are many, or others are, they
/// had better not be static. SAG_ERROR_ARGUMENT, changing nothing, for an unknown id or value.
SAG_API sag_status sag_geometry_set_update(sag_scene *scene, uint32_t geometry, sag_update update);

/// Removes a geometry and frees it; its id stays unused.
SAG_API sag_status sag_geometry_remove(sag_scene *scene, uint32_t geometry);

/// The kind of a geometry and, when shape is not NULL, the scene's own copy of its description (alive until
/// the geometry goes; for an instance NULL). SAG_ERROR_ARGUMENT for an unknown id.
SAG_API sag_status sag_geometry_get(const sag_scene *scene, uint32_t geometry, sag_shape_kind *kind,
                                    const void **shape);

/// Where a geometry (or instance) stands: writes the map given to sag_geometry_set_transform (or
/// sag_add_instance), the identity when there was none. SAG_ERROR_ARGUMENT, writing nothing, for an unknown
/// id.
SAG_API sag_status sag_geometry_get_transform(const sag_scene *scene, uint32_t geometry,
                                              sag_affine *to_scene);

/// How many ids a scene has given out: they are 0 … count − 1, those of removed geometries among them.
SAG_API uint32_t sag_scene_geometry_count(const sag_scene *scene);

/// The scene that an instance shows: the one given to sag_add_instance. NULL for an id that is unknown or no
/// instance's, and when that scene is destroyed (the instance goes on showing what it was).
SAG_API const sag_scene *sag_instance_scene(const sag_scene *scene, uint32_t instance);
/// Brings a surface from the space of the scene that an instance shows to that of the scene the instance is
/// in, its error included, as sag_surface_at does with a hit's at each level; of the last commit. An id that
/// is no instance's changes nothing. (tests/unit/test_scene_surface.c)
SAG_API void sag_instance_map_surface(const sag_scene *scene, uint32_t instance, sag_surface *surface);

/// How much care a commit takes over its acceleration structure. Answers do not depend on it, not in a bit
/// (tests/unit/test_quality.c); only the time to build, the memory and the time to trace do.
/// Figures are of one mesh on two cores, beside the default.
typedef enum sag_quality {
    SAG_QUALITY_DEFAULT = 0, ///< a binned surface area heuristic: right for nearly everything
    /// Builds in about 0.6 of the time, traces 6 % (scans) to 15 % (machine parts) slower.
    SAG_QUALITY_FAST,
    /// Builds in 10 to 30 times the time. Traces 15 to 25 % faster where the triangles of a mesh are long,
    /// thin or of many sizes (machines, wires, slanted slabs), 0 to 3 % where they are much alike (scans).
    SAG_QUALITY_HIGH,
} sag_quality;

/// The quality of the structure that the next sag_scene_commit builds, and those after it, until it is set
/// again; SAG_QUALITY_DEFAULT at first. SAG_ERROR_ARGUMENT, changing nothing, for what is none of the three.
/// An instance keeps the quality its own scene was committed with.
SAG_API sag_status sag_scene_set_quality(sag_scene *scene, sag_quality quality);

/// Makes the scene ready for queries: validates, builds the acceleration structure on the context's threads,
/// as far as it is not as it was at the last commit (sag_update). On failure the error says why (the first
/// failed add included) and the scene answers as it did before.
SAG_API sag_status sag_scene_commit(sag_scene *scene, sag_error *error);

/// Writes a committed scene to a file: its geometries, the scenes its instances show (a shared one once) and
/// the acceleration structure as it is, with checksums. The file appears whole or not at all: it is written
/// under another name beside `path` and renamed over it when it is on disk. What is saved is what queries
/// see: changes since the last commit are not in it, nor are geometries that are disabled (their ids stay
/// unused, as those of removed ones do; a part of a solid that was disabled stays nowhere). SAG_ERROR_STATE
/// before the first commit, SAG_ERROR_ARGUMENT for a scene with shapes of the user's own (callbacks cannot be
/// saved), SAG_ERROR_MEMORY, SAG_ERROR_IO with the system's reason. May run while other threads query the
/// scene. (tests/unit/test_save.c)
SAG_API sag_status sag_scene_save(const sag_scene *scene, const char *path, sag_error *error);
/// Makes a committed scene from a file that sag_scene_save wrote. It answers every query with the same bits
/// as the one that was saved, has the same ids, and may be changed and committed again; the scenes of its
/// instances come with it. Reading takes a small part of the time that building took. Files are for the
/// machine they were made on and its like: SAG_ERROR_FORMAT for one of another byte order, of another version
/// of the format, for one that is cut or damaged, and for anything else. Nothing in a file is believed: no
/// file, however made, can make this call or a later query leave its memory or not end. The error has the
/// file and, in its message, the byte and what is wrong there. *scene is written on SAG_OK only; the context
/// must outlive it. (tests/unit/test_save.c, test_load_hostile.c)
SAG_API sag_status sag_scene_load(sag_context *context, const char *path, sag_scene **scene,
                                  sag_error *error);

/// Takes the next `bytes` bytes; false: that failed. Never called with 0.
typedef bool (*sag_write_callback)(void *user, const void *data, size_t bytes);
/// Fills in the next `bytes` bytes; false: there are not that many. Never called with 0.
typedef bool (*sag_read_callback)(void *user, void *data, size_t bytes);

/// sag_scene_save to anywhere: the bytes of the file, in order, to a callback. For a network, an archive,
/// memory. SAG_ERROR_IO when the callback returned false.
SAG_API sag_status sag_scene_write(const sag_scene *scene, sag_write_callback write, void *user,
                                   sag_error *error);
/// sag_scene_load from anywhere: asks for the bytes of the file, in order, and for none after its end.
SAG_API sag_status sag_scene_read(sag_context *context, sag_read_callback read, void *user, sag_scene **scene,
                                  sag_error *error);

/// Counts and sizes of a committed scene.
typedef struct sag_scene_stats {
    uint32_t geometry_count;
    uint64_t primitive_count; ///< in the tree, dropped ones not counted, instances as one each
    uint64_t dropped_not_finite, dropped_degenerate;
    uint64_t node_count, leaf_count;
    uint32_t depth; ///< of the tree
    double sah; ///< what a ray through the bounds costs on average as the builder reckons, in visits of nodes
    uint64_t geometry_bytes;  ///< the shapes' own data
    uint64_t structure_bytes; ///< nodes and leaves
    uint64_t memory_bytes; ///< all that is held for this scene now: the two above, its tables, descriptions
                           ///< not committed yet or disabled; not the scenes that its instances show
    uint64_t shared_bytes; ///< the committed scenes that its instances show, and theirs in turn: each once,
                           ///< however often it is shown. Other scenes may share them
    double build_seconds;
    sag_box3 bounds; ///< of the bounded geometries; empty when there are none
} sag_scene_stats;

/// Writes the counts of the last commit; all zero before the first.
SAG_API void sag_scene_get_stats(const sag_scene *scene, sag_scene_stats *stats);

/// The box of everything in the committed scene; infinite when a plane or the like is in it, empty for an
/// empty scene.
SAG_API sag_box3 sag_scene_bounds(const sag_scene *scene);

/// The closest hit in [t_min, t_max]. Returns false and leaves *hit alone when there is none.
SAG_API bool sag_intersect(const sag_scene *scene, const sag_ray *ray, sag_hit *hit);
/// Whether anything is hit in [t_min, t_max]; sooner than sag_intersect.
SAG_API bool sag_occluded(const sag_scene *scene, const sag_ray *ray);
/// Every crossing in [t_min, t_max] in order of t; writes the first `capacity` to hits[] and returns how many
/// there are in all. hits may be NULL when capacity is 0. Crossings at the same t of different primitives are
/// all reported; an edge or vertex that triangles of one mesh share is one crossing.
SAG_API size_t sag_intersect_all(const sag_scene *scene, const sag_ray *ray, sag_hit *hits, size_t capacity);
/// How many crossings sag_intersect_all finds, without storing them.
SAG_API size_t sag_count_crossings(const sag_scene *scene, const sag_ray *ray);
/// Whether the point is inside the closed geometries: an odd number of crossings on a ray from it to
/// infinity. Points on a surface may count as either. What is not closed gives no defined answer. Masks are
/// not looked at.
SAG_API bool sag_contains(const sag_scene *scene, sag_vec3 point);

/// The nearest point of the scene's surfaces.
typedef struct sag_closest {
    sag_vec3 point;
    double distance;
    uint32_t geometry, primitive;
    uint32_t instance_depth;
    uint32_t instance_path[SAG_MAX_INSTANCE_DEPTH];
} sag_closest;

/// The point nearest to `point` on any surface within max_distance (INFINITY: any); false, writing nothing,
/// when there is none. Speaks of shapes that have a closest_point (shapes.h): the others are passed over.
/// Under an instance or transform that is not a similarity, meshes and triangles are exact, other shapes are
/// passed over.
SAG_API bool sag_closest_point(const sag_scene *scene, sag_vec3 point, double max_distance,
                               sag_closest *closest);

/// Everything about a hit of this very ray: fills *surface in the scene's space. For a hit that names what
/// the scene does not have (any more), all of it is 0 and geometry SAG_INVALID_ID (tests/unit/test_scene.c).
SAG_API void sag_surface_at(const sag_scene *scene, const sag_ray *ray, const sag_hit *hit,
                            sag_surface *surface);

/// sag_intersect for rays[0 … count) on all the context's threads: writes hits[i], its t = INFINITY and
/// geometry = SAG_INVALID_ID on a miss. The same bits as single calls.
SAG_API void sag_intersect_batch(const sag_scene *scene, const sag_ray *rays, sag_hit *hits, size_t count);
/// sag_occluded for rays[0 … count) on all the context's threads: writes occluded[i].
SAG_API void sag_occluded_batch(const sag_scene *scene, const sag_ray *rays, bool *occluded, size_t count);

/// The area of one primitive of a geometry, placed as it is in its committed scene (transform included); NAN
/// for an unknown id, INFINITY for an unbounded shape. `primitive` is the triangle of a mesh or the sphere of
/// a set; other shapes are one whole, whatever its value. For lights. Under a transform that is not a
/// similarity: exact for flat shapes, else numerical (within about 1e-3).
SAG_API double sag_geometry_area(const sag_scene *scene, uint32_t geometry, uint32_t primitive);
/// A box that holds one primitive of a geometry (all of an instance), placed as it is in its committed scene,
/// rounded outward. Empty for an unknown id, for what is not there (disabled, dropped, without extent in any
/// direction); infinite for an unbounded shape. (tests/unit/test_scene_surface.c)
SAG_API sag_box3 sag_geometry_bounds(const sag_scene *scene, uint32_t geometry, uint32_t primitive);
/// A point on one primitive, placed as it is in its scene, and its density by area: exactly 1/area for flat
/// shapes and similarities, else the density the map makes of it. False, writing nothing, when it cannot be
/// sampled.
SAG_API bool sag_geometry_sample(const sag_scene *scene, uint32_t geometry, uint32_t primitive,
                                 sag_vec2 random, sag_surface *surface, double *density);
/// The density sag_geometry_sample has at a point of this geometry known by its surface (for multiple
/// importance sampling).
SAG_API double sag_geometry_density(const sag_scene *scene, uint32_t geometry, uint32_t primitive,
                                    const sag_surface *surface);

#ifdef __cplusplus
}
#endif
#endif
