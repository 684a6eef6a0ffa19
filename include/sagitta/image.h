// SPDX-License-Identifier: MIT
/// @file image.h
/// Pictures in memory and in files (libsagitta-render). Values are linear, rows run from the top, pixels are
/// interleaved floats.
#ifndef SAGITTA_IMAGE_H
#define SAGITTA_IMAGE_H

#include <sagitta/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Linear RGB: which primaries and white.
typedef enum sag_color_space {
    SAG_COLOR_SRGB,       ///< Rec. ITU-R BT.709, D65
    SAG_COLOR_DCI_P3,     ///< P3 with the white of D65 (Display P3)
    SAG_COLOR_REC2020,    ///< Rec. ITU-R BT.2020, D65
    SAG_COLOR_ACES2065_1, ///< SMPTE ST 2065-1, about D60
} sag_color_space;

/// A picture: pixels[(y·width + x)·channels + c], allocated from the context it was made with. channels: 1
/// grey, 2 grey + alpha, 3 RGB, 4 RGBA.
typedef struct sag_image {
    uint32_t width, height, channels;
    float *pixels;
    sag_color_space color_space; ///< of red, green and blue
} sag_image;

/// Largest width or height of an image.
#define SAG_MAX_IMAGE_SIZE 65536u

/// Makes a black picture. SAG_ERROR_ARGUMENT for a size of 0, over SAG_MAX_IMAGE_SIZE or channels not 1 … 4;
/// SAG_ERROR_MEMORY. *image is written on success only.
SAG_API sag_status sag_image_create(const sag_context *context, uint32_t width, uint32_t height,
                                    uint32_t channels, sag_image *image, sag_error *error);
/// Frees the pixels and zeroes the struct. Nothing happens for an empty struct or NULL.
SAG_API void sag_image_clear(const sag_context *context, sag_image *image);

/// How the numbers of an 8- or 16-bit file become linear ones.
typedef enum sag_encoding {
    SAG_ENCODING_DEFAULT, ///< sRGB for 8-bit files, linear for the others
    SAG_ENCODING_SRGB,
    SAG_ENCODING_LINEAR,
} sag_encoding;

/// Reads PNG, JPEG, TGA, BMP, QOI, HDR (Radiance), EXR or PFM; the kind is told by the content, not the name.
/// Alpha is kept, and always linear. The colour space is sRGB's but for an EXR whose chromaticities are
/// another's. EXR: the channels R G B and A, or Y, or the first; of the first part. A file that ends too soon
/// is an error, never a picture with a grey end. Threads: any (tests/render/test_images.c). Errors:
/// SAG_ERROR_IO with the path, SAG_ERROR_FORMAT for damaged or foreign content, SAG_ERROR_MEMORY. Never
/// crashes on hostile input.
SAG_API sag_status sag_image_read(const sag_context *context, const char *path, sag_encoding encoding,
                                  sag_image *image, sag_error *error);

/// Writes by the name's ending, in either case: .png (8-bit sRGB, clipped to [0, 1], rounded to the nearest,
/// NaN as 0; other colour spaces are converted), .pfm (without alpha; other colour spaces are
/// converted too) and .exr (32-bit float, ZIP; channels R G B A or Y A, with the colour space's
/// chromaticities), both linear and exact. The file appears whole or
/// not at all: it is written beside its place under a temporary name, then renamed; a pipe or device is
/// written to directly. Directories are not made. SAG_ERROR_ARGUMENT for another ending or an empty image,
/// SAG_ERROR_IO with the system's reason.
SAG_API sag_status sag_image_write(const sag_context *context, const sag_image *image, const char *path,
                                   sag_error *error);

/// The sRGB transfer function and its inverse, on [0, 1] (IEC 61966-2-1); values outside follow the same
/// formula, odd-symmetric.
SAG_API double sag_srgb_encode(double linear);
SAG_API double sag_srgb_decode(double encoded);

#ifdef __cplusplus
}
#endif
#endif
