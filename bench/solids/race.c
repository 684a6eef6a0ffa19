// SPDX-License-Identifier: MIT
// Runs the two programs and reads what they say about the time they took to trace: POV-Ray the seconds in
// brackets of its line "Trace Time", Sagitta "trace_seconds" of --stats.
#include "../program.h"
#include "solids.h"
#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The end of the file's text, to be freed; NULL: it cannot be read.
static char *read_text(const char *path) {
    FILE *file = fopen(path, "r");
    char *text = malloc(1 << 16);
    if (file != NULL && fseek(file, -((1 << 16) - 1), SEEK_END) != 0) rewind(file); // it is shorter
    size_t length = file != NULL && text != NULL ? fread(text, 1, (1 << 16) - 1, file) : 0;
    if (file != NULL) fclose(file);
    if (text != NULL) text[length] = 0;
    return text;
}

bool povray_found(char version[64]) {
    char program[] = "povray", ask[] = "--version", log[] = "/tmp/bench-solids-XXXXXX";
    const int file = mkstemp(log);
    if (file < 0) return false;
    close(file);
    const bool found = program_run((char *[]){program, ask, NULL}, log, NULL);
    char *text = read_text(log);
    const char *at = text != NULL ? strstr(text, "POV-Ray") : NULL;
    snprintf(version, 64, "%.*s", at != NULL ? (int)strcspn(at, "\n") : 7, at != NULL ? at : "POV-Ray");
    free(text);
    remove(log);
    return found;
}

static double povray_seconds(const char *text) {
    const char *line = strstr(text, "Trace Time:"), *bracket = line != NULL ? strchr(line, '(') : NULL;
    return bracket != NULL ? strtod(bracket + 1, NULL) : 0;
}

double run_povray(const char *folder, const scene_kind *kind, size film, int quality, const char *picture) {
    char input[4096], log[4096], wide[32], high[32], level[32], output[4096] = "-F";
    char program[] = "povray", plain[] = "-A", threads[] = "+WT1", still[] = "-D", short_log[] = "-V",
         gamma[] = "File_Gamma=1.0", bits[] = "Bits_Per_Color=16", form[] = "+FP";
    snprintf(input, sizeof input, "+I%s/%s.pov", folder, kind->name);
    snprintf(log, sizeof log, "%s/%s.povray.log", folder, kind->name);
    snprintf(wide, sizeof wide, "+W%u", film.width);
    snprintf(high, sizeof high, "+H%u", film.height);
    snprintf(level, sizeof level, "+Q%d", quality);
    if (picture != NULL) snprintf(output, sizeof output, "+O%s", picture);
    char *arguments[] = {program, input, wide,      high,  level, plain,
                         threads, still, short_log, gamma, bits,  picture != NULL ? form : output,
                         output,  NULL};
    double result = 0;
    if (program_run(arguments, log, NULL)) {
        char *text = read_text(log);
        if (text != NULL) result = povray_seconds(text);
        free(text);
    }
    if (!(result > 0)) fprintf(stderr, "bench-solids: POV-Ray failed: see %s\n", log);
    return result;
}

double run_sagitta(const char *folder, const scene_kind *kind, const char *picture) {
    char input[4096], log[4096], stats[4096], nowhere[4096];
    char program[] = BENCH_SAGITTA, verb[] = "render", integrator[] = "--integrator", depth[] = "depth",
         spp[] = "--spp", threads[] = "--threads", one[] = "1", to[] = "-o", with[] = "--stats",
         quiet[] = "--quiet";
    snprintf(input, sizeof input, "%s/%s.pbrt", folder, kind->name);
    snprintf(log, sizeof log, "%s/%s.sagitta.log", folder, kind->name);
    snprintf(stats, sizeof stats, "%s/%s.sagitta.json", folder, kind->name);
    snprintf(nowhere, sizeof nowhere, "%s", picture);
    char *arguments[] = {program, verb, input,   integrator, depth, spp,   one, threads,
                         one,     to,   nowhere, with,       stats, quiet, NULL};
    double result = 0;
    if (program_run(arguments, log, NULL)) {
        char *text = read_text(stats);
        cJSON *json = text != NULL ? cJSON_Parse(text) : NULL;
        const cJSON *seconds = cJSON_GetObjectItem(json, "trace_seconds");
        if (cJSON_IsNumber(seconds)) result = seconds->valuedouble;
        cJSON_Delete(json);
        free(text);
    }
    if (!(result > 0)) fprintf(stderr, "bench-solids: sagitta failed: see %s\n", log);
    return result;
}
