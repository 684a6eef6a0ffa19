// SPDX-License-Identifier: MIT
// bench-render: how long whole pictures take beside pbrt-v4, and whether they are the same pictures. The
// scenes are those of ../shared/scenes, with the sizes, seconds and images that pbrt-v4 made from the very
// files (README.md there); its seconds are for 1024 samples a pixel and grow with the samples. Where pbrt-v4
// itself is at hand (--pbrt) the two programs render in turns instead.
#include "../bench.h"
#include "render.h"
#include <cjson/cJSON.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: bench-render [OPTION]…\n"
    "Renders scenes and tells how long it took, beside pbrt-v4's time for as many samples, and how far the\n"
    "pictures are from pbrt-v4's (1024 samples a pixel).\n"
    "\n"
    "  --scene NAME     cornell-box, veach-mis, spaceship, coffee, dining-room or staircase2; may be given\n"
    "                   again (all)\n"
    "  --spp N          samples a pixel (64)\n"
    "  --repeats N      the median of so many (1)\n"
    "  --threads N      0, the default: one a core\n"
    "  --pbrt PROGRAM   run this pbrt-v4 too, before each of our own runs; without it: the seconds that it\n"
    "                   took for the reference pictures\n"
    "  --folder DIR     keep the pictures there\n"
    "  --json FILE      write the results there\n"
    "\n"
    "bench/README.md says what is rendered and how it is timed.\n";

static const subject_scene scenes[] = {
    {"cornell-box", 256, 256, 143}, {"veach-mis", 400, 225, 161},   {"spaceship", 400, 225, 187},
    {"coffee", 240, 300, 276},      {"dining-room", 400, 225, 322}, {"staircase2", 256, 256, 388},
};
enum { SCENES = sizeof scenes / sizeof *scenes, MOST_REPEATS = 101 };

typedef struct options {
    const char *folder, *json, *pbrt;
    unsigned repeats, scenes, spp, threads; // scenes: bits; 0: all
} options;

typedef struct outcome {
    const subject_scene *scene;
    double seconds, load_seconds, build_seconds, pbrt_seconds;
    sag_render_stats stats;
    size_t peak_bytes, pbrt_bytes; // pbrt_bytes: its whole process; 0: not run
    bool compared;
    agreement agreement;
} outcome;

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, unsigned count) {
    qsort(values, count, sizeof *values, by_size);
    return (values[count / 2] + values[(count - 1) / 2]) / 2;
}

static bool complain(const char *name, const sag_error *error) {
    fprintf(stderr, "bench-render: %s: %s:%d:%d: %s\n", name, error->file, error->line, error->column,
            error->message);
    return false;
}

static bool render_once(sag_world *world, outcome *r, sag_image *image) {
    sag_error error = {0};
    sag_render *render = sag_render_create(world, &error);
    if (render == NULL) return complain(r->scene->name, &error);
    bool good = sag_render_run(render, NULL, NULL, &error) == SAG_OK;
    sag_render_get_stats(render, &r->stats);
    sag_image_clear(sag_world_context(world), image);
    good = good && sag_render_get_image(render, image, &error) == SAG_OK;
    sag_render_destroy(render);
    return good ? true : complain(r->scene->name, &error);
}

