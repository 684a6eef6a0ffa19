// SPDX-License-Identifier: MIT
// Blocks and transforms of a pbrt scene. The current transform maps the space a shape is written in to the
// world's; each directive multiplies it from the right, so what stands last acts first. pbrt writes its
// matrices by columns.
#include "formats/pbrt_blocks.h"

#include "formats/number.h"

#include <math.h>
#include <string.h>

static const char *const block_ends[] = {"AttributeEnd", "TransformEnd", "ObjectEnd", "SolidEnd",
                                         "the end of the imported file"};
static const char *const block_begins[] = {"AttributeBegin", "TransformBegin", "ObjectBegin", "SolidBegin",
                                           "Import"};

sag_status sagi_pbrt_push(sagi_pbrt *p, sagi_place place, sagi_block block) {
    if (p->saved_count == SAGI_MAX_BLOCK_DEPTH)
        return sagi_place_error(place, p->error, "blocks nest more than %d deep", SAGI_MAX_BLOCK_DEPTH);
    void *saved = p->saved;
    if (!sagi_pbrt_reserve(p, &saved, &p->saved_allocated, p->saved_count, sizeof *p->saved))
        return sagi_pbrt_out_of_memory(p);
    p->saved = saved;
    sagi_state *state = &p->saved[p->saved_count++];
    *state = p->state;
    state->block = block;
    state->place = place;
    return SAG_OK;
}

sag_status sagi_pbrt_pop(sagi_pbrt *p, sagi_place place, sagi_block block) {
    const sagi_state *state = p->saved_count ? &p->saved[p->saved_count - 1] : NULL;
    const bool attributes = block == SAGI_BLOCK_ATTRIBUTE || block == SAGI_BLOCK_TRANSFORM;
    if (!state || (attributes && state->block == SAGI_BLOCK_IMPORT)) {
        if (!attributes)
            return sagi_place_error(place, p->error, "%s without %s", block_ends[block], block_begins[block]);
        sagi_pbrt_warn(p, place, "%s without %s: ignored, as pbrt does", block_ends[block],
                       block_begins[block]);
        return SAG_OK;
    }
    const bool fits = attributes
                          ? state->block == SAGI_BLOCK_ATTRIBUTE || state->block == SAGI_BLOCK_TRANSFORM
                          : state->block == block;
    if (!fits) {
        int line, column;
        sagi_place_find(state->place, &line, &column);
        return sagi_place_error(place, p->error, "%s while the %s of line %d is open", block_ends[block],
                                block_begins[state->block], line);
    }
    // Before pbrt-v4 a transform's block took back nothing else.
    if (state->block == SAGI_BLOCK_TRANSFORM &&
        (state->material != p->state.material || state->area_light.on != p->state.area_light.on ||
         state->reverse_orientation != p->state.reverse_orientation))
        sagi_pbrt_warn_once(p, state->place, "TransformBegin",
                            "TransformBegin is AttributeBegin by another name: its end takes back materials, "
                            "lights and orientation too");
    p->saved_count--;
    p->state = *state;
    p->attribute_count = p->state.attribute_count;
    return SAG_OK;
}

sag_status sagi_pbrt_check_closed(sagi_pbrt *p) {
    if (p->saved_count == 0) return SAG_OK;
    const sagi_state *state = &p->saved[p->saved_count - 1];
    return sagi_place_error(state->place, p->error, "this %s is never closed by %s",
                            block_begins[state->block], block_ends[state->block]);
}

sag_status sagi_pbrt_attribute_begin(sagi_pbrt *p, sagi_place place) {
    return sagi_pbrt_push(p, place, SAGI_BLOCK_ATTRIBUTE);
}
sag_status sagi_pbrt_attribute_end(sagi_pbrt *p, sagi_place place) {
    return sagi_pbrt_pop(p, place, SAGI_BLOCK_ATTRIBUTE);
}
sag_status sagi_pbrt_transform_begin(sagi_pbrt *p, sagi_place place) {
    return sagi_pbrt_push(p, place, SAGI_BLOCK_TRANSFORM);
}
sag_status sagi_pbrt_transform_end(sagi_pbrt *p, sagi_place place) {
    return sagi_pbrt_pop(p, place, SAGI_BLOCK_TRANSFORM);
}

sag_status sagi_pbrt_reverse_orientation(sagi_pbrt *p, sagi_place place) {
    (void)place;
    p->state.reverse_orientation = !p->state.reverse_orientation;
    return SAG_OK;
}

