// SPDX-License-Identifier: MIT
// What every subcommand needs around its work: a context, messages, interrupts, the clock, numbers for
// people.
#include "tool.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <time.h>

// So many warnings are shown; a scene with one mistake a thousand times should not bury the rest.
#define MAX_WARNINGS 20

volatile sig_atomic_t interrupt_flag;

// The log callback's own count; the program has one context.
static unsigned warning_count;

// How many bytes the well-formed UTF-8 character at p has; 0 when there is none.
static int character_bytes(const unsigned char *p) {
    if (p[0] < 0x80) return 1;
    const int length = p[0] >= 0xC2 && p[0] < 0xE0   ? 2
                       : p[0] >= 0xE0 && p[0] < 0xF0 ? 3
                       : p[0] >= 0xF0 && p[0] < 0xF5 ? 4
                                                     : 0;
    for (int i = 1; i < length; i++) {
        if (p[i] >> 6 != 2) return 0;
    }
    // Too long for what they say, surrogates, and beyond U+10FFFF.
    if ((p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xED && p[1] >= 0xA0)) return 0;
    if ((p[0] == 0xF0 && p[1] < 0x90) || (p[0] == 0xF4 && p[1] >= 0x90)) return 0;
    return length;
}

// The same of one that may be shown; 0 for one that would steer the terminal.
static int shown_bytes(const unsigned char *p) {
    if (p[0] < 0x20 || p[0] == 0x7F || (p[0] == 0xC2 && p[1] < 0xA0)) return 0;
    return character_bytes(p);
}

// Writes a message that may quote a file's bytes: what would upset a terminal becomes a question mark.
static void print_clean(const char *text) {
    const unsigned char *p = (const unsigned char *)text;
    while (*p) {
        const int length = shown_bytes(p);
        if (length > 0) {
            fwrite(p, 1, (size_t)length, stderr);
        } else {
            fputc('?', stderr);
        }
        p += length > 0 ? length : 1;
    }
}

bool json_add_text(cJSON *object, const char *name, const char *text) {
    static const char replacement[] = "\xEF\xBF\xBD"; // U+FFFD
    char *clean = malloc(3 * strlen(text) + 1), *end = clean;
    if (!clean) return false;
    for (const unsigned char *p = (const unsigned char *)text; *p;) {
        const int length = character_bytes(p);
        memcpy(end, length > 0 ? (const char *)p : replacement, length > 0 ? (size_t)length : 3);
        end += length > 0 ? length : 3;
        p += length > 0 ? length : 1;
    }
    *end = '\0';
    const bool good = cJSON_AddStringToObject(object, name, clean) != NULL;
    free(clean);
    return good;
}

static void log_message(void *user, sag_log_level level, const char *message) {
    const bool quiet = user != NULL;
    if (level == SAG_LOG_INFO) return;
    if (level == SAG_LOG_WARNING && (quiet || ++warning_count > MAX_WARNINGS)) return;
    progress_clear_line();
    // A message with a place in a file ("scene.pbrt:3:1: warning: …") says itself what it is.
    const char *prefix = strstr(message, "warning: ") || strstr(message, "error: ") ? ""
                         : level == SAG_LOG_WARNING                                 ? "sagitta: warning: "
                                                                                    : "sagitta: ";
    fputs(prefix, stderr);
    print_clean(message);
    fputc('\n', stderr);
}

sag_context *session_open(uint64_t threads, bool quiet) {
    static char is_quiet;
    const sag_context_options options = {
        .thread_count = (uint32_t)threads, .log = log_message, .log_user = quiet ? &is_quiet : NULL};
    warning_count = 0;
    sag_context *context = sag_context_create(&options);
    if (context) return context;
    const char *isa = getenv("SAG_ISA");
    if (isa && *isa) {
        report_failure("SAG_ISA=%s: this machine has no such instruction set, or memory is short", isa);
    } else {
        report_failure("cannot start: out of memory");
    }
    return NULL;
}

sag_world *session_load(sag_context *context, const char *file, bool quiet, sag_mesh_callback on_mesh,
                        void *user, sag_error *error) {
    progress bar;
    progress_begin(&bar, "loading", "", quiet);
    progress_note(&bar, "loading ...");
    sag_world *world = sag_world_create(context);
    sag_status status = world ? sag_world_load_geometry(world, file, on_mesh, user, error)
                              : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    if (status == SAG_OK) status = sag_scene_commit(sag_world_scene(world), error);
    progress_end(&bar);
    if (status == SAG_OK) return world;
    sag_world_destroy(world);
    return NULL;
}

