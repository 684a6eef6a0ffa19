// SPDX-License-Identifier: MIT
// Pictures for textures, in two steps: one gets an id at once and is read later, on any thread.
#ifndef SAGI_FORMATS_PICTURE_H
#define SAGI_FORMATS_PICTURE_H

#include "render/picture.h"

// The id of the picture that this file is, read in this way (see sag_world_load_picture); *is_new: nobody has
// asked for it before, it is to be read. 0 when memory is short.
sag_picture_id sagi_picture_reserve(sag_world *world, const char *path, sag_encoding encoding, double gamma,
                                    bool *is_new);
// Reads it. Others may be read at the same time; none may be added meanwhile.
sag_status sagi_picture_read(sag_picture_id id, sag_world *world, sag_error *error);

#endif
