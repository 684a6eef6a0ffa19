// SPDX-License-Identifier: MIT
// The scenes of tests/scenes, with the pictures that they use, in the folder of scene_text.h.
#ifndef TESTS_SUPPORT_SCENE_FILES_H
#define TESTS_SUPPORT_SCENE_FILES_H

// After scene_setup: copies all files there, and makes picture.png and sky.exr.
void scene_copy_files(void);

#endif
