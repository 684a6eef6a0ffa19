// SPDX-License-Identifier: MIT
// Meshes and pictures of a pbrt scene that are read later, all at once and on all threads.
#ifndef SAGI_FORMATS_PBRT_LATER_H
#define SAGI_FORMATS_PBRT_LATER_H

#include "formats/pbrt.h"

// Whether a mesh at this point may be read later: not within a solid.
bool sagi_pbrt_may_wait(const sagi_pbrt *p);

// The mesh of a PLY file; `name` is the place of its name.
sag_status sagi_pbrt_ply_later(sagi_pbrt *p, const char *path, sagi_place name);
// The triangle mesh whose parameters have been skimmed (sagi_params.skim); `parameters` is where they begin.
// False, having done nothing, when something about it is unusual: then it is to be read now.
bool sagi_pbrt_triangles_later(sagi_pbrt *p, sagi_cursor parameters, sag_status *status);
// The picture in the file that the texture or material being read names there. Its id is good at once.
sag_status sagi_pbrt_picture_later(sagi_pbrt *p, const char *path, sagi_place name, sag_encoding encoding,
                                   double gamma, sag_picture_id *id);
// An object's scene is committed again once its meshes are there. False when it has none that wait.
bool sagi_pbrt_commit_later(sagi_pbrt *p, sagi_place place, uint32_t object, sag_status *status);
// A message that comes after those of the meshes before it. False when nothing waits.
bool sagi_pbrt_message_later(sagi_pbrt *p, const char *message);

// Reads all that waits. Messages and the first error are those of reading in the order of the file.
sag_status sagi_pbrt_catch_up(sagi_pbrt *p);
// The same if so much waits that it is better done now.
sag_status sagi_pbrt_catch_up_partly(sagi_pbrt *p);
void sagi_pbrt_later_clear(sagi_pbrt *p);

#endif
