// SPDX-License-Identifier: MIT
// Pictures for textures, from files: 8-bit ones keep their bytes. As in pbrt-v4 the encoding that a scene
// asks for is for PNG files; the other 8-bit formats have one of their own, and floats are linear.
#include "formats/picture.h"

#include "formats/file.h"
#include "formats/image.h"
#include "math/elementary.h"

#include <math.h>

// Numbers of 16 bits, which were read as linear ones, to what they stand for.
static void apply_gamma(sag_image *image, double gamma) {
    const size_t n = (size_t)image->width * image->height * image->channels;
    for (size_t i = 0; i < n; i++) image->pixels[i] = (float)sagi_pow((double)image->pixels[i], gamma);
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

sag_status sagi_picture_read(sag_picture_id id, sag_world *world, sag_error *error) {
    sagi_picture *picture = sagi_world_picture_entry(world, id);
    const sagi_transfer transfer = picture->transfer;
    sag_context *context = sag_world_context(world);
    sagi_file file;
    sag_status status = sagi_file_open(context, picture->path, &file, error);
    if (status != SAG_OK) return status;
    sagi_image_bytes kept = {0};
    const sag_encoding encoding = transfer.gamma > 0 ? SAG_ENCODING_LINEAR : transfer.encoding;
    const sagi_image_source source = {context, picture->path, file.bytes, file.size, encoding, &kept};
    status = decode(&source, transfer, &picture->mipmap, error);
    sagi_file_close(&file);
    return status;
}

sag_picture_id sagi_picture_reserve(sag_world *world, const char *path, sag_encoding encoding, double gamma,
                                    bool *is_new) {
    const sagi_transfer transfer = {encoding == SAG_ENCODING_DEFAULT ? SAG_ENCODING_SRGB : encoding,
                                    gamma > 0 && isfinite(gamma) ? gamma : 0};
    const sag_picture_id found = sagi_world_find_picture(world, path, transfer);
    *is_new = found == 0;
    sagi_mipmap empty = {0};
    return found != 0 ? found : sagi_world_keep_picture(world, &empty, path, transfer);
}

sag_status sag_world_load_picture(sag_world *world, const char *path, sag_encoding encoding, double gamma,
                                  sag_picture_id *id, sag_error *error) {
    bool is_new;
    *id = 0;
    const sag_picture_id made = sagi_picture_reserve(world, path, encoding, gamma, &is_new);
    if (made == 0) return sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory");
    const sag_status status = is_new ? sagi_picture_read(made, world, error) : SAG_OK;
    if (status == SAG_OK)
        *id = made;
    else
        sagi_world_drop_picture(world); // the newest
    return status;
}
