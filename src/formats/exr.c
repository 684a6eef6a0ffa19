// SPDX-License-Identifier: MIT
// OpenEXR through OpenEXRCore, its C library. Reading: the first part, scan lines or tiles (the full-size
// level), the channels R G B (A), or Y (A), or whatever the first is; halves become floats; chunk by chunk
// into the image. Writing: one part of scan lines, 32-bit floats, ZIP, into memory first, since the library
// fills its chunk table last and a pipe cannot go back.
#include "formats/image.h"

#if SAGITTA_HAVE_OPENEXR

#include "render/colorspace.h"

#include <math.h>
#include <openexr.h>
#include <string.h>

typedef struct reader {
    const sagi_image_source *source;
    exr_context_t exr;
    float *waste; // where channels go that nobody wants
    size_t waste_bytes;
} reader;

static int64_t on_size(exr_const_context_t exr, void *user) {
    (void)exr;
    return (int64_t)((const reader *)user)->source->size;
}

static int64_t on_read(exr_const_context_t exr, void *user, void *out, uint64_t count, uint64_t offset,
                       exr_stream_error_func_ptr_t on_error) {
    (void)exr, (void)on_error;
    const sagi_image_source *source = ((const reader *)user)->source;
    if (offset >= source->size) return 0;
    const uint64_t left = source->size - offset;
    if (count > left) count = left;
    memcpy(out, source->bytes + offset, count);
    return (int64_t)count;
}

// The library prints where it has no callback. What it says also comes as a code.
static void on_message(exr_const_context_t exr, exr_result_t code, const char *message) {
    (void)exr, (void)code, (void)message;
}

static sag_status damaged(const reader *r, sag_error *error, exr_result_t code) {
    return sagi_image_damaged(r->source, error, "EXR",
                              code == EXR_ERR_READ_IO ? "the file is cut short"
                                                      : exr_get_default_error_message(code));
}

// Which channels of the file go where: names[i] is the image's channel i.
typedef struct selection {
    const char *names[4];
    uint32_t count;
} selection;

static bool has_channel(const exr_attr_chlist_t *list, const char *name) {
    for (int i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0) return true;
    return false;
}

static selection select_channels(const exr_attr_chlist_t *list) {
    selection s = {{NULL}, 0};
    if (has_channel(list, "R") && has_channel(list, "G") && has_channel(list, "B")) {
        s.names[0] = "R", s.names[1] = "G", s.names[2] = "B";
        s.count = 3;
    } else {
        s.names[0] = has_channel(list, "Y") ? "Y" : list->entries[0].name.str;
        s.count = 1;
    }
    if (has_channel(list, "A") && strcmp(s.names[0], "A") != 0) s.names[s.count++] = "A";
    return s;
}

// The chromaticities of a colour space, and the space that has these, to 0.001 as pbrt-v4 takes it; sRGB when
// none.
static exr_attr_chromaticities_t chromaticities_of(sag_color_space space) {
    const sagi_color_space *s = &sagi_color_spaces[space];
    const double sum = s->white[0] + s->white[1] + s->white[2];
    return (exr_attr_chromaticities_t){.red_x = (float)s->primaries[0][0],
                                       .red_y = (float)s->primaries[0][1],
                                       .green_x = (float)s->primaries[1][0],
                                       .green_y = (float)s->primaries[1][1],
                                       .blue_x = (float)s->primaries[2][0],
                                       .blue_y = (float)s->primaries[2][1],
                                       .white_x = (float)(s->white[0] / sum),
                                       .white_y = (float)(s->white[1] / sum)};
}

static bool is_near(float a, float b) { return fabsf(a - b) < 1e-3F; }

static sag_color_space find_space(exr_const_context_t exr) {
    exr_attr_chromaticities_t c;
    if (exr_attr_get_chromaticities(exr, 0, "chromaticities", &c) != EXR_ERR_SUCCESS) return SAG_COLOR_SRGB;
    for (int i = 0; i < SAGI_COLOR_SPACE_COUNT; i++) {
        const exr_attr_chromaticities_t s = chromaticities_of((sag_color_space)i);
        if (is_near(s.red_x, c.red_x) && is_near(s.red_y, c.red_y) && is_near(s.green_x, c.green_x) &&
            is_near(s.green_y, c.green_y) && is_near(s.blue_x, c.blue_x) && is_near(s.blue_y, c.blue_y) &&
            is_near(s.white_x, c.white_x) && is_near(s.white_y, c.white_y))
            return (sag_color_space)i;
    }
    return SAG_COLOR_SRGB;
}

