// SPDX-License-Identifier: MIT
// A picture's layers to a file: one part with all channels, as viewers, compositors and denoisers expect.
#include "formats/image.h"
#include "formats/output.h"

#include <sagitta/render.h>
#include <string.h>
#include <strings.h>

sag_status sag_layers_write(const sag_context *context, const sag_layers *layers, const char *path,
                            sag_error *error) {
    const size_t length = strlen(path);
    if (!layers->pixels)
        return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0, "there are no layers to write");
    if (length < 5 || strcasecmp(path + length - 4, ".exr") != 0)
        return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0,
                                "layers are written to .exr files only");
    const sagi_exr_picture picture = {.width = layers->width,
                                      .height = layers->height,
                                      .x = layers->x,
                                      .y = layers->y,
                                      .full_width = layers->full_width,
                                      .full_height = layers->full_height,
                                      .channel_count = layers->channel_count,
                                      .names = layers->names,
                                      .is_id = layers->is_id,
                                      .pixels = layers->pixels,
                                      .color_space = layers->color_space};
    sagi_output output;
    sag_status status = sagi_output_open(&output, path, error);
    if (status != SAG_OK) return status;
    status = sagi_exr_write(context, &picture, output.file, path, error);
    if (status == SAG_OK) return sagi_output_commit(&output, error);
    sagi_output_discard(&output);
    return status;
}
