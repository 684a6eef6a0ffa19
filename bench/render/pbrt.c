// SPDX-License-Identifier: MIT
// pbrt-v4 itself, run on the same scene between our own runs. It has no option for the size of the film, so
// it is given a folder in which everything is a link to what the scene's folder holds, but for the scene
// file, in which the numbers of xresolution and yresolution are changed. How long it rendered, without
// loading, it writes into its picture: the attribute renderTimeSeconds of the EXR.
#define _XOPEN_SOURCE 700 // realpath
#include "../program.h"
#include "render.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH = 4096 };

// Every `"integer NAME" [ 123` gets another number, those of comments too.
static bool copy_with_size(const char *from, const char *to, uint32_t width, uint32_t height) {
    FILE *in = fopen(from, "r"), *out = in != NULL ? fopen(to, "w") : NULL;
    char *line = NULL;
    size_t room = 0;
    bool good = out != NULL;
    for (ssize_t length; good && (length = getline(&line, &room, in)) >= 0;) {
        const char *rest = line;
        for (const char *at; (at = strstr(rest, "resolution\"")) != NULL && at > line;) {
            const char *number = at + strcspn(at, "0123456789#\n");
            fwrite(rest, 1, (size_t)(number - rest), out);
            rest = number + strspn(number, "0123456789");
            if (rest != number) fprintf(out, "%u", at[-1] == 'x' ? width : height);
        }
        good = fputs(rest, out) >= 0;
    }
    free(line);
    if (in != NULL) fclose(in);
    return out != NULL && fclose(out) == 0 && good;
}

static bool join(char path[PATH], const char *folder, const char *name) {
    const int length = snprintf(path, PATH, "%s/%s", folder, name);
    return length > 0 && length < PATH;
}

static bool link_all(const char *from, const char *to) {
    char target[PATH], name[PATH];
    DIR *folder = opendir(from);
    if (folder == NULL) return false;
    bool good = true;
    for (const struct dirent *entry; good && (entry = readdir(folder)) != NULL;) {
        if (entry->d_name[0] == '.' || strcmp(entry->d_name, "scene-v4.pbrt") == 0) continue;
        good =
            join(target, from, entry->d_name) && join(name, to, entry->d_name) && symlink(target, name) == 0;
    }
    closedir(folder);
    return good;
}

bool pbrt_prepare(pbrt_scene *p, const subject_scene *scene) {
    char from[PATH], source[PATH], copy[PATH];
    *p = (pbrt_scene){.folder = "/tmp/bench-render-XXXXXX"};
    if (mkdtemp(p->folder) == NULL) return false;
    char *whole = realpath(BENCH_DATA "/scenes", NULL); // a link is read from where it lies
    if (whole == NULL) return false;
    const bool good = join(from, whole, scene->name) && link_all(from, p->folder) &&
                      join(source, from, "scene-v4.pbrt") && join(copy, p->folder, "scene-v4.pbrt");
    free(whole);
    return good && copy_with_size(source, copy, scene->width, scene->height);
}

void pbrt_forget(pbrt_scene *p) {
    char name[PATH];
    DIR *folder = p->folder[0] ? opendir(p->folder) : NULL;
    if (folder == NULL) return;
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;)
        if (entry->d_name[0] != '.' && join(name, p->folder, entry->d_name)) unlink(name);
    closedir(folder);
    rmdir(p->folder);
}

// 0: the picture has no such attribute.
static double render_seconds(const char *picture) {
    static const char name[] = "renderTimeSeconds\0float\0\4\0\0"; // and a last 0: the value's four bytes
    char head[1 << 14];
    FILE *file = fopen(picture, "rb");
    const size_t length = file != NULL ? fread(head, 1, sizeof head, file) : 0;
    if (file != NULL) fclose(file);
    for (size_t i = 0; i + sizeof name + sizeof(float) <= length; i++)
        if (memcmp(head + i, name, sizeof name) == 0) {
            float seconds;
            memcpy(&seconds, head + i + sizeof name, sizeof seconds);
            return (double)seconds;
        }
    return 0;
}

bool pbrt_run(const pbrt_scene *p, const char *program, unsigned spp, unsigned threads, double *seconds,
              size_t *peak_bytes) {
    char input[PATH], output[PATH], log[PATH], path[PATH], samples[16], crew[16];
    char quiet[] = "--quiet", with[] = "--spp", by[] = "--nthreads", to[] = "--outfile";
    snprintf(path, sizeof path, "%s", program);
    snprintf(input, sizeof input, "%s/scene-v4.pbrt", p->folder);
    snprintf(output, sizeof output, "%s/pbrt.exr", p->folder);
    snprintf(log, sizeof log, "%s/log", p->folder);
    snprintf(samples, sizeof samples, "%u", spp);
    snprintf(crew, sizeof crew, "%u", threads != 0 ? threads : (unsigned)sysconf(_SC_NPROCESSORS_ONLN));
    char *arguments[] = {path, quiet, with, samples, by, crew, to, output, input, NULL};
    const bool good = program_run(arguments, log, peak_bytes);
    *seconds = good ? render_seconds(output) : 0;
    if (!(*seconds > 0)) fprintf(stderr, "bench-render: %s failed on %s\n", program, input);
    return *seconds > 0;
}
