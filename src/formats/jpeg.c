// SPDX-License-Identifier: MIT
// JPEG through libjpeg(-turbo), reading only. CMYK files (Adobe's, stored inverted) are turned to RGB
// plainly: R = C·K. A file whose data end too soon or are damaged is an error, where libjpeg would fill in
// grey.
#include "formats/image.h"

#include <setjmp.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

typedef struct reader {
    const sagi_image_source *source;
    sag_image *image;
    sag_error *error;
    sag_status status;
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    jmp_buf jump;
    uint8_t *row;
    size_t row_bytes;
} reader;

static void on_error(j_common_ptr info) {
    reader *r = info->client_data;
    char message[JMSG_LENGTH_MAX];
    info->err->format_message(info, message);
    r->status = sagi_image_damaged(r->source, r->error, "JPEG", message);
    longjmp(r->jump, 1);
}

// Negative levels are warnings about the data. Stray bytes between the parts are harmless and common.
static void on_message(j_common_ptr info, int level) {
    if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA && info->err->msg_code != JWRN_ADOBE_XFORM)
        on_error(info);
}

static void on_output(j_common_ptr info) { (void)info; }

static void read_image(reader *r) {
    if (setjmp(r->jump)) return;
    jpeg_create_decompress(&r->jpeg);
    jpeg_mem_src(&r->jpeg, r->source->bytes, (unsigned long)r->source->size);
    jpeg_read_header(&r->jpeg, TRUE);
    const bool grey = r->jpeg.jpeg_color_space == JCS_GRAYSCALE;
    const bool cmyk = r->jpeg.jpeg_color_space == JCS_CMYK || r->jpeg.jpeg_color_space == JCS_YCCK;
    r->jpeg.out_color_space = grey ? JCS_GRAYSCALE : cmyk ? JCS_CMYK : JCS_RGB;
    // A block of 64 pixels takes two bits in a sequential file; in a progressive one a run of 32767 empty
    // blocks takes about three bytes, but the first pass still names each block.
    r->status = sagi_image_create_for(r->source, r->jpeg.image_width, r->jpeg.image_height, grey ? 1 : 3, 8,
                                      64 * 8, "JPEG", r->image, r->error);
    if (r->status != SAG_OK) return;
    if (r->source->kept) r->source->kept->encoding = SAG_ENCODING_SRGB;
    jpeg_start_decompress(&r->jpeg);
    r->row_bytes = (size_t)r->jpeg.output_width * (size_t)r->jpeg.output_components;
    r->row = sag_allocate(r->source->context, r->row_bytes);
    if (!r->row) {
        r->status = sag_error_set_at(r->error, SAG_ERROR_MEMORY, r->source->path, 0, 0, "out of memory");
        return;
    }
    for (uint32_t y = 0; y < r->image->height; y++) {
        JSAMPROW row = r->row;
        jpeg_read_scanlines(&r->jpeg, &row, 1);
        if (cmyk) {
            for (uint32_t x = 0; x < r->image->width; x++)
                for (uint32_t c = 0; c < 3; c++)
                    r->row[3 * x + c] = (uint8_t)((r->row[4 * x + c] * r->row[4 * x + 3] + 127) / 255);
        }
        sagi_image_decode_row(r->source, r->row, 8, y, r->image);
    }
    jpeg_finish_decompress(&r->jpeg);
}

sag_status sagi_jpeg_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    reader r = {.source = source, .image = image, .error = error};
    r.jpeg.err = jpeg_std_error(&r.errors);
    r.jpeg.client_data = &r;
    r.errors.error_exit = on_error;
    r.errors.emit_message = on_message;
    r.errors.output_message = on_output;
    read_image(&r);
    jpeg_destroy_decompress(&r.jpeg);
    sag_release(source->context, r.row, r.row_bytes);
    return r.status;
}
