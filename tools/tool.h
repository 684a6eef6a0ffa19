// SPDX-License-Identifier: MIT
// What the files of the program share. main.c picks the subcommand; each subcommand is one file with a table
// of its options, its help and one function.
#ifndef SAGITTA_TOOL_H
#define SAGITTA_TOOL_H

#include <cjson/cJSON.h>
#include <sagitta/render.h>
#include <signal.h>
#include <stdio.h>

// Exit codes.
enum { TOOL_OK = 0, TOOL_FAILED = 1, TOOL_USAGE = 2, TOOL_INTERRUPTED = 130 };

// One subcommand. `run` gets the arguments after the subcommand's name.
typedef struct tool_command {
    const char *name;
    const char *summary; // a line for `sagitta --help`
    const char *help;
    int (*run)(const struct tool_command *command, int argc, char **argv);
} tool_command;

extern const tool_command tool_render, tool_cast, tool_measure, tool_info;

// ---------------------------------------------------------------------------------------------------------------
// options.c

// What an option's value is and where it goes.
typedef enum option_kind {
    OPTION_FLAG,   // no value; *(bool *)target becomes true
    OPTION_TEXT,   // *(const char **)target
    OPTION_COUNT,  // a whole number in [minimum, maximum]; *(uint64_t *)target
    OPTION_NUMBER, // between `least` and `most`, both excluded; *(double *)target
    OPTION_SIZE,   // WxH; (uint32_t *)target, two of them
    OPTION_CROP,   // WxH+X+Y; (uint32_t *)target, four of them: width, height, x, y
    OPTION_CHOICE, // one of `choices`; *(int *)target becomes its index
} option_kind;

typedef struct option {
    const char *name; // without the dashes
    char letter;      // 0: none
    option_kind kind;
    void *target;
    uint64_t minimum, maximum;  // OPTION_COUNT
    double least, most;         // OPTION_NUMBER
    const char *const *choices; // OPTION_CHOICE, ends in NULL
} option;

// Reads the arguments: options go to their targets; the rest, in order, to the front of argv. Returns how
// many those are, -1 when something was wrong (and said so), -2 when --help was asked for (and given).
int options_parse(const tool_command *command, const option *options, size_t option_count, int argc,
                  char **argv);

// Says on stderr what is wrong with how the program was called, and where help is. Returns TOOL_USAGE.
int usage_error(const char *command, const char *format, ...) SAG_PRINTF(2, 3);

// The word of a list that ends in NULL which is nearest to what was typed; NULL when none is near.
const char *nearest_word(const char *typed, const char *const *words);

// ---------------------------------------------------------------------------------------------------------------
// progress.c

// A bar on a terminal, a line every few seconds elsewhere, nothing when quiet: always on stderr.
typedef struct progress {
    const char *what; // "rendering"
    const char *unit; // "samples"
    bool quiet, on_terminal, utf8, is_drawn;
    double start, last, interval;
} progress;

void progress_begin(progress *p, const char *what, const char *unit, bool quiet);
// `fraction` 0 … 1, or NAN when the end is not known; `done` counts units.
void progress_update(progress *p, double fraction, double done);
// Takes the bar away.
void progress_end(progress *p);
// Draws at once, whatever the time: before work that cannot report.
void progress_note(progress *p, const char *text);
// Takes the bar of whichever progress is shown off the terminal, so that a message can be written; it is
// drawn again at its next update.
void progress_clear_line(void);

// ---------------------------------------------------------------------------------------------------------------
// session.c

// A context whose messages go to stderr. NULL, having said why, when it cannot be had. threads 0: all.
sag_context *session_open(uint64_t threads, bool quiet);
// Says how many warnings were held back, and gives the context up.
void session_close(sag_context *context);

// The geometry of a file, committed, a bar shown meanwhile; on_mesh may be NULL (sag_world_load_geometry).
// NULL with *error set on failure.
sag_world *session_load(sag_context *context, const char *file, bool quiet, sag_mesh_callback on_mesh,
                        void *user, sag_error *error);

// Writes an error as "file:line:col: message" or "sagitta: message". Returns TOOL_FAILED (TOOL_INTERRUPTED
// for SAG_ERROR_CANCELLED).
int report_error(const sag_error *error);
// The same for a message of the program's own.
int report_failure(const char *format, ...) SAG_PRINTF(1, 2);

// From now on Ctrl-C (and a polite kill) sets interrupt_flag instead of ending the program; a second one ends
// it.
void interrupt_catch(void);
extern volatile sig_atomic_t interrupt_flag;

// Whether standard output took everything; says so when not.
int close_stdout(void);

// Adds a text to a JSON object, with U+FFFD for bytes that are no UTF-8: names of files and meshes may be
// anything, JSON may not. False when memory is short.
bool json_add_text(cJSON *object, const char *name, const char *text);

double clock_seconds(void);
// The most memory the process ever had, in bytes.
uint64_t peak_memory(void);

// Numbers for people. The texts are written to the given buffer, which is returned.
#define TEXT_BYTES 32
const char *text_count(char text[TEXT_BYTES], uint64_t count);   // 1,234,567
const char *text_bytes(char text[TEXT_BYTES], uint64_t bytes);   // 12.3 MiB
const char *text_seconds(char text[TEXT_BYTES], double seconds); // 850 ms, 12.3 s, 1:02:03
const char *text_rate(char text[TEXT_BYTES], double count, double seconds, const char *unit); // 1.23 Mrays/s

// The part of a path behind the last slash.
const char *base_name(const char *path);
// Whether a name ends so, in any case.
bool has_ending(const char *name, const char *ending);

#endif
