// SPDX-License-Identifier: MIT
// What the files of the room share: a body's place in the scene, its moments, and the numbers that rays give.
#ifndef SAGI_MEASURE_MEASURE_H
#define SAGI_MEASURE_MEASURE_H

#include "scene/scene.h"
#include <sagitta/measure.h>

// Volume, centre of mass and second moments about it: central[] = ∫ rᵢ rⱼ dV for xx yy zz xy xz yz.
typedef struct sagi_moments {
    double volume;
    sag_vec3 center;
    double central[6];
} sagi_moments;

// ∫ 1, xᵢ, xᵢ xⱼ dV about some point, before that is the centre of mass: 1 x y z xx yy zz xy xz yz.
#define SAGI_RAW_COUNT 10
typedef struct sagi_raw_moments {
    double m[SAGI_RAW_COUNT];
} sagi_raw_moments;

// The moments from raw ones about `origin` (moments.c). A volume of 0 gives zeros at the origin.
sagi_moments sagi_moments_from_raw(const sagi_raw_moments *raw, sag_vec3 origin);
// Those of the body's image under a map.
sagi_moments sagi_moments_map(const sagi_moments *moments, const sag_affine *map);
// The inertia tensor tr(C) 1 − C.
void sagi_moments_inertia(const sagi_moments *moments, double inertia[3][3]);
// Eigenvalues, ascending, and unit eigenvectors of a symmetric matrix.
void sagi_symmetric_eigen(const double a[3][3], double values[3], sag_vec3 vectors[3]);

// What a closed shape that is not a mesh amounts to, in its own space (closed_form.c). False: there is no
// closed form of the moments.
bool sagi_shape_moments(sag_shape_kind kind, const void *shape, sagi_moments *moments);
// A body of revolution about z (revolution.c): those whose ρ² is a polynomial of second degree between z_min
// and z_max, given at three points; the torus.
sagi_moments sagi_revolution_moments(double z_min, double z_max, const double square[3]);
sagi_moments sagi_revolution_sum(const sagi_moments *a, const sagi_moments *b);
sagi_moments sagi_torus_moments(const sag_torus *torus);
// Where ρ² is to be given: the places in (−1, 1) of the interval.
extern const double sagi_revolution_nodes[3];

// Whether a shape has an inside, as far as its description tells: of meshes sag_mesh_check does.
sag_body_state sagi_shape_state(sag_shape_kind kind, const void *shape);

// The area of the boundary of a shape that is no mesh, under a map; the error is 0 where it is exact
// (area.c). NAN when nobody knows.
sag_estimate sagi_shape_area(sag_shape_kind kind, const void *shape, const sagi_place *place,
                             const sag_measure_options *options, uint64_t seed);

// A mesh by the divergence theorem, about the middle of `box`, and its area under a map (NULL: as it is), on
// all threads (mesh_moments.c). False when memory is short.
typedef struct sagi_mesh_sums {
    sagi_raw_moments raw;
    double area;
    double volume_error; // bound of the roundings
    bool balanced;       // every edge is run through equally often both ways: the volume means something
} sagi_mesh_sums;
bool sagi_mesh_sum(const sag_context *context, const sag_mesh *mesh, const sag_affine *map, sag_vec3 origin,
                   sagi_mesh_sums *sums);

// Points and intervals (points.c, student.c).
//
// Bits of a number's own for this seed and these counters.
uint64_t sagi_measure_hash(uint64_t seed, uint64_t a, uint64_t b);
// Point `index` < 2³² of a scrambled Sobol' sequence in [0, 1)²: another key, an independent randomisation.
sag_vec2 sagi_measure_point(uint64_t key, uint64_t index);
// t with P(|T| < t) = confidence for Student's distribution with `freedom` degrees, 1 … 1000.
double sagi_student_quantile(double confidence, int freedom);

// A body in the scene: its place is the snapshot that has it, and the way there.
typedef struct sagi_subject {
    const sagi_snapshot *snapshot; // of the solid itself, or the one whose geometry it is
    sag_affine to_scene;           // from the snapshot's space; the product along the path
    uint32_t slot;                 // the same for all bodies of one geometry or solid: instances of it
} sagi_subject;

// The body's box in its snapshot's space, or of the solid with SAG_INVALID_ID (bodies.c).
sag_box3 sagi_subject_box(const sagi_subject *subject, uint32_t geometry);

