// SPDX-License-Identifier: MIT
// The render job: tiles of pixels, sampled in passes that double in length, on all threads. Each thread takes
// tile after tile and follows their samples a wave at a time (wave.c).
//
// A tile is the unit of work and of resumption: it notes how many samples each of its pixels has, and takes
// the next ones up to the pass's end. A cancelled pass leaves some tiles behind; the next run brings them up
// first. A pixel's samples are summed in order by one thread at a time, and each is a pure function of (seed,
// pixel, index): the sums do not depend on threads, cancellations or resumptions.
#include "job.h"

#include <string.h>

#define REPORT_SECONDS 0.1
#define LONGEST_PASS   32u // samples per pixel

// Whether rays may have to pass some surface; see sagi_trace.
static bool sees_through(const sag_world *world) {
    const sagi_appearance *appearances = world->appearances.items;
    const sagi_material *materials = world->materials.items;
    for (size_t i = 0; i < world->appearances.count; i++)
        if (appearances[i].look.alpha.texture != 0) return true;
    for (size_t i = 0; i < world->materials.count; i++)
        if (materials[i].material.kind == SAG_MATERIAL_INTERFACE) return true;
    return false;
}

// Which meshes of scene files take their texture coordinates from their corners, which have normals.
static void find_meshes(sag_world *world) {
    sagi_appearance *appearances = world->appearances.items;
    for (size_t i = 0; i < world->appearances.count; i++) {
        sagi_appearance *a = &appearances[i];
        sag_shape_kind kind;
        const void *shape = NULL;
        const bool is_mesh = a->look.square_uv &&
                             sag_geometry_get(a->scene, a->geometry, &kind, &shape) == SAG_OK &&
                             kind == SAG_SHAPE_MESH;
        a->square_uv = is_mesh && !((const sag_mesh *)shape)->texcoords_f32;
        a->smooth_mesh = is_mesh && ((const sag_mesh *)shape)->normals_f32;
    }
}

// A wave for each thread, but no more than there are tiles.
static sag_status make_waves(sag_render *render, sag_error *error) {
    size_t tile_count = (size_t)render->tiles_x * render->tiles_y;
    uint32_t count = sag_context_thread_count(render->context);
    if (count > tile_count) count = (uint32_t)tile_count;
    render->wave_size = SAGI_WAVE_SIZE;
    render->waves = sag_allocate(render->context, count * sizeof *render->waves);
    bool made = render->waves != NULL;
    if (made) memset(render->waves, 0, count * sizeof *render->waves), render->wave_count = count;
    for (uint32_t i = 0; i < count && made; i++) made = sagi_wave_init(&render->waves[i], render);
    return made ? SAG_OK
                : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for %u threads' paths", count);
}

