// SPDX-License-Identifier: MIT
// Lights prepared for rendering: one is chosen by its power, a direction to it is drawn, and the density of
// both is known for directions that were found in another way.
#ifndef SAGI_RENDER_LIGHT_H
#define SAGI_RENDER_LIGHT_H

#include "distribution.h"
#include "world.h"

// A light that is not a geometry.
typedef struct sagi_light {
    sag_light light;
    sagi_color color, horizon; // the light's, made ready
    double brightness;         // of the color
    sag_vec3 axis;             // unit; spot: where it looks, distant: where its light comes from
    double cos_cone, cos_full; // spot: of the half angles where light ends and where it is full
    bool placed;               // infinite with a picture: from_world and to_world matter
    sag_affine from_world;     // the inverse of to_world
    sagi_alias texels;         // infinite with a picture: by brightness
} sagi_light;

// The primitives of one shining geometry: area lights [first, first + count) of sagi_lights.
typedef struct sagi_area_group {
    const sag_scene *scene;
    uint32_t appearance; // index
    uint32_t geometry;
    uint32_t first, count;
    bool flat; // uniform density 1/area on each primitive
} sagi_area_group;

typedef struct sagi_area_light {
    uint32_t group, primitive;
    double density; // flat: 1/area; 0: cannot be sampled
    double radius;  // > 0: a whole ball, sampled by the cone it fills; see ball.c
    sag_vec3 center;
} sagi_area_light;

typedef struct sagi_lights {
    const sag_world *world;
    sag_strategy strategy;
    sagi_light *lights; // each of the world's, same order
    uint32_t light_count;
    sagi_area_group *groups;
    uint32_t group_count;
    sagi_area_light *areas;
    uint32_t area_count;
    uint32_t *group_of; // by appearance index: its group, or SAG_INVALID_ID
    uint32_t appearance_count;
    sagi_alias choice; // of the lights, then the areas
} sagi_lights;

// What lights know of the point they shine on.
typedef struct sagi_shading_point {
    sag_vec3 position;
    sag_vec3 normal;    // on the side the path came from
    bool reflects_only; // light from behind the normal is of no use
} sagi_shading_point;

typedef enum sagi_light_target { SAGI_TARGET_FAR, SAGI_TARGET_POINT, SAGI_TARGET_SURFACE } sagi_light_target;

typedef struct sagi_light_sample {
    sag_vec3 wi;            // unit, towards the light
    sagi_spectrum radiance; // arriving if nothing is in the way; intensity/distance² for points
    double pdf;             // of the choice and, unless delta, per solid angle of wi
    bool delta;             // no ray finds this light
    sagi_light_target target;
    sag_vec3 point;      // SAGI_TARGET_POINT
    sag_surface surface; // SAGI_TARGET_SURFACE
} sagi_light_sample;

// SAG_ERROR_MEMORY, or SAG_ERROR_ARGUMENT for a light with numbers that cannot be. The scene is committed.
sag_status sagi_lights_init(sagi_lights *lights, const sag_world *world, sag_error *error);
void sagi_lights_clear(sagi_lights *lights);

// Draws a light and a direction. False when it gives nothing.
bool sagi_lights_sample(const sagi_lights *lights, const sagi_shading_point *from, sagi_spectrum lambda,
                        double choose, sag_vec2 u, sagi_light_sample *sample);
// Radiance from the unit direction wi where no surface is hit. `from` NULL: as it is (seen by the camera or
// through a mirror); else weighted, light by light, for a direction that the surface's sampling found with
// surface_pdf.
sagi_spectrum sagi_lights_far(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 wi,
                              sagi_spectrum lambda, double surface_pdf);
// The density with which sagi_lights_sample finds a point of a shining surface, per solid angle seen from
// `from`.
double sagi_lights_area_pdf(const sagi_lights *lights, sag_vec3 from, sag_vec3 wi, const sag_hit *hit,
                            const sag_surface *surface);
// What a surface with this appearance sends to direction wo. The surface is oriented (sagi_orient).
sagi_spectrum sagi_emission(const sagi_appearance *appearance, const sag_surface *surface, sag_vec3 wo,
                            sagi_spectrum lambda);

// The weights of what was found by sampling the surface, and by sampling the lights, under the strategy in
// use.
double sagi_surface_weight(const sagi_lights *lights, double surface_pdf, double light_pdf);
double sagi_light_weight(const sagi_lights *lights, double surface_pdf, const sagi_light_sample *sample);

// Lights that are balls, seen from outside; ball.c. cone: 1 − cos of the half angle, 0 when `from` is not
// outside.
double sagi_ball_cone(const sagi_area_light *ball, sag_vec3 from);
void sagi_ball_sample(const sagi_area_light *ball, sag_vec3 from, double cone, sag_vec2 u,
                      sag_surface *surface);
// Whether this primitive of a geometry is a whole ball in the scene's space, and which.
bool sagi_ball_find(const sag_scene *scene, uint32_t geometry, uint32_t primitive, sag_vec3 *center,
                    double *radius);

// Radiance of an infinite or sky light, and its density; sky.c.
sagi_spectrum sagi_sky_radiance(const sagi_light *light, sag_vec3 wi, sagi_spectrum lambda);
double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi);
bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u, sag_vec3 *wi);
sag_status sagi_sky_init(sagi_light *light, const sag_context *context, sag_error *error);

#endif
