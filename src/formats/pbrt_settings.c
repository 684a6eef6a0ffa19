// SPDX-License-Identifier: MIT
// What stands above WorldBegin: camera, film, sampler, filter, integrator.
#include "formats/pbrt.h"
#include "formats/pbrt_blocks.h"
#include "render/filter.h"
#include "render/sensor.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// More would take years.
#define MAX_SAMPLES (1 << 24)

#define RADIANS (3.14159265358979323846 / 180)

void sagi_pbrt_default_settings(sagi_pbrt *p) {
    sag_settings *settings = sag_world_settings(p->world);
    p->film_diagonal = 35;
    settings->camera.kind = SAG_CAMERA_PERSPECTIVE;
    settings->camera.to_world = sag_affine_identity();
    settings->camera.fov_rad = 90 * RADIANS;
    settings->film.width = 1280, settings->film.height = 720;
    settings->film.filter = SAG_FILTER_GAUSSIAN;
    settings->film.filter_radius_x = settings->film.filter_radius_y = 1.5;
    settings->film.filter_sigma = 0.5;
    settings->sampler = SAG_SAMPLER_ZSOBOL;
    settings->samples_per_pixel = 16;
    settings->integrator = SAG_INTEGRATOR_VOLPATH;
    settings->max_depth = 5;
}

// Reads the name after a directive and its parameters.
static sag_status read_named(sagi_pbrt *p, sagi_place place, const char *what, char *name, size_t size) {
    const sag_status status = sagi_pbrt_string(p, place, name, size);
    return status == SAG_OK ? sagi_pbrt_parameters(p, place, SAGI_TARGET_NONE, "%s \"%.60s\"", what, name)
                            : status;
}

static sag_status unknown(sagi_pbrt *p, sagi_place place, const char *what, const char *name) {
    return sagi_place_error(place, p->error, "unknown %s \"%.60s\"", what, name);
}

