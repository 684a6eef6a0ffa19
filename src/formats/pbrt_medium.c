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
    p->media[p->medium_count++] = (sagi_medium_name){.used_at = place};
    *number = (uint32_t)p->medium_count;
    return sagi_names_set(&p->medium_names, key, *number);
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
    sagi_pbrt_warn_once(p, place, "media", "participating media are not supported: they are left out");
    return SAG_OK;
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