static bool measure(const options *o, const subject_scene *scene, outcome *r) {
    *r = (outcome){.scene = scene};
    char path[4096];
    sag_error error = {0};
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = o->threads});
    sag_world *world = context ? sag_world_create(context) : NULL;
    snprintf(path, sizeof path, BENCH_DATA "/scenes/%s/scene-v4.pbrt", scene->name);
    const double start = seconds_now();
    bool good = world != NULL && sag_world_load(world, path, &error) == SAG_OK;
    if (!good) complain(scene->name, &error);
    r->load_seconds = seconds_now() - start;
    sag_image image = {0}, wanted = {0};
    double seconds[MOST_REPEATS], pbrt[MOST_REPEATS];
    pbrt_scene theirs = {{0}};
    if (good) {
        sag_settings *settings = sag_world_settings(world);
        settings->film.width = scene->width, settings->film.height = scene->height;
        settings->samples_per_pixel = o->spp;
    }
    if (good && o->pbrt != NULL && !(good = pbrt_prepare(&theirs, scene)))
        fprintf(stderr, "bench-render: %s: no copy for pbrt-v4 could be made in /tmp\n", scene->name);
    for (unsigned i = 0; i < o->repeats && good; i++) {
        if (o->pbrt != NULL && !pbrt_run(&theirs, o->pbrt, o->spp, o->threads, &pbrt[i], &r->pbrt_bytes)) {
            good = false;
            break;
        }
        good = render_once(world, r, &image);
        seconds[i] = r->stats.trace_seconds;
        if (i == 0) r->build_seconds = r->stats.build_seconds;
    }
    if (good) {
        r->seconds = median(seconds, o->repeats);
        r->pbrt_seconds = o->pbrt != NULL ? median(pbrt, o->repeats) : scene->pbrt_seconds * o->spp / 1024;
        snprintf(path, sizeof path, BENCH_DATA "/scenes/reference/%s.exr", scene->name);
        r->compared = sag_image_read(context, path, SAG_ENCODING_DEFAULT, &wanted, &error) == SAG_OK &&
                      agree(&image, &wanted, &r->agreement);
        size_t bytes;
        sag_context_memory(context, &bytes, &r->peak_bytes);
    }
    if (good && o->folder != NULL) {
        snprintf(path, sizeof path, "%s/%s.exr", o->folder, scene->name);
        good = sag_image_write(context, &image, path, &error) == SAG_OK;
        if (!good) complain(scene->name, &error);
    }
    sag_image_clear(context, &image);
    sag_image_clear(context, &wanted);
    pbrt_forget(&theirs);
    sag_world_destroy(world);
    sag_context_destroy(context);
    return good;
}

static void print_heading(const options *o) {
    printf("\n  %u samples a pixel; seconds of tracing alone, pbrt-v4's of rendering%s\n\n", o->spp,
           o->pbrt != NULL ? " (in the same run, in turns)" : " (when it made the reference pictures)");
    printf("  %-12s %9s %8s %8s %6s %10s %8s %9s %8s %8s %9s %9s   %9s %7s %7s %7s %8s %8s\n", "scene",
           "size", "seconds", "pbrt", "ratio", "Msamples/s", "Mrays/s", "traversal", "shading", "textures",
           "memory", "pbrt's", "luminance", "R", "G", "B", "blocks", "pixels");
}

// What the threads' time goes into; shading is all but the other two, camera and film included.
typedef enum part { TRAVERSAL, SHADING, TEXTURES } part;

static double share_of(const outcome *o, part which) {
    const double traversal = o->stats.traversal_seconds / o->stats.thread_seconds,
                 textures = o->stats.texture_seconds / o->stats.thread_seconds;
    switch (which) {
    case TRAVERSAL: return traversal;
    case TEXTURES: return textures;
    case SHADING: break;
    }
    return 1 - traversal - textures;
}

static void print_outcome(const outcome *o) {
    char size[32];
    snprintf(size, sizeof size, "%u x %u", o->scene->width, o->scene->height);
    printf("  %-12s %9s %8.2f %8.2f %6.2f %10.3f %8.2f %7.0f %% %6.0f %% %6.0f %% %6.0f MB", o->scene->name,
           size, o->seconds, o->pbrt_seconds, o->pbrt_seconds / o->seconds,
           (double)o->stats.camera_samples / o->seconds / 1e6, (double)o->stats.rays / o->seconds / 1e6,
           100 * share_of(o, TRAVERSAL), 100 * share_of(o, SHADING), 100 * share_of(o, TEXTURES),
           (double)o->peak_bytes / 1e6);
    if (o->pbrt_bytes != 0)
        printf(" %6.0f MB", (double)o->pbrt_bytes / 1e6);
    else
        printf(" %9s", "");
    const agreement *a = &o->agreement;
    if (o->compared)
        printf("   %9.4f %7.3f %7.3f %7.3f %6.2f %% %6.1f %%", a->luminance, a->channels[0], a->channels[1],
               a->channels[2], 100 * a->blocks, 100 * a->error);
    printf("\n");
    fflush(stdout);
}

