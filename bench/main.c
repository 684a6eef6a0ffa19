// SPDX-License-Identifier: MIT
// bench-rays: how fast Sagitta builds and traces, beside Embree in the same run, and who is right where they
// differ. This file reads the command line and goes through models, instruction sets, qualities, threads and
// sets of rays.
#include "bench.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: bench-rays [--mesh FILE]… [--threads N] [--json FILE] [OPTION]…\n"
    "Measures Sagitta beside Embree. Without --mesh, --terrain, --spheres: bunny, nefertiti and dragon of\n"
    "$SAGITTA_DATA/meshes where they are, a terrain of ten million triangles, a million spheres, a "
    "sphereflake.\n"
    "\n"
    "  --mesh FILE      a mesh, any format sagitta reads; may be given again\n"
    "  --terrain[=N]    a generated terrain of N triangles (10,000,000)\n"
    "  --spheres[=N]    N random spheres (1,000,000) and the sphereflake of 7,381\n"
    "  --threads N      measure one thread and N (default: all the machine has); 1: only one\n"
    "  --json FILE      write the results there\n"
    "  --sets A,B,…     of camera,bounce,shadow,chord (default: all; spheres: camera,chord)\n"
    "  --rays N         N × N pixels, and as many chords (1024); a multiple of 4\n"
    "  --repeats N      the median of so many (5)\n"
    "  --isa NAME       Sagitta's instruction set: portable, sse42, avx2, avx512, neon; may be given again\n"
    "  --quality NAME   of Sagitta's tree: fast, default, high; may be given again\n"
    "  --no-build       do not measure building\n"
    "  --no-embree      Sagitta alone\n"
    "  --plant          spoil some of Sagitta's answers before they are judged; the exit code says whether\n"
    "                   all of them, and no others, were found\n"
    "  --stages         count instead of measuring: how often each stage of the traversal runs, a ray\n"
    "  --quick          256 × 256 rays, one repeat, smaller generated models: does it work?\n"
    "\n"
    "Rays are given as floats to both. Speeds are millions a second. \"single\": a call a ray; \"batch\": "
    "one call\n"
    "for all; \"fast\", \"robust\": Embree's single rays without and with RTC_SCENE_FLAG_ROBUST; \"packet\": "
    "its\n"
    "packets of 16. An exact oracle settles every ray on which the answers differ; bench/README.md says "
    "more.\n";

enum { MOST = 16 };

typedef struct options {
    const char *meshes[MOST], *isas[MOST], *qualities[MOST];
    size_t mesh_count, isa_count, quality_count;
    const char *json;
    uint32_t threads, side, repeats, terrain, spheres;
    unsigned sets; // 0: all
    bool build, embree, plant, stages;
} options;

typedef struct bench {
    options o;
    report report;
    const peer *fast, *robust;
} bench;

// Sagitta's qualities that stand beside Embree's low, medium and high.
static const char *const beside[PEER_QUALITY_COUNT] = {"fast", "default", "high"};

static int by_seconds(const void *a, const void *b) {
    double x = ((const built *)a)->seconds, y = ((const built *)b)->seconds;
    return (x > y) - (x < y);
}

// Small models are built more often, so that each is the median of something.
static void measure_build(bench *b, const model *m, uint32_t threads) {
    enum { SMALL = 3 };
    size_t repeats = model_primitives(m) < 3000000 && b->o.repeats > 1 ? SMALL : 1;
    for (int q = 0; q < PEER_QUALITY_COUNT; q++) {
        build_result r = {.quality = beside[q], .threads = threads, .primitives = model_primitives(m)};
        memcpy(r.model, m->name, sizeof r.model);
        subject_options ours = {.isa = b->o.isas[0], .quality = r.quality, .threads = threads};
        built sagitta[SMALL] = {{0}}, embree[SMALL] = {{0}};
        for (size_t i = 0; i < repeats; i++) {
            subject s = subject_create(m, &ours, &sagitta[i]);
            subject_destroy(&s);
            if (b->o.embree) peer_destroy(peer_create(m, q, false, threads, &embree[i]));
        }
        qsort(sagitta, repeats, sizeof *sagitta, by_seconds);
        qsort(embree, repeats, sizeof *embree, by_seconds);
        r.sagitta = sagitta[repeats / 2];
        r.embree = embree[repeats / 2];
        report_add_build(&b->report, &r);
    }
}

