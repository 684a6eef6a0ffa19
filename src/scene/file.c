// SPDX-License-Identifier: MIT
// Scenes in files of the file system. A file is written under a temporary name beside its place and renamed
// over it when everything is on disk: a crash or a full disk leaves the old file as it was.
#include "scene/file.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_ATTEMPTS 1000 // names tried; only what dead processes left can be in the way

static sag_status fail(sag_error *error, const char *path, const char *what, int reason) {
    return sag_error_set_at(error, SAG_ERROR_IO, path, 0, 0, "%s: %s", what, strerror(reason));
}

// A new file of a name nobody has (O_EXCL) in the directory of `path`; NULL with errno.
static FILE *open_beside(const char *path, char *name, size_t name_bytes) {
    const char *slash = strrchr(path, '/');
    int directory = slash != NULL ? (int)(slash - path) + 1 : 0;
    for (int attempt = 0; attempt < MAX_ATTEMPTS; attempt++) {
        int length =
            snprintf(name, name_bytes, "%.*s.sagitta-%ld-%d.tmp", directory, path, (long)getpid(), attempt);
        if (length < 0 || (size_t)length >= name_bytes) {
            errno = ENAMETOOLONG;
            return NULL;
        }
        int descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno == EEXIST) continue;
        FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
        if (descriptor >= 0 && file == NULL) close(descriptor), unlink(name);
        return file;
    }
    errno = EEXIST;
    return NULL;
}

static bool write_file(void *user, const void *data, size_t bytes) {
    return fwrite(data, 1, bytes, (FILE *)user) == bytes;
}

sag_status sag_scene_save(const sag_scene *scene, const char *path, sag_error *error) {
    char name[4096];
    FILE *file = open_beside(path, name, sizeof name);
    if (file == NULL) return fail(error, path, "cannot write", errno);
    sag_status status = sag_scene_write(scene, write_file, file, error);
    int reason = status == SAG_ERROR_IO ? errno : 0;
    if (status == SAG_OK && (fflush(file) != 0 || fsync(fileno(file)) != 0)) reason = errno;
    if (fclose(file) != 0 && reason == 0) reason = errno;
    if (status == SAG_OK && reason == 0 && rename(name, path) != 0) reason = errno;
    if (reason != 0) status = fail(error, path, "cannot write", reason);
    if (status == SAG_OK) return SAG_OK;
    unlink(name);
    if (error != NULL) snprintf(error->file, sizeof error->file, "%s", path);
    return status;
}

static bool read_file(void *user, void *data, size_t bytes) {
    return fread(data, 1, bytes, (FILE *)user) == bytes;
}

sag_status sag_scene_load(sag_context *context, const char *path, sag_scene **scene, sag_error *error) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) return fail(error, path, "cannot read", errno);
    struct stat about;
    uint64_t bytes = UINT64_MAX; // of a pipe, say
    if (fstat(fileno(file), &about) == 0 && S_ISREG(about.st_mode)) bytes = (uint64_t)about.st_size;
    errno = 0;
    sag_status status = sagi_scene_read(context, read_file, file, bytes, scene, error);
    if (ferror(file)) status = fail(error, path, "cannot read", errno);
    fclose(file);
    if (status != SAG_OK && error != NULL) snprintf(error->file, sizeof error->file, "%s", path);
    return status;
}