static sag_status prepare(sag_render *render, sag_error *error) {
    sag_world *world = render->world;
    double start = sagi_clock_seconds();
    sag_status status = sag_scene_commit(world->scene, error);
    if (status != SAG_OK) return status;
    render->scene = world->scene;
    render->has_media = render->settings.integrator == SAG_INTEGRATOR_VOLPATH && world->media.count > 0;
    render->see_through = sees_through(world);
    find_meshes(world);
    sagi_world_solve_colors(world);
    status = sagi_lights_init(&render->lights, world, error);
    if (status != SAG_OK) return status;
    render->build_seconds = sagi_clock_seconds() - start;
    if (sagi_is_spectral(render) && render->lights.light_count == 0 && !sagi_world_shines(world))
        sag_context_log(world->context, SAG_LOG_WARNING,
                        "there is no light in the scene: the picture is black");

    const sag_film *film = &render->settings.film;
    status = sagi_camera_init(&render->camera, &render->settings.camera, film->width, film->height, error);
    if (status == SAG_OK)
        sagi_footprint_init(&render->footprint, &render->camera, render->settings.samples_per_pixel);
    if (status == SAG_OK) status = sagi_sensor_init(&render->sensor, film, error);
    sagi_bounds bounds = {0};
    if (status == SAG_OK) status = sagi_film_bounds(film, &bounds, error);
    if (status == SAG_OK && !(film->max_component >= 0))
        status = sag_error_set(error, SAG_ERROR_ARGUMENT, "max_component %g", film->max_component);
    if (status == SAG_OK) status = sagi_filter_init(&render->filter, film, error);
    if (status == SAG_OK) status = sagi_sampler_plan_init(&render->sampler_plan, &render->settings, error);
    if (status != SAG_OK) return status;
    render->sampler.plan = &render->sampler_plan;
    sagi_wavelength_table_init(&render->wavelengths);
    // Distances are no fireflies.
    const bool dims = film->max_component > 0 && render->settings.integrator != SAG_INTEGRATOR_DEPTH;
    render->max_component = dims ? film->max_component : INFINITY;
    render->first_x = bounds.x, render->first_y = bounds.y;
    render->width = bounds.width, render->height = bounds.height;
    render->tiles_x = (render->width + SAGI_TILE_SIZE - 1) / SAGI_TILE_SIZE;
    render->tiles_y = (render->height + SAGI_TILE_SIZE - 1) / SAGI_TILE_SIZE;
    size_t pixel_bytes = (size_t)render->width * render->height * sizeof *render->pixels;
    size_t tile_bytes = (size_t)render->tiles_x * render->tiles_y * sizeof *render->tile_done;
    render->pixels = sag_allocate(render->context, pixel_bytes);
    render->tile_done = sag_allocate(render->context, tile_bytes);
    const bool layered = (film->layers & ~(uint32_t)SAG_LAYER_PICTURE) != 0;
    const size_t layer_bytes = (size_t)render->width * render->height * sizeof *render->layers;
    const bool from_lamps = render->settings.integrator == SAG_INTEGRATOR_LIGHTPATH;
    const size_t splat_bytes = (size_t)render->width * render->height * sizeof *render->splats;
    if (from_lamps) render->splats = sag_allocate(render->context, splat_bytes);
    if (layered) render->layers = sag_allocate(render->context, layer_bytes);
    if (!render->pixels || !render->tile_done || (layered && !render->layers) ||
        (from_lamps && !render->splats))
        return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a picture of %u x %u pixels",
                             (unsigned)render->width, (unsigned)render->height);
    memset(render->pixels, 0, pixel_bytes);
    if (from_lamps) memset(render->splats, 0, splat_bytes);
    if (layered) memset(render->layers, 0, layer_bytes);
    memset(render->tile_done, 0, tile_bytes);
    return make_waves(render, error);
}

sag_render *sag_render_create(sag_world *world, sag_error *error) {
    sag_context *context = world->context;
    sag_render *render = sag_allocate(context, sizeof *render);
    if (!render) {
        sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
        return NULL;
    }
    memset(render, 0, sizeof *render);
    render->world = world;
    render->context = context;
    render->settings = world->settings;
    atomic_init(&render->rays, 0);
    atomic_init(&render->camera_samples, 0);
    atomic_init(&render->bad_samples, 0);
    for (int i = 0; i < SAG_BAD_SAMPLES; i++) atomic_init(&render->first_bad[i], UINT64_MAX);
    atomic_init(&render->cancelled, false);
    atomic_init(&render->next_tile, 0);
    atomic_flag_clear(&render->reporting);
    if (prepare(render, error) != SAG_OK) {
        sag_render_destroy(render);
        return NULL;
    }
    return render;
}

void sag_render_destroy(sag_render *render) {
    if (!render) return;
    sagi_lights_clear(&render->lights);
    for (uint32_t i = 0; i < render->wave_count; i++) sagi_wave_clear(&render->waves[i], render->context);
    sag_release(render->context, render->waves, render->wave_count * sizeof *render->waves);
    size_t pixel_count = (size_t)render->width * render->height;
    sag_release(render->context, render->pixels, pixel_count * sizeof *render->pixels);
    sag_release(render->context, render->splats, pixel_count * sizeof *render->splats);
    sag_release(render->context, render->layers, pixel_count * sizeof *render->layers);
    size_t tile_count = (size_t)render->tiles_x * render->tiles_y;
    sag_release(render->context, render->tile_done, tile_count * sizeof *render->tile_done);
    sag_release(render->context, render, sizeof *render);
}