static void measure_sets(bench *b, const model *m, ray_set sets[SET_COUNT], unsigned wanted, const char *isa,
                         const char *quality, uint32_t threads) {
    built ignored;
    subject s =
        subject_create(m, &(subject_options){.isa = isa, .quality = quality, .threads = threads}, &ignored);
    if (sets[0].rays == NULL) sets_make(sets, wanted, m, s.scene, b->o.side);
    if (!b->o.stages) print_set_heading(threads, sag_context_isa(s.context), quality);
    size_t first = b->report.result_count;
    for (int i = 0; i < SET_COUNT; i++) {
        if (sets[i].count == 0) continue;
        if (b->o.stages) {
            subject_run run;
            subject_run_init(&run, &s, &sets[i], 1);
            print_stages(&s, &sets[i], &run);
            subject_run_clear(&run);
            continue;
        }
        result r = {
            .set = sets[i].name, .quality = quality, .spheres = m->sphere_count > 0, .threads = threads};
        memcpy(r.model, m->name, sizeof r.model);
        snprintf(r.isa, sizeof r.isa, "%s", sag_context_isa(s.context));
        measure_set(&r, m, &sets[i], &s, b->fast, b->robust, b->o.repeats, b->o.plant);
        print_set(&r);
        report_add_result(&b->report, &r);
    }
    if (!b->o.stages) print_set_means(b->report.results + first, b->report.result_count - first);
    subject_destroy(&s);
}

static void measure_model(bench *b, const model *m) {
    bool balls = m->sphere_count > 0;
    printf("\n%s: %u %s\n", m->name, model_primitives(m), balls ? "spheres" : "triangles");
    fflush(stdout);
    uint32_t threads[2] = {1, b->o.threads};
    size_t counts = b->o.threads > 1 ? 2 : 1;
    if (b->o.build) {
        size_t first = b->report.build_count;
        for (size_t i = 0; i < counts; i++) measure_build(b, m, threads[i]);
        print_build(b->report.builds + first, b->report.build_count - first);
        fflush(stdout);
    }
    built ignored;
    peer *fast = b->o.embree ? peer_create(m, PEER_MEDIUM, false, b->o.threads, &ignored) : NULL;
    peer *robust = b->o.embree ? peer_create(m, PEER_MEDIUM, true, b->o.threads, &ignored) : NULL;
    b->fast = fast;
    b->robust = robust;
    unsigned wanted = b->o.sets != 0 ? b->o.sets
                      : balls        ? 1u << SET_CAMERA | 1u << SET_CHORD
                                     : (1u << SET_COUNT) - 1;
    ray_set sets[SET_COUNT] = {{0}}; // made when the first scene is there
    for (size_t i = 0; i < b->o.isa_count; i++)
        for (size_t q = 0; q < b->o.quality_count; q++)
            for (size_t t = 0; t < counts; t++)
                measure_sets(b, m, sets, wanted, b->o.isas[i], b->o.qualities[q], threads[t]);
    sets_free(sets);
    peer_destroy(robust);
    peer_destroy(fast);
}

static void measure_file(bench *b, const char *path, bool *failed) {
    model m;
    if (!model_load(&m, path)) {
        *failed = true;
        return;
    }
    measure_model(b, &m);
    model_free(&m);
}

static void measure_all(bench *b, bool *failed) {
    const options *o = &b->o;
    for (size_t i = 0; i < o->mesh_count; i++) measure_file(b, o->meshes[i], failed);
    bool everything = o->mesh_count == 0 && o->terrain == 0 && o->spheres == 0;
    const char *data = getenv("SAGITTA_DATA");
    static const char *const known[] = {"stanford-bunny.obj", "nefertiti.obj", "dragon.ply"};
    for (size_t i = 0; everything && i < sizeof known / sizeof *known; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/meshes/%s", data != NULL ? data : BENCH_DATA, known[i]);
        if (access(path, R_OK) == 0)
            measure_file(b, path, failed);
        else
            printf("\n%s is not there: passed over (set SAGITTA_DATA)\n", path);
    }
    model m;
    bool quick = o->repeats == 1 && o->side <= 256;
    if (everything || o->terrain > 0) {
        model_make_terrain(&m, o->terrain > 0 ? o->terrain : quick ? 200000 : 10000000);
        measure_model(b, &m);
        model_free(&m);
    }
    if (everything || o->spheres > 0) {
        model_make_random_spheres(&m, o->spheres > 0 ? o->spheres : quick ? 20000 : 1000000);
        measure_model(b, &m);
        model_free(&m);
        model_make_flake(&m, 4);
        measure_model(b, &m);
        model_free(&m);
    }
}

static unsigned sets_named(const char *list) {
    unsigned sets = 0;
    while (*list != 0) {
        size_t length = strcspn(list, ",");
        unsigned before = sets;
        for (int i = 0; i < SET_COUNT; i++)
            if (strlen(set_names[i]) == length && strncmp(set_names[i], list, length) == 0) sets |= 1u << i;
        if (sets == before) return 0;
        list += length + (list[length] == ',');
    }
    return sets;
}

// A whole number from 1 to `most`; 0: it is none.
static uint32_t number(const char *text, uint32_t most) {
    char *end;
    unsigned long long value = strtoull(text, &end, 10);
    return end != text && *end == 0 && *text != '-' && value <= most ? (uint32_t)value : 0;
}

