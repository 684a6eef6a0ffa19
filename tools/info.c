// SPDX-License-Identifier: MIT
// sagitta info: what is in a file, and what is wrong with it. Without a file: what this program is.
#include "info_solids.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] = "usage: sagitta info [FILE] [OPTIONS]\n\n"
                           "Says what is in FILE (a pbrt-v4 scene or any mesh Assimp reads): how many "
                           "geometries of each kind, triangles and\n"
                           "vertices, the bounding box, memory, times; for each mesh whether it is closed, "
                           "and what is wrong with it. Without\n"
                           "FILE: version, instruction set and threads.\n\n"
                           "      --json           the same as JSON on the standard output\n"
                           "      --threads N      as many threads; 0, the default: one a core\n"
                           "  -q, --quiet          no warnings of the loader\n"
                           "  -h, --help           this text\n\n"
                           "A mesh is closed when each of its edges has exactly two triangles that run "
                           "through it in opposite directions;\n"
                           "equal positions count as one vertex. Only then are inside and outside defined.\n";

#define MAX_NAME       48
#define MESHES_SHOWN   30
#define WARNINGS_SHOWN 20
#define KIND_COUNT     (SAG_SHAPE_INSTANCE + 1)

typedef struct mesh_info {
    char name[MAX_NAME];
    uint32_t vertex_count;
    bool has_normals, has_texcoords, is_double;
    sag_mesh_report report;
} mesh_info;

typedef struct info {
    const char *file;
    sag_context *context;
    mesh_info *meshes;
    size_t mesh_count, capacity;
    uint64_t triangle_count, vertex_count;
    uint64_t not_finite_count, degenerate_count, duplicate_count, open_count;
    uint64_t kinds[KIND_COUNT];
    uint32_t object_count; // scenes that instances place
    solids solids;         // those of them that are solids
    sag_scene_stats stats;
    double load_seconds, check_seconds;
    bool out_of_memory;
} info;

static void on_mesh(void *user, const char *name, const sag_mesh *mesh) {
    info *n = user;
    const double start = clock_seconds();
    if (n->mesh_count == n->capacity) {
        const size_t capacity = n->capacity ? 2 * n->capacity : 64;
        mesh_info *meshes = realloc(n->meshes, capacity * sizeof *meshes);
        if (!meshes) {
            n->out_of_memory = true;
            return;
        }
        n->meshes = meshes;
        n->capacity = capacity;
    }
    mesh_info *m = &n->meshes[n->mesh_count];
    *m = (mesh_info){.vertex_count = mesh->vertex_count,
                     .has_normals = mesh->normals_f32 != NULL,
                     .has_texcoords = mesh->texcoords_f32 != NULL,
                     .is_double = mesh->positions_f64 != NULL};
    // A mesh without a name of its own is called like its file.
    const bool is_path = name && strcmp(name, n->file) == 0;
    snprintf(m->name, sizeof m->name, "%s", is_path ? base_name(name) : name && *name ? name : "(no name)");
    // A mesh that cannot be examined is refused when it is added; the message is the loader's.
    if (sag_mesh_check(n->context, mesh, &m->report, NULL) != SAG_OK) return;
    n->mesh_count++;
    n->triangle_count += m->report.triangle_count;
    n->vertex_count += m->vertex_count;
    n->not_finite_count += m->report.not_finite_count;
    n->degenerate_count += m->report.degenerate_count;
    n->duplicate_count += m->report.duplicate_count;
    n->open_count += !m->report.closed;
    n->check_seconds += clock_seconds() - start;
}

static void count_kinds(info *n, const sag_scene *scene, uint32_t geometry_count) {
    for (uint32_t i = 0, found = 0; found < geometry_count && i < SAG_INVALID_ID; i++) {
        sag_shape_kind kind;
        if (sag_geometry_get(scene, i, &kind, NULL) != SAG_OK) continue;
        n->kinds[kind]++;
        found++;
    }
}

// Adds the objects, which the scene's instances place, to the scene's own counts and sizes.
static void add_objects(info *n, const sag_world *world) {
    const sag_scene *object;
    for (; (object = sag_world_object(world, n->object_count)) != NULL; n->object_count++) {
        sag_scene_stats s;
        sag_scene_get_stats(object, &s);
        count_kinds(n, object, s.geometry_count);
        n->stats.geometry_count += s.geometry_count;
        n->stats.primitive_count += s.primitive_count;
        n->stats.node_count += s.node_count;
        n->stats.leaf_count += s.leaf_count;
        n->stats.geometry_bytes += s.geometry_bytes;
        n->stats.structure_bytes += s.structure_bytes;
        n->stats.build_seconds += s.build_seconds;
        if (s.depth > n->stats.depth) n->stats.depth = s.depth;
        solids_add(&n->solids, object);
    }
    n->out_of_memory |= n->solids.out_of_memory;
}

