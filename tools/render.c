// SPDX-License-Identifier: MIT
// sagitta render: from a file to a picture.
#include "formats/output.h"
#include "tool.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char help[] =
    "usage: sagitta render FILE [OPTIONS]\n\n"
    "Makes a picture of FILE: a pbrt-v4 scene (.pbrt), or any mesh Assimp reads, which gets a camera that "
    "sees all\n"
    "of it, a ground and a sky.\n\n"
    "  -o, --output OUT     the picture: .png (8 bit sRGB), .pfm or .exr (linear floats). Without it the "
    "name the\n"
    "                       scene gives, or FILE's with .png, in the current directory\n"
    "      --spp N          samples a pixel\n"
    "      --size WxH       width and height in pixels\n"
    "      --crop WxH+X+Y   only W x H pixels from column X and row Y of the picture on, the same bits\n"
    "      --max-component V  dim samples brighter than V: fewer fireflies, but darker than the truth\n"
    "      --aov LAYERS     keep beside the picture, in an .exr: all, or some of "
    "albedo,normal,depth,position,\n"
    "                       uv,id,variance\n"
    "      --integrator I   volpath (all light, through media), path (without media), direct (one bounce),\n"
    "                       lightpath (light followed from the lamps), ao (ambient occlusion), normal, uv,\n"
    "                       depth (linear distance), id (a colour for each geometry), albedo; default: the\n"
    "                       scene's\n"
    "      --seed N         another seed gives another pattern of noise; the same one the same bits\n"
    "      --threads N      as many threads; 0, the default: one a core. The picture does not depend on it\n"
    "      --stats FILE     times, rays, memory and more as JSON\n"
    "  -q, --quiet          no progress, no warnings; errors only\n"
    "  -h, --help           this text\n\n"
    "The picture appears whole or not at all. Ctrl-C stops without one (exit code 130).\n";

typedef struct render_options {
    const char *file, *output, *stats, *aov;
    uint32_t layers; // of --aov
    uint64_t spp, threads, seed;
    uint32_t size[2], crop[4];
    double max_component;
    int integrator; // -1: the scene's
    bool quiet, has_seed;
} render_options;

static double load_seconds;

static bool is_picture_name(const char *name) {
    return has_ending(name, ".png") || has_ending(name, ".pfm") || has_ending(name, ".exr");
}

// Where the picture goes when nobody says: the scene's own name where that can be written, else the file's.
static void default_output(const render_options *o, const sag_settings *settings, char *path,
                           size_t capacity) {
    const char *wanted = base_name(settings->film.file);
    if (is_picture_name(wanted) && has_ending(o->file, ".pbrt") && (!o->aov || has_ending(wanted, ".exr"))) {
        snprintf(path, capacity, "%s", wanted);
        return;
    }
    const char *name = base_name(o->file), *dot = strrchr(name, '.');
    const int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    snprintf(path, capacity, "%.*s%s", length, name, o->aov ? ".exr" : ".png");
}

// Whether a file can be made there, asked before an hour is spent on its content.
static int check_writable(const char *path) {
    char directory[SAGI_MAX_PATH];
    struct stat status;
    const bool exists = stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) errno = EISDIR;
    if (exists && S_ISDIR(status.st_mode))
        return report_failure("%s: cannot write: %s", path, strerror(errno));
    if (exists && !S_ISREG(status.st_mode)) return TOOL_OK;
    const char *slash = strrchr(path, '/');
    const int length = slash == path ? 1 : slash ? (int)(slash - path) : 1;
    snprintf(directory, sizeof directory, "%.*s", length, slash ? path : ".");
    if (access(directory, W_OK | X_OK) == 0) return TOOL_OK;
    return report_failure("%s: cannot write: %s", path, strerror(errno));
}

static bool on_progress(void *user, const sag_progress *p) {
    const double fraction = p->samples_total ? (double)p->samples_done / (double)p->samples_total : 1;
    progress_update(user, fraction, (double)p->samples_done);
    return !interrupt_flag;
}

