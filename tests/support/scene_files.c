// SPDX-License-Identifier: MIT
#include "support/scene_files.h"
#include "support/scene_text.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <sagitta/image.h>
#include <stdio.h>

void scene_copy_files(void) {
    static char bytes[1 << 16];
    DIR *folder = opendir(SAGITTA_SCENES);
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        if (entry->d_name[0] == '.') continue;
        char path[1024];
        snprintf(path, sizeof path, SAGITTA_SCENES "/%s", entry->d_name);
        FILE *in = fopen(path, "rb");
        assert_non_null(in);
        const size_t size = fread(bytes, 1, sizeof bytes, in);
        assert_true(size < sizeof bytes);
        fclose(in);
        scene_write(entry->d_name, bytes, size);
    }
    closedir(folder);
    sag_image image = {0};
    assert_int_equal(sag_image_create(scene_context, 8, 8, 3, &image, NULL), SAG_OK);
    for (size_t i = 0; i < 8 * 8 * 3; i++) image.pixels[i] = (float)((i * 37) % 11) / 10;
    const char *const pictures[] = {"picture.png", "sky.exr"};
    for (int i = 0; i < 2; i++)
        assert_int_equal(sag_image_write(scene_context, &image, scene_path(pictures[i]), NULL), SAG_OK);
    sag_image_clear(scene_context, &image);
}
