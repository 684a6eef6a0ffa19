// SPDX-License-Identifier: MIT
// Scenes in files of the file system. A file is written under a temporary name beside its place and renamed
// over it when everything is on disk: a crash or a full disk leaves the old file as it was.
#define _XOPEN_SOURCE 700 // realpath
#include "scene/file.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
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

// Where a file is to appear and where it is written meanwhile.
typedef struct target {
    char path[PATH_MAX], name[PATH_MAX];
    FILE *file;
    bool beside; // to be renamed; else `path` is a pipe or device, and written itself
} target;

// Behind a symbolic link it is the file that is replaced, not the link. Returns 0 or the system's reason.
static int open_target(target *t, const char *path) {
    struct stat about;
    bool exists = stat(path, &about) == 0;
    if (exists && S_ISDIR(about.st_mode)) return EISDIR;
    t->beside = !exists || S_ISREG(about.st_mode);
    if (strlen(path) >= sizeof t->path) return ENAMETOOLONG;
    if (!exists || !t->beside || realpath(path, t->path) == NULL) strcpy(t->path, path);
    t->file = t->beside ? open_beside(t->path, t->name, sizeof t->name) : fopen(path, "wb");
    return t->file != NULL ? 0 : errno;
}

sag_status sag_scene_save(const sag_scene *scene, const char *path, sag_error *error) {
    target t;
    if (path == NULL) return sag_error_set(error, SAG_ERROR_ARGUMENT, "no path to save to");
    int reason = open_target(&t, path);
    if (reason != 0) return fail(error, path, "cannot write", reason);
    sag_status status = sag_scene_write(scene, write_file, t.file, error);
    if (status == SAG_ERROR_IO) reason = errno;
    if (status == SAG_OK && fflush(t.file) != 0) reason = errno;
    if (status == SAG_OK && reason == 0 && t.beside && fsync(fileno(t.file)) != 0) reason = errno;
    if (fclose(t.file) != 0 && reason == 0) reason = errno;
    if (status == SAG_OK && reason == 0 && t.beside && rename(t.name, t.path) != 0) reason = errno;
    if (status == SAG_OK && reason == 0) return SAG_OK;
    if (t.beside) unlink(t.name);
    if (reason != 0) return fail(error, path, "cannot write", reason);
    if (error != NULL) snprintf(error->file, sizeof error->file, "%s", path);
    return status;
}

static bool read_file(void *user, void *data, size_t bytes) {
    return fread(data, 1, bytes, (FILE *)user) == bytes;
}

sag_status sag_scene_load(sag_context *context, const char *path, sag_scene **scene, sag_error *error) {
    FILE *file = path != NULL ? fopen(path, "rb") : NULL;
    if (path == NULL) return sag_error_set(error, SAG_ERROR_ARGUMENT, "no path to load from");
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