static void apply_options(const render_options *o, sag_settings *settings) {
    if (o->spp) settings->samples_per_pixel = (uint32_t)o->spp;
    if (o->size[0]) settings->film.width = o->size[0], settings->film.height = o->size[1];
    if (o->has_seed) settings->seed = o->seed;
    if (o->aov) settings->film.layers = o->layers, settings->film.layers_in_camera_space = false;
    if (o->max_component > 0) settings->film.max_component = o->max_component;
    if (o->crop[0]) {
        sag_film *film = &settings->film;
        memset(film->crop_window, 0, sizeof film->crop_window);
        for (int i = 0; i < 2; i++) {
            film->pixel_bounds[2 * i] = o->crop[2 + i];
            film->pixel_bounds[2 * i + 1] = o->crop[2 + i] + o->crop[i];
        }
    }
    if (o->integrator >= 0) settings->integrator = (sag_integrator_kind)o->integrator;
}

// "first_bad_samples": [[x, y, sample], ...]
static bool add_bad_samples(cJSON *json, const sag_render_stats *stats) {
    cJSON *list = cJSON_AddArrayToObject(json, "first_bad_samples");
    bool good = list != NULL;
    for (uint32_t i = 0; i < stats->bad_told && good; i++) {
        const int numbers[3] = {(int)stats->bad[i].x, (int)stats->bad[i].y, (int)stats->bad[i].sample};
        cJSON *item = cJSON_CreateIntArray(numbers, 3);
        good = item && cJSON_AddItemToArray(list, item);
    }
    return good;
}

static sag_status write_stats(const render_options *o, sag_world *world, const sag_render_stats *r,
                              const char *output, sag_error *error) {
    sag_context *context = sag_world_context(world);
    const sag_settings *settings = sag_world_settings(world);
    sag_scene_stats s;
    size_t peak = 0;
    sag_scene_get_stats(sag_world_scene(world), &s);
    sag_context_memory(context, NULL, &peak);
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"width", r->width},
        {"height", r->height},
        {"samples_per_pixel", settings->samples_per_pixel},
        {"load_seconds", load_seconds},
        {"build_seconds", r->build_seconds},
        {"trace_seconds", r->trace_seconds},
        {"rays", (double)r->rays},
        {"rays_per_second", r->trace_seconds > 0 ? (double)r->rays / r->trace_seconds : 0},
        {"camera_samples", (double)r->camera_samples},
        {"bad_samples", (double)r->bad_samples},
        {"peak_bytes", (double)peak},
        {"process_peak_bytes", (double)peak_memory()},
        {"threads", sag_context_thread_count(context)},
        {"geometries", s.geometry_count},
        {"primitives", (double)s.primitive_count},
        {"dropped_not_finite", (double)s.dropped_not_finite},
        {"dropped_degenerate", (double)s.dropped_degenerate},
        {"geometry_bytes", (double)s.geometry_bytes},
        {"structure_bytes", (double)s.structure_bytes},
    };
    cJSON *json = cJSON_CreateObject();
    bool good = cJSON_AddStringToObject(json, "version", SAG_VERSION) &&
                json_add_text(json, "file", o->file) && json_add_text(json, "output", output) &&
                cJSON_AddStringToObject(json, "isa", sag_context_isa(context));
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && good; i++) {
        good = cJSON_AddNumberToObject(json, numbers[i].name, numbers[i].value) != NULL;
    }
    if (good) good = add_bad_samples(json, r);
    char *text = good ? cJSON_Print(json) : NULL;
    cJSON_Delete(json);
    if (!text) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for %s", o->stats);
    sagi_output file;
    sag_status status = sagi_output_open(&file, o->stats, error);
    if (status == SAG_OK) {
        fprintf(file.file, "%s\n", text);
        status = sagi_output_commit(&file, error);
    }
    cJSON_free(text);
    return status;
}

static void say_what_was_made(sag_world *world, const sag_render_stats *r, const char *output) {
    char seconds[TEXT_BYTES], rays[TEXT_BYTES], load[TEXT_BYTES], build[TEXT_BYTES], bad[TEXT_BYTES];
    const sag_settings *settings = sag_world_settings(world);
    fprintf(stderr, "%s: %u x %u, %u sample%s a pixel in %s, %s on %u thread%s (load %s, build %s)\n", output,
            r->width, r->height, settings->samples_per_pixel, settings->samples_per_pixel == 1 ? "" : "s",
            text_seconds(seconds, r->trace_seconds),
            text_rate(rays, (double)r->rays, r->trace_seconds, "rays"),
            sag_context_thread_count(sag_world_context(world)),
            sag_context_thread_count(sag_world_context(world)) == 1 ? "" : "s",
            text_seconds(load, load_seconds), text_seconds(build, r->build_seconds));
    if (r->bad_samples) {
        fprintf(stderr, "sagitta: warning: %s of the samples were not numbers and were dropped:",
                text_count(bad, r->bad_samples));
        for (uint32_t i = 0; i < r->bad_told; i++)
            fprintf(stderr, "%s pixel (%u, %u) sample %u", i ? "," : "", r->bad[i].x, r->bad[i].y,
                    r->bad[i].sample);
        fprintf(stderr, "%s\n", r->bad_samples > r->bad_told ? ", ..." : "");
    }
}

