// SPDX-License-Identifier: MIT
// sagitta measure: how much there is of each body in a file.
#include "measure.h"
#include "formats/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: sagitta measure FILE [OPTIONS]\n\n"
    "Measures every body in FILE (a pbrt-v4 scene or any mesh Assimp reads): volume, surface area, centre "
    "of mass,\n"
    "moments of inertia, wall thickness, bounds. A body is a closed mesh, a closed shape or a solid, at each "
    "place where\n"
    "it stands. Lengths are in the file's unit; moments are for density 1 unless --density says "
    "otherwise.\n\n"
    "      --error E        the relative error wanted where rays have to tell (default 1e-3)\n"
    "      --confidence C   how often the interval value +- error shall hold the truth (default 0.95)\n"
    "      --density D      mass of a unit of volume: gives masses, and moments of mass\n"
    "      --json FILE      everything as JSON; - is the standard output, in place of the text\n"
    "      --max-rays N     for each body, at which it is left at the error reached (default 100000000)\n"
    "      --no-thickness   saves the rays for it, the only ones that meshes and single shapes take\n"
    "      --sample         rays for everything, to check\n"
    "      --seed N         other rays; the same seed gives the same bits\n"
    "      --threads N      as many threads; 0, the default: one a core. The result does not depend on it\n"
    "  -q, --quiet          no progress, no warnings; errors only\n"
    "  -h, --help           this text\n\n"
    "Closed meshes and single shapes are measured exactly (to rounding), solids by rays with a confidence "
    "interval.\n"
    "Thickness is what is behind the surface, straight inward, at points spread evenly over it. What is not "
    "closed\n"
    "has an area and bounds, and it is said why.\n";

// ---------------------------------------------------------------------------------------------------------------
// names of meshes: the loader tells them when it adds a mesh, and the body has the mesh

typedef struct named_mesh {
    uint64_t hash;
    char name[MEASURE_NAME_BYTES / 2];
    const void *shape; // whose name it is; NULL: nobody's yet
} named_mesh;

typedef struct name_list {
    const char *file;
    named_mesh *meshes;
    size_t count, capacity;
} name_list;

// Of counts and of the first corners: enough to tell meshes of a file apart, and those that are not are told
// apart by their order.
static uint64_t hash_of(const sag_mesh *mesh) {
    uint64_t hash = (uint64_t)mesh->vertex_count << 32 ^ mesh->triangle_count;
    const uint32_t corners = mesh->triangle_count < 64 ? 3 * mesh->triangle_count : 192;
    for (uint32_t i = 0; i < corners; i++) {
        const size_t at = 3 * (size_t)mesh->triangles[i];
        for (size_t k = at; k < at + 3 && mesh->triangles[i] < mesh->vertex_count; k++) {
            const double x = mesh->positions_f64 ? mesh->positions_f64[k] : (double)mesh->positions_f32[k];
            uint64_t bits;
            memcpy(&bits, &x, sizeof bits);
            hash = (hash ^ bits ^ hash >> 29) * 0x9E3779B97F4A7C15u;
        }
    }
    return hash;
}

static void on_mesh(void *user, const char *name, const sag_mesh *mesh) {
    name_list *list = user;
    if (!name || !*name) return;
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 64;
        named_mesh *meshes = realloc(list->meshes, capacity * sizeof *meshes);
        if (!meshes) return; // one without a name, then
        list->meshes = meshes, list->capacity = capacity;
    }
    named_mesh *m = &list->meshes[list->count++];
    *m = (named_mesh){.hash = hash_of(mesh)};
    // A mesh without a name of its own is called like its file.
    const bool is_path = strcmp(name, list->file) == 0 || has_ending(name, ".ply");
    snprintf(m->name, sizeof m->name, "%s", is_path ? base_name(name) : name);
}

static const char *name_of(name_list *list, const sag_body *body) {
    if (body->kind != SAG_SHAPE_MESH || !list->count) return NULL;
    named_mesh *unclaimed = NULL;
    const uint64_t hash = hash_of(body->shape);
    for (size_t i = 0; i < list->count; i++) {
        named_mesh *m = &list->meshes[i];
        if (m->hash != hash) continue;
        if (m->shape == body->shape) return m->name;
        if (!m->shape && !unclaimed) unclaimed = m;
    }
    if (!unclaimed) return NULL;
    unclaimed->shape = body->shape;
    return unclaimed->name;
}

// ---------------------------------------------------------------------------------------------------------------

typedef struct measure_options {
    const char *file, *json;
    double density;
    uint64_t threads;
    bool quiet;
    sag_measure_options how;
} measure_options;

