// SPDX-License-Identifier: MIT
// bench-solids: how fast Sagitta traces solids and exact shapes beside POV-Ray, and whether both see the
// same. This file reads the command line and goes through the scenes.
#include "solids.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: bench-solids [OPTION]…\n"
    "Renders three scenes with POV-Ray (where the program povray is found) and with "
    "Sagitta, one thread each,\n"
    "in turns, and tells how many camera rays each traces in a second.\n"
    "\n"
    "  --scene NAME     dice, flake, shapes or carving (a mesh with balls cut out); may be given again "
    "(all)\n"
    "  --size WxH       of the pictures (2400x1800)\n"
    "  --repeats N      the median of so many (5)\n"
    "  --compare        compare the depth images; the exit code is 1 where 0.1 % of "
    "the pixels differ by more\n"
    "                   than 2/255 away from silhouettes\n"
    "  --folder DIR     keep scenes and pictures there\n"
    "  --no-povray      Sagitta alone\n"
    "  --mesh FILE      the mesh to carve ($SAGITTA_DATA/meshes/dragon.ply); it must be closed\n"
    "  --json FILE      write the results there\n"
    "\n"
    "bench/README.md says what is traced and how it is timed.\n";

enum { SCENES = 3, MOST_REPEATS = 101 };
static const scene_kind *const kinds[SCENES] = {&scene_dice, &scene_flake, &scene_shapes};

typedef struct options {
    const char *folder, *json, *mesh;
    size film;
    unsigned repeats, scenes; // scenes: bits, CARVED's the last; 0: all
    bool compare, povray;
} options;

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Millions of rays a second, from the median.
static double speed(double seconds[], unsigned count, size film) {
    qsort(seconds, count, sizeof *seconds, by_size);
    const double median = (seconds[count / 2] + seconds[(count - 1) / 2]) / 2;
    return median > 0 ? (double)film.width * film.height / 1e6 / median : 0;
}

static bool measure(const options *o, const scene_kind *kind, outcome *result) {
    double povray[MOST_REPEATS], sagitta[MOST_REPEATS];
    char of_povray[4096], of_sagitta[4096];
    snprintf(of_povray, sizeof of_povray, "%s/%s.ppm", o->folder, kind->name);
    snprintf(of_sagitta, sizeof of_sagitta, "%s/%s.pfm", o->folder, kind->name);
    *result = (outcome){.kind = kind, .film = o->film};
    if (!scene_write(kind, o->folder, o->film)) return false;
    bool good = true;
    for (unsigned i = 0; i < o->repeats && good; i++) {
        povray[i] = o->povray ? run_povray(o->folder, kind, o->film, 1, NULL) : 0;
        sagitta[i] = run_sagitta(o->folder, kind, of_sagitta);
        good = sagitta[i] > 0 && (povray[i] > 0 || !o->povray);
    }
    if (!good) return false;
    if (o->povray) result->povray = speed(povray, o->repeats, o->film);
    result->sagitta = speed(sagitta, o->repeats, o->film);
    if (!o->compare || !o->povray) return true;
    result->compared = run_povray(o->folder, kind, o->film, 9, of_povray) > 0 &&
                       compare_depths(kind, of_povray, of_sagitta, &result->likeness);
    return result->compared && result->likeness.differing * 1000 < result->likeness.pixels;
}

static void forget(const char *folder) {
    static const char *const endings[] = {"pov",        "pbrt",        "ppm",         "pfm",
                                          "povray.log", "sagitta.log", "sagitta.json"};
    for (size_t i = 0; i < SCENES; i++)
        for (size_t k = 0; k < sizeof endings / sizeof *endings; k++) {
            char path[4096];
            snprintf(path, sizeof path, "%s/%s.%s", folder, kinds[i]->name, endings[k]);
            remove(path);
        }
    rmdir(folder);
}

// A whole number from 1 to `most`; 0: it is none.
static unsigned number(const char *text, unsigned most, char end) {
    char *rest;
    const unsigned long value = strtoul(text, &rest, 10);
    return rest != text && *rest == end && *text != '-' && value <= most ? (unsigned)value : 0;
}

static bool scene_named(options *o, const char *name) {
    for (unsigned i = 0; i < SCENES; i++)
        if (strcmp(name, kinds[i]->name) == 0) return o->scenes |= 1U << i;
    if (strcmp(name, "carving") == 0) return o->scenes |= 1U << SCENES;
    return false;
}

