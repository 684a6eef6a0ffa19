// SPDX-License-Identifier: MIT
/// @file settings.h
/// Settings: everything about how to look at a world. Camera, film, the source of random numbers and the
/// algorithm that follows light.
#ifndef SAGITTA_RENDER_SETTINGS_H
#define SAGITTA_RENDER_SETTINGS_H

#include <sagitta/render/camera.h>
#include <sagitta/render/film.h>

/// Where the random numbers come from. Each number is a pure function of seed, pixel, sample and dimension.
/// Test: tests/render/test_sampler.c.
typedef enum sag_sampler_kind {
    SAG_SAMPLER_INDEPENDENT, ///< uniform, unrelated
    SAG_SAMPLER_STRATIFIED,  ///< one in each of samples_per_pixel strata, in every dimension (pair)
    SAG_SAMPLER_SOBOL, ///< Sobol’ points, each number of its own dimension (the first 32; then as ZSOBOL)
    SAG_SAMPLER_PADDED_SOBOL, ///< Sobol’ points in every dimension pair, of each pixel by itself (Burley,
                              ///< JCGT 9(4), 2020)
    SAG_SAMPLER_ZSOBOL, ///< the same, neighbouring pixels sharing out a net, so that noise is blue: what one
                        ///< has too much of the next has too little (Ahmed & Wonka 2020)
    SAG_SAMPLER_HALTON, ///< Halton’s sequence over 128×128 pixels
} sag_sampler_kind;

/// How low-discrepancy points are made random.
typedef enum sag_randomization {
    SAG_RANDOMIZATION_DEFAULT,        ///< fast Owen; Halton: permuted digits
    SAG_RANDOMIZATION_NONE,           ///< not at all (but for the order in which samples take them)
    SAG_RANDOMIZATION_PERMUTE_DIGITS, ///< digit by digit, for all points alike
    SAG_RANDOMIZATION_FAST_OWEN,      ///< nested, by Laine and Karras’ hash; not for Halton
    SAG_RANDOMIZATION_OWEN,           ///< nested, by a better and slower hash
} sag_randomization;

typedef enum sag_integrator_kind {
    SAG_INTEGRATOR_PATH,   ///< all light paths: next-event estimation, multiple importance sampling, Russian
                           ///< roulette
    SAG_INTEGRATOR_DIRECT, ///< light that bounces once, mirrors and glass followed
    SAG_INTEGRATOR_AO, ///< ambient occlusion: the share of the cosine-weighted hemisphere over the surface
                       ///< (its true normal's) in which nothing is within occlusion_distance; 0 where nothing
                       ///< is hit
    SAG_INTEGRATOR_NORMAL,    ///< (n + 1)/2 of the shading normal, turned to the camera
    SAG_INTEGRATOR_UV,        ///< texture coordinates (u, v, 0), wrapped to [0, 1]
    SAG_INTEGRATOR_DEPTH,     ///< distance from the camera's origin; 0 where nothing is hit
    SAG_INTEGRATOR_ID,        ///< a colour for each geometry (and instance)
    SAG_INTEGRATOR_ALBEDO,    ///< reflectance
    SAG_INTEGRATOR_VOLPATH,   ///< as path, through media
    SAG_INTEGRATOR_LIGHTPATH, ///< light followed from the lamps to what the camera sees: good caustics, but
                              ///< nothing in mirrors and through smooth glass, no background and no layers.
                              ///< Its lamps are chosen by power, its sums are exact: the same bits however
                              ///< many threads there are. Test: tests/render/test_particle.c
} sag_integrator_kind;

/// How the path tracer finds the light that reaches a surface. All three have the same mean; for comparison.
typedef enum sag_strategy {
    SAG_STRATEGY_MIS,      ///< lights and surfaces sampled, weighted by the power heuristic (Veach 1995)
    SAG_STRATEGY_LIGHTS,   ///< lights sampled; surfaces only for mirrors and glass
    SAG_STRATEGY_SURFACES, ///< surfaces sampled; point, spot and distant lights, which no ray finds, sampled
} sag_strategy;

/// How one of the lights is chosen at a surface. All have the same mean.
typedef enum sag_light_sampler {
    SAG_LIGHT_SAMPLER_BVH,   ///< by a tree of lights: what each may send there (Conty Estévez & Kulla 2018)
    SAG_LIGHT_SAMPLER_POWER, ///< by its power
    SAG_LIGHT_SAMPLER_UNIFORM, ///< all alike
} sag_light_sampler;

/// Everything about how to look: what a scene file says above WorldBegin. sag_world_create fills the
/// defaults: 1280×720, box filter, independent sampler, 16 samples, path, depth 5.
typedef struct sag_settings {
    sag_camera camera;
    sag_film film;
    sag_sampler_kind sampler;
    sag_randomization randomization;
    uint32_t samples_per_pixel;  ///< 1 … 2³¹
    uint32_t strata_x, strata_y; ///< stratified: the strata of a pair, where their product is
                                 ///< samples_per_pixel; else the most nearly square grid
    bool no_jitter;              ///< stratified: in the middle of each stratum
    uint64_t seed;
    sag_integrator_kind integrator;
    uint32_t max_depth;    ///< bounces; 0: only what shines by itself
    bool regularize;       ///< roughen what a path meets after its first rough surface (pbrt's): less sharp
                           ///< caustics for far less noise. Off by default
    sag_strategy strategy; ///< path and direct only
    sag_light_sampler light_sampler; ///< path and direct only
    double occlusion_distance;       ///< ambient occlusion only; 0: any distance
    bool occlusion_uniform; ///< its directions are uniform and weighted by the cosine, for comparison
    uint32_t camera_medium; ///< the medium the camera stands in; 0: vacuum
} sag_settings;

#endif