void session_close(sag_context *context) {
    if (context && warning_count > MAX_WARNINGS) {
        fprintf(stderr, "sagitta: warning: %u more warnings not shown\n", warning_count - MAX_WARNINGS);
    }
    warning_count = 0;
    sag_context_destroy(context);
}

int report_error(const sag_error *error) {
    progress_clear_line();
    if (error->status == SAG_ERROR_CANCELLED) {
        fprintf(stderr, "sagitta: interrupted\n");
        return TOOL_INTERRUPTED;
    }
    print_clean(error->file[0] ? error->file : "sagitta");
    if (error->line > 0) fprintf(stderr, ":%d", error->line);
    if (error->line > 0 && error->column > 0) fprintf(stderr, ":%d", error->column);
    fputs(": ", stderr);
    print_clean(error->message[0] ? error->message : sag_status_name(error->status));
    fputc('\n', stderr);
    return TOOL_FAILED;
}

int report_failure(const char *format, ...) {
    progress_clear_line();
    fprintf(stderr, "sagitta: ");
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return TOOL_FAILED;
}

static void on_interrupt(int signal_number) {
    (void)signal_number;
    interrupt_flag = 1;
}

void interrupt_catch(void) {
    // Without SA_RESTART, so that a wait for input ends; with SA_RESETHAND, so that a second Ctrl-C is final.
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    struct sigaction before;
    const bool is_nohup = sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN;
    if (!is_nohup) sigaction(SIGHUP, &action, NULL);
}

int close_stdout(void) {
    const bool failed = ferror(stdout) != 0;
    if (fflush(stdout) == 0 && !failed) return TOOL_OK;
    return report_failure("standard output: cannot write: %s", strerror(errno));
}

double clock_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

uint64_t peak_memory(void) {
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
#ifdef __APPLE__
    return (uint64_t)usage.ru_maxrss;
#else
    return (uint64_t)usage.ru_maxrss * 1024;
#endif
}

const char *text_count(char text[TEXT_BYTES], uint64_t count) {
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)count);
    char *p = text;
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0) *p++ = ',';
        *p++ = digits[i];
    }
    *p = 0;
    return text;
}

const char *text_bytes(char text[TEXT_BYTES], uint64_t bytes) {
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    double value = (double)bytes;
    int unit = 0;
    while (value >= 1000 && unit < 6) value /= 1024, unit++;
    snprintf(text, TEXT_BYTES,
             unit == 0 || value >= 100 ? "%.0f %s"
             : value >= 10             ? "%.1f %s"
                                       : "%.2f %s",
             value, units[unit]);
    return text;
}

const char *text_seconds(char text[TEXT_BYTES], double seconds) {
    if (!(seconds >= 0)) seconds = 0;
    if (seconds < 0.9995) {
        snprintf(text, TEXT_BYTES, "%.0f ms", 1e3 * seconds);
    } else if (seconds < 59.95) {
        snprintf(text, TEXT_BYTES, "%.1f s", seconds);
    } else {
        const double whole = floor(fmin(seconds, 1e9) + 0.5);
        const long all = (long)whole, hours = all / 3600, minutes = all / 60 % 60;
        if (hours > 0) {
            snprintf(text, TEXT_BYTES, "%ld:%02ld:%02ld h", hours, minutes, all % 60);
        } else {
            snprintf(text, TEXT_BYTES, "%ld:%02ld min", minutes, all % 60);
        }
    }
    return text;
}

const char *text_rate(char text[TEXT_BYTES], double count, double seconds, const char *unit) {
    static const char *const prefixes[] = {"", "k", "M", "G"};
    double value = seconds > 0 ? count / seconds : 0;
    int prefix = 0;
    while (value >= 999.5 && prefix < 3) value /= 1000, prefix++;
    const int decimals = value >= 99.5 ? 0 : value >= 9.95 ? 1 : 2;
    snprintf(text, TEXT_BYTES, "%.*f %s%s/s", decimals, value, prefixes[prefix], unit);
    return text;
}

const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool has_ending(const char *name, const char *ending) {
    const size_t length = strlen(name), tail = strlen(ending);
    return length >= tail && strcasecmp(name + length - tail, ending) == 0;
}
