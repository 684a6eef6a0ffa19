// SPDX-License-Identifier: MIT
// Command-line options: --name value, --name=value, -n value, -nvalue; options and other arguments in any
// order; -- ends the options; a lone - is an argument. What is not known is answered with the nearest thing
// that is.
#include "tool.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define MAX_WORD 40

int usage_error(const char *command, const char *format, ...) {
    fprintf(stderr, "sagitta: ");
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\nTry 'sagitta %s%s--help'.\n", command ? command : "", command ? " " : "");
    return TOOL_USAGE;
}

// The least number of letters to insert, remove or change to turn one word into the other (Levenshtein).
static size_t distance(const char *a, const char *b) {
    size_t row[MAX_WORD + 1], b_length = strlen(b);
    if (strlen(a) > MAX_WORD || b_length > MAX_WORD) return SIZE_MAX;
    for (size_t j = 0; j <= b_length; j++) row[j] = j;
    for (size_t i = 1; a[i - 1]; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            const size_t changed = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            const size_t shorter = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = changed < shorter ? changed : shorter;
        }
    }
    return row[b_length];
}

const char *nearest_word(const char *typed, const char *const *words) {
    const char *best = NULL;
    size_t least = strlen(typed) / 3 + 1;
    for (; *words; words++) {
        const size_t d = strncmp(*words, typed, strlen(typed)) == 0 ? 0 : distance(typed, *words);
        if (d < least || (d == least && !best)) best = *words, least = d;
    }
    return best;
}

static const option *find_option(const option *options, size_t count, const char *name, size_t length) {
    for (size_t i = 0; i < count; i++) {
        if (strlen(options[i].name) == length && strncmp(options[i].name, name, length) == 0)
            return &options[i];
    }
    return NULL;
}

static int unknown_option(const tool_command *command, const option *options, size_t count,
                          const char *argument) {
    const char *words[32] = {"help"}; // the rest stays NULL, which ends the list
    char typed[MAX_WORD + 1];
    for (size_t i = 0; i < count && i + 2 < 32; i++) words[i + 1] = options[i].name;
    snprintf(typed, sizeof typed, "%.*s", (int)strcspn(argument + 2, "="), argument + 2);
    const char *near = argument[1] == '-' ? nearest_word(typed, words) : NULL;
    usage_error(command->name, near ? "unknown option '%s'; did you mean '--%s'?" : "unknown option '%s'",
                argument, near);
    return -1;
}

static int read_count(const tool_command *command, const option *o, const char *value) {
    char *end = NULL;
    const bool digits = value[0] >= '0' && value[0] <= '9';
    errno = 0; // which says when it is more than 64 bits hold
    const unsigned long long n = digits ? strtoull(value, &end, 10) : 0;
    if (!digits || *end || errno == ERANGE || n < o->minimum || n > o->maximum) {
        usage_error(command->name, "--%s %s: expected a whole number from %llu to %llu", o->name, value,
                    (unsigned long long)o->minimum, (unsigned long long)o->maximum);
        return -1;
    }
    *(uint64_t *)o->target = n;
    return 0;
}

static int read_number(const tool_command *command, const option *o, const char *value) {
    char *end = NULL;
    const bool starts = (value[0] >= '0' && value[0] <= '9') || value[0] == '.';
    const double x = starts ? strtod(value, &end) : 0;
    if (!starts || *end || !(x > o->least && x < o->most)) {
        if (o->most > 1e300) {
            usage_error(command->name, "--%s %s: expected a finite number greater than %g", o->name, value,
                        o->least);
        } else {
            usage_error(command->name, "--%s %s: expected a number between %g and %g", o->name, value,
                        o->least, o->most);
        }
        return -1;
    }
    *(double *)o->target = x;
    return 0;
}

