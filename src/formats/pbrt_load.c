// SPDX-License-Identifier: MIT
// Reading a pbrt scene: the files (Include, Import), the loop over directives, what is common to them, and
// the blocks. Nothing recurses: included files and open blocks are stacks of their own, so that depth costs
// memory and has a bound.
#include "formats/pbrt.h"

#include "formats/pbrt_blocks.h"
#include "formats/pbrt_later.h"
#include "formats/pbrt_medium.h"
#include "formats/pbrt_options.h"
#include "formats/pbrt_promise.h"
#include "formats/pbrt_solid.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

// ---- messages

static void warn(sagi_pbrt *p, sagi_place place, const char *message) {
    int line, column;
    char text[SAGI_MAX_PATH + 512];
    sagi_place_find(place, &line, &column);
    snprintf(text, sizeof text, "%s:%d:%d: warning: %s", place.source->path, line, column, message);
    if (!sagi_pbrt_message_later(p, text)) sag_context_log(p->context, SAG_LOG_WARNING, "%s", text);
}

void sagi_pbrt_warn(sagi_pbrt *p, sagi_place place, const char *format, ...) {
    char message[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    warn(p, place, message);
}

void sagi_pbrt_warn_once(sagi_pbrt *p, sagi_place place, const char *what, const char *format, ...) {
    const sagi_slice name = {what, strlen(what)};
    if (sagi_names_get(&p->warned, name, NULL)) return;
    sagi_names_set(&p->warned, name, 1);
    char message[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    warn(p, place, message);
}

sag_status sagi_pbrt_out_of_memory(sagi_pbrt *p) {
    return sag_error_set(p->error, SAG_ERROR_MEMORY, "out of memory loading the scene");
}

sag_status sagi_pbrt_define(sagi_pbrt *p, sagi_place place, sagi_names *names, const char *name, uint32_t id,
                            const char *what) {
    const sagi_slice key = {name, strlen(name)};
    if (sagi_names_get(names, key, NULL))
        return sagi_place_error(place, p->error, "there is a %s \"%.100s\" already", what, name);
    return sagi_names_set(names, key, id) ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

bool sagi_pbrt_reserve(sagi_pbrt *p, void **items, size_t *allocated, size_t count, size_t item_bytes) {
    if (count < *allocated) return true;
    const size_t larger = *allocated ? 2 * *allocated : 16;
    void *fresh = sag_allocate(p->context, larger * item_bytes);
    if (!fresh) return false;
    if (*allocated) memcpy(fresh, *items, *allocated * item_bytes);
    sag_release(p->context, *items, *allocated * item_bytes);
    *items = fresh;
    *allocated = larger;
    return true;
}

// ---- parameters

static sag_status parse_parameters(sagi_pbrt *p, sagi_place place, sagi_target target) {
    sagi_params *params = &p->params;
    params->place = place;
    params->error = p->error;
    sagi_params_empty(params);
    // The last of a name counts: what an Attribute sets comes before what the directive itself says.
    sag_status status = SAG_OK;
    const bool skim = params->skim;
    params->skim = false;
    for (size_t i = 0; target != SAGI_TARGET_NONE && status == SAG_OK && i < p->state.attribute_count; i++) {
        if (p->attributes[i].target != target) continue;
        sagi_cursor cursor = p->attributes[i].parameters;
        status = sagi_params_parse(params, &cursor);
    }
    for (size_t i = 0; i < params->count; i++) params->items[i].used = true; // for some shapes only
    params->skim = skim;
    return status == SAG_OK ? sagi_params_parse(params, &p->files[p->file_count - 1]) : status;
}

sag_status sagi_pbrt_parameters(sagi_pbrt *p, sagi_place place, sagi_target target, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(p->params.what, sizeof p->params.what, format, arguments);
    va_end(arguments);
    return parse_parameters(p, place, target);
}

sag_status sagi_pbrt_parameters_of(sagi_pbrt *p, sagi_place place, sagi_target target, const char *directive,
                                   const char *name) {
    char *at = p->params.what;
    const char *const parts[] = {directive, " \"", name, "\""};
    for (int i = 0; i < 4; i++) {
        const size_t length = strnlen(parts[i], 60);
        memcpy(at, parts[i], length);
        at += length;
    }
    *at = '\0';
    return parse_parameters(p, place, target);
}

sag_status sagi_pbrt_parameters_done(sagi_pbrt *p) {
    const sagi_params *params = &p->params;
    if (params->status != SAG_OK) return params->status;
    for (size_t i = 0; i < params->count; i++) {
        const sagi_param *param = &params->items[i];
        if (param->used) continue;
        bool again = false;
        for (size_t k = i + 1; k < params->count && !again; k++)
            again = params->items[k].used && params->items[k].name.length == param->name.length &&
                    memcmp(params->items[k].name.text, param->name.text, param->name.length) == 0;
        char key[256];
        snprintf(key, sizeof key, "%s %.*s", params->what, (int)param->name.length, param->name.text);
        sagi_pbrt_warn_once(p, param->place, key,
                            again ? "%s: \"%.*s\" is given again: the last one counts"
                                  : "%s: unknown parameter \"%.*s\"",
                            params->what, (int)param->name.length, param->name.text);
    }
    return SAG_OK;
}

void sagi_pbrt_ignore(sagi_pbrt *p, const char *name, const char *reason) {
    for (size_t i = 0; i < p->params.count; i++) {
        sagi_param *param = &p->params.items[i];
        if (!sagi_slice_is(param->name, name) || param->used) continue;
        param->used = true;
        if (reason) sagi_pbrt_warn_once(p, param->place, name, "%s: \"%s\" %s", p->params.what, name, reason);
    }
}

sag_status sagi_pbrt_string(sagi_pbrt *p, sagi_place after, char *text, size_t size) {
    sagi_token token;
    const sag_status status = sagi_cursor_next(&p->files[p->file_count - 1], &token, p->error);
    if (status != SAG_OK) return status;
    if (token.kind != SAGI_TOKEN_STRING) {
        const char *end = after.at;
        while (end != (const char *)after.source->file.bytes + after.source->file.size && *end >= 'A') end++;
        return sagi_place_error(token.kind == SAGI_TOKEN_END ? after : token.place, p->error,
                                "a string expected after %.*s", (int)(end - after.at), after.at);
    }
    size_t length = 0;
    for (size_t i = 0; i < token.text.length; i++) {
        if (token.text.text[i] == '\\' && i + 1 < token.text.length) i++;
        if (length + 1 >= size)
            return sagi_place_error(token.place, p->error, "this name is longer than %zu bytes", size - 1);
        text[length++] = token.text.text[i];
    }
    text[length] = '\0';
    return SAG_OK;
}

void sagi_pbrt_path(const sagi_pbrt *p, const char *name, char path[SAGI_MAX_PATH]) {
    const int length = snprintf(path, SAGI_MAX_PATH, "%s%s", name[0] == '/' ? "" : p->directory, name);
    if (length >= SAGI_MAX_PATH) path[0] = '\0'; // no such file: opening it fails
}

// ---- files

static sag_status open_source(sagi_pbrt *p, const char *path, sagi_source **opened) {
    sagi_source *source = sag_allocate(p->context, sizeof *source);
    if (!source) return sagi_pbrt_out_of_memory(p);
    source->device = source->inode = 0;
    snprintf(source->path, sizeof source->path, "%s", path);
    const sag_status status = sagi_file_open(p->context, path, &source->file, p->error);
    if (status != SAG_OK) {
        sag_release(p->context, source, sizeof *source);
        return status;
    }
    struct stat information;
    if (stat(path, &information) == 0)
        source->device = (uint64_t)information.st_dev, source->inode = (uint64_t)information.st_ino;
    source->previous = p->sources;
    p->sources = source;
    *opened = source;
    return SAG_OK;
}

static void enter(sagi_pbrt *p, const sagi_source *source, bool is_import) {
    const char *text = (const char *)source->file.bytes;
    if (source->file.size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) text += 3; // a byte order mark
    p->is_import[p->file_count] = is_import;
    p->files[p->file_count++] =
        (sagi_cursor){source, text, (const char *)source->file.bytes + source->file.size};
}

static sag_status include(sagi_pbrt *p, sagi_place place, bool is_import) {
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    if (is_import && !p->in_world) return sagi_place_error(place, p->error, "Import before WorldBegin");
    if (p->file_count == SAGI_MAX_INCLUDE_DEPTH)
        return sagi_place_error(place, p->error, "files include one another %d deep", SAGI_MAX_INCLUDE_DEPTH);
    sagi_pbrt_path(p, name, path);
    sagi_source *source;
    sag_error reason;
    sag_error *const error = p->error;
    p->error = &reason;
    status = open_source(p, path, &source);
    p->error = error;
    if (status != SAG_OK) {
        sagi_place_error(place, error, "%s: %s", path, reason.message);
        if (error) error->status = status;
        return status;
    }
    for (int i = 0; i < p->file_count; i++) {
        const sagi_source *open = p->files[i].source;
        if (open->inode == source->inode && open->device == source->device && open->inode != 0)
            return sagi_place_error(place, p->error, "%s includes itself", path);
    }
    if (is_import && (status = sagi_pbrt_push(p, place, SAGI_BLOCK_IMPORT)) != SAG_OK) return status;
    enter(p, source, is_import);
    return SAG_OK;
}

static sag_status include_directive(sagi_pbrt *p, sagi_place place) { return include(p, place, false); }
static sag_status import_directive(sagi_pbrt *p, sagi_place place) { return include(p, place, true); }

// ---- directives without effect

// A name and parameters, all without effect.
static sag_status skip_named(sagi_pbrt *p, sagi_place place, const char *what) {
    char name[SAGI_MAX_PATH];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters(p, place, SAGI_TARGET_NONE, "%s \"%.60s\"", what, name);
    return status;
}

static sag_status accelerator_directive(sagi_pbrt *p, sagi_place place) {
    return skip_named(p, place, "Accelerator");
}

static sag_status color_space_directive(sagi_pbrt *p, sagi_place place) {
    char name[SAGI_MAX_PATH];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    static const char *const names[] = {"srgb", "dci-p3", "rec2020", "aces2065-1"}; // as sag_color_space
    if (status != SAG_OK) return status;
    for (int i = 0; i < 4; i++)
        if (strcasecmp(name, names[i]) == 0) return p->state.color_space = (sag_color_space)i, SAG_OK;
    return sagi_place_error(place, p->error, "unknown colour space \"%.60s\"", name);
}

static sag_status world_begin(sagi_pbrt *p, sagi_place place) {
    if (p->saved_count) return sagi_place_error(place, p->error, "WorldBegin within a block");
    p->in_world = true;
    p->state.ctm = sag_affine_identity();
    p->state.active = SAGI_ACTIVE_ALL;
    sagi_pbrt_apply_seed(p);
    sagi_pbrt_apply_lens(p);
    const sag_status status = sagi_pbrt_check_settings(p);
    if (status != SAG_OK) return status;
    const sagi_slice world = {"world", 5};
    return sagi_pbrt_name_system(p, world) ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

// Where a directive may stand: above WorldBegin, below it, or both.
enum { BEFORE = 1, AFTER = 2, ANYWHERE = 3 };

static const struct {
    const char *name;
    int where;
    sag_status (*read)(sagi_pbrt *p, sagi_place place);
} directives[] = {
    {"Shape", AFTER, sagi_pbrt_shape},
    {"NamedMaterial", AFTER, sagi_pbrt_named_material},
    {"Material", AFTER, sagi_pbrt_material},
    {"AttributeBegin", AFTER, sagi_pbrt_attribute_begin},
    {"AttributeEnd", AFTER, sagi_pbrt_attribute_end},
    {"Translate", ANYWHERE, sagi_pbrt_translate},
    {"Transform", ANYWHERE, sagi_pbrt_transform},
    {"ConcatTransform", ANYWHERE, sagi_pbrt_concat_transform},
    {"Rotate", ANYWHERE, sagi_pbrt_rotate},
    {"Scale", ANYWHERE, sagi_pbrt_scale},
    {"Identity", ANYWHERE, sagi_pbrt_identity},
    {"LookAt", ANYWHERE, sagi_pbrt_look_at},
    {"TransformBegin", AFTER, sagi_pbrt_transform_begin},
    {"TransformEnd", AFTER, sagi_pbrt_transform_end},
    {"TransformTimes", BEFORE, sagi_pbrt_transform_times},
    {"ActiveTransform", ANYWHERE, sagi_pbrt_active_transform},
    {"CoordinateSystem", ANYWHERE, sagi_pbrt_coordinate_system},
    {"CoordSysTransform", ANYWHERE, sagi_pbrt_coord_sys_transform},
    {"ReverseOrientation", AFTER, sagi_pbrt_reverse_orientation},
    {"ObjectInstance", AFTER, sagi_pbrt_object_instance},
    {"ObjectBegin", AFTER, sagi_pbrt_object_begin},
    {"ObjectEnd", AFTER, sagi_pbrt_object_end},
    {"Attribute", ANYWHERE, sagi_pbrt_attribute},
    {"LightSource", AFTER, sagi_pbrt_light_source},
    {"AreaLightSource", AFTER, sagi_pbrt_area_light_source},
    {"Texture", AFTER, sagi_pbrt_texture},
    {"MakeNamedMaterial", AFTER, sagi_pbrt_make_named_material},
    {"MakeNamedMedium", ANYWHERE, sagi_pbrt_make_named_medium},
    {"MediumInterface", ANYWHERE, sagi_pbrt_medium_interface},
    {"WorldBegin", BEFORE, world_begin},
    {"Camera", BEFORE, sagi_pbrt_camera},
    {"Film", BEFORE, sagi_pbrt_film},
    {"Sampler", BEFORE, sagi_pbrt_sampler},
    {"PixelFilter", BEFORE, sagi_pbrt_pixel_filter},
    {"Integrator", BEFORE, sagi_pbrt_integrator},
    {"Accelerator", BEFORE, accelerator_directive},
    {"ColorSpace", ANYWHERE, color_space_directive},
    {"Option", BEFORE, sagi_pbrt_option},
    {"Include", ANYWHERE, include_directive},
    {"Import", AFTER, import_directive},
    {"SolidBegin", AFTER, sagi_pbrt_solid_begin},
    {"SolidEnd", AFTER, sagi_pbrt_solid_end},
};

static sag_status read_directive(sagi_pbrt *p, const sagi_token *token) {
    const int shown = (int)(token->text.length < 60 ? token->text.length : 60);
    if (token->kind != SAGI_TOKEN_WORD)
        return sagi_place_error(token->place, p->error, "a directive expected, not %s%.*s%s",
                                token->kind == SAGI_TOKEN_STRING ? "\"" : "", shown, token->text.text,
                                token->kind == SAGI_TOKEN_STRING ? "\"" : "");
    for (size_t i = 0; i < sizeof directives / sizeof *directives; i++) {
        if (!sagi_slice_is(token->text, directives[i].name)) continue;
        if (!(directives[i].where & (p->in_world ? AFTER : BEFORE)))
            return sagi_place_error(token->place, p->error, "%s %s WorldBegin", directives[i].name,
                                    p->in_world ? "after" : "before");
        return directives[i].read(p, token->place);
    }
    // What is no word at all is no scene at all; bytes that are no text would spoil the message.
    for (int i = 0; i < shown; i++)
        if ((uint8_t)token->text.text[i] < 0x20)
            return sagi_place_error(token->place, p->error, "a directive expected: this is no text");
    const bool old = sagi_slice_is(token->text, "WorldEnd");
    return sagi_place_error(token->place, p->error, "unknown directive %.*s%s", shown, token->text.text,
                            old ? ": a pbrt-v4 scene ends with its file" : "");
}

static sag_status read_all(sagi_pbrt *p) {
    while (p->file_count > 0) {
        sagi_token token;
        sag_status status = sagi_cursor_next(&p->files[p->file_count - 1], &token, p->error);
        if (status != SAG_OK) return status;
        if (token.kind != SAGI_TOKEN_END) {
            status = read_directive(p, &token);
            if (status == SAG_OK) status = sagi_pbrt_catch_up_partly(p);
            if (status != SAG_OK) return status;
            continue;
        }
        if (p->is_import[p->file_count - 1] &&
            (status = sagi_pbrt_pop(p, token.place, SAGI_BLOCK_IMPORT)) != SAG_OK)
            return status;
        if (--p->file_count == 0 && !p->in_world)
            return sagi_place_error(token.place, p->error, "the scene ends without WorldBegin");
    }
    sag_status status = sagi_pbrt_check_closed(p);
    if (status == SAG_OK) status = sagi_pbrt_check_media(p);
    return status == SAG_OK ? sagi_pbrt_check_promises(p) : status;
}

// The same with the meshes that have waited. One that is wrong comes before what went wrong after it.
static sag_status read_everything(sagi_pbrt *p) {
    const sag_status status = read_all(p);
    const sag_error error = *p->error;
    const sag_status before = sagi_pbrt_catch_up(p);
    if (before != SAG_OK) return before;
    *p->error = error;
    return status;
}

static void clear(sagi_pbrt *p) {
    for (sagi_source *source = p->sources; source;) {
        sagi_source *previous = source->previous;
        sagi_file_close(&source->file);
        sag_release(p->context, source, sizeof *source);
        source = previous;
    }
    sagi_params_clear(&p->params);
    sagi_names *const maps[] = {&p->materials,    &p->float_textures, &p->spectrum_textures,
                                &p->object_names, &p->system_names,   &p->medium_names,
                                &p->warned};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) sagi_names_clear(maps[i]);
    sag_release(p->context, p->saved, p->saved_allocated * sizeof *p->saved);
    sag_release(p->context, p->attributes, p->attribute_allocated * sizeof *p->attributes);
    sag_release(p->context, p->objects, p->object_allocated * sizeof *p->objects);
    sag_release(p->context, p->solids, p->solid_allocated * sizeof *p->solids);
    sag_release(p->context, p->solid_parts, p->solid_part_allocated * sizeof *p->solid_parts);
    sag_release(p->context, p->object_parts, p->object_part_allocated * sizeof *p->object_parts);
    sag_release(p->context, p->media, p->medium_allocated * sizeof *p->media);
    sag_release(p->context, p->systems, p->system_allocated * sizeof *p->systems);
    sagi_pbrt_promises_clear(p);
    sagi_pbrt_solid_clear(p);
    sagi_pbrt_later_clear(p);
}

sag_status sagi_pbrt_load(sag_world *world, const char *path, const sagi_load_options *options,
                          sag_error *error) {
    const sag_context *context = sag_world_context(world);
    // Kept off the stack: it is some hundred kilobytes of paths.
    sagi_pbrt *p = sag_allocate(context, sizeof *p);
    if (!p) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory loading the scene");
    sag_error unwanted;
    memset(p, 0, sizeof *p);
    p->world = world;
    p->context = context;
    p->options = options;
    p->error = error ? error : &unwanted;
    p->scene = sag_world_scene(world);
    p->state.ctm = sag_affine_identity();
    p->params.context = p->materials.context = p->float_textures.context = p->spectrum_textures.context =
        context;
    p->object_names.context = p->system_names.context = p->medium_names.context = p->warned.context = context;
    const char *slash = strrchr(path, '/');
    snprintf(p->directory, sizeof p->directory, "%.*s", slash ? (int)(slash - path) + 1 : 0, path);
    if (!options->geometry_only) sagi_pbrt_default_settings(p);
    sagi_source *source;
    sag_status status = open_source(p, path, &source);
    if (status == SAG_OK) {
        enter(p, source, false);
        status = read_everything(p);
    }
    clear(p);
    sag_release(context, p, sizeof *p);
    return status;
}
