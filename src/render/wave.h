// SPDX-License-Identifier: MIT
// Many samples followed at once, so that their rays are traced in batches.
#ifndef SAGI_RENDER_WAVE_H
#define SAGI_RENDER_WAVE_H

#include "film.h"
#include "layers.h"
#include "light.h"
#include "sampler.h"

#include <time.h>

// How many paths a wave has at most: enough that the last few, which trace in small batches, do not matter;
// few enough that all that belongs to them (about half a kilobyte each) stays in a core's own cache.
#define SAGI_WAVE_SIZE 1024u

// Some of the pixels there are sums of, [x0, x1) × [y0, y1), and which of their samples are to be taken.
typedef struct sagi_tile {
    uint32_t x0, y0, x1, y1;
    uint32_t first, end;
} sagi_tile;

// One sample under way: a path from the camera, and the light it has brought so far.
typedef struct sagi_path {
    sagi_sampler sampler;
    sagi_pixel *pixel;   // where the sample belongs
    double pixel_weight; // with which
    sagi_wavelengths wavelengths;
    union {
        struct {
            sagi_spectrum radiance, weight;
        };
        sag_rgb shown; // by the integrators that show something
    };
    sagi_shading_point from; // the last surface that scattered
    double surface_pdf;      // with which it chose this ray; from a lamp: how far the light's window is
    double eta2;             // product of the η² crossed
    double distance;         // along this ray, in its directions, up to where it is now
    uint32_t passed;         // surfaces on this ray that are not there
    uint32_t depth;          // bounces so far
    uint32_t medium;         // around the ray's origin; 0: vacuum, or media are not looked at
    bool exact;              // no surface, a mirror or glass chose this ray: light is counted in full
    bool scattered;          // the path has met a surface that is no mirror or glass
    bool dispersed;          // only the first wavelength is left
} sagi_path;

static inline double sagi_clock_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// What a ray has met: the nearest surface that is really there, its normals turned to the front.
typedef struct sagi_meeting {
    const sag_hit *hit;
    const sagi_appearance *appearance; // NULL: the default
    sag_surface surface;
    sagi_bsdf bsdf;
} sagi_meeting;

// Light on its way to a path: it arrives unless something is in the way.
typedef struct sagi_shadow {
    sagi_path *path;
    sagi_spectrum light; // weighted
    uint32_t medium;     // around the shadow ray's origin
} sagi_shadow;

// A sample that is no more than the hit of its ray.
typedef struct sagi_glance {
    sagi_pixel *pixel;
    double pixel_weight;
    uint32_t sample;
} sagi_glance;

// The samples one thread follows together; arrays have room for SAGI_WAVE_SIZE. On cache lines of its own, as
// other threads' waves lie beside it.
typedef struct sagi_wave {
    _Alignas(64) sag_render *render;
    sagi_path *paths; // in the order they were started
    uint32_t path_count;
    // The paths that go on, each with its ray and, once traced, what it hit.
    uint32_t active_count;
    sagi_path **active;
    sag_ray *rays;
    sag_hit *hits;
    // The shadow rays of this step.
    uint32_t shadow_count;
    sagi_shadow *shadows;
    sag_ray *shadow_rays;
    bool *occluded;
    sagi_light_sample *samples; // what the shadow rays go to; only where they may have to go on, else NULL
    sag_vec2 *places;           // on the film, of the shadow rays of light from the lamps; else NULL
    sagi_first *firsts;         // what each path met first; NULL when no layer asks for it
    sagi_glance *glances;       // samples that are no paths (glance.c)
    uint64_t rays_traced;
    double traversal_seconds; // within the scene's queries
    uint64_t hits_seen;       // to time textures at one of SAGI_TIMED_HITS
    double texture_seconds;   // about, texture_time.c
} sagi_wave;

// False when memory is short; clear it then too. `wave` is zeroed.
bool sagi_wave_init(sagi_wave *wave, sag_render *render);
void sagi_wave_clear(sagi_wave *wave, const sag_context *context);
// Starts samples number first … end − 1 of the pixel at (x, y). The wave has room for them.
void sagi_wave_start(sagi_wave *wave, sagi_pixel *pixel, uint32_t x, uint32_t y, uint32_t first,
                     uint32_t end);