// Room for one chunk of a channel that nobody wants; false when there is no memory.
static bool make_waste(reader *r, size_t count) {
    const size_t bytes = count * sizeof *r->waste;
    if (bytes <= r->waste_bytes) return true;
    sag_release(r->source->context, r->waste, r->waste_bytes);
    r->waste = sag_allocate(r->source->context, bytes);
    r->waste_bytes = r->waste != NULL ? bytes : 0;
    return r->waste != NULL;
}

// Reads one chunk (a band of scan lines, or a tile) to column x and row y of the image. All channels are
// decoded: OpenEXR 3.1 to 3.3 has quick ways for three and four channels of halves, which write to all of
// them, wanted or not (openexr-1991).
static exr_result_t read_chunk(reader *r, const exr_chunk_info_t *chunk, exr_decode_pipeline_t *pipeline,
                               bool first, const selection *s, uint32_t x, uint32_t y, sag_image *image) {
    exr_result_t code = first ? exr_decoding_initialize(r->exr, 0, chunk, pipeline)
                              : exr_decoding_update(r->exr, 0, chunk, pipeline);
    if (code != EXR_ERR_SUCCESS) return code;
    const uint32_t stride = image->channels * (uint32_t)sizeof(float);
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        if (channel->width < 0 || channel->height < 0 ||
            (uint64_t)x + (uint64_t)channel->width > image->width ||
            (uint64_t)y + (uint64_t)channel->height > image->height)
            return EXR_ERR_CORRUPT_CHUNK;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        uint32_t c = 0;
        while (c < s->count && strcmp(channel->channel_name, s->names[c]) != 0) c++;
        if (c < s->count) {
            channel->decode_to_ptr =
                (uint8_t *)(image->pixels + ((size_t)y * image->width + x) * image->channels + c);
            channel->user_pixel_stride = (int32_t)stride;
            channel->user_line_stride = (int32_t)(stride * image->width);
        } else {
            if (!make_waste(r, (size_t)channel->width * (size_t)channel->height + 1))
                return EXR_ERR_OUT_OF_MEMORY;
            channel->decode_to_ptr = (uint8_t *)r->waste;
            channel->user_pixel_stride = 4;
            channel->user_line_stride = 4 * channel->width;
        }
    }
    if (first) code = exr_decoding_choose_default_routines(r->exr, 0, pipeline);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(r->exr, 0, pipeline) : code;
}

static exr_result_t read_scanlines(reader *r, const exr_attr_box2i_t *window, const selection *s,
                                   exr_decode_pipeline_t *pipeline, sag_image *image) {
    int32_t lines = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(r->exr, 0, &lines);
    if (code == EXR_ERR_SUCCESS && lines < 1) code = EXR_ERR_CORRUPT_CHUNK;
    for (uint32_t y = 0; code == EXR_ERR_SUCCESS && y < image->height; y += (uint32_t)lines) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(r->exr, 0, window->min.y + (int32_t)y, &chunk);
        if (code == EXR_ERR_SUCCESS) code = read_chunk(r, &chunk, pipeline, y == 0, s, 0, y, image);
    }
    return code;
}

static exr_result_t read_tiles(reader *r, const selection *s, exr_decode_pipeline_t *pipeline,
                               sag_image *image) {
    int32_t tile_width = 0, tile_height = 0;
    exr_result_t code = exr_get_tile_sizes(r->exr, 0, 0, 0, &tile_width, &tile_height);
    if (code == EXR_ERR_SUCCESS && (tile_width < 1 || tile_height < 1)) code = EXR_ERR_CORRUPT_CHUNK;
    bool first = true;
    for (uint32_t y = 0; code == EXR_ERR_SUCCESS && y < image->height; y += (uint32_t)tile_height) {
        for (uint32_t x = 0; code == EXR_ERR_SUCCESS && x < image->width; x += (uint32_t)tile_width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(r->exr, 0, (int)(x / (uint32_t)tile_width),
                                            (int)(y / (uint32_t)tile_height), 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) code = read_chunk(r, &chunk, pipeline, first, s, x, y, image);
            first = false;
        }
    }
    return code;
}