// All bodies, in order (bodies.c). False when memory is short. The bodies have their path, geometry, kind,
// user data and bounds.
typedef struct sagi_body_list {
    const sag_context *context;
    sag_body *bodies;
    sagi_subject *subjects;
    size_t count, capacity, limit;
    uint64_t omitted;
    uint32_t slot_count;
    sagi_listing listing;
    uint32_t *first_slot;  // of each snapshot in the listing
    uint64_t *body_counts; // likewise: bodies that one instance of it shows
} sagi_body_list;
bool sagi_body_list_make(sagi_body_list *list, const sagi_snapshot *snapshot);
void sagi_body_list_release(sagi_body_list *list);

// What rays are sent into: one body, in the space that they are in (target.c).
typedef struct sagi_target {
    const sag_context *context;
    const sagi_kernel *kernel;
    const sagi_snapshot *snapshot;
    uint32_t geometry; // SAG_INVALID_ID: the snapshot is a solid
    bool by_depth;     // inside is where more surfaces are entered than left, not where their number is odd
    bool mapped;       // by `place`, from the snapshot's space to that of the rays
    sagi_place place;
    sag_box3 box; // holds the body, in the space of the rays
} sagi_target;

// A place where a line enters or leaves the body.
typedef struct sagi_boundary {
    sag_hit hit;
    bool entering;
} sagi_boundary;

// Room for the crossings of a line, of one thread. Zero-initialised but for the context.
typedef struct sagi_line_buffer {
    const sag_context *context;
    sag_hit *hits;
    sagi_boundary *boundaries;
    size_t capacity;
    bool failed; // out of memory: what was found is not all
} sagi_line_buffer;

// Where the ray crosses the body's boundary, in order: buffer->boundaries, as many as returned, entering and
// leaving by turns.
size_t sagi_target_cross(const sagi_target *target, const sag_ray *ray, sagi_line_buffer *buffer);
// Where a ray that starts just inside the body comes to its boundary; false: nowhere.
bool sagi_target_inward(const sagi_target *target, const sag_ray *ray, sagi_line_buffer *buffer, double *end);
// The surface of a hit.
void sagi_target_surface(const sagi_target *target, const sag_ray *ray, const sag_hit *hit,
                         sag_surface *surface);
void sagi_line_buffer_release(sagi_line_buffer *buffer);

// Parallel lines through a body's box (lines.c): randomisations of three families of lines.
#define SAGI_REPLICATES 32
#define SAGI_AXES       3
typedef struct sagi_line_sums {
    double raw[SAGI_RAW_COUNT]; // in the box's units, where it is [−1, 1]³
    double area;
    uint64_t boundary_count, turned_count; // those where the surface's own normal says the contrary
    bool failed;
} sagi_line_sums;
uint64_t sagi_line_key(uint64_t seed, uint32_t replicate, int axis);
// The line number `index` of a family, from its place in the box's middle plane; at[] is that place in the
// box's units.
sag_ray sagi_line(const sag_box3 *box, uint64_t key, int axis, uint64_t index, double at[3]);
// Adds the integrals over lines [first, first + count).
void sagi_lines_sum(const sagi_target *target, uint64_t key, int axis, uint64_t first, uint64_t count,
                    sagi_line_sums *sums);

// What is found out about a body, in the space where it is looked at.
typedef struct sagi_result {
    bool known, by_rays, reached, inside_out, overlaps;
    sag_body_state state;
    uint64_t rays;
    sag_mesh_report report;
    sagi_moments moments;
    double volume_error, center_error[3], inertia_error[3][3], principal_error[3];
    sag_estimate area;
    sag_thickness thickness;
} sagi_result;

// Who wants to know how far it is; `stop` is set when he has had enough.
typedef struct sagi_reporter {
    const sag_measure_options *options; // with no field left 0
    sag_measure_progress progress;
    bool stop;
} sagi_reporter;
// Adds rays and tells; false: stop.
bool sagi_report(sagi_reporter *reporter, double fraction, uint64_t rays);

// Moments and area by rays (sampling.c). False when memory is short or the reporter stops.
bool sagi_sample_body(const sagi_target *target, uint64_t seed, sagi_reporter *reporter, sagi_result *result);
// The mean of independent numbers with its interval.
sag_estimate sagi_mean_estimate(const double *values, int count, double confidence);

// The thickness from `lines` lines of each family of each randomisation (thickness.c); as above.
bool sagi_sample_thickness(const sagi_target *target, uint64_t seed, uint32_t lines, sagi_reporter *reporter,
                           sagi_result *result);

#endif
