// SPDX-License-Identifier: MIT
// Lights prepared for rendering: one is chosen by its power, a direction to it is drawn, and the density of
// both is known for directions that were found in another way.
#ifndef SAGI_RENDER_LIGHT_H
#define SAGI_RENDER_LIGHT_H

#include "area.h"
#include "distribution.h"
#include "portal.h"

// Light of a texel made ready: sagi_color, less what is the same for all of a picture.
typedef struct sagi_glow {
    float scale, c[3]; // c[2] infinite: as if s(λ) was 1
} sagi_glow;

// A light that is not a geometry.
typedef struct sagi_light {
    sag_light light;
    sagi_color color, horizon; // the light's, made ready
    double brightness;         // of the color
    sag_vec3 axis;             // unit; spot: where it looks, distant: where its light comes from
    double cos_cone, cos_full; // spot: of the half angles where light ends and where it is full
    bool chosen;               // it is at infinity, and not black
    bool stretched;            // a spot whose cone is round in its own space only
    sag_vec3 own_axis;         // unit, there
    sag_affine from_world;     // with a picture, or stretched: directions to its space
    sagi_window_table table;   // infinite with a picture: by brightness
    sagi_glow *texels;         // its light; NULL: made when it is wanted
    size_t texel_count;
    sagi_portal portal; // infinite with a portal; its picture, then, in place of light.image
    sag_vec2 screen;    // projection: half the picture's sizes at distance 1
    double mean;        // of the picture of a goniometric light or a projection
    double solid_angle; // that the mean is over
} sagi_light;

// Whether it is at infinity.
static inline bool sagi_light_is_far(const sagi_light *light) {
    switch (light->light.kind) {
    case SAG_LIGHT_POINT:
    case SAG_LIGHT_SPOT:
    case SAG_LIGHT_GONIOMETRIC:
    case SAG_LIGHT_PROJECTION: return false;
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
    sag_vec3 center; // of a ball that holds the scene
    double radius;
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
// The second half of that: of a light that is chosen, with sample->pdf the probability of the choice.
bool sagi_lights_sample_one(const sagi_lights *lights, uint32_t index, const sagi_shading_point *from,
                            sagi_spectrum lambda, sag_vec2 u, sagi_light_sample *sample);
// Radiance at `origin` from the unit direction wi where no surface is hit. `from` NULL: as it is (seen by the
// camera or through a mirror); else weighted, light by light, for a direction that the surface's sampling
// found with surface_pdf.
sagi_spectrum sagi_lights_far(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 origin,
                              sag_vec3 wi, sagi_spectrum lambda, double surface_pdf);
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

// Radiance of an infinite or sky light at `from`, and its density; both at once, the density only where
// `from` is given; and a direction drawn, with both. sky.c.
sagi_spectrum sagi_sky_radiance(const sagi_light *light, sag_vec3 from, sag_vec3 wi, sagi_spectrum lambda);
double sagi_sky_pdf(const sagi_light *light, const sagi_shading_point *from, sag_vec3 wi);
sagi_spectrum sagi_sky_look(const sagi_light *light, const sagi_shading_point *from, sag_vec3 origin,
                            sag_vec3 wi, sagi_spectrum lambda, double *pdf);
bool sagi_sky_sample(const sagi_light *light, const sagi_shading_point *from, sag_vec2 u,
                     sagi_spectrum lambda, sag_vec3 *wi, double *pdf, sagi_spectrum *radiance);
// `compensated`: what surfaces' sampling finds well enough is left to it.
sag_status sagi_sky_init(sagi_light *light, const sag_context *context, bool compensated, sag_error *error);
void sagi_sky_clear(sagi_light *light, const sag_context *context);

// A spot's share of its intensity in a unit direction away from it.
static inline double sagi_spot_falloff(const sagi_light *light, sag_vec3 away) {
    double x = light->stretched
                   ? sag_dot(sag_normalize(sag_affine_vector(&light->from_world, away)), light->own_axis)
                   : sag_dot(away, light->axis);
    if (!(x > light->cos_cone)) return 0;
    if (x >= light->cos_full) return 1;
    x = (x - light->cos_cone) / (light->cos_full - light->cos_cone);
    return x * x * (3 - 2 * x);
}

// Lights that shine from a point through a picture; beam.c.
sag_status sagi_beam_init(sagi_light *light, sag_error *error);
// Intensity in the unit direction `away` from the light.
sagi_spectrum sagi_beam_intensity(const sagi_light *light, sag_vec3 away, sagi_spectrum lambda);
// The light's color times a texel's: light of that colour or, where the light has a spectrum, a filter.
sagi_spectrum sagi_light_through(const sagi_light *light, sag_rgb texel, sagi_spectrum lambda);
// Makes from_world of to_world. SAG_ERROR_ARGUMENT for a singular one.
sag_status sagi_light_place(sagi_light *light, sag_error *error);
static inline sag_rgb sagi_picture_texel(const sag_image *image, size_t index) {
    const float *p = image->pixels + index * image->channels;
    return image->channels < 3 ? sagi_rgb_grey(p[0]) : sagi_rgb(p[0], p[1], p[2]);
}

#endif