static int read_size(const tool_command *command, const option *o, const char *value) {
    uint32_t *size = o->target;
    char *end = NULL;
    unsigned long long w = 0, h = 0;
    bool good = value[0] >= '0' && value[0] <= '9';
    if (good) {
        w = strtoull(value, &end, 10);
        good = (*end == 'x' || *end == 'X') && end[1] >= '0' && end[1] <= '9';
    }
    if (good) {
        h = strtoull(end + 1, &end, 10);
        good = *end == 0 && w >= 1 && h >= 1 && w <= SAG_MAX_IMAGE_SIZE && h <= SAG_MAX_IMAGE_SIZE;
    }
    if (!good) {
        usage_error(command->name, "--%s %s: expected WIDTHxHEIGHT, each from 1 to %u", o->name, value,
                    SAG_MAX_IMAGE_SIZE);
        return -1;
    }
    size[0] = (uint32_t)w, size[1] = (uint32_t)h;
    return 0;
}

// As X11 and ImageMagick write a part of a picture.
static int read_crop(const tool_command *command, const option *o, const char *value) {
    static const char after[4] = {'x', '+', '+', 0};
    uint32_t *crop = o->target;
    bool good = true;
    const char *at = value;
    for (int i = 0; i < 4 && good; i++) {
        char *end = NULL;
        good = *at >= '0' && *at <= '9';
        const unsigned long long n = good ? strtoull(at, &end, 10) : 0;
        good = good && *end == after[i] && n <= SAG_MAX_IMAGE_SIZE && (i >= 2 || n >= 1);
        if (good) crop[i] = (uint32_t)n, at = end + 1;
    }
    if (good) return 0;
    usage_error(command->name, "--%s %s: expected WIDTHxHEIGHT+X+Y in pixels", o->name, value);
    return -1;
}

static int read_choice(const tool_command *command, const option *o, const char *value) {
    char list[160] = "";
    for (int i = 0; o->choices[i]; i++) {
        if (strcmp(o->choices[i], value) == 0) {
            *(int *)o->target = i;
            return 0;
        }
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", o->choices[i]);
    }
    const char *near = nearest_word(value, o->choices);
    if (near) {
        usage_error(command->name, "--%s %s: did you mean '%s'? One of %s", o->name, value, near, list);
    } else {
        usage_error(command->name, "--%s %s: expected one of %s", o->name, value, list);
    }
    return -1;
}

static int read_value(const tool_command *command, const option *o, const char *value) {
    switch (o->kind) {
    case OPTION_FLAG: *(bool *)o->target = true; return 0;
    case OPTION_TEXT:
        if (!*value) {
            usage_error(command->name, "--%s: the value is empty", o->name);
            return -1;
        }
        *(const char **)o->target = value;
        return 0;
    case OPTION_COUNT: return read_count(command, o, value);
    case OPTION_NUMBER: return read_number(command, o, value);
    case OPTION_SIZE: return read_size(command, o, value);
    case OPTION_CROP: return read_crop(command, o, value);
    case OPTION_CHOICE: return read_choice(command, o, value);
    }
    return -1;
}

int options_parse(const tool_command *command, const option *options, size_t option_count, int argc,
                  char **argv) {
    int rest = 0;
    bool ended = false;
    for (int i = 0; i < argc; i++) {
        char *argument = argv[i];
        if (ended || argument[0] != '-' || argument[1] == 0) {
            argv[rest++] = argument;
            continue;
        }
        if (strcmp(argument, "--") == 0) {
            ended = true;
            continue;
        }
        if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
            fputs(command->help, stdout);
            return close_stdout() == TOOL_OK ? -2 : -1;
        }
        const option *o = NULL;
        const char *value = NULL;
        if (argument[1] == '-') {
            const size_t length = strcspn(argument + 2, "=");
            o = find_option(options, option_count, argument + 2, length);
            if (argument[2 + length]) value = argument + 3 + length;
        } else {
            for (size_t k = 0; k < option_count; k++) {
                if (options[k].letter && options[k].letter == argument[1]) o = &options[k];
            }
            if (argument[2]) value = argument + 2;
        }
        if (!o || (o->kind == OPTION_FLAG && argument[1] != '-' && value))
            return unknown_option(command, options, option_count, argument);
        if (o->kind == OPTION_FLAG && value) {
            usage_error(command->name, "--%s takes no value", o->name);
            return -1;
        }
        if (o->kind != OPTION_FLAG && !value) {
            if (i + 1 >= argc) {
                usage_error(command->name, "--%s needs a value", o->name);
                return -1;
            }
            value = argv[++i];
        }
        if (read_value(command, o, value) < 0) return -1;
    }
    return rest;
}