// ---------------------------------------------------------------------------------------------------------------
// for people

static const char *plural(uint64_t count) { return count == 1 ? "" : "s"; }

static void print_axis(const char *label, const char *axis, double low, double high) {
    printf("  %-14s %s %15.9g to %-15.9g (%.6g)\n", label, axis, low, high, high - low);
}

static void print_summary(const info *n) {
    char a[TEXT_BYTES], b[TEXT_BYTES], c[TEXT_BYTES];
    const sag_scene_stats *s = &n->stats;
    printf("%s\n", n->file);
    printf("  %-14s %s", "geometries", text_count(a, s->geometry_count));
    const char *separator = ": ";
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        if (n->kinds[kind] == 0) continue;
        printf("%s%s %s", separator, text_count(a, n->kinds[kind]),
               sag_shape_kind_name((sag_shape_kind)kind));
        separator = ", ";
    }
    const uint64_t objects = n->object_count - n->solids.count;
    if (objects) printf("; %s object%s placed by instances", text_count(a, objects), plural(objects));
    printf("\n  %-14s %s\n", "primitives", text_count(a, s->primitive_count));
    if (n->mesh_count) {
        printf("  %-14s %s in %s mesh%s, %s vertices\n", "triangles", text_count(a, n->triangle_count),
               text_count(b, n->mesh_count), n->mesh_count == 1 ? "" : "es", text_count(c, n->vertex_count));
    }
    solids_print_summary(&n->solids);
    if (sag_box3_is_empty(&s->bounds)) {
        printf("  %-14s none\n", "bounds");
    } else {
        print_axis("bounds", "x", s->bounds.min.x, s->bounds.max.x);
        print_axis("", "y", s->bounds.min.y, s->bounds.max.y);
        print_axis("", "z", s->bounds.min.z, s->bounds.max.z);
    }
    printf("  %-14s %s: shapes %s, tree %s", "memory", text_bytes(a, s->geometry_bytes + s->structure_bytes),
           text_bytes(b, s->geometry_bytes), text_bytes(c, s->structure_bytes));
    if (n->triangle_count) {
        printf("; %.0f bytes a triangle",
               (double)(s->geometry_bytes + s->structure_bytes) / (double)n->triangle_count);
    }
    printf("\n  %-14s %s nodes, %s leaves, depth %u\n", "tree", text_count(a, s->node_count),
           text_count(b, s->leaf_count), s->depth);
    printf("  %-14s load %s, build %s\n", "time", text_seconds(a, n->load_seconds),
           text_seconds(b, s->build_seconds));
    printf("  %-14s %s on %u thread%s\n", "runs on", sag_context_isa(n->context),
           sag_context_thread_count(n->context), plural(sag_context_thread_count(n->context)));
}

static int by_triangles(const void *a, const void *b) {
    const mesh_info *x = a, *y = b;
    if (x->report.triangle_count != y->report.triangle_count) {
        return x->report.triangle_count > y->report.triangle_count ? -1 : 1;
    }
    return strcmp(x->name, y->name);
}

static void print_meshes(const info *n) {
    if (n->mesh_count == 0) return;
    char a[TEXT_BYTES], b[TEXT_BYTES], c[TEXT_BYTES];
    printf("\n  %-32s %12s %12s  %-7s %10s\n", "mesh", "triangles", "vertices", "closed", "open edges");
    for (size_t i = 0; i < n->mesh_count && i < MESHES_SHOWN; i++) {
        const mesh_info *m = &n->meshes[i];
        printf("  %-32.32s %12s %12s  %-7s %10s\n", m->name, text_count(a, m->report.triangle_count),
               text_count(b, m->vertex_count), m->report.closed ? "yes" : "no",
               text_count(c, m->report.open_edge_count));
    }
    if (n->mesh_count > MESHES_SHOWN) {
        printf("  ... and %s smaller ones (--json lists all)\n", text_count(a, n->mesh_count - MESHES_SHOWN));
    }
}

