// SPDX-License-Identifier: MIT
/// @file measure.h
/// How much there is of each body of a scene: volume, area, centre of mass, moments of inertia, wall
/// thickness.
///
/// A body is a closed geometry (a whole sphere, a closed mesh …) or a solid (solid.h), each place where it
/// stands counting as one; it is measured alone, whatever else is in the scene. Where a closed form exists
/// the result is exact to rounding: all closed shapes alone, closed meshes by the divergence theorem, under
/// any transform. What has none (solids, sets of spheres) is measured by rays: parallel lines along the
/// three axes, spread by scrambled Sobol' points in 32 independent randomisations, from which a confidence
/// interval is made; more of them until it is as narrow as wanted. docs/measuring.md has the mathematics.
///
///     sag_measurement m;
///     if (sag_measure(scene, &(sag_measure_options){.error = 1e-4}, &m, &error) != SAG_OK) …
///     for (size_t i = 0; i < m.body_count; i++)
///         printf("%g ± %g\n", m.bodies[i].volume.value, m.bodies[i].volume.error);
///     sag_measurement_clear(&m);
#ifndef SAGITTA_MEASURE_H
#define SAGITTA_MEASURE_H

#include <sagitta/scene.h>
#include <sagitta/solid.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A number and how far off it may be: half the width of its confidence interval, 0 for what is exact to
/// rounding. NAN where there is no such number.
typedef struct sag_estimate {
    double value, error;
} sag_estimate;

/// What kind of thing a body is.
typedef enum sag_body_state {
    SAG_BODY_CLOSED,    ///< has an inside: everything is measured
    SAG_BODY_OPEN,      ///< a surface without an inside: area and bounds only
    SAG_BODY_UNBOUNDED, ///< reaches to infinity: a plane, a slab
    SAG_BODY_EMPTY,     ///< there is nothing of it, or no ray met anything
} sag_body_state;

/// How thick a body is: from points spread evenly over its surface, the way straight inward (against the
/// normal) to where it ends. It is what engineers call wall thickness by the ray method. By area: a
/// percentile of 5 says that a twentieth of the surface has no more behind it.
#define SAG_THICKNESS_PERCENTILES 7 ///< at 1, 5, 25, 50, 75, 95 and 99 %
#define SAG_THICKNESS_BINS        40
typedef struct sag_thickness {
    uint64_t sample_count;                         ///< points asked; 0: not measured, all else is 0 then
    double min, max;                               ///< of the points asked: thinner places may be between
    sag_estimate mean;                             ///< over the area
    double percentiles[SAG_THICKNESS_PERCENTILES]; ///< [3] is the median
    double histogram[SAG_THICKNESS_BINS];          ///< shares of the area; equal bins from 0 to max
    sag_vec3 thinnest;                             ///< the point of the surface where min was found
} sag_thickness;

/// One body. Lengths are in the scene's unit, moments for density 1, all in the scene's space.
typedef struct sag_body {
    uint32_t instance_depth;                        ///< how many of instance_path are used
    uint32_t instance_path[SAG_MAX_INSTANCE_DEPTH]; ///< the instances that lead to it, outermost first
    uint32_t geometry;   ///< in the innermost scene; SAG_INVALID_ID for a solid, which is a scene itself
    sag_shape_kind kind; ///< SAG_SHAPE_INSTANCE for a solid
    const void *shape;   ///< the description it was added with, alive as long as the geometry; NULL: a solid
    uint64_t user_data;  ///< of the geometry, or of the instance that shows the solid
    sag_body_state state;
    sag_box3 bounds;        ///< conservative
    bool by_rays;           ///< some of the following are estimates
    bool reached;           ///< the error asked for is reached by all of them
    bool inside_out;        ///< a mesh whose normals point inward; it is measured as if they did not
    bool overlaps;          ///< a mesh that goes through itself or has parts facing both ways: the exact
                            ///< volume counts what is inside twice twice, and the inside-out parts off
    uint64_t rays;          ///< lines that were sent, thickness included
    sag_mesh_report report; ///< of a mesh: why it is not closed
    sag_estimate volume, area;
    sag_estimate center[3];     ///< of mass
    sag_estimate inertia[3][3]; ///< about the centre of mass: ∫ (|r|² δᵢⱼ − rᵢ rⱼ) dV
    sag_estimate principal[3];  ///< the tensor's eigenvalues, ascending
    sag_vec3 axes[3];           ///< the unit eigenvectors that belong to them, right-handed
    sag_thickness thickness;
} sag_body;

/// How far a measurement is.
typedef struct sag_measure_progress {
    size_t body, body_count; ///< at which it is
    double fraction;         ///< how much of this body is likely done, 0 … 1
    uint64_t rays;           ///< sent so far, over all bodies
} sag_measure_progress;

/// How to measure. Zero-initialised: the defaults.
typedef struct sag_measure_options {
    double error;      ///< the relative error wanted; 0: 1e-3. Below about 1e-6 rays take their time
    double confidence; ///< of the intervals, in (0, 1); 0: 0.95
    uint64_t seed;     ///< another seed, other rays; the same seed the same bits, whatever the threads
    uint64_t max_rays; ///< for each body, at which it is left at the error reached, but for thickness; 24,576
                       ///< at least, with which it begins; 0: 100 million
    size_t max_bodies; ///< no more of them are looked at; 0: 65,536
    bool no_thickness; ///< saves the rays for it, which are all that exact bodies take
    bool sample_all;   ///< rays for everything, to check
    bool (*progress)(void *user, const sag_measure_progress *progress); ///< NULL, or asked now and then on
                                                                        ///< the calling thread; false: stop
    void *user;
} sag_measure_options;

/// What sag_measure found.
typedef struct sag_measurement {
    sag_body *bodies;
    size_t body_count;
    uint64_t omitted_count; ///< bodies beyond max_bodies; 2⁶³ − 1: or more
    uint64_t rays;
    const sag_context *context; ///< that the bodies' memory is of,
    size_t capacity;            ///< which has room for so many
} sag_measurement;

/// Measures every body of a committed scene, in order of their instance paths and ids, on all the context's
/// threads. The result does not depend on their number.
///
/// The error asked for is relative: of volume and area to themselves, of the centre to the body's radius of
/// gyration, of moments of inertia to the largest. A confidence interval holds the truth with the confidence
/// asked for as far as the rays have seen the body: something finer than 1e-4 of it may be missed altogether.
/// (Measured: tests/oracle/test_measure_coverage.c.) Closed forms are within 1e-13
/// (tests/unit/test_measure_shapes.c).
///
/// Memory of about 1 KiB a body, and while a mesh is examined 40 bytes a triangle. SAG_ERROR_STATE before
/// the first commit, SAG_ERROR_ARGUMENT for options out of range, SAG_ERROR_MEMORY, SAG_ERROR_CANCELLED;
/// *measurement is written on SAG_OK only. Thread-safe.
SAG_API sag_status sag_measure(const sag_scene *scene, const sag_measure_options *options,
                               sag_measurement *measurement, sag_error *error);

/// Frees the bodies and zeroes the struct. NULL does nothing.
SAG_API void sag_measurement_clear(sag_measurement *measurement);

#ifdef __cplusplus
}
#endif
#endif
