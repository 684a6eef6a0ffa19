// SPDX-License-Identifier: MIT
// Waves of paths (Laine, Karras & Aila, "Megakernels Considered Harmful", HPG 2013, on one core).
//
// A ray of a path cannot be traced before the one before it, so a thread that follows one path at a time
// waits for memory at each node. Rays of different paths are unrelated: traced as a batch, one's waiting is
// another's work. So a thread follows many paths step by step: all their rays as one batch; what each means
// for its path, one after the other (path.c), which leaves a new ray, a shadow ray, both or none; then all
// shadow rays as one batch. Paths that go on move up in the lists as they are written anew, so that these
// have no holes.
//
// The picture cannot depend on any of this. A path has its own random numbers and sums, nothing of them is
// touched in another order than if it were alone (light that a shadow ray lets through is added before the
// next step), and the pixels get their samples in the order these were started.
#include "shapes/spawn.h"
#include "start.h"
#include "trace.h"

bool sagi_wave_init(sagi_wave *wave, sag_render *render) {
    const sag_context *context = render->context;
    wave->render = render;
    wave->paths = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->paths);
    wave->active = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->active);
    wave->rays = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->rays);
    wave->hits = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->hits);
    wave->shadows = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->shadows);
    wave->shadow_rays = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->shadow_rays);
    wave->occluded = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->occluded);
    wave->glances = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->glances);
    const bool from_lamps = render->splats != NULL;
    if (from_lamps) wave->places = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->places);
    if (render->layers) wave->firsts = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->firsts);
    if (render->see_through) wave->samples = sag_allocate(context, SAGI_WAVE_SIZE * sizeof *wave->samples);
    return (wave->samples || !render->see_through) && (wave->firsts || !render->layers) &&
           (wave->places || !from_lamps) && wave->paths && wave->active && wave->rays && wave->glances &&
           wave->hits && wave->shadows && wave->shadow_rays && wave->occluded;
}

void sagi_wave_clear(sagi_wave *wave, const sag_context *context) {
    sag_release(context, wave->paths, SAGI_WAVE_SIZE * sizeof *wave->paths);
    sag_release(context, wave->active, SAGI_WAVE_SIZE * sizeof *wave->active);
    sag_release(context, wave->rays, SAGI_WAVE_SIZE * sizeof *wave->rays);
    sag_release(context, wave->hits, SAGI_WAVE_SIZE * sizeof *wave->hits);
    sag_release(context, wave->shadows, SAGI_WAVE_SIZE * sizeof *wave->shadows);
    sag_release(context, wave->shadow_rays, SAGI_WAVE_SIZE * sizeof *wave->shadow_rays);
    sag_release(context, wave->occluded, SAGI_WAVE_SIZE * sizeof *wave->occluded);
    sag_release(context, wave->glances, SAGI_WAVE_SIZE * sizeof *wave->glances);
    sag_release(context, wave->places, SAGI_WAVE_SIZE * sizeof *wave->places);
    sag_release(context, wave->firsts, SAGI_WAVE_SIZE * sizeof *wave->firsts);
    sag_release(context, wave->samples, SAGI_WAVE_SIZE * sizeof *wave->samples);
}

// A path before its first ray. Where it comes from is not set: no surface has scattered it.
static inline void begin(sagi_path *path, const sagi_sampler *sampler, sagi_pixel *pixel, uint32_t medium) {
    path->sampler = *sampler;
    path->pixel = pixel;
    path->radiance = (sagi_spectrum){0, 0, 0, 0};
    path->weight = (sagi_spectrum){1, 1, 1, 1};
    path->surface_pdf = path->distance = 0;
    path->eta2 = 1;
    path->passed = path->depth = 0;
    path->medium = medium;
    path->exact = true;
    path->scattered = path->dispersed = false;
}