// One line for each thing that is wrong with a mesh. Returns how many there are; prints those that still fit.
static int print_warnings_of(const mesh_info *m, int room) {
    char a[TEXT_BYTES];
    const sag_mesh_report *r = &m->report;
    const struct {
        uint32_t count;
        const char *what;
    } issues[] = {
        {r->not_finite_count, "with a vertex that is NaN, infinite or too large: dropped"},
        {r->degenerate_count, "without area: dropped"},
        {r->duplicate_count, "over the same three positions as another"},
    };
    int found = 0;
    for (size_t i = 0; i < sizeof issues / sizeof *issues; i++) {
        if (issues[i].count == 0 || found++ >= room) continue;
        printf("  %s: %s triangle%s %s\n", m->name, text_count(a, issues[i].count), plural(issues[i].count),
               issues[i].what);
    }
    if (r->crowded_edge_count && found++ < room) {
        printf("  %s: %s edge%s with more than two triangles\n", m->name,
               text_count(a, r->crowded_edge_count), plural(r->crowded_edge_count));
    }
    if (r->flipped_edge_count && found++ < room) {
        printf("  %s: %s edge%s whose two triangles face opposite ways\n", m->name,
               text_count(a, r->flipped_edge_count), plural(r->flipped_edge_count));
    }
    if (r->open_edge_count && found++ < room) {
        printf("  %s: %s open edge%s, one between the vertices %u and %u\n", m->name,
               text_count(a, r->open_edge_count), plural(r->open_edge_count), r->open_edge[0],
               r->open_edge[1]);
    }
    return found;
}

static void print_warnings(const info *n) {
    int found = 0;
    for (size_t i = 0; i < n->mesh_count; i++) {
        const sag_mesh_report *r = &n->meshes[i].report;
        const bool any = r->not_finite_count || r->degenerate_count || r->duplicate_count ||
                         r->open_edge_count || r->crowded_edge_count || r->flipped_edge_count;
        if (any && found == 0) printf("\nwarnings\n");
        if (any) found += print_warnings_of(&n->meshes[i], WARNINGS_SHOWN - found);
    }
    if (found > WARNINGS_SHOWN) printf("  ... and %d more (--json has all)\n", found - WARNINGS_SHOWN);
}

// ---------------------------------------------------------------------------------------------------------------
// for programs

static void add_number(cJSON *object, const char *name, double value) {
    cJSON_AddNumberToObject(object, name, value);
}

static void add_point(cJSON *object, const char *name, sag_vec3 p) {
    const double numbers[3] = {p.x, p.y, p.z};
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(numbers, 3));
}

static void add_platform(cJSON *json, const sag_context *context) {
    cJSON_AddStringToObject(json, "version", SAG_VERSION);
    cJSON_AddStringToObject(json, "isa", sag_context_isa(context));
    add_number(json, "threads", sag_context_thread_count(context));
}

static cJSON *mesh_to_json(const mesh_info *m) {
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "name", m->name);
    add_number(json, "triangles", m->report.triangle_count);
    add_number(json, "vertices", m->vertex_count);
    cJSON_AddBoolToObject(json, "double_precision", m->is_double);
    cJSON_AddBoolToObject(json, "normals", m->has_normals);
    cJSON_AddBoolToObject(json, "texture_coordinates", m->has_texcoords);
    cJSON_AddBoolToObject(json, "closed", m->report.closed);
    add_number(json, "open_edges", m->report.open_edge_count);
    add_number(json, "crowded_edges", m->report.crowded_edge_count);
    add_number(json, "flipped_edges", m->report.flipped_edge_count);
    add_number(json, "not_finite", m->report.not_finite_count);
    add_number(json, "degenerate", m->report.degenerate_count);
    add_number(json, "duplicate", m->report.duplicate_count);
    return json;
}

static int print_json(cJSON *json) {
    char *text = cJSON_Print(json);
    cJSON_Delete(json);
    if (!text) return report_failure("out of memory");
    puts(text);
    cJSON_free(text);
    return TOOL_OK;
}

static int info_to_json(const info *n) {
    const sag_scene_stats *s = &n->stats;
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "file", n->file);
    add_platform(json, n->context);
    add_number(json, "load_seconds", n->load_seconds);
    add_number(json, "build_seconds", s->build_seconds);
    add_number(json, "geometries", s->geometry_count);
    cJSON *kinds = cJSON_AddObjectToObject(json, "kinds");
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        if (n->kinds[kind])
            add_number(kinds, sag_shape_kind_name((sag_shape_kind)kind), (double)n->kinds[kind]);
    }
    add_number(json, "objects", (double)(n->object_count - n->solids.count));
    add_number(json, "instances", (double)n->kinds[SAG_SHAPE_INSTANCE]);
    add_number(json, "primitives", (double)s->primitive_count);
    add_number(json, "triangles", (double)n->triangle_count);
    add_number(json, "vertices", (double)n->vertex_count);
    cJSON *bounds = cJSON_AddObjectToObject(json, "bounds");
    add_point(bounds, "min", s->bounds.min); // cJSON writes what is infinite as null
    add_point(bounds, "max", s->bounds.max);
    add_number(json, "geometry_bytes", (double)s->geometry_bytes);
    add_number(json, "structure_bytes", (double)s->structure_bytes);
    add_number(json, "nodes", (double)s->node_count);
    add_number(json, "leaves", (double)s->leaf_count);
    add_number(json, "depth", s->depth);
    add_number(json, "not_finite", (double)n->not_finite_count);
    add_number(json, "degenerate", (double)n->degenerate_count);
    add_number(json, "duplicate", (double)n->duplicate_count);
    add_number(json, "not_closed", (double)n->open_count);
    cJSON *meshes = cJSON_AddArrayToObject(json, "meshes");
    for (size_t i = 0; i < n->mesh_count; i++) cJSON_AddItemToArray(meshes, mesh_to_json(&n->meshes[i]));
    solids_to_json(&n->solids, json);
    return print_json(json);
}

