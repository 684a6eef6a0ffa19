// SPDX-License-Identifier: MIT
// Option "name" value: pbrt's command line within a scene. Most of them are about how pbrt works (its space
// of calculation, its wavefront kernels, its statistics) and no picture depends on them; those on which one
// does, and that have no effect here, are named in a warning.
#include "formats/pbrt_options.h"

#include "formats/number.h"

#include <stdio.h>
#include <string.h>

typedef enum value_kind { BOOL, NUMBER, INTEGER, STRING } value_kind;

// As pbrt compares names: without - and _, in lower case.
static void normalize(char *name) {
    char *out = name;
    for (const char *c = name; *c; c++) {
        if (*c == '-' || *c == '_') continue;
        *out++ = *c >= 'A' && *c <= 'Z' ? (char)(*c + ('a' - 'A')) : *c;
    }
    *out = '\0';
}

static bool is_of_kind(const sagi_token *token, value_kind kind, double *number) {
    const char *const end = token->text.text + token->text.length;
    *number = sagi_slice_is(token->text, "true");
    switch (kind) {
    case BOOL: return *number != 0 || sagi_slice_is(token->text, "false");
    case STRING: return token->kind == SAGI_TOKEN_STRING;
    case NUMBER:
    case INTEGER:
        return token->kind == SAGI_TOKEN_WORD && sagi_parse_number(token->text.text, end, number) == end &&
               (kind == NUMBER || (*number >= INT32_MIN && *number <= INT32_MAX));
    }
    return false;
}

static sag_status apply(sagi_pbrt *p, sagi_place place, const char *name, const sagi_token *token) {
    static const struct {
        const char *name;
        value_kind kind;
        bool matters; // for the picture, or as a file that is expected
    } options[] = {
        {"disablepixeljitter", BOOL, true},
        {"disabletexturefiltering", BOOL, true},
        {"disablewavelengthjitter", BOOL, true},
        {"displacementedgescale", NUMBER, false},
        {"forcediffuse", BOOL, true},
        {"msereferenceimage", STRING, true},
        {"msereferenceout", STRING, true},
        {"pixelstats", BOOL, true},
        {"rendercoordsys", STRING, false},
        {"seed", INTEGER, false},
        {"wavefront", BOOL, false},
    };
    static const char *const kinds[] = {"true or false", "a number", "an integer", "a string"};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        if (strcmp(name, options[i].name) != 0) continue;
        double value;
        if (!is_of_kind(token, options[i].kind, &value))
            return sagi_place_error(token->place, p->error, "Option \"%s\": %s expected", name,
                                    kinds[options[i].kind]);
        if (strcmp(name, "seed") == 0)
            p->seed = (int32_t)value;
        else if (options[i].matters && !(options[i].kind == BOOL && value == 0))
            sagi_pbrt_warn(p, place, "Option \"%s\" has no effect", name);
        return SAG_OK;
    }
    return sagi_place_error(place, p->error, "unknown option \"%.60s\"", name);
}

// A name, with or without a type before it, and one value, in brackets or not.
sag_status sagi_pbrt_option(sagi_pbrt *p, sagi_place place) {
    char name[256];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    sagi_cursor *cursor = &p->files[p->file_count - 1];
    sagi_token token;
    status = sagi_cursor_next(cursor, &token, p->error);
    if (status != SAG_OK) return status;
    if (token.kind == SAGI_TOKEN_OPEN) {
        sagi_token close;
        status = sagi_cursor_next(cursor, &token, p->error);
        if (status == SAG_OK) status = sagi_cursor_next(cursor, &close, p->error);
        if (status != SAG_OK) return status;
        if (close.kind != SAGI_TOKEN_CLOSE)
            return sagi_place_error(close.place, p->error, "] expected: Option \"%.60s\" has one value",
                                    name);
    }
    if (token.kind != SAGI_TOKEN_WORD && token.kind != SAGI_TOKEN_STRING)
        return sagi_place_error(token.place, p->error, "Option \"%.60s\" has no value", name);
    const char *const typed = strrchr(name, ' ');
    char *const bare = typed ? name + (typed + 1 - name) : name;
    normalize(bare);
    return apply(p, place, bare, &token);
}

void sagi_pbrt_apply_seed(sagi_pbrt *p) {
    sag_settings *settings = sag_world_settings(p->world);
    if (p->seed && settings->seed == 0 && !p->options->geometry_only)
        settings->seed = (uint64_t)(int64_t)p->seed;
}