sag_status sagi_pbrt_camera(sagi_pbrt *p, sagi_place place) {
    char name[64];
    const sag_status status = read_named(p, place, "Camera", name, sizeof name);
    if (status != SAG_OK) return status;
    sag_camera camera = {.kind = SAG_CAMERA_PERSPECTIVE};
    if (strcmp(name, "orthographic") == 0)
        camera.kind = SAG_CAMERA_ORTHOGRAPHIC;
    else if (strcmp(name, "spherical") == 0 || strcmp(name, "environment") == 0)
        camera.kind = SAG_CAMERA_ENVIRONMENT;
    else if (strcmp(name, "perspective") != 0 && strcmp(name, "realistic") != 0)
        return unknown(p, place, "camera", name);
    if (p->state.outside) sag_world_settings(p->world)->camera_medium = p->media[p->state.outside - 1].id;
    sagi_params *params = &p->params;
    if (!sag_affine_inverse(&p->state.ctm, &camera.to_world))
        return sagi_params_fail(params, NULL, "the transform is singular");
    // pbrt's name for the space of the camera, for lights that are fixed to it.
    const sag_affine ctm = p->state.ctm;
    p->state.ctm = camera.to_world;
    const bool named = sagi_pbrt_name_system(p, (sagi_slice){"camera", 6});
    p->state.ctm = ctm;
    if (!named) return sagi_pbrt_out_of_memory(p);
    if (p->options->geometry_only) return SAG_OK;

    p->image_distance = 0, p->lens_share = 1;
    if (strcmp(name, "realistic") == 0) {
        const sag_status read = sagi_pbrt_lens(p, place, &camera);
        if (read != SAG_OK) return read;
    }
    const double fov = sagi_params_float(params, "fov", 90);
    if (!(fov > 0 && fov < 180))
        sagi_params_fail(params, sagi_params_find(params, "fov", ~0u), "fov %g: it must be in (0, 180)", fov);
    camera.fov_rad = fov * RADIANS;
    camera.lens_radius = sagi_params_float(params, "lensradius", camera.lens_radius);
    camera.focal_distance = sagi_params_float(params, "focaldistance", camera.focal_distance);
    if (!(camera.lens_radius >= 0))
        sagi_params_fail(params, sagi_params_find(params, "lensradius", ~0u), "a lens of radius %g",
                         camera.lens_radius);
    size_t count;
    const double *window = sagi_params_numbers(params, "screenwindow", SAGI_TYPE_FLOAT, 4, &count);
    if (count == 4) memcpy(camera.screen_window, window, sizeof camera.screen_window);
    if (count != 0 && (count != 4 || window[0] == window[1] || window[2] == window[3]))
        sagi_params_fail(params, sagi_params_find(params, "screenwindow", ~0u),
                         "\"screenwindow\" must be four numbers, left right bottom top, with room between");
    const double aspect = sagi_params_float(params, "frameaspectratio", 0);
    if (!(aspect >= 0))
        sagi_params_fail(params, sagi_params_find(params, "frameaspectratio", ~0u),
                         "frameaspectratio %g: it must be positive", aspect);
    if (aspect > 0 && count != 4) {
        const double x = aspect > 1 ? aspect : 1, y = aspect > 1 ? 1 : 1 / aspect;
        const double frame[4] = {-x, x, -y, y};
        memcpy(camera.screen_window, frame, sizeof frame);
    }
    const double opens = sagi_params_float(params, "shutteropen", 0);
    const double exposure = sagi_params_float(params, "shutterclose", 1) - opens;
    if (!(exposure > 0 && isfinite(exposure)))
        sagi_params_fail(params, NULL, "the shutter closes %g s after it opened", exposure);
    sag_world_settings(p->world)->film.exposure_seconds = exposure * p->lens_share;
    if (camera.kind == SAG_CAMERA_ENVIRONMENT) {
        char mapping[32]; // "environment" is how older scenes call the one there was
        sagi_params_string(params, "mapping",
                           strcmp(name, "environment") == 0 ? "equirectangular" : "equalarea", mapping,
                           sizeof mapping);
        if (strcmp(mapping, "equalarea") == 0)
            camera.kind = SAG_CAMERA_EQUAL_AREA;
        else if (strcmp(mapping, "equirectangular") != 0)
            sagi_params_fail(params, sagi_params_find(params, "mapping", ~0u), "unknown mapping \"%s\"",
                             mapping);
    }
    sag_world_settings(p->world)->camera = camera;
    return sagi_pbrt_parameters_done(p);
}

// "cropwindow" [x0 x1 y0 y1] in shares of the film goes before "pixelbounds", as in pbrt.
static void read_bounds(sagi_pbrt *p, sagi_place place, sag_film *film) {
    sagi_params *params = &p->params;
    size_t count;
    memset(film->crop_window, 0, sizeof film->crop_window);
    memset(film->pixel_bounds, 0, sizeof film->pixel_bounds);
    const double *bounds = sagi_params_numbers(params, "pixelbounds", SAGI_TYPE_INTEGER, 4, &count);
    if (count != 0 &&
        (count != 4 || !(bounds[0] < bounds[1] && bounds[2] < bounds[3] && bounds[1] > 0 && bounds[3] > 0 &&
                         bounds[0] < film->width && bounds[2] < film->height))) {
        sagi_params_fail(params, sagi_params_find(params, "pixelbounds", ~0u),
                         "\"pixelbounds\" must be four whole numbers, x0 x1 y0 y1, with pixels between");
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t size = i < 2 ? film->width : film->height;
        film->pixel_bounds[i] = bounds[i] < 0 ? 0 : bounds[i] > size ? size : (uint32_t)bounds[i];
    }
    const bool bounded = count != 0;
    const double *window = sagi_params_numbers(params, "cropwindow", SAGI_TYPE_FLOAT, 4, &count);
    if (count == 0) return;
    for (int i = 0; i < 4 && count == 4; i += 2) {
        film->crop_window[i] = fmin(fmax(fmin(window[i], window[i + 1]), 0), 1);
        film->crop_window[i + 1] = fmin(fmax(fmax(window[i], window[i + 1]), 0), 1);
    }
    const double *w = film->crop_window;
    if (count != 4 || !(ceil(w[0] * film->width) < ceil(w[1] * film->width) &&
                        ceil(w[2] * film->height) < ceil(w[3] * film->height)))
        sagi_params_fail(params, sagi_params_find(params, "cropwindow", ~0u),
                         "\"cropwindow\" must be four numbers, x0 x1 y0 y1, with pixels between");
    if (bounded) sagi_pbrt_warn(p, place, "Film: of \"pixelbounds\" and \"cropwindow\" the latter counts");
}

