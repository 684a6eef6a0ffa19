// SPDX-License-Identifier: MIT
// Lights prepared for rendering: one is chosen by its power, a direction to it is drawn, and the density of
// both is known for directions that were found in another way.
#ifndef SAGI_RENDER_LIGHT_H
#define SAGI_RENDER_LIGHT_H

#include "area.h"
#include "distribution.h"

// A light that is not a geometry.
typedef struct sagi_light {
    sag_light light;
    sagi_color color, horizon; // the light's, made ready
    double brightness;         // of the color
    sag_vec3 axis;             // unit; spot: where it looks, distant: where its light comes from
    double cos_cone, cos_full; // spot: of the half angles where light ends and where it is full
    bool chosen;               // it is at infinity, and not black
    bool placed;               // infinite with a picture: from_world and to_world matter
    sag_affine from_world;     // the inverse of to_world
    sagi_alias texels;         // infinite with a picture: by brightness
} sagi_light;

// Whether it is at infinity.
static inline bool sagi_light_is_far(const sagi_light *light) {
    switch (light->light.kind) {
    case SAG_LIGHT_POINT:
    case SAG_LIGHT_SPOT: return false;
    case SAG_LIGHT_DISTANT:
    case SAG_LIGHT_INFINITE:
    case SAG_LIGHT_SKY: break;
    }
    return true;
}

typedef struct sagi_lights {
    const sag_world *world;
    sag_strategy strategy;
    sag_light_sampler sampler;
    sagi_light *lights; // each of the world's, same order
    uint32_t light_count;
    sagi_areas areas; // numbered after the lights
    // To choose by the tree: lights at infinity alike, one share each and one for the tree.
    sagi_light_tree tree;
    uint32_t *far;
    uint32_t far_count;
    sagi_alias choice; // else: of the lights, then the areas
} sagi_lights;

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
// Chooses a light: its number, and the probability of it. *u in [0, 1) becomes a number to use again.
bool sagi_lights_choose(const sagi_lights *lights, const sagi_shading_point *from, double *u, uint32_t *index,
                        double *probability);
// The probability with which a light is chosen.
double sagi_lights_choice(const sagi_lights *lights, const sagi_shading_point *from, uint32_t index);
// The density with which sagi_lights_sample finds a point of a shining surface, per solid angle seen from
// `from`.
double sagi_lights_area_pdf(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 wi,
                            const sag_hit *hit, const sag_surface *surface);
// What a surface with this appearance sends to direction wo. The surface is oriented (sagi_orient).
sagi_spectrum sagi_emission(const sagi_appearance *appearance, const sag_surface *surface, sag_vec3 wo,
                            sagi_spectrum lambda);

// The weights of what was found by sampling the surface, and by sampling the lights, under the strategy in
// use.
double sagi_surface_weight(const sagi_lights *lights, double surface_pdf, double light_pdf);
double sagi_light_weight(const sagi_lights *lights, double surface_pdf, const sagi_light_sample *sample);

// Radiance of an infinite or sky light, and its density; sky.c.
sagi_spectrum sagi_sky_radiance(const sagi_light *light, sag_vec3 wi, sagi_spectrum lambda);
double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi);
bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u, sag_vec3 *wi);
sag_status sagi_sky_init(sagi_light *light, const sag_context *context, sag_error *error);

#endif
