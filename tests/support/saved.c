// SPDX-License-Identifier: MIT
#include "support/saved.h"
#include "base/checksum.h"
#include "scene/file.h"
#include <stdlib.h>
#include <string.h>

static bool append(void *user, const void *data, size_t bytes) {
    saved *s = user;
    if (bytes > s->capacity - s->count) {
        size_t capacity = 2 * (s->capacity + bytes);
        unsigned char *larger = realloc(s->bytes, capacity);
        if (larger == NULL) return false;
        s->bytes = larger, s->capacity = capacity;
    }
    memcpy(s->bytes + s->count, data, bytes);
    s->count += bytes;
    return true;
}

saved saved_from(const sag_scene *scene, sag_status *status, sag_error *error) {
    saved s = {.count = 0};
    sag_status result = sag_scene_write(scene, append, &s, error);
    if (status != NULL) *status = result;
    if (result != SAG_OK) s.count = 0;
    return s;
}

typedef struct source {
    const unsigned char *bytes;
    size_t left;
} source;

static bool take(void *user, void *data, size_t bytes) {
    source *s = user;
    if (bytes > s->left) return false;
    memcpy(data, s->bytes, bytes);
    s->bytes += bytes, s->left -= bytes;
    return true;
}

sag_status saved_read(sag_context *context, const unsigned char *bytes, size_t count, sag_scene **scene,
                      sag_error *error) {
    source s = {bytes, count};
    return sag_scene_read(context, take, &s, scene, error);
}

void saved_seal(saved *s) {
    sagi_file_head *head = (void *)s->bytes;
    head->checksum = sagi_checksum(head, offsetof(sagi_file_head, checksum));
    for (size_t at = sizeof *head; at + sizeof(sagi_file_section) <= s->count;) {
        sagi_file_section *section = (void *)(s->bytes + at);
        at += sizeof *section;
        if (section->bytes > s->count - at) return;
        section->checksum = sagi_checksum(s->bytes + at, section->bytes);
        section->head_checksum = sagi_checksum(section, offsetof(sagi_file_section, head_checksum));
        at += (section->bytes + SAGI_FILE_ALIGNMENT - 1) / SAGI_FILE_ALIGNMENT * SAGI_FILE_ALIGNMENT;
    }
}

void saved_free(saved *s) {
    free(s->bytes);
    *s = (saved){.count = 0};
}