void sagi_wave_start(sagi_wave *wave, sagi_pixel *pixel, uint32_t x, uint32_t y, uint32_t first,
                     uint32_t end) {
    const sag_render *render = wave->render;
    const bool spectral = sagi_is_spectral(render);
    const uint32_t medium = render->has_media ? render->settings.camera_medium : 0;
    sagi_sampler sampler = render->sampler;
    sagi_sampler_start_pixel(&sampler, x, y);
    for (uint32_t sample = first; sample < end; sample++) {
        sagi_path *path = &wave->paths[wave->path_count++];
        begin(path, &sampler, pixel, medium);
        if (wave->firsts) wave->firsts[wave->path_count - 1] = (sagi_first){0};
        wave->active[wave->active_count] = path;
        if (wave->places) {
            sagi_sampler_start_sample(&path->sampler, sample);
            path->wavelengths =
                sagi_wavelengths_sample(&render->wavelengths, sagi_sampler_1d(&path->sampler));
            wave->active_count += sagi_particle_start(wave, path, &wave->rays[wave->active_count]);
            continue;
        }
        path->pixel_weight =
            sagi_camera_sample(render, &path->sampler, x, y, sample, &wave->rays[wave->active_count++]);
        if (spectral)
            path->wavelengths =
                sagi_wavelengths_sample(&render->wavelengths, sagi_sampler_1d(&path->sampler));
        else
            path->wavelengths.lambda = sagi_spectrum_all(560);
    }
}

void sagi_wave_add_light(sagi_wave *wave, sagi_path *path, const sag_surface *from, uint32_t medium,
                         const sagi_light_sample *sample, sagi_spectrum light) {
    light *= path->weight;
    if (wave->samples) wave->samples[wave->shadow_count] = *sample;
    wave->shadows[wave->shadow_count] = (sagi_shadow){.path = path, .light = light, .medium = medium};
    sagi_shadow_ray(from, sample, &wave->shadow_rays[wave->shadow_count++]);
}

// How many paths go through the stages of a step together: enough that the processor always finds work in
// another one; what belongs to them, a kilobyte each, stays in its nearest memory.
#define TOGETHER 8

// One step of one path, whose ray has hit or missed. True when the path is at a surface that scatters it;
// else it is known whether it goes on.
static bool step(sagi_wave *wave, sagi_visit *visit, const sag_hit *hit) {
    sagi_path *path = visit->path;
    visit->goes_on = false;
    if (path->medium != 0) {
        const sagi_passage passage = sagi_volume_step(wave, path, visit->ray, hit);
        visit->goes_on = passage == SAGI_PASSAGE_SCATTERED;
        if (passage != SAGI_PASSAGE_THROUGH) return false;
    }
    const sagi_course course = sagi_trace(wave->render, path, visit->ray, hit, &visit->meeting);
    visit->goes_on = course == SAGI_COURSE_ON;
    if (visit->goes_on) return false;
    sagi_meeting *met = course == SAGI_COURSE_MEETING ? &visit->meeting : NULL;
    if (wave->firsts && met && path->depth == 0 && !wave->places)
        sagi_layers_note(wave->render, path, visit->ray, met, &wave->firsts[path - wave->paths]);
    switch (wave->render->settings.integrator) {
    case SAG_INTEGRATOR_PATH:
    case SAG_INTEGRATOR_DIRECT:
    case SAG_INTEGRATOR_VOLPATH: return sagi_path_arrive(wave, path, met, visit->ray);
    case SAG_INTEGRATOR_LIGHTPATH:
        visit->goes_on = sagi_particle_step(wave, path, met, visit->ray);
        path->passed = 0;
        return false;
    case SAG_INTEGRATOR_AO:
    case SAG_INTEGRATOR_NORMAL:
    case SAG_INTEGRATOR_UV:
    case SAG_INTEGRATOR_DEPTH:
    case SAG_INTEGRATOR_ID:
    case SAG_INTEGRATOR_ALBEDO: break;
    }
    sagi_show(wave, path, met);
    return false;
}

void sagi_wave_intersect(sagi_wave *wave, const sag_ray *rays, uint32_t count) {
    const double start = sagi_clock_seconds();
    sag_intersect_batch(wave->render->scene, rays, wave->hits, count);
    wave->traversal_seconds += sagi_clock_seconds() - start;
    wave->rays_traced += count;
}