sag_status sagi_pbrt_film(sagi_pbrt *p, sagi_place place) {
    char name[64];
    const sag_status status = read_named(p, place, "Film", name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    if (strcmp(name, "rgb") != 0 && strcmp(name, "gbuffer") != 0 && strcmp(name, "spectral") != 0 &&
        strcmp(name, "image") != 0)
        return unknown(p, place, "film", name);
    p->film_at = place;
    if (strcmp(name, "spectral") == 0) {
        sagi_pbrt_warn(p, place, "Film \"spectral\" is not supported: \"rgb\" takes its place");
        sagi_pbrt_ignore(p, "nbuckets", NULL);
        sagi_pbrt_ignore(p, "lambdamin", NULL);
        sagi_pbrt_ignore(p, "lambdamax", NULL);
    }
    sagi_params *params = &p->params;
    sag_film *film = &sag_world_settings(p->world)->film;
    const int32_t width = sagi_params_integer(params, "xresolution", 1280);
    const int32_t height = sagi_params_integer(params, "yresolution", 720);
    if (width < 1 || height < 1 || width > (int32_t)SAG_MAX_IMAGE_SIZE ||
        height > (int32_t)SAG_MAX_IMAGE_SIZE)
        return sagi_params_fail(params, NULL, "a size of %d×%d: each must be in 1 … %u", width, height,
                                SAG_MAX_IMAGE_SIZE);
    film->width = (uint32_t)width, film->height = (uint32_t)height;
    sagi_params_string(params, "filename", "", film->file, sizeof film->file);
    sagi_params_string(params, "sensor", "cie1931", film->sensor, sizeof film->sensor);
    film->iso = sagi_params_float(params, "iso", 100);
    film->white_balance_kelvin = sagi_params_float(params, "whitebalance", 0);
    film->color_space = p->state.color_space;
    if (!(film->iso > 0)) sagi_params_fail(params, sagi_params_find(params, "iso", ~0u), "iso %g", film->iso);
    if (!sag_sensor_is_known(film->sensor))
        sagi_params_fail(params, sagi_params_find(params, "sensor", ~0u), "unknown sensor \"%s\"",
                         film->sensor);
    p->film_diagonal = sagi_params_float(params, "diagonal", 35);
    sagi_pbrt_ignore(p, "savefp16", NULL);
    film->layers = 0;
    if (strcmp(name, "gbuffer") == 0) {
        char space[32];
        sagi_params_string(params, "coordinatesystem", "camera", space, sizeof space);
        film->layers = SAG_LAYER_ALL;
        film->layers_in_camera_space = strcmp(space, "world") != 0;
        if (strcmp(space, "world") != 0 && strcmp(space, "camera") != 0)
            sagi_params_fail(params, sagi_params_find(params, "coordinatesystem", ~0u),
                             "unknown coordinate system \"%s\"", space);
    }
    read_bounds(p, place, film);
    const double most = sagi_params_float(params, "maxcomponentvalue", INFINITY);
    if (!(most > 0))
        sagi_params_fail(params, sagi_params_find(params, "maxcomponentvalue", ~0u), "maxcomponentvalue %g",
                         most);
    film->max_component = isfinite(most) ? most : 0;
    return sagi_pbrt_parameters_done(p);
}

static void read_randomization(sagi_params *params, sag_settings *settings) {
    static const char *const names[] = {"", "none", "permutedigits", "fastowen", "owen"}; // as the enum
    char name[32];
    sagi_params_string(params, "randomization", "", name, sizeof name);
    size_t i = 0;
    while (i < sizeof names / sizeof *names && strcmp(name, names[i]) != 0) i++;
    if (i == sizeof names / sizeof *names || (i == 3 && settings->sampler == SAG_SAMPLER_HALTON)) {
        sagi_params_fail(params, sagi_params_find(params, "randomization", ~0u),
                         "unknown randomization \"%s\" for this sampler", name);
        return;
    }
    settings->randomization = (sag_randomization)i;
}

sag_status sagi_pbrt_sampler(sagi_pbrt *p, sagi_place place) {
    char name[64];
    const sag_status status = read_named(p, place, "Sampler", name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    static const struct {
        const char *name;
        sag_sampler_kind kind;
    } kinds[] = {
        {"zsobol", SAG_SAMPLER_ZSOBOL},
        {"paddedsobol", SAG_SAMPLER_PADDED_SOBOL},
        {"sobol", SAG_SAMPLER_SOBOL},
        {"halton", SAG_SAMPLER_HALTON},
        {"stratified", SAG_SAMPLER_STRATIFIED},
        {"independent", SAG_SAMPLER_INDEPENDENT},
        {"pmj02bn", SAG_SAMPLER_ZSOBOL},
        {"02sequence", SAG_SAMPLER_PADDED_SOBOL}, // pbrt-v3's
        {"lowdiscrepancy", SAG_SAMPLER_PADDED_SOBOL},
    };
    const size_t kind_count = sizeof kinds / sizeof *kinds;
    sagi_params *params = &p->params;
    sag_settings *settings = sag_world_settings(p->world);
    size_t kind = 0;
    while (kind < kind_count && strcmp(name, kinds[kind].name) != 0) kind++;
    if (kind == kind_count) return unknown(p, place, "sampler", name);
    settings->sampler = kinds[kind].kind;
    if (strcmp(name, "pmj02bn") == 0)
        sagi_pbrt_warn(p, place, "Sampler \"pmj02bn\" is not supported: \"zsobol\" takes its place");
    int64_t samples = settings->sampler == SAG_SAMPLER_INDEPENDENT ? 4 : 16;
    settings->strata_x = settings->strata_y = 0;
    settings->no_jitter = false;
    if (settings->sampler == SAG_SAMPLER_STRATIFIED) {
        const int32_t x = sagi_params_integer(params, "xsamples", 4);
        const int32_t y = sagi_params_integer(params, "ysamples", 4);
        samples = x > 0 && y > 0 ? (int64_t)x * y : 0;
        if (samples > 0) settings->strata_x = (uint32_t)x, settings->strata_y = (uint32_t)y;
        settings->no_jitter = !sagi_params_bool(params, "jitter", true);
    }
    samples =
        sagi_params_integer(params, "pixelsamples", (int32_t)(samples > INT32_MAX ? INT32_MAX : samples));
    if (samples < 1 || samples > MAX_SAMPLES)
        return sagi_params_fail(params, NULL, "%lld samples in a pixel: it must be in 1 … %d",
                                (long long)samples, MAX_SAMPLES);
    settings->samples_per_pixel = (uint32_t)samples;
    settings->seed = (uint64_t)sagi_params_integer(params, "seed", 0);
    read_randomization(params, settings);
    return sagi_pbrt_parameters_done(p);
}

sag_status sagi_pbrt_pixel_filter(sagi_pbrt *p, sagi_place place) {
    char name[64];
    const sag_status status = read_named(p, place, "PixelFilter", name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    p->filter_at = place;
    sagi_params *params = &p->params;
    sag_film *film = &sag_world_settings(p->world)->film;
    static const struct {
        const char *name;
        sag_filter_kind kind;
        double radius;
    } kinds[] = {
        {"gaussian", SAG_FILTER_GAUSSIAN, 1.5}, {"box", SAG_FILTER_BOX, 0.5},
        {"triangle", SAG_FILTER_TRIANGLE, 2},   {"mitchell", SAG_FILTER_MITCHELL, 2},
        {"sinc", SAG_FILTER_SINC, 4},
    };
    size_t kind = 0;
    const size_t kind_count = sizeof kinds / sizeof *kinds;
    while (kind < kind_count && strcmp(name, kinds[kind].name) != 0) kind++;
    if (kind == kind_count) return unknown(p, place, "pixel filter", name);
    film->filter = kinds[kind].kind;
    film->filter_radius_x = sagi_params_float(params, "xradius", kinds[kind].radius);
    film->filter_radius_y = sagi_params_float(params, "yradius", kinds[kind].radius);
    film->filter_sigma = film->filter == SAG_FILTER_GAUSSIAN ? sagi_params_float(params, "sigma", 0.5) : 0;
    film->filter_tau = film->filter == SAG_FILTER_SINC ? sagi_params_float(params, "tau", 3) : 0;
    if (film->filter == SAG_FILTER_MITCHELL) {
        film->filter_b = sagi_params_float(params, "B", 1.0 / 3);
        film->filter_c = sagi_params_float(params, "C", 1.0 / 3);
        // Both 0 would be taken for the default.
        if (film->filter_b == 0 && film->filter_c == 0) film->filter_c = DBL_MIN;
    }
    if (!(film->filter_radius_x > 0 && film->filter_radius_y > 0 && film->filter_radius_x <= 64 &&
          film->filter_radius_y <= 64))
        return sagi_params_fail(params, NULL, "the radius must be in (0, 64]");
    if (film->filter == SAG_FILTER_GAUSSIAN && !(film->filter_sigma > 0))
        return sagi_params_fail(params, NULL, "sigma must be positive");
    if (film->filter == SAG_FILTER_SINC && !(film->filter_tau > 0))
        return sagi_params_fail(params, NULL, "tau must be positive");
    return sagi_pbrt_parameters_done(p);
}

// The parameter "lightsampler". pbrt's "exhaustive" weighs all lamps one by one: the tree has the same mean.
static void light_sampler(sagi_pbrt *p, sagi_place place) {
    static const char *const names[] = {"bvh", "power", "uniform"};
    char text[64];
    sagi_params_string(&p->params, "lightsampler", "bvh", text, sizeof text);
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        sag_world_settings(p->world)->light_sampler = (sag_light_sampler)i;
        return;
    }
    sagi_pbrt_warn_once(p, place, "lightsampler",
                        "Integrator: the light sampler \"%s\" is taken to be \"bvh\"", text);
}

// "ambientocclusion": pbrt-v4's, whose "maxdistance" is infinite by default.
static void read_occlusion(sagi_params *params, sag_settings *settings) {
    const double distance = sagi_params_float(params, "maxdistance", INFINITY);
    settings->occlusion_uniform = !sagi_params_bool(params, "cossample", true);
    settings->occlusion_distance = isfinite(distance) ? distance : 0;
    if (!(distance > 0))
        sagi_params_fail(params, sagi_params_find(params, "maxdistance", ~0u),
                         "maxdistance %g: it must be positive", distance);
}

// "simplepath": lights are sampled, or else only found; and uniformly chosen. That its directions may be
// uniform too makes no other picture.
static void read_simple(sagi_pbrt *p, sag_settings *settings) {
    const bool sampled = sagi_params_bool(&p->params, "samplelights", true);
    settings->strategy = sampled ? SAG_STRATEGY_LIGHTS : SAG_STRATEGY_SURFACES;
    sagi_pbrt_ignore(p, "samplebsdf", NULL);
}

sag_status sagi_pbrt_integrator(sagi_pbrt *p, sagi_place place) {
    char name[64];
    const sag_status status = read_named(p, place, "Integrator", name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    // What each becomes; those that are not supported are followed by volpath, as they see media too.
    static const struct {
        const char *name;
        sag_integrator_kind kind;
        bool supported;
    } kinds[] = {
        {"volpath", SAG_INTEGRATOR_VOLPATH, true},     {"path", SAG_INTEGRATOR_PATH, true},
        {"simplepath", SAG_INTEGRATOR_PATH, true},     {"simplevolpath", SAG_INTEGRATOR_VOLPATH, true},
        {"randomwalk", SAG_INTEGRATOR_PATH, true},     {"lightpath", SAG_INTEGRATOR_LIGHTPATH, true},
        {"ambientocclusion", SAG_INTEGRATOR_AO, true}, {"directlighting", SAG_INTEGRATOR_DIRECT, true},
        {"bdpt", SAG_INTEGRATOR_VOLPATH, false},       {"mlt", SAG_INTEGRATOR_VOLPATH, false},
        {"sppm", SAG_INTEGRATOR_VOLPATH, false},       {"function", SAG_INTEGRATOR_VOLPATH, false},
    };
    const size_t kind_count = sizeof kinds / sizeof *kinds;
    size_t kind = 0;
    while (kind < kind_count && strcmp(name, kinds[kind].name) != 0) kind++;
    if (kind == kind_count) return unknown(p, place, "integrator", name);
    sag_settings *settings = sag_world_settings(p->world);
    settings->integrator = kinds[kind].kind;
    settings->strategy = SAG_STRATEGY_MIS;
    settings->occlusion_distance = 0, settings->occlusion_uniform = false;
    if (!kinds[kind].supported) {
        sagi_pbrt_warn(p, place, "Integrator \"%s\" is not supported: \"volpath\" takes its place%s", name,
                       strcmp(name, "function") == 0 ? "" : ", for the same picture");
        for (size_t k = 0; k < p->params.count; k++)
            if (!sagi_slice_is(p->params.items[k].name, "maxdepth")) p->params.items[k].used = true;
    }
    if (strcmp(name, "ambientocclusion") == 0) read_occlusion(&p->params, settings);
    if (strcmp(name, "simplepath") == 0) read_simple(p, settings);
    if (strcmp(name, "randomwalk") == 0) settings->strategy = SAG_STRATEGY_SURFACES;
    const int32_t depth = sagi_params_integer(&p->params, "maxdepth", 5);
    if (depth < 0) return sagi_params_fail(&p->params, NULL, "maxdepth %d", depth);
    settings->max_depth = (uint32_t)depth;
    settings->regularize = sagi_params_bool(&p->params, "regularize", false);
    light_sampler(p, place);
    if (strncmp(name, "simple", 6) == 0) settings->light_sampler = SAG_LIGHT_SAMPLER_UNIFORM;
    sagi_pbrt_ignore(p, "rrthreshold", NULL);
    return sagi_pbrt_parameters_done(p);
}

sag_status sagi_pbrt_check_settings(sagi_pbrt *p) {
    const sag_film *film = &sag_world_settings(p->world)->film;
    sagi_filter filter;
    sagi_sensor sensor;
    sag_error reason;
    if (p->options->geometry_only) return SAG_OK;
    if (p->filter_at.source && sagi_filter_init(&filter, film, &reason) != SAG_OK)
        return sagi_place_error(p->filter_at, p->error, "PixelFilter: %s", reason.message);
    if (p->film_at.source && sagi_sensor_init(&sensor, film, &reason) != SAG_OK)
        return sagi_place_error(p->film_at, p->error, "Film: %s", reason.message);
    return SAG_OK;
}
