// SPDX-License-Identifier: MIT
// The reader of pbrt-v4 scenes, in the order a scene goes through it: pbrt_text (tokens, parameters),
// pbrt_load (files, directives), pbrt_blocks (blocks, transforms), pbrt_settings (camera, film …),
// pbrt_texture, pbrt_material, pbrt_light, pbrt_shape, loop_subdivision and pbrt_mesh, pbrt_later (meshes on
// all threads), pbrt_object (objects and their instances), pbrt_solid.
#ifndef SAGI_FORMATS_PBRT_H
#define SAGI_FORMATS_PBRT_H

#include "formats/load.h"
#include "formats/pbrt_text.h"
#include <sagitta/solid.h>

#define SAGI_MAX_INCLUDE_DEPTH 64
#define SAGI_MAX_BLOCK_DEPTH   1000000

// What a spectrum is used for.
typedef enum sagi_spectrum_use {
    SAGI_SPECTRUM_REFLECTANCE,
    SAGI_SPECTRUM_LIGHT,
    SAGI_SPECTRUM_INDEX, // of refraction, and any other amount
} sagi_spectrum_use;

// What opened a block.
typedef enum sagi_block {
    SAGI_BLOCK_ATTRIBUTE,
    SAGI_BLOCK_TRANSFORM,
    SAGI_BLOCK_OBJECT,
    SAGI_BLOCK_SOLID,
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
    sag_input radiance;
    double scale;
    double power;           // > 0: the radiance is a colour, the power of each shape (triangle) is this
    sag_texture_id picture; // that multiplies it; 0: none
    double luminance;       // the picture's, on average
} sagi_area_light;

typedef enum sagi_active { SAGI_ACTIVE_ALL, SAGI_ACTIVE_START, SAGI_ACTIVE_END } sagi_active;

// What is known of a medium.
typedef struct sagi_medium_name {
    sagi_place used_at; // first
    uint32_t id;        // in the world; 0 where only the geometry is read
    bool made;
} sagi_medium_name;

// The graphics state: what AttributeBegin saves.
typedef struct sagi_state {
    sag_affine ctm; // object to world; within a solid: to the solid's space
    bool reverse_orientation;
    sagi_active active;       // what transforms are for; those for the end of a motion are passed over
    uint32_t inside, outside; // media (pbrt_medium.h)
    uint32_t material;
    sag_color_space color_space; // of "rgb" parameters
    sagi_area_light area_light;
    size_t attribute_count;
    sagi_block block; // what the state was saved for
    sagi_place place; // and where
} sagi_state;

// A geometry of an object or of a solid in one, remembered for those who place the object in a solid.
typedef struct sagi_part {
    sag_appearance look;
    sagi_place place;
    uint32_t geometry;
    uint32_t solid; // that it is an instance of: index in the loader's + 1; 0: a shape
} sagi_part;

typedef struct sagi_object {
    sag_scene *scene;
    uint32_t solid; // all of it as a solid: index + 1; 0: nobody asked yet
    size_t part_first, part_count;
    size_t weight; // primitives of its parts, written out
    bool committed;
} sagi_object;

// A finished solid that may become part of others; its geometries' ids count from 0 as its parts do.
typedef struct sagi_solid {
    sag_scene *scene;
    size_t part_first, part_count;
    size_t weight; // primitives of its parts
} sagi_solid;

// An operation of a solid that is being read, with as many operands as it has so far.
typedef struct sagi_solid_level {
    sag_solid_operation operation;
    uint32_t operand_count;
    sagi_place place;
} sagi_solid_level;

// The solid that is being read: SolidBegins within it are operations of the same.
typedef struct sagi_solid_reader {
    sag_scene *scene;      // NULL: none is open
    sag_scene *outside;    // where it goes
    sag_affine to_outside; // its space is the one in which the outermost SolidBegin stands
    sag_solid_step *steps;
    size_t step_count, step_allocated;
    sagi_solid_level *levels;
    size_t level_count, level_allocated;
    sagi_part *parts; // its geometries
    size_t part_count, part_allocated, weight;
} sagi_solid_reader;

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
    int32_t seed; // Option's
    bool in_world;
    bool naming; // the material that is being read gets a name
    sagi_state state, *saved;
    size_t saved_count, saved_allocated;
    sagi_attribute *attributes;
    size_t attribute_count, attribute_allocated;
    sagi_params params;
    sagi_names materials, float_textures, spectrum_textures, object_names, system_names, medium_names, warned;
    sagi_object *objects;
    size_t object_count, object_allocated;
    sagi_solid *solids; // that objects have
    size_t solid_count, solid_allocated;
    sagi_part *solid_parts, *object_parts; // of all of them, each one's in a row
    size_t solid_part_count, solid_part_allocated, object_part_count, object_part_allocated;
    sag_affine *systems;
    size_t system_count, system_allocated;
    sagi_medium_name *media;
    size_t medium_count, medium_allocated;
    struct sagi_promise *promises; // pbrt_promise.c
    struct sagi_promised_instance *promised_instances;
    size_t promise_count, promise_allocated, promised_instance_count, promised_instance_allocated;
    double image_distance;         // behind a lens (pbrt_lens.c), in the scene's unit; 0: there is none
    double lens_share;             // of radiance that a lens lets through to the film
    double film_diagonal;          // in mm
    sagi_place film_at, filter_at; // their directives
    const float (*corner_uv)[2];   // of the patch that is being added; NULL: none
    bool in_patches;               // the mesh that is being added is one of patches
    sag_scene *scene;              // shapes go there: the world's, an object's or a solid's
    bool in_object;
    sagi_solid_reader solid;
    struct sagi_waiting *waiting; // pbrt_later.c
    size_t waiting_count, waiting_allocated, waiting_bytes;
    bool catching_up;
} sagi_pbrt;

