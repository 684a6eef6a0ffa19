// SPDX-License-Identifier: MIT
// Names that are used before what they stand for is there. As in pbrt-v4 that may come later in the file, for
// textures, materials and objects (and media, pbrt_medium.h).
#ifndef SAGI_FORMATS_PBRT_PROMISE_H
#define SAGI_FORMATS_PBRT_PROMISE_H

#include "formats/pbrt.h"

// The id of a name, if there is or will be such a thing. False: none yet.
bool sagi_pbrt_find(const sagi_pbrt *p, const sagi_names *names, sagi_slice name, uint32_t *id);
// Whether it is there already.
bool sagi_pbrt_is_made(const sagi_names *names, sagi_slice name);
// An id for a name that is to come.
sag_status sagi_pbrt_promise(sagi_pbrt *p, sagi_place place, sagi_names *names, sagi_slice name,
                             uint32_t *id);
// The id a name was promised; 0: none was, or what it stands for is made. And that it is now.
uint32_t sagi_pbrt_promised(const sagi_pbrt *p, const sagi_names *names, const char *name);
void sagi_pbrt_keep(sagi_pbrt *p, sagi_names *names, const char *name);
// A material that is mixed of one that is to come, which may be no interface.
sag_status sagi_pbrt_promise_mix(sagi_pbrt *p, sagi_place place, uint32_t material);
// An instance of an object that is to come, at the current transform.
sag_status sagi_pbrt_promise_instance(sagi_pbrt *p, sagi_place place, const char *name);

// At the end of the scene: an error for what never came; places the instances.
sag_status sagi_pbrt_check_promises(sagi_pbrt *p);
void sagi_pbrt_promises_clear(sagi_pbrt *p);

#endif