// What a path's sample is in numbers.
static sag_rgb path_value(const sag_render *render, const sagi_path *path) {
    if (sagi_is_spectral(render))
        return sagi_sensor_measure(&render->sensor, path->radiance, &path->wavelengths);
    return render->settings.integrator == SAG_INTEGRATOR_AO ? sagi_rgb_grey((double)path->radiance[0])
                                                            : path->shown;
}

// Follows the wave's paths to their ends and adds each sample to its pixel.
static void finish_wave(sag_render *render, sagi_wave *wave) {
    sagi_wave_follow(wave);
    for (uint32_t i = 0; i < wave->path_count; i++) {
        const sagi_path *path = &wave->paths[i];
        if (render->splats) break; // all that they brought is on the film
        const sag_rgb value = path_value(render, path);
        sagi_film_add(render, path->pixel, path->sampler.sample, path->pixel_weight, value);
        if (wave->firsts) sagi_layers_add(render, path->pixel, &wave->firsts[i], path->pixel_weight, value);
    }
    wave->path_count = 0;
}

static void report(sag_render *render) {
    if (!render->progress || atomic_flag_test_and_set(&render->reporting)) return;
    double now = sagi_clock_seconds();
    if (now >= render->next_report) {
        render->next_report = now + REPORT_SECONDS;
        sag_progress progress = {.samples_done = atomic_load(&render->camera_samples),
                                 .samples_total = (uint64_t)render->width * render->height *
                                                  render->settings.samples_per_pixel,
                                 .seconds = render->trace_seconds + (now - render->run_start)};
        if (!render->progress(render->progress_user, &progress)) atomic_store(&render->cancelled, true);
    }
    atomic_flag_clear(&render->reporting);
}

// Takes a tile's samples, a wave at a time.
static void follow_tile(sag_render *render, sagi_wave *wave, const sagi_tile *tile) {
    for (uint32_t i = 0; i < SAGI_TILE_SIZE * SAGI_TILE_SIZE; i++) {
        const uint32_t x = tile->x0 + sagi_along(i), y = tile->y0 + sagi_along(i >> 1);
        if (x >= tile->x1 || y >= tile->y1) continue;
        sagi_pixel *pixel = &render->pixels[(size_t)y * render->width + x];
        for (uint32_t k = tile->first, next; k < tile->end; k = next) {
            const uint32_t room = render->wave_size - wave->path_count;
            next = tile->end - k < room ? tile->end : k + room;
            sagi_wave_start(wave, pixel, render->first_x + x, render->first_y + y, k, next);
            if (wave->path_count == render->wave_size) finish_wave(render, wave);
        }
    }
    finish_wave(render, wave);
}

static void run_tile(sag_render *render, sagi_wave *wave, size_t index) {
    sagi_tile tile = {.first = render->tile_done[index], .end = render->pass_end};
    if (tile.first >= tile.end) return;
    tile.x0 = (uint32_t)(index % render->tiles_x) * SAGI_TILE_SIZE;
    tile.y0 = (uint32_t)(index / render->tiles_x) * SAGI_TILE_SIZE;
    tile.x1 = tile.x0 + SAGI_TILE_SIZE < render->width ? tile.x0 + SAGI_TILE_SIZE : render->width;
    tile.y1 = tile.y0 + SAGI_TILE_SIZE < render->height ? tile.y0 + SAGI_TILE_SIZE : render->height;
    wave->rays_traced = 0;
    wave->traversal_seconds = wave->texture_seconds = 0;
    const double start = sagi_clock_seconds();
    if (sagi_can_glance(render))
        sagi_glance_tile(render, wave, &tile);
    else
        follow_tile(render, wave, &tile);
    render->tile_done[index] = tile.end;
    atomic_fetch_add(&render->rays, wave->rays_traced);
    atomic_fetch_add(&render->traversal_ns, (uint64_t)(1e9 * wave->traversal_seconds));
    atomic_fetch_add(&render->texture_ns, (uint64_t)(1e9 * wave->texture_seconds));
    atomic_fetch_add(&render->thread_ns, (uint64_t)(1e9 * (sagi_clock_seconds() - start)));
    atomic_fetch_add(&render->camera_samples,
                     (uint64_t)(tile.x1 - tile.x0) * (tile.y1 - tile.y0) * (tile.end - tile.first));
    report(render);
}

