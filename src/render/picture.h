// SPDX-License-Identifier: MIT
// The pictures of a world, which textures look up.
#ifndef SAGI_RENDER_PICTURE_H
#define SAGI_RENDER_PICTURE_H

#include "mipmap.h"

typedef struct sagi_picture {
    sagi_mipmap mipmap;
    char *path; // of a picture that came from a file, or NULL
    sagi_transfer transfer;
} sagi_picture;

// The picture that was read from this file in this way, or 0.
sag_picture_id sagi_world_find_picture(const sag_world *world, const char *path, sagi_transfer transfer);
// Takes the mipmap over, also on failure; `path` may be NULL. 0 when memory is short.
sag_picture_id sagi_world_keep_picture(sag_world *world, sagi_mipmap *mipmap, const char *path,
                                       sagi_transfer transfer);
sagi_picture *sagi_world_picture_entry(sag_world *world, sag_picture_id id); // one that is
// Takes back the picture that was added last.
void sagi_world_drop_picture(sag_world *world);
// NULL for an id that is none.
const sagi_mipmap *sagi_world_picture(const sag_world *world, sag_picture_id id);
void sagi_world_clear_pictures(sag_world *world);

#endif