// Attribute "shape" "float radius" 2: what shapes to come take when they do not say it themselves.
sag_status sagi_pbrt_attribute(sagi_pbrt *p, sagi_place place) {
    static const char *const targets[] = {"shape", "light", "material", "medium", "texture"};
    char name[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    sagi_attribute attribute = {.target = SAGI_TARGET_NONE, .parameters = p->files[p->file_count - 1]};
    for (int i = 0; i < SAGI_TARGET_NONE; i++)
        if (strcmp(name, targets[i]) == 0) attribute.target = (sagi_target)i;
    if (attribute.target == SAGI_TARGET_NONE)
        return sagi_place_error(place, p->error, "unknown attribute target \"%s\"", name);
    status = sagi_pbrt_parameters(p, place, SAGI_TARGET_NONE, "Attribute \"%s\"", name);
    if (status != SAG_OK) return status;
    attribute.parameters.end = p->files[p->file_count - 1].next;
    void *attributes = p->attributes;
    if (!sagi_pbrt_reserve(p, &attributes, &p->attribute_allocated, p->attribute_count,
                           sizeof *p->attributes))
        return sagi_pbrt_out_of_memory(p);
    p->attributes = attributes;
    p->attributes[p->attribute_count++] = attribute;
    p->state.attribute_count = p->attribute_count;
    return SAG_OK;
}

// ---- transforms

// Numbers, in brackets or not.
static sag_status read_numbers(sagi_pbrt *p, sagi_place place, double *numbers, int count) {
    sagi_cursor *cursor = &p->files[p->file_count - 1];
    sagi_token token;
    bool bracket = false;
    for (int i = 0; i <= count; i++) {
        if (i == count && !bracket) return SAG_OK;
        sag_status status = sagi_cursor_next(cursor, &token, p->error);
        if (status == SAG_OK && i == 0 && token.kind == SAGI_TOKEN_OPEN) {
            bracket = true;
            status = sagi_cursor_next(cursor, &token, p->error);
        }
        if (status != SAG_OK) return status;
        if (i == count && token.kind == SAGI_TOKEN_CLOSE) return SAG_OK;
        const char *const end = token.text.text + token.text.length;
        if (i == count || token.kind != SAGI_TOKEN_WORD ||
            sagi_parse_number(token.text.text, end, &numbers[i]) != end)
            return sagi_place_error(token.kind == SAGI_TOKEN_END ? place : token.place, p->error,
                                    "%d numbers expected%s", count, i == count ? " before the ]" : "");
        if (!isfinite(numbers[i])) return sagi_place_error(token.place, p->error, "a finite number expected");
    }
    return SAG_OK;
}

sag_affine sagi_pbrt_transform_now(const sagi_pbrt *p) {
    return p->solid.scene ? sag_affine_multiply(&p->solid.to_outside, &p->state.ctm) : p->state.ctm;
}

// Whether a transform is for the start of a motion, which is all there is.
static bool is_for_start(sagi_pbrt *p, sagi_place place) {
    if (p->state.active != SAGI_ACTIVE_ALL)
        sagi_pbrt_warn_once(p, place, "motion", "motion is not supported: all stands as at the start");
    return p->state.active != SAGI_ACTIVE_END;
}

// A transform from the outermost space, which a solid's is brought back from.
static void set(sagi_pbrt *p, sagi_place place, const sag_affine *a) {
    if (!is_for_start(p, place)) return;
    p->state.ctm = *a;
    sag_affine inverse;
    if (p->solid.scene && sag_affine_inverse(&p->solid.to_outside, &inverse))
        p->state.ctm = sag_affine_multiply(&inverse, a);
}

static void concatenate(sagi_pbrt *p, sagi_place place, const sag_affine *a) {
    if (is_for_start(p, place)) p->state.ctm = sag_affine_multiply(&p->state.ctm, a);
}

sag_status sagi_pbrt_identity(sagi_pbrt *p, sagi_place place) {
    const sag_affine identity = sag_affine_identity();
    set(p, place, &identity);
    return SAG_OK;
}

sag_status sagi_pbrt_translate(sagi_pbrt *p, sagi_place place) {
    double v[3];
    const sag_status status = read_numbers(p, place, v, 3);
    if (status != SAG_OK) return status;
    const sag_affine a = sag_affine_translate(sag_vec3_make(v[0], v[1], v[2]));
    concatenate(p, place, &a);
    return SAG_OK;
}

sag_status sagi_pbrt_scale(sagi_pbrt *p, sagi_place place) {
    double v[3];
    const sag_status status = read_numbers(p, place, v, 3);
    if (status != SAG_OK) return status;
    if (v[0] == 0 || v[1] == 0 || v[2] == 0) return sagi_place_error(place, p->error, "Scale by 0");
    const sag_affine a = sag_affine_scale(sag_vec3_make(v[0], v[1], v[2]));
    concatenate(p, place, &a);
    return SAG_OK;
}

sag_status sagi_pbrt_rotate(sagi_pbrt *p, sagi_place place) {
    double v[4];
    const sag_status status = read_numbers(p, place, v, 4);
    if (status != SAG_OK) return status;
    if (v[1] == 0 && v[2] == 0 && v[3] == 0)
        return sagi_place_error(place, p->error, "Rotate about the axis 0 0 0");
    const sag_affine a =
        sag_affine_rotate(v[0] / 180 * 3.14159265358979323846, sag_vec3_make(v[1], v[2], v[3]));
    concatenate(p, place, &a);
    return SAG_OK;
}

// The camera at `eye` looks along +z at `look`, +x to the right, in pbrt's left-handed way: right = up ×
// forward.
sag_status sagi_pbrt_look_at(sagi_pbrt *p, sagi_place place) {
    double v[9];
    const sag_status status = read_numbers(p, place, v, 9);
    if (status != SAG_OK) return status;
    const sag_vec3 eye = {v[0], v[1], v[2]}, look = {v[3], v[4], v[5]}, up = {v[6], v[7], v[8]};
    const sag_vec3 forward = sag_normalize(sag_sub(look, eye));
    const sag_vec3 right = sag_normalize(sag_cross(sag_normalize(up), forward));
    const sag_affine to_world = sag_affine_from_columns(right, sag_cross(forward, right), forward, eye);
    sag_affine a;
    if (!sag_affine_inverse(&to_world, &a))
        return sagi_place_error(place, p->error,
                                "LookAt: the up vector is along the view, or the eye at the point looked at");
    concatenate(p, place, &a);
    return SAG_OK;
}

static sag_status read_matrix(sagi_pbrt *p, sagi_place place, sag_affine *a) {
    double v[16];
    const sag_status status = read_numbers(p, place, v, 16);
    if (status != SAG_OK) return status;
    if (v[3] != 0 || v[7] != 0 || v[11] != 0 || v[15] == 0)
        return sagi_place_error(place, p->error,
                                "a projective transform: the 4th, 8th and 12th number must be 0");
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) a->m[row][column] = v[4 * column + row] / v[15];
    sag_affine inverse;
    if (!sag_affine_inverse(a, &inverse)) return sagi_place_error(place, p->error, "the matrix is singular");
    return SAG_OK;
}