// "file:line:col: warning: …" to the log.
void sagi_pbrt_warn(sagi_pbrt *p, sagi_place place, const char *format, ...) SAG_PRINTF(3, 4);
// The same, once for each `what`, a name of the thing that is missing.
void sagi_pbrt_warn_once(sagi_pbrt *p, sagi_place place, const char *what, const char *format, ...)
    SAG_PRINTF(4, 5);
sag_status sagi_pbrt_out_of_memory(sagi_pbrt *p);
// Gives a name its number; an error for one that has one.
sag_status sagi_pbrt_define(sagi_pbrt *p, sagi_place place, sagi_names *names, const char *name, uint32_t id,
                            const char *what);
// Makes room for one more item in an array of the loader. False when memory is short.
bool sagi_pbrt_reserve(sagi_pbrt *p, void **items, size_t *allocated, size_t count, size_t item_bytes);

// The parameters that follow, and those Attribute has set for the target; `format` says for what they are.
sag_status sagi_pbrt_parameters(sagi_pbrt *p, sagi_place place, sagi_target target, const char *format, ...)
    SAG_PRINTF(4, 5);
// The same for: directive "name"; quickly.
sag_status sagi_pbrt_parameters_of(sagi_pbrt *p, sagi_place place, sagi_target target, const char *directive,
                                   const char *name);
// To be called when all have been looked up: warns of those nobody asked for and returns the list's status.
sag_status sagi_pbrt_parameters_done(sagi_pbrt *p);
// Marks parameters that are known and have no effect here; with a reason they are warned of, once each.
void sagi_pbrt_ignore(sagi_pbrt *p, const char *name, const char *reason);
// The next token as a string; a copy without escapes in text[size].
sag_status sagi_pbrt_string(sagi_pbrt *p, sagi_place after, char *text, size_t size);
// A file named by a parameter, relative to the scene's directory.
void sagi_pbrt_path(const sagi_pbrt *p, const char *name, char path[SAGI_MAX_PATH]);

// Colours and numbers that may be spectra or textures (pbrt_spectrum). A light's colour is no texture: an rgb
// as it is (by default white), or a spectrum of luminance 1.
sag_input sagi_pbrt_light_color(sagi_pbrt *p, const char *name);
sag_input sagi_pbrt_spectrum_input(sagi_pbrt *p, const char *name, sagi_spectrum_use use, double otherwise);
sag_spectrum_id sagi_pbrt_named_spectrum(sagi_pbrt *p, const char *name);
// The numbers in a file that a parameter names: of a spectrum's, pairs with rising wavelengths.
sag_status sagi_pbrt_read_numbers(sagi_pbrt *p, const sagi_param *param, sagi_slice name, double *numbers,
                                  size_t most, size_t *count);
sag_input sagi_pbrt_float_input(sagi_pbrt *p, const char *name, double otherwise);
// The picture in the file a parameter names, which must be there.
sag_status sagi_pbrt_picture(sagi_pbrt *p, sagi_place place, const char *parameter, sag_encoding encoding,
                             double gamma, sag_picture_id *id);

// The transform to the world's space, or the object's, also within a solid.
sag_affine sagi_pbrt_transform_now(const sagi_pbrt *p);

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
// Whether a material is none, as far as is known: one may be used before it is made.
bool sagi_pbrt_is_interface(const sagi_pbrt *p, uint32_t id);
sag_status sagi_pbrt_light_source(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_area_light_source(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_shape(sagi_pbrt *p, sagi_place place);

// Camera "realistic" (pbrt_lens.c); and its field, once the film is known.
sag_status sagi_pbrt_lens(sagi_pbrt *p, sagi_place place, sag_camera *camera);
void sagi_pbrt_apply_lens(sagi_pbrt *p);

// How pbrt begins: Gaussian filter, Sobol' points, 16 samples, 1280 × 720 (pbrt_settings).
void sagi_pbrt_default_settings(sagi_pbrt *p);
// At WorldBegin: what the render would find wrong with film and filter, with their places.
sag_status sagi_pbrt_check_settings(sagi_pbrt *p);

#endif