// What one thread does of a pass: tile after tile, with the wave that is its own.
static void run_tiles(void *argument, size_t wave) {
    sag_render *render = argument;
    size_t tile_count = (size_t)render->tiles_x * render->tiles_y;
    while (!atomic_load(&render->cancelled)) {
        size_t tile = atomic_fetch_add(&render->next_tile, 1);
        if (tile >= tile_count) return;
        run_tile(render, &render->waves[wave], tile);
    }
}

sag_status sag_render_run(sag_render *render, sag_progress_callback progress, void *user, sag_error *error) {
    render->progress = progress;
    render->progress_user = user;
    render->run_start = sagi_clock_seconds();
    render->next_report = render->run_start;
    atomic_store(&render->cancelled, false);
    size_t tile_count = (size_t)render->tiles_x * render->tiles_y;
    uint32_t done = UINT32_MAX;
    for (size_t i = 0; i < tile_count; i++)
        if (render->tile_done[i] < done) done = render->tile_done[i];
    uint32_t total = render->settings.samples_per_pixel;
    while (done < total && !atomic_load(&render->cancelled)) {
        uint32_t step = done == 0 ? 1 : done < LONGEST_PASS ? done : LONGEST_PASS;
        render->pass_end = total - done > step ? done + step : total;
        atomic_store(&render->next_tile, 0);
        sag_parallel_for(render->context, render->wave_count, run_tiles, render);
        done = render->pass_end;
    }
    if (!atomic_load(&render->cancelled)) {
        render->next_report = 0;
        report(render); // the last one says all is done
    }
    render->trace_seconds += sagi_clock_seconds() - render->run_start;
    // Asked to stop with the last tile done already is no cancellation.
    for (size_t i = 0; i < tile_count; i++)
        if (render->tile_done[i] < total)
            return sag_error_set(error, SAG_ERROR_CANCELLED, "the render was cancelled");
    return SAG_OK;
}

sag_status sag_render_get_image(const sag_render *render, sag_image *image, sag_error *error) {
    sag_image made;
    sag_status status = sag_image_create(render->context, render->width, render->height, 3, &made, error);
    if (status != SAG_OK) return status;
    size_t count = (size_t)render->width * render->height;
    for (size_t i = 0; i < count; i++) {
        const sag_rgb value = sagi_film_value(render, &render->pixels[i]);
        made.pixels[3 * i] = (float)value.r;
        made.pixels[3 * i + 1] = (float)value.g;
        made.pixels[3 * i + 2] = (float)value.b;
    }
    if (sagi_is_spectral(render)) made.color_space = render->settings.film.color_space;
    *image = made;
    return SAG_OK;
}

void sag_render_get_stats(const sag_render *render, sag_render_stats *stats) {
    *stats = (sag_render_stats){.width = render->width,
                                .height = render->height,
                                .rays = atomic_load(&render->rays),
                                .camera_samples = atomic_load(&render->camera_samples),
                                .bad_samples = atomic_load(&render->bad_samples),
                                .build_seconds = render->build_seconds,
                                .trace_seconds = render->trace_seconds,
                                .thread_seconds = 1e-9 * (double)atomic_load(&render->thread_ns),
                                .traversal_seconds = 1e-9 * (double)atomic_load(&render->traversal_ns),
                                .texture_seconds = 1e-9 * (double)atomic_load(&render->texture_ns)};
    stats->bad_told = sagi_film_first_bad(render, stats->bad);
}