// Whether no background is mixed into a pixel's distance: none of those a filter may reach shows any.
static bool is_pure(const sag_image *image, uint32_t x, uint32_t y) {
    const size_t row = (size_t)image->width * image->channels;
    const float *at = image->pixels + y * row + (size_t)x * image->channels;
    bool pure = at[0] > 0 && isfinite(at[0]);
    for (uint32_t i = 1; i <= 4 && pure; i++) {
        pure = (x < i || *(at - (size_t)i * image->channels) > 0) && (y < i || *(at - i * row) > 0) &&
               (x + i >= image->width || at[(size_t)i * image->channels] > 0) &&
               (y + i >= image->height || at[i * row] > 0);
    }
    return pure;
}

// Distances as they are would be white all over in a PNG, and a ground that reaches far leaves no shades for
// what stands on it: the brightness is the nearest distance over the distance. What is not hit (0) stays
// black.
static void show_depth(sag_image *image, const char *output, bool quiet) {
    float near = INFINITY;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            if (is_pure(image, x, y))
                near = fminf(near, image->pixels[((size_t)y * image->width + x) * image->channels]);
        }
    }
    if (!isfinite(near)) return;
    const size_t count = (size_t)image->width * image->height * image->channels;
    for (size_t i = 0; i < count; i++) {
        float *d = &image->pixels[i];
        if (*d > 0) *d = near / fmaxf(*d, near);
    }
    if (!quiet)
        fprintf(stderr, "%s: brightness is %g / distance; .pfm and .exr hold the distance\n", output,
                (double)near);
}

// What was rendered: all layers of it, or the picture alone.
typedef struct made_picture {
    bool layered;
    sag_layers layers;
    sag_image image;
    sag_render_stats stats;
} made_picture;

static sag_status take_picture(const sag_render *render, made_picture *p, sag_error *error) {
    sag_render_get_stats(render, &p->stats);
    return p->layered ? sag_render_get_layers(render, &p->layers, error)
                      : sag_render_get_image(render, &p->image, error);
}

static sag_status write_picture(const render_options *o, sag_world *world, made_picture *p,
                                const char *output, sag_error *error) {
    sag_context *context = sag_world_context(world);
    if (p->layered) return sag_layers_write(context, &p->layers, output, error);
    const sag_settings *settings = sag_world_settings(world);
    if (settings->film.layers != 0)
        sag_context_log(context, SAG_LOG_WARNING, "%s: layers are written to .exr files only", output);
    const bool is_depth = settings->integrator == SAG_INTEGRATOR_DEPTH;
    if (is_depth && has_ending(output, ".png")) show_depth(&p->image, output, o->quiet);
    return sag_image_write(context, &p->image, output, error);
}

static int make_picture(const render_options *o, sag_world *world, const char *output, progress *bar) {
    sag_error error = {0};
    progress_note(bar, "building ...");
    sag_render *render = sag_render_create(world, &error);
    if (!render) return report_error(&error);
    interrupt_catch();
    progress_begin(bar, "rendering", "samples", o->quiet);
    sag_status status = sag_render_run(render, on_progress, bar, &error);
    progress_end(bar);
    made_picture made = {.layered =
                             sag_world_settings(world)->film.layers != 0 && has_ending(output, ".exr")};
    if (status == SAG_OK) status = take_picture(render, &made, &error);
    sag_render_destroy(render); // its film is as large as the picture and the file together
    if (status == SAG_OK) status = write_picture(o, world, &made, output, &error);
    sag_image_clear(sag_world_context(world), &made.image);
    sag_layers_clear(sag_world_context(world), &made.layers);
    if (status == SAG_OK && o->stats) status = write_stats(o, world, &made.stats, output, &error);
    if (status == SAG_OK && !o->quiet) say_what_was_made(world, &made.stats, output);
    return status == SAG_OK ? TOOL_OK : report_error(&error);
}

