// SPDX-License-Identifier: MIT
// MakeNamedMedium and MediumInterface: names, numbers, and what is between which shapes. pbrt's rule for one
// name only is that it stands for both sides.
#include "formats/pbrt_medium.h"

#include <string.h>

// The number of a name, new when it is seen for the first time; 0 for no name. False when memory is short.
static bool number_of(sagi_pbrt *p, sagi_place place, const char *name, uint32_t *number) {
    const sagi_slice key = {name, strlen(name)};
    *number = 0;
    if (!name[0] || sagi_names_get(&p->medium_names, key, number)) return true;
    void *media = p->media;
    if (!sagi_pbrt_reserve(p, &media, &p->medium_allocated, p->medium_count, sizeof *p->media)) return false;
    p->media = media;
    uint32_t id = 0;
    if (!p->options->geometry_only && !(id = sag_world_add_medium(p->world, &(sag_medium){.g = 0})))
        return false;
    p->media[p->medium_count++] = (sagi_medium_name){.used_at = place, .id = id};
    *number = (uint32_t)p->medium_count;
    return sagi_names_set(&p->medium_names, key, *number);
}

// The medium's coefficients: of a substance with a name, or as given; 1 where nothing is said.
static void read_coefficients(sagi_pbrt *p, sagi_place place, sag_medium *medium) {
    char preset[128];
    sagi_params_string(&p->params, "preset", "", preset, sizeof preset);
    if (preset[0]) {
        if (sagi_pbrt_substance(preset, &medium->absorption.value, &medium->scattering.value)) {
            sagi_pbrt_ignore(p, "sigma_a", NULL);
            sagi_pbrt_ignore(p, "sigma_s", NULL);
            return;
        }
        sagi_pbrt_warn(p, place, "there is no substance \"%.100s\"", preset);
    }
    medium->absorption = sagi_pbrt_spectrum_input(p, "sigma_a", SAGI_SPECTRUM_INDEX, 1);
    medium->scattering = sagi_pbrt_spectrum_input(p, "sigma_s", SAGI_SPECTRUM_INDEX, 1);
}

static sag_status read_medium(sagi_pbrt *p, sagi_place place, uint32_t id) {
    sagi_params *params = &p->params;
    char kind[64];
    sagi_params_string(params, "type", "", kind, sizeof kind);
    if (params->status == SAG_OK && !kind[0])
        return sagi_params_fail(params, NULL, "its \"string type\" is missing");
    if (strcmp(kind, "homogeneous") != 0) {
        static const char *const others[] = {"uniformgrid", "rgbgrid", "cloud", "nanovdb"};
        for (size_t i = 0; i < sizeof others / sizeof *others; i++)
            if (strcmp(kind, others[i]) == 0) {
                sagi_pbrt_warn_once(p, place, others[i], "media \"%s\" are not supported: nothing is there",
                                    kind);
                return SAG_OK;
            }
        return sagi_params_fail(params, sagi_params_find(params, "type", ~0u), "unknown medium \"%.60s\"",
                                kind);
    }
    sag_medium medium = {.scale = sagi_params_float(params, "scale", 1),
                         .g = sagi_params_float(params, "g", 0)};
    const bool nothing = medium.scale == 0;
    read_coefficients(p, place, &medium);
    if (sagi_params_find(params, "Le", ~0u)) {
        medium.emission = sagi_pbrt_light_color(p, "Le");
        medium.emission_scale = sagi_params_float(params, "Lescale", 1);
        if (medium.emission_scale == 0) medium.emission = (sag_input){.texture = 0};
    } else {
        sagi_pbrt_ignore(p, "Lescale", NULL);
    }
    const sag_status status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK || nothing) return status;
    if (sag_world_set_medium(p->world, id, &medium) != SAG_OK)
        return sagi_params_fail(params, NULL,
                                "sigma_a, sigma_s, scale and Le must not be negative or infinite, nor be "
                                "textures; g is in (-1, 1)");
    return SAG_OK;
}

sag_status sagi_pbrt_make_named_medium(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    uint32_t number;
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters_of(p, place, SAGI_TARGET_MEDIUM, "MakeNamedMedium", name);
    if (status != SAG_OK) return status;
    if (!name[0]) return sagi_place_error(place, p->error, "MakeNamedMedium: a name expected");
    if (!number_of(p, place, name, &number)) return sagi_pbrt_out_of_memory(p);
    sagi_medium_name *medium = &p->media[number - 1];
    if (medium->made) return sagi_place_error(place, p->error, "there is a medium \"%.100s\" already", name);
    medium->made = true;
    return p->options->geometry_only ? SAG_OK : read_medium(p, place, medium->id);
}

sag_status sagi_pbrt_medium_interface(sagi_pbrt *p, sagi_place place) {
    char inside[1024], outside[1024];
    sag_status status = sagi_pbrt_string(p, place, inside, sizeof inside);
    if (status != SAG_OK) return status;
    memcpy(outside, inside, sizeof outside);
    sagi_cursor *cursor = &p->files[p->file_count - 1];
    sagi_token second;
    const sagi_cursor before = *cursor;
    status = sagi_cursor_next(cursor, &second, p->error);
    if (status != SAG_OK) return status;
    *cursor = before;
    if (second.kind == SAGI_TOKEN_STRING) status = sagi_pbrt_string(p, place, outside, sizeof outside);
    if (status != SAG_OK) return status;
    if (!number_of(p, place, inside, &p->state.inside) || !number_of(p, place, outside, &p->state.outside))
        return sagi_pbrt_out_of_memory(p);
    return SAG_OK;
}

sag_status sagi_pbrt_check_media(sagi_pbrt *p) {
    for (size_t i = 0; i < p->medium_count; i++)
        if (!p->media[i].made)
            return sagi_place_error(p->media[i].used_at, p->error, "this medium is never made");
    return SAG_OK;
}
