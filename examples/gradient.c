// SPDX-License-Identifier: MIT
// The smallest use of libsagitta-render: a picture into a file.  cc gradient.c $(pkg-config --cflags --libs
// sagitta-render)
#include <sagitta/image.h>
#include <stdio.h>

int main(int argc, char **argv) {
    if (argc != 2) return fprintf(stderr, "usage: gradient OUT.png|OUT.pfm|OUT.exr\n"), 2;
    sag_context *context = sag_context_create(NULL);
    sag_image image;
    sag_error error;
    int failed = 1;
    if (sag_image_create(context, 256, 64, 3, &image, &error) == SAG_OK) {
        for (uint32_t i = 0; i < 256 * 64; i++)
            for (uint32_t c = 0; c < 3; c++)
                image.pixels[3 * i + c] = (float)(c == 0 ? i % 256 / 255.0 : i / 256 / 63.0);
        failed = sag_image_write(context, &image, argv[1], &error) != SAG_OK;
        sag_image_clear(context, &image);
    }
    if (failed) fprintf(stderr, "%s\n", error.message);
    sag_context_destroy(context);
    return failed;
}