static sag_status read_part(reader *r, sag_image *image, sag_error *error) {
    exr_storage_t storage;
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *list = NULL;
    exr_result_t code = exr_get_storage(r->exr, 0, &storage);
    if (code == EXR_ERR_SUCCESS) code = exr_get_data_window(r->exr, 0, &window);
    if (code == EXR_ERR_SUCCESS) code = exr_get_channels(r->exr, 0, &list);
    if (code != EXR_ERR_SUCCESS) return damaged(r, error, code);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return sagi_image_damaged(r->source, error, "EXR", "deep images are not pictures");
    if (list->num_channels < 1) return sagi_image_damaged(r->source, error, "EXR", "it has no channels");
    const selection s = select_channels(list);
    for (int i = 0; i < list->num_channels; i++)
        if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1)
            return sagi_image_damaged(r->source, error, "EXR",
                                      "channels of reduced resolution are not supported");
    const int64_t width = (int64_t)window.max.x - window.min.x + 1,
                  height = (int64_t)window.max.y - window.min.y + 1;
    sag_status status =
        sagi_image_create_for(r->source, width < 1 ? 0 : (uint64_t)width, height < 1 ? 0 : (uint64_t)height,
                              s.count, 32, 8 * 1032, "EXR", image, error);
    if (status != SAG_OK) return status;
    image->color_space = find_space(r->exr);
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    code = storage == EXR_STORAGE_TILED ? read_tiles(r, &s, &pipeline, image)
                                        : read_scanlines(r, &window, &s, &pipeline, image);
    exr_decoding_destroy(r->exr, &pipeline);
    sag_release(r->source->context, r->waste, r->waste_bytes);
    return code == EXR_ERR_SUCCESS ? SAG_OK : damaged(r, error, code);
}

sag_status sagi_exr_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    reader r = {.source = source};
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = on_message;
    options.user_data = &r;
    options.read_fn = on_read;
    options.size_fn = on_size;
    options.max_image_width = options.max_image_height = SAG_MAX_IMAGE_SIZE;
    options.flags = EXR_CONTEXT_FLAG_SILENT_HEADER_PARSE | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    const exr_result_t code = exr_start_read(&r.exr, source->path, &options);
    if (code != EXR_ERR_SUCCESS) return damaged(&r, error, code);
    const sag_status status = read_part(&r, image, error);
    exr_finish(&r.exr);
    return status;
}

// The file as it grows; writes may go back.
typedef struct writer {
    const sag_context *context;
    uint8_t *bytes;
    size_t size, allocated;
} writer;

static int64_t on_write(exr_const_context_t exr, void *user, const void *data, uint64_t count,
                        uint64_t offset, exr_stream_error_func_ptr_t on_error) {
    (void)exr, (void)on_error;
    writer *w = user;
    const size_t end = (size_t)(offset + count);
    if (end > w->allocated) {
        const size_t larger = 2 * end;
        uint8_t *bytes = sag_allocate(w->context, larger);
        if (!bytes) return -1;
        if (w->size) memcpy(bytes, w->bytes, w->size);
        sag_release(w->context, w->bytes, w->allocated);
        w->bytes = bytes;
        w->allocated = larger;
    }
    if (offset > w->size) memset(w->bytes + w->size, 0, (size_t)offset - w->size);
    memcpy(w->bytes + offset, data, count);
    if (end > w->size) w->size = end;
    return (int64_t)count;
}