// ---------------------------------------------------------------------------------------------------------------

static int describe_program(sag_context *context, bool as_json) {
    if (as_json) {
        cJSON *json = cJSON_CreateObject();
        add_platform(json, context);
        return print_json(json);
    }
    printf("sagitta " SAG_VERSION "\n");
    printf("  %-14s %s (SAG_ISA chooses another)\n", "runs on", sag_context_isa(context));
    printf("  %-14s %u\n", "threads", sag_context_thread_count(context));
    printf("  %-14s pbrt-v4 scenes; meshes by Assimp: OBJ, PLY, STL, glTF, FBX, ...\n", "reads");
    printf("  %-14s PNG, PFM, EXR; hits as CSV and NumPy .npy\n", "writes");
    return TOOL_OK;
}

static sag_status load(info *n, sag_world *world, sag_error *error) {
    const double start = clock_seconds();
    sag_status status = sag_world_load_geometry(world, n->file, on_mesh, n, error);
    n->load_seconds = clock_seconds() - start - n->check_seconds;
    if (status == SAG_OK) status = sag_scene_commit(sag_world_scene(world), error);
    if (status != SAG_OK) return status;
    sag_scene_get_stats(sag_world_scene(world), &n->stats);
    n->stats.bounds = sag_scene_bounds(sag_world_scene(world)); // infinite with a plane in it
    count_kinds(n, sag_world_scene(world), n->stats.geometry_count);
    add_objects(n, world);
    return n->out_of_memory ? sag_error_set(error, SAG_ERROR_MEMORY, "out of memory") : SAG_OK;
}

static int describe_file(info *n, bool as_json, bool quiet) {
    progress bar;
    progress_begin(&bar, "loading", "", quiet);
    progress_note(&bar, "loading ...");
    sag_error error = {0};
    sag_world *world = sag_world_create(n->context);
    sag_status status =
        world ? load(n, world, &error) : sag_error_set(&error, SAG_ERROR_MEMORY, "out of memory");
    progress_end(&bar);
    int result = status == SAG_OK ? TOOL_OK : report_error(&error);
    if (status == SAG_OK && as_json) result = info_to_json(n);
    if (status == SAG_OK && !as_json) {
        if (n->mesh_count) qsort(n->meshes, n->mesh_count, sizeof *n->meshes, by_triangles);
        print_summary(n);
        solids_print(&n->solids);
        print_meshes(n);
        print_warnings(n);
    }
    sag_world_destroy(world);
    free(n->meshes);
    solids_clear(&n->solids);
    return result;
}

static int run(const tool_command *command, int argc, char **argv) {
    bool as_json = false, quiet = false;
    uint64_t threads = 0;
    const option options[] = {
        {.name = "json", .kind = OPTION_FLAG, .target = &as_json},
        {.name = "threads", .kind = OPTION_COUNT, .target = &threads, .minimum = 0, .maximum = 4096},
        {.name = "quiet", .letter = 'q', .kind = OPTION_FLAG, .target = &quiet},
    };
    const int count = options_parse(command, options, sizeof options / sizeof *options, argc, argv);
    if (count == -2) return TOOL_OK;
    if (count < 0) return TOOL_USAGE;
    if (count > 1) return usage_error(command->name, "one file at a time: '%s' is too much", argv[1]);
    info n = {.context = session_open(threads, quiet)};
    if (!n.context) return TOOL_FAILED;
    n.file = count == 1 ? argv[0] : NULL;
    int result = n.file ? describe_file(&n, as_json, quiet) : describe_program(n.context, as_json);
    session_close(n.context);
    const int written = close_stdout();
    return result == TOOL_OK ? written : result;
}

const tool_command tool_info = {"info", "say what is in a file, and what is wrong with it", help, run};