static bool quality_named(const char *name, const char **list, size_t *count) {
    for (const char *const *q = subject_qualities; *q != NULL; q++) {
        if (strcmp(name, *q) == 0 && *count < MOST) return list[(*count)++] = *q, true;
    }
    return false;
}

enum {
    MESH = 1,
    TERRAIN,
    SPHERES,
    THREADS,
    JSON,
    SETS,
    RAYS,
    REPEATS,
    ISA,
    QUALITY,
    NO_BUILD,
    NO_EMBREE,
    PLANT,
    STAGES,
    QUICK,
    HELP
};

static const struct option long_options[] = {{"mesh", required_argument, NULL, MESH},
                                             {"terrain", optional_argument, NULL, TERRAIN},
                                             {"spheres", optional_argument, NULL, SPHERES},
                                             {"threads", required_argument, NULL, THREADS},
                                             {"json", required_argument, NULL, JSON},
                                             {"sets", required_argument, NULL, SETS},
                                             {"rays", required_argument, NULL, RAYS},
                                             {"repeats", required_argument, NULL, REPEATS},
                                             {"isa", required_argument, NULL, ISA},
                                             {"quality", required_argument, NULL, QUALITY},
                                             {"no-build", no_argument, NULL, NO_BUILD},
                                             {"no-embree", no_argument, NULL, NO_EMBREE},
                                             {"plant", no_argument, NULL, PLANT},
                                             {"stages", no_argument, NULL, STAGES},
                                             {"quick", no_argument, NULL, QUICK},
                                             {"help", no_argument, NULL, HELP},
                                             {0}};

// False: what the option says makes no sense.
static bool take(options *o, int option, const char *value) {
    switch (option) {
    case MESH: return o->mesh_count < MOST && (o->meshes[o->mesh_count++] = value) != NULL;
    case TERRAIN: return (o->terrain = value != NULL ? number(value, 1u << 30) : 10000000) > 0;
    case SPHERES: return (o->spheres = value != NULL ? number(value, 1u << 30) : 1000000) > 0;
    case THREADS: return (o->threads = number(value, 1024)) > 0;
    case JSON: return (o->json = value) != NULL;
    case SETS: return (o->sets = sets_named(value)) != 0;
    case RAYS: return (o->side = number(value, 8192)) > 0 && o->side % 4 == 0;
    case REPEATS: return (o->repeats = number(value, 101)) > 0;
    case ISA: return o->isa_count < MOST && (o->isas[o->isa_count++] = value) != NULL;
    case QUALITY: return quality_named(value, o->qualities, &o->quality_count);
    case NO_BUILD: return o->build = false, true;
    case NO_EMBREE: return o->embree = false, true;
    case PLANT: return o->plant = true;
    case STAGES: o->build = o->embree = false, o->threads = 1; return o->stages = true;
    case QUICK: return o->side = 256, o->repeats = 1, true;
    default: return false;
    }
}

int main(int argc, char **argv) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    bench b = {.o = {.threads = cores > 1 ? (uint32_t)cores : 1,
                     .side = 1024,
                     .repeats = 5,
                     .build = true,
                     .embree = peer_name() != NULL}};
    int option, which = 0;
    while ((option = getopt_long(argc, argv, "", long_options, &which)) != -1) {
        if (option == HELP) return fputs(usage, stdout) == EOF;
        if (take(&b.o, option, optarg)) continue;
        if (option != '?') // of what it does not know getopt has spoken
            fprintf(stderr, "bench-rays: --%s %s?\n", long_options[which].name, optarg ? optarg : "");
        fputs("bench-rays --help tells what can be asked for\n", stderr);
        return 2;
    }
    if (optind < argc) return fprintf(stderr, "bench-rays: %s? Files come after --mesh.\n", argv[optind]), 2;
    if (b.o.isa_count == 0) b.o.isas[b.o.isa_count++] = NULL;
    if (b.o.quality_count == 0) b.o.qualities[b.o.quality_count++] = subject_qualities[0];
    printf("Sagitta %s beside %s; millions of rays a second, the median of %u interleaved repeats\n",
           SAG_VERSION,
           peer_name() == NULL ? "nothing (Embree was not found when this was built)"
           : b.o.embree        ? peer_name()
                               : "nothing (--no-embree)",
           b.o.repeats);
    bool failed = false;
    measure_all(&b, &failed);
    if (!b.o.stages) print_summary(&b.report);
    if (b.o.json != NULL && !json_write(&b.report, b.o.json)) failed = true;
    for (size_t i = 0; i < b.report.result_count; i++)
        failed |= b.report.results[i].settled.sagitta_wrong != b.report.results[i].planted ||
                  b.report.results[i].batch_differs > 0;
    report_free(&b.report);
    return failed;
}