static bool write_json(const char *path, const outcome *outcomes, size_t count, const options *o) {
    cJSON *all = cJSON_CreateObject(), *results = cJSON_AddArrayToObject(all, "results");
    cJSON_AddStringToObject(all, "sagitta", SAG_VERSION);
    for (size_t i = 0; i < count; i++) {
        const outcome *r = &outcomes[i];
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "scene", r->scene->name);
        cJSON_AddNumberToObject(json, "width", r->scene->width);
        cJSON_AddNumberToObject(json, "height", r->scene->height);
        cJSON_AddNumberToObject(json, "samples_per_pixel", o->spp);
        cJSON_AddNumberToObject(json, "seconds", r->seconds);
        cJSON_AddNumberToObject(json, "pbrt_seconds", r->pbrt_seconds);
        cJSON_AddBoolToObject(json, "pbrt_in_this_run", o->pbrt != NULL);
        cJSON_AddNumberToObject(json, "load_seconds", r->load_seconds);
        cJSON_AddNumberToObject(json, "build_seconds", r->build_seconds);
        cJSON_AddNumberToObject(json, "samples_per_second", (double)r->stats.camera_samples / r->seconds);
        cJSON_AddNumberToObject(json, "rays_per_second", (double)r->stats.rays / r->seconds);
        cJSON_AddNumberToObject(json, "traversal_share", share_of(r, TRAVERSAL));
        cJSON_AddNumberToObject(json, "shading_share", share_of(r, SHADING));
        cJSON_AddNumberToObject(json, "texture_share", share_of(r, TEXTURES));
        cJSON_AddNumberToObject(json, "bad_samples", (double)r->stats.bad_samples);
        cJSON_AddNumberToObject(json, "peak_bytes", (double)r->peak_bytes);
        if (r->pbrt_bytes != 0) cJSON_AddNumberToObject(json, "pbrt_peak_bytes", (double)r->pbrt_bytes);
        if (r->compared) {
            cJSON_AddNumberToObject(json, "luminance", r->agreement.luminance);
            cJSON_AddItemToObject(json, "channels", cJSON_CreateDoubleArray(r->agreement.channels, 3));
            cJSON_AddNumberToObject(json, "blocks", r->agreement.blocks);
            cJSON_AddNumberToObject(json, "pixels", r->agreement.error);
        }
        cJSON_AddItemToArray(results, json);
    }
    char *text = cJSON_Print(all);
    cJSON_Delete(all);
    FILE *file = text != NULL ? fopen(path, "w") : NULL;
    bool written = file != NULL && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    if (file != NULL) written = fclose(file) == 0 && written;
    if (!written) fprintf(stderr, "bench-render: %s could not be written\n", path);
    free(text);
    return written;
}

static bool read_number(const char *text, unsigned least, unsigned most, unsigned *number) {
    char *end;
    const unsigned long value = strtoul(text, &end, 10);
    if (*text < '0' || *text > '9' || *end || value < least || value > most) return false;
    *number = (unsigned)value;
    return true;
}

static bool read_scene(const char *name, unsigned *bits) {
    for (unsigned i = 0; i < SCENES; i++)
        if (strcmp(name, scenes[i].name) == 0) {
            *bits |= 1u << i;
            return true;
        }
    return false;
}

int main(int argc, char **argv) {
    static const struct option names[] = {{"scene", required_argument, NULL, 's'},
                                          {"spp", required_argument, NULL, 'n'},
                                          {"repeats", required_argument, NULL, 'r'},
                                          {"threads", required_argument, NULL, 't'},
                                          {"folder", required_argument, NULL, 'f'},
                                          {"json", required_argument, NULL, 'j'},
                                          {"pbrt", required_argument, NULL, 'p'},
                                          {"help", no_argument, NULL, 'h'},
                                          {0}};
    options o = {.repeats = 1, .spp = 64};
    for (int c; (c = getopt_long(argc, argv, "", names, NULL)) != -1;) {
        bool good = true;
        switch (c) {
        case 's': good = read_scene(optarg, &o.scenes); break;
        case 'n': good = read_number(optarg, 1, 1u << 20, &o.spp); break;
        case 'r': good = read_number(optarg, 1, MOST_REPEATS, &o.repeats); break;
        case 't': good = read_number(optarg, 0, 4096, &o.threads); break;
        case 'f': o.folder = optarg; break;
        case 'j': o.json = optarg; break;
        case 'p': o.pbrt = optarg; break;
        case 'h': fputs(usage, stdout); return 0;
        default: good = false;
        }
        if (!good) {
            fputs(usage, stderr);
            return 2;
        }
    }
    outcome outcomes[SCENES];
    size_t count = 0;
    print_heading(&o);
    for (unsigned i = 0; i < SCENES; i++) {
        if (o.scenes != 0 && !(o.scenes >> i & 1)) continue;
        if (!measure(&o, &scenes[i], &outcomes[count])) return 1;
        print_outcome(&outcomes[count++]);
    }
    return o.json == NULL || write_json(o.json, outcomes, count, &o) ? 0 : 1;
}
