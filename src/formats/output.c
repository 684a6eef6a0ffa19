// SPDX-License-Identifier: MIT
// Atomic output: POSIX's rename replaces the old file in one step, so a reader sees either the old one or the
// new one, whole. The data are forced to disk first (fsync): otherwise a power cut soon after the rename can
// leave a file with its name but without its content.
#define _XOPEN_SOURCE 700 // realpath
#include "formats/output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Names tried before giving up; only another writer with the same process id (another machine on a shared
// directory, a dead process) can be in the way.
#define MAX_ATTEMPTS 1000

static sag_status fail(sag_error *error, const char *path, const char *what, int reason) {
    return sag_error_set_at(error, SAG_ERROR_IO, path, 0, 0, "%s: %s", what, strerror(reason));
}

// Opens DIRECTORY/.sagitta-PID-N.tmp, a name nobody has (O_EXCL). Returns the descriptor or −1 with errno.
// The name does not grow with the file's own, which may be as long as the system allows.
static int open_temporary(sagi_output *output) {
    const char *slash = strrchr(output->path, '/');
    const int directory_length = slash ? (int)(slash - output->path) + 1 : 0;
    for (int attempt = 0; attempt < MAX_ATTEMPTS; attempt++) {
        const int length = snprintf(output->temporary, sizeof output->temporary, "%.*s.sagitta-%ld-%d.tmp",
                                    directory_length, output->path, (long)getpid(), attempt);
        if (length < 0 || (size_t)length >= sizeof output->temporary) {
            errno = ENAMETOOLONG;
            return -1;
        }
        const int descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
    return -1;
}

sag_status sagi_output_open(sagi_output *output, const char *path, sag_error *error) {
    output->file = NULL;
    output->is_temporary = false;
    output->path[0] = output->temporary[0] = '\0';
    if (!path || !path[0]) return fail(error, "", "cannot write", ENOENT);
    if (strlen(path) >= sizeof output->path) return fail(error, path, "cannot write", ENAMETOOLONG);
    strcpy(output->path, path);
    struct stat status;
    const bool is_link = lstat(path, &status) == 0 && S_ISLNK(status.st_mode);
    const bool exists = stat(path, &status) == 0;
    // Behind a symbolic link the file is replaced, not the link.
    char target[PATH_MAX];
    if (is_link && exists && S_ISREG(status.st_mode) && realpath(path, target) &&
        strlen(target) < sizeof output->path)
        strcpy(output->path, target);
    if (exists && S_ISDIR(status.st_mode)) return fail(error, path, "cannot write", EISDIR);
    int descriptor;
    if (exists && !S_ISREG(status.st_mode)) {
        descriptor = open(path, O_WRONLY | O_CLOEXEC);
    } else {
        descriptor = open_temporary(output);
        output->is_temporary = descriptor >= 0;
    }
    if (descriptor < 0) return fail(error, path, "cannot write", errno);
    output->file = fdopen(descriptor, "wb");
    if (!output->file) {
        const int reason = errno;
        close(descriptor);
        sagi_output_discard(output);
        return fail(error, path, "cannot write", reason);
    }
    return SAG_OK;
}

sag_status sagi_output_commit(sagi_output *output, sag_error *error) {
    if (!output->file) return fail(error, output->path, "cannot write", EBADF);
    int reason = 0;
    // An earlier write may have failed without anybody looking; its errno is gone by now.
    if (ferror(output->file)) reason = EIO;
    if (fflush(output->file) != 0) reason = errno;
    if (!reason && output->is_temporary && fsync(fileno(output->file)) != 0) reason = errno;
    if (fclose(output->file) != 0 && !reason) reason = errno;
    output->file = NULL;
    if (!reason && output->is_temporary && rename(output->temporary, output->path) != 0) reason = errno;
    if (reason) {
        sagi_output_discard(output);
        return fail(error, output->path, "cannot write", reason);
    }
    output->is_temporary = false;
    return SAG_OK;
}

void sagi_output_discard(sagi_output *output) {
    if (output->file) fclose(output->file);
    output->file = NULL;
    if (output->is_temporary) unlink(output->temporary);
    output->is_temporary = false;
}