static bool on_progress(void *user, const sag_measure_progress *p) {
    progress_update(user, ((double)p->body + p->fraction) / (double)p->body_count, (double)p->rays);
    return !interrupt_flag;
}

// Whether the file can be written is known before the work is done.
static sag_status check_json(const char *path, sag_error *error) {
    if (!path || strcmp(path, "-") == 0) return SAG_OK;
    sagi_output output;
    const sag_status status = sagi_output_open(&output, path, error);
    if (status == SAG_OK) sagi_output_discard(&output);
    return status;
}

static sag_status report(const measure_options *o, sag_world *world, name_list *names, double load_seconds,
                         sag_error *error) {
    progress bar;
    progress_begin(&bar, "measuring", "rays", o->quiet);
    sag_measure_options how = o->how;
    how.progress = on_progress, how.user = &bar;
    sag_measurement m;
    const double start = clock_seconds();
    interrupt_catch();
    sag_status status = sag_measure(sag_world_scene(world), &how, &m, error);
    progress_end(&bar);
    if (status != SAG_OK) return status;
    measure_report r = {.file = o->file,
                        .json = o->json,
                        .context = sag_world_context(world),
                        .measurement = &m,
                        .names = calloc(m.body_count ? m.body_count : 1, sizeof *r.names),
                        .error = o->how.error,
                        .confidence = o->how.confidence,
                        .density = o->density,
                        .seed = o->how.seed,
                        .load_seconds = load_seconds,
                        .seconds = clock_seconds() - start};
    if (!r.names) status = sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    for (size_t i = 0; i < m.body_count && r.names; i++) r.names[i] = name_of(names, &m.bodies[i]);
    if (status == SAG_OK && o->json) status = measure_write_json(&r, error);
    if (status == SAG_OK && (!o->json || strcmp(o->json, "-") != 0)) measure_print(&r);
    free(r.names);
    sag_measurement_clear(&m);
    return status;
}

static int measure_file(const measure_options *o) {
    sag_context *context = session_open(o->threads, o->quiet);
    if (!context) return TOOL_FAILED;
    name_list names = {.file = o->file};
    sag_error error = {0};
    sag_status status = check_json(o->json, &error);
    const double start = clock_seconds();
    sag_world *world = NULL;
    if (status == SAG_OK) {
        world = session_load(context, o->file, o->quiet, on_mesh, &names, &error);
        status = error.status;
    }
    if (world) status = report(o, world, &names, clock_seconds() - start, &error);
    sag_world_destroy(world);
    free(names.meshes);
    const int result = status == SAG_OK ? TOOL_OK : report_error(&error);
    session_close(context);
    return result;
}

static int run(const tool_command *command, int argc, char **argv) {
    measure_options o = {.how = {.error = 1e-3, .confidence = 0.95}};
    const option options[] = {
        {.name = "error", .kind = OPTION_NUMBER, .target = &o.how.error, .least = 0, .most = 1},
        {.name = "confidence", .kind = OPTION_NUMBER, .target = &o.how.confidence, .least = 0, .most = 1},
        {.name = "density", .kind = OPTION_NUMBER, .target = &o.density, .least = 0, .most = INFINITY},
        {.name = "json", .kind = OPTION_TEXT, .target = &o.json},
        {.name = "max-rays",
         .kind = OPTION_COUNT,
         .target = &o.how.max_rays,
         .minimum = 1,
         .maximum = (uint64_t)1 << 52},
        {.name = "no-thickness", .kind = OPTION_FLAG, .target = &o.how.no_thickness},
        {.name = "sample", .kind = OPTION_FLAG, .target = &o.how.sample_all},
        {.name = "seed", .kind = OPTION_COUNT, .target = &o.how.seed, .minimum = 0, .maximum = UINT64_MAX},
        {.name = "threads", .kind = OPTION_COUNT, .target = &o.threads, .minimum = 0, .maximum = 4096},
        {.name = "quiet", .letter = 'q', .kind = OPTION_FLAG, .target = &o.quiet},
    };
    const int count = options_parse(command, options, sizeof options / sizeof *options, argc, argv);
    if (count == -2) return TOOL_OK;
    if (count < 0) return TOOL_USAGE;
    if (count == 0) return usage_error(command->name, "which file?");
    if (count > 1) return usage_error(command->name, "one file at a time: '%s' is too much", argv[1]);
    o.file = argv[0];
    const int result = measure_file(&o);
    const int written = close_stdout();
    return result == TOOL_OK ? written : result;
}

const tool_command tool_measure = {"measure", "measure volume, area, moments and thickness of each body",
                                   help, run};
