// SPDX-License-Identifier: MIT
// Pictures are kept once, however many textures show them.
#include "picture.h"

#include "world.h"

#include <string.h>

sag_picture_id sagi_world_find_picture(const sag_world *world, const char *path, sagi_transfer transfer) {
    const sagi_picture *pictures = world->pictures.items;
    for (size_t i = 0; i < world->pictures.count; i++)
        if (pictures[i].path && strcmp(pictures[i].path, path) == 0 &&
            pictures[i].transfer.encoding == transfer.encoding &&
            pictures[i].transfer.gamma == transfer.gamma)
            return (sag_picture_id)(i + 1);
    return 0;
}

sag_picture_id sagi_world_keep_picture(sag_world *world, sagi_mipmap *mipmap, const char *path,
                                       sagi_transfer transfer) {
    char *copy = NULL;
    bool enough = true;
    if (path) {
        copy = sag_allocate(world->context, strlen(path) + 1);
        enough = copy != NULL;
        if (copy) memcpy(copy, path, strlen(path) + 1);
    }
    sagi_picture *slot = NULL;
    if (enough && world->pictures.count < UINT32_MAX)
        slot = sagi_list_grow(world->context, &world->pictures, sizeof *slot);
    if (!slot) {
        sagi_mipmap_clear(mipmap, world->context);
        if (copy) sag_release(world->context, copy, strlen(copy) + 1);
        return 0;
    }
    slot->mipmap = *mipmap, slot->path = copy, slot->transfer = transfer;
    *mipmap = (sagi_mipmap){0};
    return (sag_picture_id)++world->pictures.count;
}

const sagi_mipmap *sagi_world_picture(const sag_world *world, sag_picture_id id) {
    if (id == 0 || id > world->pictures.count) return NULL;
    return &((const sagi_picture *)world->pictures.items)[id - 1].mipmap;
}

sagi_picture *sagi_world_picture_entry(sag_world *world, sag_picture_id id) {
    return (sagi_picture *)world->pictures.items + (id - 1);
}

static void clear(const sag_world *world, sagi_picture *picture) {
    sagi_mipmap_clear(&picture->mipmap, world->context);
    if (picture->path) sag_release(world->context, picture->path, strlen(picture->path) + 1);
}

void sagi_world_drop_picture(sag_world *world) {
    clear(world, sagi_world_picture_entry(world, (sag_picture_id)world->pictures.count));
    world->pictures.count--;
}

void sagi_world_clear_pictures(sag_world *world) {
    sagi_picture *pictures = world->pictures.items;
    for (size_t i = 0; i < world->pictures.count; i++) clear(world, &pictures[i]);
    sagi_list_clear(world->context, &world->pictures, sizeof *pictures);
}

sag_picture_id sag_world_add_picture(sag_world *world, sag_image *image) {
    sagi_mipmap mipmap;
    sag_status status = SAG_ERROR_ARGUMENT;
    if (image->pixels) status = sagi_mipmap_init(&mipmap, world->context, image, NULL);
    sag_image_clear(world->context, image);
    return status == SAG_OK ? sagi_world_keep_picture(world, &mipmap, NULL, (sagi_transfer){0}) : 0;
}