static bool size_named(options *o, const char *text) {
    const char *x = strchr(text, 'x');
    o->film = (size){number(text, 16384, 'x'), x != NULL ? number(x + 1, 16384, 0) : 0};
    return o->film.width > 0 && o->film.height > 0;
}

enum { SCENE = 1, SIZE, REPEATS, COMPARE, FOLDER, NO_POVRAY, MESH, JSON, HELP };

static const struct option long_options[] = {{"scene", required_argument, NULL, SCENE},
                                             {"size", required_argument, NULL, SIZE},
                                             {"repeats", required_argument, NULL, REPEATS},
                                             {"compare", no_argument, NULL, COMPARE},
                                             {"folder", required_argument, NULL, FOLDER},
                                             {"no-povray", no_argument, NULL, NO_POVRAY},
                                             {"mesh", required_argument, NULL, MESH},
                                             {"json", required_argument, NULL, JSON},
                                             {"help", no_argument, NULL, HELP},
                                             {0}};

// False: what the option says makes no sense.
static bool take(options *o, int option, const char *value) {
    switch (option) {
    case SCENE: return scene_named(o, value);
    case SIZE: return size_named(o, value);
    case REPEATS: return (o->repeats = number(value, MOST_REPEATS, 0)) > 0;
    case COMPARE: return o->compare = true;
    case FOLDER: return (o->folder = value) != NULL;
    case MESH: return (o->mesh = value) != NULL;
    case NO_POVRAY: return !(o->povray = false);
    case JSON: return (o->json = value) != NULL;
    default: return false;
    }
}

static bool carve(const options *o, carving carvings[CARVINGS]) {
    char path[4096];
    const char *data = getenv("SAGITTA_DATA");
    snprintf(path, sizeof path, "%s/meshes/dragon.ply", data != NULL ? data : BENCH_DATA);
    if (o->mesh != NULL) snprintf(path, sizeof path, "%s", o->mesh);
    if (access(path, R_OK) != 0)
        return printf("\n  %s is not there: nothing to carve (set SAGITTA_DATA)\n", path) > 0;
    const char *slash = strrchr(path, '/');
    if (!measure_carving(path, 1024, o->repeats, carvings)) return false;
    print_carvings(slash != NULL ? slash + 1 : path, carvings);
    return true;
}

int main(int argc, char **argv) {
    options o = {.film = {2400, 1800}, .repeats = 5, .povray = true};
    int option, which = 0;
    while ((option = getopt_long(argc, argv, "", long_options, &which)) != -1) {
        if (option == HELP) return fputs(usage, stdout) == EOF;
        if (take(&o, option, optarg)) continue;
        if (option != '?') // of what it does not know getopt has spoken
            fprintf(stderr, "bench-solids: --%s %s?\n", long_options[which].name, optarg ? optarg : "");
        fputs("bench-solids --help tells what can be asked for\n", stderr);
        return 2;
    }
    if (optind < argc) return fprintf(stderr, "bench-solids: %s?\n", argv[optind]), 2;
    char version[64] = "nothing (--no-povray)", temporary[] = "/tmp/bench-solids-XXXXXX";
    if (o.povray && !povray_found(version)) {
        o.povray = false;
        snprintf(version, sizeof version, "nothing (povray was not found; Debian: povray)");
    }
    const bool temporarily = o.folder == NULL;
    if (temporarily && (o.folder = mkdtemp(temporary)) == NULL)
        return fprintf(stderr, "bench-solids: no folder in /tmp\n"), 1;
    printf("Sagitta beside %s; one thread, the median of %u interleaved repeats\n", version, o.repeats);
    print_heading();
    outcome outcomes[SCENES];
    carving carvings[CARVINGS] = {{0}};
    size_t count = 0;
    bool failed = false;
    for (unsigned i = 0; i < SCENES; i++) {
        if (o.scenes != 0 && (o.scenes >> i & 1) == 0) continue;
        failed |= !measure(&o, kinds[i], &outcomes[count]);
        print_outcome(&outcomes[count++]);
    }
    if (o.scenes == 0 || (o.scenes >> SCENES & 1) != 0) failed |= !carve(&o, carvings);
    if (o.json != NULL) failed |= !write_json(o.json, o.povray ? version : NULL, outcomes, count, carvings);
    if (temporarily && !failed) forget(o.folder);
    return failed;
}