static int render_file(const render_options *o) {
    sag_context *context = session_open(o->threads, o->quiet);
    if (!context) return TOOL_FAILED;
    int result = TOOL_FAILED;
    progress bar;
    progress_begin(&bar, "loading", "", o->quiet);
    progress_note(&bar, "loading ...");
    const double start = clock_seconds();
    sag_error error = {0};
    sag_world *world = sag_world_create(context);
    if (!world) {
        report_failure("out of memory");
    } else if (sag_world_load(world, o->file, &error) != SAG_OK) {
        result = report_error(&error);
    } else {
        char path[SAGI_MAX_PATH];
        load_seconds = clock_seconds() - start;
        apply_options(o, sag_world_settings(world));
        default_output(o, sag_world_settings(world), path, sizeof path);
        const char *output = o->output ? o->output : path;
        result = check_writable(output);
        if (result == TOOL_OK && o->stats) result = check_writable(o->stats);
        if (result == TOOL_OK) result = make_picture(o, world, output, &bar);
    }
    progress_end(&bar);
    sag_world_destroy(world);
    session_close(context);
    return result;
}

static bool read_layers(const char *list, uint32_t *layers) {
    static const char *const names[] = {"albedo", "normal", "depth",    "position",
                                        "uv",     "id",     "variance", NULL}; // bit by bit as sag_layer
    if (strcmp(list, "all") == 0) {
        *layers = SAG_LAYER_ALL;
        return true;
    }
    for (*layers = 0;; list++) {
        const size_t length = strcspn(list, ",");
        int i = 0;
        while (names[i] && (strlen(names[i]) != length || strncmp(names[i], list, length) != 0)) i++;
        if (!names[i]) return false;
        *layers |= 1u << i;
        list += length;
        if (!*list) return true;
    }
}

static int run(const tool_command *command, int argc, char **argv) {
    static const char *const integrators[] = {"path", "direct", "ao",      "normal",    "uv", "depth",
                                              "id",   "albedo", "volpath", "lightpath", NULL};
    render_options o = {.integrator = -1, .seed = UINT64_MAX};
    const option options[] = {
        {.name = "output", .letter = 'o', .kind = OPTION_TEXT, .target = &o.output},
        {.name = "spp", .kind = OPTION_COUNT, .target = &o.spp, .minimum = 1, .maximum = 1000000000},
        {.name = "size", .kind = OPTION_SIZE, .target = o.size},
        {.name = "crop", .kind = OPTION_CROP, .target = o.crop},
        {.name = "max-component",
         .kind = OPTION_NUMBER,
         .target = &o.max_component,
         .least = 0,
         .most = INFINITY},
        {.name = "aov", .kind = OPTION_TEXT, .target = &o.aov},
        {.name = "integrator", .kind = OPTION_CHOICE, .target = &o.integrator, .choices = integrators},
        {.name = "seed", .kind = OPTION_COUNT, .target = &o.seed, .minimum = 0, .maximum = UINT64_MAX - 1},
        {.name = "threads", .kind = OPTION_COUNT, .target = &o.threads, .minimum = 0, .maximum = 4096},
        {.name = "stats", .kind = OPTION_TEXT, .target = &o.stats},
        {.name = "quiet", .letter = 'q', .kind = OPTION_FLAG, .target = &o.quiet},
    };
    const int count = options_parse(command, options, sizeof options / sizeof *options, argc, argv);
    if (count == -2) return TOOL_OK;
    if (count < 0) return TOOL_USAGE;
    if (count == 0) return usage_error(command->name, "which file?");
    if (count > 1) return usage_error(command->name, "one file at a time: '%s' is too much", argv[1]);
    o.file = argv[0];
    o.has_seed = o.seed != UINT64_MAX;
    if (o.output && !is_picture_name(o.output)) {
        return usage_error(command->name, "%s: a picture's name ends in .png, .pfm or .exr", o.output);
    }
    if (o.aov && !read_layers(o.aov, &o.layers)) {
        return usage_error(command->name,
                           "--aov %s: expected all, or some of albedo,normal,depth,position,"
                           "uv,id,variance",
                           o.aov);
    }
    if (o.aov && o.output && !has_ending(o.output, ".exr"))
        return usage_error(command->name, "%s: with --aov, the picture's name ends in .exr", o.output);
    return render_file(&o);
}

const tool_command tool_render = {"render", "make a picture of a scene or mesh", help, run};