// Follows all paths to their ends: then paths[0 … path_count) have their radiance.
void sagi_wave_follow(sagi_wave *wave);
// Adds light to a path if the sampled light is seen from the surface: at once, or before the path's next
// step. The shadow ray begins in the path's medium, or in `medium`.
void sagi_wave_add_light(sagi_wave *wave, sagi_path *path, const sag_surface *from, uint32_t medium,
                         const sagi_light_sample *sample, sagi_spectrum light);

// The scene's batch query, counted and timed.
void sagi_wave_intersect(sagi_wave *wave, const sag_ray *rays, uint32_t count);

// One of so many hits is looked at for how long its textures take.
#define SAGI_TIMED_HITS 64u
void sagi_time_textures(sagi_wave *wave, const sagi_path *path, const sag_ray *ray, const sag_hit *hit);

// Whether samples are no more than the hits of the camera's rays; takes those of a tile and adds them to
// their pixels (glance.c).
bool sagi_can_glance(const sag_render *render);
void sagi_glance_tile(sag_render *render, sagi_wave *wave, const sagi_tile *tile);
// A bright colour of the hit's ids.
sag_rgb sagi_id_color(const sag_hit *hit);

// How many surfaces that are not there a ray passes before it is given up: a bound, not a setting.
#define SAGI_MAX_PASSED 10000u

// What a ray comes to.
typedef enum sagi_course {
    SAGI_COURSE_AWAY,    // it meets nothing
    SAGI_COURSE_MEETING, // a surface
    SAGI_COURSE_ON,      // what it hit is not there: the ray goes on behind
} sagi_course;

// What it comes to where it has met a surface, which may not be there: then moves *ray on.
sagi_course sagi_trace_through(const sag_render *render, sagi_path *path, sag_ray *ray,
                               const sagi_meeting *meeting);
// What a medium does to a path on its way to the next surface.
typedef enum sagi_passage {
    SAGI_PASSAGE_THROUGH,   // the path comes to the surface
    SAGI_PASSAGE_SCATTERED, // it goes on from a particle with what is then in *ray
    SAGI_PASSAGE_END,
} sagi_passage;

// volume.c: what is in the way of a path's ray up to its hit (t in its directions, which are unit), and of a
// shadow ray (NULL: all along).
sagi_passage sagi_volume_step(sagi_wave *wave, sagi_path *path, sag_ray *ray, const sag_hit *hit);
void sagi_volume_dim(const sag_render *render, sagi_shadow *shadow, const sag_ray *ray, const sag_hit *hit);
// Russian roulette: whether the path goes on.
bool sagi_path_survives(sagi_path *path);

// The ray that light of this sample takes to the surface, backwards.
void sagi_shadow_ray(const sag_surface *from, const sagi_light_sample *sample, sag_ray *ray);
// What this ray comes to at its hit; moves *ray on, and *medium with it.
sagi_course sagi_trace_shadow(const sag_render *render, const sagi_light_sample *sample, sag_ray *ray,
                              const sag_hit *hit, uint32_t *medium);

// The integrators. What happens where a path's ray has met something (NULL: nothing): true when it scatters
// there, which sagi_path_scatter does for several.
bool sagi_path_arrive(sagi_wave *wave, sagi_path *path, sagi_meeting *meeting, const sag_ray *ray);
typedef struct sagi_visit {
    sagi_path *path;
    sag_ray *ray; // that met the surface; that goes on
    sagi_meeting meeting;
    sagi_light_sample light;
    sag_vec2 u;    // its point
    uint32_t lamp; // its number
    bool lit;      // there is any
    bool goes_on;  // the path does, with what is in *ray
} sagi_visit;
void sagi_path_scatter(sagi_wave *wave, sagi_visit *const visits[], uint32_t count);
// Light that is followed from the lamps (particle.c): its radiance is what left the lamp. What happens where
// its ray has met something; true when it goes on with what is then in *ray. And how it starts; false where
// it ends at once.
bool sagi_particle_step(sagi_wave *wave, sagi_path *path, sagi_meeting *meeting, sag_ray *ray);
bool sagi_particle_start(sagi_wave *wave, sagi_path *path, sag_ray *ray);
// The same for those that show what the camera's ray met: they end there.
void sagi_show(sagi_wave *wave, sagi_path *path, const sagi_meeting *meeting);

#endif