sag_status sagi_pbrt_transform(sagi_pbrt *p, sagi_place place) {
    sag_affine a;
    const sag_status status = read_matrix(p, place, &a);
    if (status == SAG_OK) set(p, place, &a);
    return status;
}

sag_status sagi_pbrt_concat_transform(sagi_pbrt *p, sagi_place place) {
    sag_affine a;
    const sag_status status = read_matrix(p, place, &a);
    if (status == SAG_OK) concatenate(p, place, &a);
    return status;
}

bool sagi_pbrt_name_system(sagi_pbrt *p, sagi_slice name) {
    void *systems = p->systems;
    if (!sagi_pbrt_reserve(p, &systems, &p->system_allocated, p->system_count, sizeof *p->systems))
        return false;
    p->systems = systems;
    p->systems[p->system_count] = sagi_pbrt_transform_now(p);
    return sagi_names_set(&p->system_names, name, (uint32_t)p->system_count++);
}

sag_status sagi_pbrt_coordinate_system(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    return sagi_pbrt_name_system(p, (sagi_slice){name, strlen(name)}) ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

sag_status sagi_pbrt_coord_sys_transform(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    uint32_t index;
    if (!sagi_names_get(&p->system_names, (sagi_slice){name, strlen(name)}, &index)) {
        sagi_pbrt_warn(p, place, "there is no coordinate system \"%.100s\"", name);
        return SAG_OK;
    }
    set(p, place, &p->systems[index]);
    return SAG_OK;
}

sag_status sagi_pbrt_active_transform(sagi_pbrt *p, sagi_place place) {
    (void)place;
    sagi_token token;
    const sag_status status = sagi_cursor_next(&p->files[p->file_count - 1], &token, p->error);
    if (status != SAG_OK) return status;
    static const char *const names[] = {"All", "StartTime", "EndTime"}; // as sagi_active
    for (int i = 0; i < 3; i++)
        if (sagi_slice_is(token.text, names[i])) return p->state.active = (sagi_active)i, SAG_OK;
    return sagi_place_error(token.place, p->error, "ActiveTransform: All, StartTime or EndTime expected");
}

sag_status sagi_pbrt_transform_times(sagi_pbrt *p, sagi_place place) {
    double v[2];
    return read_numbers(p, place, v, 2); // of motion, which is warned of where it is
}
