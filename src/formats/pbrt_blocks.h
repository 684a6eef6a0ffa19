// SPDX-License-Identifier: MIT
// The directives that move space and open blocks.
#ifndef SAGI_FORMATS_PBRT_BLOCKS_H
#define SAGI_FORMATS_PBRT_BLOCKS_H

#include "formats/pbrt.h"

// Saves the state for a block; takes it back, if the innermost open block is of this kind.
sag_status sagi_pbrt_push(sagi_pbrt *p, sagi_place place, sagi_block block);
sag_status sagi_pbrt_pop(sagi_pbrt *p, sagi_place place, sagi_block block);
// An error when a block is still open.
sag_status sagi_pbrt_check_closed(sagi_pbrt *p);
// Remembers the current transform under a name. False when memory is short.
bool sagi_pbrt_name_system(sagi_pbrt *p, sagi_slice name);

sag_status sagi_pbrt_attribute_begin(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_attribute_end(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_attribute(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_transform_begin(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_transform_end(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_reverse_orientation(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_identity(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_translate(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_scale(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_rotate(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_look_at(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_transform(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_concat_transform(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_coordinate_system(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_coord_sys_transform(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_active_transform(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_transform_times(sagi_pbrt *p, sagi_place place);

#endif
