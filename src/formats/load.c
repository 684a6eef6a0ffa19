// SPDX-License-Identifier: MIT
// Which reader a scene's file goes to, told by the ending of its name.
#include "formats/load.h"

#include <string.h>
#include <strings.h>

static bool ends_with(const char *path, const char *ending) {
    const size_t length = strlen(path), n = strlen(ending);
    return length > n && strcasecmp(path + length - n, ending) == 0;
}

static sag_status load(sag_world *world, const char *path, const sagi_load_options *options,
                       sag_error *error) {
    if (!world || !path || !path[0]) return sag_error_set(error, SAG_ERROR_ARGUMENT, "no file to load");
    if (ends_with(path, ".pbrt") || ends_with(path, ".pbrt.gz"))
        return sagi_pbrt_load(world, path, options, error);
    return sagi_import_load(world, path, options, error);
}

sag_status sag_world_load(sag_world *world, const char *path, sag_error *error) {
    const sagi_load_options options = {.geometry_only = false};
    return load(world, path, &options, error);
}

sag_status sag_world_load_geometry(sag_world *world, const char *path, sag_mesh_callback on_mesh, void *user,
                                   sag_error *error) {
    const sagi_load_options options = {.geometry_only = true, .on_mesh = on_mesh, .user = user};
    return load(world, path, &options, error);
}
