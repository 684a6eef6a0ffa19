// SPDX-License-Identifier: MIT
// Pictures for textures, from files: 8-bit ones keep their bytes. As in pbrt-v4 the encoding that a scene
// asks for is for PNG files; the other 8-bit formats have one of their own, and floats are linear.
#include "render/picture.h"
#include "formats/file.h"
#include "formats/image.h"

#include <math.h>

// Numbers of 16 bits, which were read as linear ones, to what they stand for.
static void apply_gamma(sag_image *image, double gamma) {
    const size_t n = (size_t)image->width * image->height * image->channels;
    for (size_t i = 0; i < n; i++) image->pixels[i] = (float)pow((double)image->pixels[i], gamma);
}

static bool is_png(const sagi_image_source *source) { return source->size > 0 && source->bytes[0] == 0x89; }

static sag_status decode(const sagi_image_source *source, sagi_transfer transfer, sagi_mipmap *mipmap,
                         sag_error *error) {
    const sag_context *context = source->context;
    sag_image image = {0};
    sag_status status = sagi_image_decode(source, &image, error);
    if (status != SAG_OK) return status;
    const sagi_image_bytes *kept = source->kept;
    if (!kept->bytes) {
        if (transfer.gamma > 0 && is_png(source)) apply_gamma(&image, transfer.gamma);
        status = sagi_mipmap_init(mipmap, context, &image, error);
        sag_image_clear(context, &image);
        return status;
    }
    if (kept->encoding != SAG_ENCODING_DEFAULT) transfer = (sagi_transfer){kept->encoding, 0};
    status = sagi_mipmap_init_bytes(mipmap, context, kept->bytes, image.width, image.height, image.channels,
                                    transfer, error);
    sag_release(context, kept->bytes, kept->size);
    return status;
}

sag_status sag_world_load_picture(sag_world *world, const char *path, sag_encoding encoding, double gamma,
                                  sag_picture_id *id, sag_error *error) {
    *id = 0;
    const sagi_transfer transfer = {encoding == SAG_ENCODING_DEFAULT ? SAG_ENCODING_SRGB : encoding,
                                    gamma > 0 && isfinite(gamma) ? gamma : 0};
    *id = sagi_world_find_picture(world, path, transfer);
    if (*id != 0) return SAG_OK;
    sag_context *context = sag_world_context(world);
    sagi_file file;
    sag_status status = sagi_file_open(context, path, &file, error);
    if (status != SAG_OK) return status;
    sagi_image_bytes kept = {0};
    const sag_encoding encoding_read = transfer.gamma > 0 ? SAG_ENCODING_LINEAR : transfer.encoding;
    const sagi_image_source source = {context, path, file.bytes, file.size, encoding_read, &kept};
    sagi_mipmap mipmap;
    status = decode(&source, transfer, &mipmap, error);
    sagi_file_close(&file);
    if (status != SAG_OK) return status;
    *id = sagi_world_keep_picture(world, &mipmap, path, transfer);
    return *id != 0 ? SAG_OK : sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory");
}
