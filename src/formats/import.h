// SPDX-License-Identifier: MIT
// Models that bring no scene: how they get into the world (import.c) and what is put around them (stage.c).
#ifndef SAGI_FORMATS_IMPORT_H
#define SAGI_FORMATS_IMPORT_H

#include "formats/load.h"

// Reads the file through Assimp and adds its meshes; `upright` is applied last. `bounds`, unless NULL, grows
// to hold what was added.
sag_status sagi_assimp_load(sag_world *world, const char *path, const sagi_load_options *options,
                            const sag_affine *upright, sag_box3 *bounds, sag_error *error);

// Adds one mesh to a scene of the world, telling the listener: as it is for geometry only, else with smooth
// normals where it has none, and with the look. `bounds` as above.
sag_status sagi_import_add(sag_world *world, const sagi_load_options *options, sag_scene *scene,
                           sagi_mesh_data *data, const char *name, const sag_appearance *look,
                           const sag_affine *placed, sag_box3 *bounds, sag_error *error);

// What a model without material is made of: light clay under a matt coat. 0 when memory is short.
uint32_t sagi_default_material(sag_world *world);

#endif
