// SPDX-License-Identifier: MIT
// A picture kept for looking up: itself and its halves down to one texel, as small as its numbers allow.
#ifndef SAGI_RENDER_MIPMAP_H
#define SAGI_RENDER_MIPMAP_H

#include "mapping.h"

// SAG_MAX_IMAGE_SIZE halved down to 1.
#define SAGI_MAX_LEVELS 17

typedef enum sagi_texel_kind {
    SAGI_TEXEL_BYTE,  // numbers of a table of 256
    SAGI_TEXEL_HALF,  // 16-bit floats
    SAGI_TEXEL_FLOAT, // 32-bit floats
} sagi_texel_kind;

typedef struct sagi_level {
    uint32_t width, height;
    size_t first; // its first number in the texels
} sagi_level;

typedef struct sagi_mipmap {
    sagi_texel_kind kind;
    uint32_t channels; // 1, 3 or 4
    sag_color_space color_space;
    uint32_t level_count; // the last is 1×1; 0: no picture at all
    sagi_level levels[SAGI_MAX_LEVELS];
    void *texels;
    size_t bytes;
    float decode[256]; // SAGI_TEXEL_BYTE
} sagi_mipmap;

// Numbers of 8 bits to linear ones: sRGB, linear or a power.
typedef struct sagi_transfer {
    sag_encoding encoding; // SAG_ENCODING_DEFAULT is sRGB
    double gamma;          // > 0: vᵞ instead
} sagi_transfer;

// Makes the mipmap of a picture of floats; halves are kept where they lose nothing. A second channel of two
// and a fourth that is 1 throughout are left out. SAG_ERROR_MEMORY.
sag_status sagi_mipmap_init(sagi_mipmap *mipmap, const sag_context *context, const sag_image *image,
                            sag_error *error);
// The same from bytes, width × height × channels, by rows from the top. They are copied.
sag_status sagi_mipmap_init_bytes(sagi_mipmap *mipmap, const sag_context *context, const uint8_t *bytes,
                                  uint32_t width, uint32_t height, uint32_t channels, sagi_transfer transfer,
                                  sag_error *error);
void sagi_mipmap_clear(sagi_mipmap *mipmap, const sag_context *context);

// How a texture looks a picture up.
typedef struct sagi_lookup {
    sag_texture_filter filter;
    sag_wrap wrap;
    double max_anisotropy; // EWA
} sagi_lookup;

// Four numbers: red, green and blue (equal in a grey picture) and what stands for the picture where one
// number is asked for: of 4 channels the last, else the mean of the others.
typedef float sagi_texel __attribute__((vector_size(16)));

// The picture around (s, t), t = 0 its bottom edge, over the spot's extent. 0 where coordinates are not
// finite and for no picture.
sagi_texel sagi_mipmap_lookup(const sagi_mipmap *mipmap, const sagi_lookup *how, const sagi_spot_2d *at);
// One texel of a level after wrapping; rows from the top.
sagi_texel sagi_mipmap_texel(const sagi_mipmap *mipmap, uint32_t level, int64_t x, int64_t y, sag_wrap wrap);

// 16-bit floats (IEEE 754 binary16): exact up, rounded to nearest even down; beyond ±65504 infinite.
float sagi_half_to_float(uint16_t half);
uint16_t sagi_half_from_float(float value);

#endif
