// SPDX-License-Identifier: MIT
// Materials of models that Assimp reads, as ours.
#ifndef SAGI_FORMATS_IMPORT_MATERIAL_H
#define SAGI_FORMATS_IMPORT_MATERIAL_H

#include "formats/import.h"

#include <assimp/scene.h>

// Where a material comes from.
typedef struct sagi_import_source {
    sag_world *world;
    const struct aiScene *scene;
    const char *path;      // of the model
    const char *directory; // with a slash: names of pictures are relative to it
} sagi_import_source;

// The look of what has this material: material, emission, alpha. False when memory is short.
bool sagi_import_look(const sagi_import_source *source, const struct aiMaterial *from, sag_appearance *look);

#endif