// All paths' next step.
static void step_all(sagi_wave *wave) {
    sagi_wave_intersect(wave, wave->rays, wave->active_count);
    uint32_t kept = 0;
    const bool textured = wave->render->world->textures.count + wave->render->world->pictures.count > 0;
    sagi_visit visits[TOGETHER], *scattered[TOGETHER];
    for (uint32_t first = 0, end; first < wave->active_count; first = end) {
        end = wave->active_count - first < TOGETHER ? wave->active_count : first + TOGETHER;
        uint32_t count = 0;
        for (uint32_t i = first; i < end; i++) {
            sagi_visit *visit = &visits[i - first];
            visit->path = wave->active[i], visit->ray = &wave->rays[i];
            if (textured && wave->hits_seen++ % SAGI_TIMED_HITS == 0)
                sagi_time_textures(wave, visit->path, visit->ray, &wave->hits[i]);
            if (step(wave, visit, &wave->hits[i])) scattered[count++] = visit;
        }
        sagi_path_scatter(wave, scattered, count);
        for (uint32_t i = first; i < end; i++) {
            if (!visits[i - first].goes_on) continue;
            wave->active[kept] = visits[i - first].path;
            if (kept != i) sagi_ray_copy(&wave->rays[kept], &wave->rays[i]);
            kept++;
        }
    }
    wave->active_count = kept;
}

static void add_light(const sagi_wave *wave, uint32_t i) {
    const sagi_shadow *shadow = &wave->shadows[i];
    if (wave->places)
        sagi_splat_add(wave->render, shadow->path, wave->places[i], shadow->light);
    else
        shadow->path->radiance += shadow->light;
}

// The light of this step, where nothing is in its way. (A medium all along the way ends at no surface.)
static void add_lights(sagi_wave *wave) {
    const double start = sagi_clock_seconds();
    sag_occluded_batch(wave->render->scene, wave->shadow_rays, wave->occluded, wave->shadow_count);
    wave->traversal_seconds += sagi_clock_seconds() - start;
    wave->rays_traced += wave->shadow_count;
    for (uint32_t i = 0; i < wave->shadow_count; i++) {
        if (wave->occluded[i]) continue;
        sagi_shadow *shadow = &wave->shadows[i];
        if (shadow->medium != 0) sagi_volume_dim(wave->render, shadow, &wave->shadow_rays[i], NULL);
        add_light(wave, i);
    }
    wave->shadow_count = 0;
}

// The same where shadow rays may have to go on: each round brings them to the next surface.
static void add_lights_through(sagi_wave *wave) {
    for (uint32_t round = 0; round < SAGI_MAX_PASSED && wave->shadow_count > 0; round++) {
        sagi_wave_intersect(wave, wave->shadow_rays, wave->shadow_count);
        uint32_t kept = 0;
        for (uint32_t i = 0; i < wave->shadow_count; i++) {
            sag_ray ray = wave->shadow_rays[i];
            sagi_shadow *shadow = &wave->shadows[i];
            if (shadow->medium != 0) sagi_volume_dim(wave->render, shadow, &ray, &wave->hits[i]);
            const sagi_course course =
                sagi_trace_shadow(wave->render, &wave->samples[i], &ray, &wave->hits[i], &shadow->medium);
            if (course == SAGI_COURSE_AWAY) add_light(wave, i);
            if (course != SAGI_COURSE_ON) continue;
            if (kept != i) wave->samples[kept] = wave->samples[i], wave->shadows[kept] = wave->shadows[i];
            if (wave->places) wave->places[kept] = wave->places[i];
            wave->shadow_rays[kept++] = ray;
        }
        wave->shadow_count = kept;
    }
    wave->shadow_count = 0; // given up
}

static void add_waiting_lights(sagi_wave *wave) {
    if (wave->shadow_count == 0) return;
    if (wave->render->see_through)
        add_lights_through(wave);
    else
        add_lights(wave);
}

void sagi_wave_follow(sagi_wave *wave) {
    add_waiting_lights(wave); // of lamps that are seen themselves
    while (wave->active_count > 0) {
        step_all(wave);
        add_waiting_lights(wave);
    }
}