static exr_result_t write_header(exr_context_t exr, const sagi_exr_picture *p) {
    exr_attr_box2i_t display, data;
    display.min.x = display.min.y = 0;
    display.max.x = (int32_t)p->full_width - 1, display.max.y = (int32_t)p->full_height - 1;
    data.min.x = (int32_t)p->x, data.min.y = (int32_t)p->y;
    data.max.x = (int32_t)(p->x + p->width) - 1, data.max.y = (int32_t)(p->y + p->height) - 1;
    exr_attr_v2f_t center;
    center.x = center.y = 0;
    exr_result_t code = exr_add_part(exr, NULL, EXR_STORAGE_SCANLINE, NULL);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr(exr, 0, &display, &data, 1, &center, 1,
                                            EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    for (uint32_t c = 0; code == EXR_ERR_SUCCESS && c < p->channel_count; c++)
        code =
            exr_add_channel(exr, 0, p->names[c], p->is_id && p->is_id[c] ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                            EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    const exr_attr_chromaticities_t chromaticities = chromaticities_of(p->color_space);
    if (code == EXR_ERR_SUCCESS)
        code = exr_attr_set_chromaticities(exr, 0, "chromaticities", &chromaticities);
    return code == EXR_ERR_SUCCESS ? exr_write_header(exr) : code;
}

// In the file channels stand in the order of their names.
static exr_result_t point_at_rows(const sagi_exr_picture *p, uint32_t row, exr_encode_pipeline_t *pipeline) {
    const uint32_t stride = p->channel_count * (uint32_t)sizeof(float);
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        uint32_t c = 0;
        while (c < p->channel_count && strcmp(channel->channel_name, p->names[c]) != 0) c++;
        if (c == p->channel_count) return EXR_ERR_INVALID_ARGUMENT;
        channel->user_data_type = p->is_id && p->is_id[c] ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        channel->user_pixel_stride = (int32_t)stride;
        channel->user_line_stride = (int32_t)(stride * p->width);
        channel->encode_from_ptr =
            (const uint8_t *)(p->pixels + (size_t)row * p->width * p->channel_count + c);
    }
    return EXR_ERR_SUCCESS;
}

// What does not get smaller is stored as it is, and is told from the rest by having the same size. OpenEXR
// 3.1.5 stores it compressed where that has the very same size, for a reader to take as it is: one block of a
// noisy picture in thirty would be garbage.
typedef struct compressor {
    exr_result_t (*compress)(exr_encode_pipeline_t *pipeline);
} compressor;

static exr_result_t compress_block(exr_encode_pipeline_t *pipeline) {
    const compressor *own = pipeline->encoding_user_data;
    const exr_result_t code = own->compress(pipeline);
    if (code != EXR_ERR_SUCCESS || pipeline->compressed_bytes < pipeline->packed_bytes) return code;
    memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
    pipeline->compressed_bytes = pipeline->packed_bytes;
    return code;
}

static exr_result_t write_lines(exr_context_t exr, const sagi_exr_picture *p,
                                exr_encode_pipeline_t *pipeline) {
    int32_t lines = 0;
    compressor own = {.compress = NULL};
    exr_result_t code = exr_get_scanlines_per_chunk(exr, 0, &lines);
    for (uint32_t y = 0; code == EXR_ERR_SUCCESS && y < p->height; y += (uint32_t)lines) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(exr, 0, (int)(p->y + y), &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = y == 0 ? exr_encoding_initialize(exr, 0, &chunk, pipeline)
                          : exr_encoding_update(exr, 0, &chunk, pipeline);
        if (code == EXR_ERR_SUCCESS) code = point_at_rows(p, y, pipeline);
        if (code == EXR_ERR_SUCCESS && y == 0) {
            code = exr_encoding_choose_default_routines(exr, 0, pipeline);
            own.compress = pipeline->compress_fn;
            pipeline->encoding_user_data = &own;
            if (own.compress) pipeline->compress_fn = compress_block;
        }
        if (code == EXR_ERR_SUCCESS) code = exr_encoding_run(exr, 0, pipeline);
    }
    pipeline->encoding_user_data = NULL;
    return code;
}

sag_status sagi_exr_write(const sag_context *context, const sagi_exr_picture *picture, FILE *file,
                          const char *path, sag_error *error) {
    writer w = {.context = context};
    exr_context_t exr;
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = on_message;
    options.user_data = &w;
    options.write_fn = on_write;
    exr_result_t code = exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &options);
    if (code == EXR_ERR_SUCCESS) {
        exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
        code = write_header(exr, picture);
        if (code == EXR_ERR_SUCCESS) code = write_lines(exr, picture, &pipeline);
        exr_encoding_destroy(exr, &pipeline);
        const exr_result_t end = exr_finish(&exr);
        if (code == EXR_ERR_SUCCESS) code = end;
    }
    if (code == EXR_ERR_SUCCESS) fwrite(w.bytes, 1, w.size, file);
    sag_release(context, w.bytes, w.allocated);
    return code == EXR_ERR_SUCCESS ? SAG_OK
                                   : sag_error_set_at(error, SAG_ERROR_IO, path, 0, 0, "cannot write EXR: %s",
                                                      exr_get_default_error_message(code));
}

#else // OpenEXR has its C interface since version 3.1

sag_status sagi_exr_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    (void)image;
    return sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0,
                            "built without OpenEXR: cannot read EXR");
}

sag_status sagi_exr_write(const sag_context *context, const sagi_exr_picture *picture, FILE *file,
                          const char *path, sag_error *error) {
    (void)context, (void)picture, (void)file;
    return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0, "built without OpenEXR: cannot write EXR");
}

#endif
