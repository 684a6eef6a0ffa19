// SPDX-License-Identifier: MIT
// bench-solids: what its files share. Three scenes, each written for POV-Ray and for Sagitta (scenes.c,
// dice.c, flake.c, shapes.c); both programs render them in turns (race.c); their depth images are compared
// (compare.c); a mesh with spheres cut out of it is measured beside the mesh alone (carve.c).
#ifndef BENCH_SOLIDS_SOLIDS_H
#define BENCH_SOLIDS_SOLIDS_H

#include <sagitta/math.h>
#include <stdio.h>

typedef struct size {
    unsigned width, height;
} size;

// ---- scenes.c: the two files of a scene, and what all scenes have in common.
typedef struct scene_files {
    FILE *pov, *pbrt;
} scene_files;

// From where a scene is seen, and the depths that become white and black.
typedef struct view {
    sag_vec3 eye, target, up;
    double fov_rad; // of the picture's height, which is its shorter side
    double near, far;
} view;

typedef struct scene_kind {
    const char *name, *title;
    view view;
    void (*write)(scene_files *files);
} scene_kind;

extern const scene_kind scene_dice, scene_flake, scene_shapes;

// Writes FOLDER/NAME.pov and FOLDER/NAME.pbrt. False, with a message, when that fails.
bool scene_write(const scene_kind *kind, const char *folder, size film);
// The twelve numbers of a map with the bottom row between them or without it: "a b c 0  d e f 0 …". Both
// languages write the images of the axes first, the translation last.
void write_matrix_pov(FILE *file, const sag_affine *map);
void write_matrix_pbrt(FILE *file, const sag_affine *map);
// A rotation that follows from the number alone, then the translation.
sag_affine tumbled(unsigned number, sag_vec3 to);

// ---- race.c: the two programs. Seconds of tracing alone; 0, with a message: it did not work.
bool povray_found(char version[64]);
// `quality`: of +Q. Without a picture nothing is written.
double run_povray(const char *folder, const scene_kind *kind, size film, int quality, const char *picture);
double run_sagitta(const char *folder, const scene_kind *kind, const char *picture);

// ---- compare.c
typedef struct likeness {
    size_t pixels, met;        // met: Sagitta sees something there
    size_t silhouettes;        // passed over
    size_t differing;          // by more than 2/255, away from silhouettes
    size_t differing_anywhere; // silhouettes as well
    double mean;               // difference of the pixels that both see, away from silhouettes, in 1/65535
} likeness;

bool compare_depths(const scene_kind *kind, const char *of_povray, const char *of_sagitta, likeness *l);

// ---- tables.c: what is shown and kept.
typedef struct outcome {
    const scene_kind *kind;
    size film;
    double povray, sagitta; // millions of rays a second; 0: not measured
    bool compared;
    likeness likeness;
} outcome;

// ---- carve.c: rays from a camera, and chords.
typedef struct carving {
    const char *set;
    double mesh[2], solid[2]; // millions of rays a second: single calls, batch; 0: not measured
    size_t rays, met;
} carving;

enum { CARVINGS = 2 };
// side × side pixels and as many chords. False, with a message: it cannot be done with this mesh.
bool measure_carving(const char *path, unsigned side, unsigned repeats, carving carvings[CARVINGS]);

void print_heading(void);
void print_outcome(const outcome *o);
void print_carvings(const char *mesh, const carving carvings[CARVINGS]);
bool write_json(const char *path, const char *povray, const outcome *outcomes, size_t count,
                const carving carvings[CARVINGS]);

#endif
