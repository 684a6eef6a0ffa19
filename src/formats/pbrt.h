// SPDX-License-Identifier: MIT
// The reader of pbrt-v4 scenes, in the order a scene goes through it: pbrt_text (tokens, parameters),
// pbrt_load (files, directives, blocks, transforms), pbrt_settings (camera, film …), pbrt_look (textures,
// materials), pbrt_light, pbrt_shape.
#ifndef SAGI_FORMATS_PBRT_H
#define SAGI_FORMATS_PBRT_H

#include "formats/load.h"
#include "formats/pbrt_text.h"
#include "formats/spectra.h"

#define SAGI_MAX_INCLUDE_DEPTH 64
#define SAGI_MAX_BLOCK_DEPTH   1000000

// What opened a block.
typedef enum sagi_block {
    SAGI_BLOCK_ATTRIBUTE,
    SAGI_BLOCK_TRANSFORM,
    SAGI_BLOCK_OBJECT,
    SAGI_BLOCK_IMPORT
} sagi_block;

// What Attribute "shape" and so on set beforehand.
typedef enum sagi_target {
    SAGI_TARGET_SHAPE,
    SAGI_TARGET_LIGHT,
    SAGI_TARGET_MATERIAL,
    SAGI_TARGET_MEDIUM,
    SAGI_TARGET_TEXTURE,
    SAGI_TARGET_NONE,
} sagi_target;

typedef struct sagi_attribute {
    sagi_target target;
    sagi_cursor parameters; // parsed anew each time
} sagi_attribute;

typedef struct sagi_area_light {
    bool on, two_sided;
    sag_rgb radiance;
    double power; // > 0: the radiance is a colour, the power over the whole shape is this
} sagi_area_light;

// The graphics state: what AttributeBegin saves.
typedef struct sagi_state {
    sag_affine ctm; // object to world
    bool reverse_orientation;
    bool end_time_only; // transforms are for the end of a motion: passed over
    uint32_t material;
    sagi_area_light area_light;
    size_t attribute_count;
    sagi_block block; // what the state was saved for
    sagi_place place; // and where
} sagi_state;

typedef struct sagi_object {
    sag_scene *scene;
    bool committed;
} sagi_object;

typedef struct sagi_pbrt {
    sag_world *world;
    const sag_context *context;
    const sagi_load_options *options;
    sag_error *error;
    char directory[SAGI_MAX_PATH]; // of the scene's file, with a slash: names of files are relative to it
    sagi_source *sources;          // all files, the last opened first
    sagi_cursor files[SAGI_MAX_INCLUDE_DEPTH]; // being read, the innermost last
    bool is_import[SAGI_MAX_INCLUDE_DEPTH];
    int file_count;
    bool in_world;
    sagi_state state, *saved;
    size_t saved_count, saved_allocated;
    sagi_attribute *attributes;
    size_t attribute_count, attribute_allocated;
    sagi_params params;
    sagi_names materials, float_textures, spectrum_textures, object_names, system_names, warned;
    sagi_object *objects;
    size_t object_count, object_allocated;
    sag_affine *systems;
    size_t system_count, system_allocated;
    sag_scene *scene; // shapes go there: the world's, or an object's
    bool in_object;
} sagi_pbrt;

// "file:line:col: warning: …" to the log.
void sagi_pbrt_warn(sagi_pbrt *p, sagi_place place, const char *format, ...) SAG_PRINTF(3, 4);
// The same, once for each `what`, a name of the thing that is missing.
void sagi_pbrt_warn_once(sagi_pbrt *p, sagi_place place, const char *what, const char *format, ...)
    SAG_PRINTF(4, 5);
sag_status sagi_pbrt_out_of_memory(sagi_pbrt *p);
// Makes room for one more item in an array of the loader. False when memory is short.
bool sagi_pbrt_reserve(sagi_pbrt *p, void **items, size_t *allocated, size_t count, size_t item_bytes);

// The parameters that follow, and those Attribute has set for the target; `format` says for what they are.
sag_status sagi_pbrt_parameters(sagi_pbrt *p, sagi_place place, sagi_target target, const char *format, ...)
    SAG_PRINTF(4, 5);
// To be called when all have been looked up: warns of those nobody asked for and returns the list's status.
sag_status sagi_pbrt_parameters_done(sagi_pbrt *p);
// Marks parameters that are known and have no effect here; with a reason they are warned of, once each.
void sagi_pbrt_ignore(sagi_pbrt *p, const char *name, const char *reason);
// The next token as a string; a copy without escapes in text[size].
sag_status sagi_pbrt_string(sagi_pbrt *p, sagi_place after, char *text, size_t size);
// A file named by a parameter, relative to the scene's directory.
void sagi_pbrt_path(const sagi_pbrt *p, const char *name, char path[SAGI_MAX_PATH]);

// Colours and numbers that may be textures (pbrt_look).
sag_rgb sagi_pbrt_rgb(sagi_pbrt *p, const char *name, sagi_spectrum_use use, sag_rgb otherwise);
sag_input sagi_pbrt_spectrum_input(sagi_pbrt *p, const char *name, sagi_spectrum_use use, sag_rgb otherwise);
sag_input sagi_pbrt_float_input(sagi_pbrt *p, const char *name, double otherwise);

// The directives; `place` is the directive's word, which has been read.
sag_status sagi_pbrt_camera(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_film(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_sampler(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_pixel_filter(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_integrator(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_texture(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_material(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_make_named_material(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_named_material(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_light_source(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_area_light_source(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_shape(sagi_pbrt *p, sagi_place place);

// How pbrt begins: Gaussian filter, Sobol' points, 16 samples, 1280 × 720 (pbrt_settings).
void sagi_pbrt_default_settings(sagi_pbrt *p);

#endif
