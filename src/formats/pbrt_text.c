// SPDX-License-Identifier: MIT
// pbrt's text: words, strings, brackets, and the parameter lists made of them, like
//     "float radius" 2   "point3 P" [ 0 0 0  1 0 0 ]   "string filename" "a.ply"
// Nothing is copied while reading: tokens point into the file. Lines are not counted either; a place is a
// pointer, and turned into line and column by counting from the beginning when a message needs it. Numbers
// are read straight into the list's pool without becoming tokens, since they are nearly all of a large file.
#include "formats/pbrt_text.h"

#include "formats/number.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// No number or directive is longer; what is, is noise.
#define MAX_WORD_BYTES 65536
// Numbers in brackets that are converted later, if a list is skimmed.
#define MIN_SKIMMED_BYTES 2048

void sagi_place_find(sagi_place place, int *line, int *column) {
    *line = 1, *column = 1;
    const char *begin = (const char *)place.source->file.bytes, *line_begin = begin;
    for (const char *p = begin; (p = memchr(p, '\n', (size_t)(place.at - p))) != NULL; ++*line)
        line_begin = ++p;
    *column = (int)(place.at - line_begin) + 1;
}

sag_status sagi_place_error(sagi_place place, sag_error *error, const char *format, ...) {
    char message[sizeof((sag_error *)0)->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    int line, column;
    sagi_place_find(place, &line, &column);
    return sag_error_set_at(error, SAG_ERROR_FORMAT, place.source->path, line, column, "%s", message);
}

// What a byte is to the reader of words.
enum { SPACE = 1, ENDS_WORD = 2 };
static const uint8_t byte_class[256] = {
    [' '] = SPACE | ENDS_WORD,  ['\n'] = SPACE | ENDS_WORD, ['\t'] = SPACE | ENDS_WORD,
    ['\r'] = SPACE | ENDS_WORD, ['\f'] = SPACE | ENDS_WORD, ['\v'] = SPACE | ENDS_WORD,
    ['"'] = ENDS_WORD,          ['['] = ENDS_WORD,          [']'] = ENDS_WORD,
    ['#'] = ENDS_WORD,
};

static inline bool is_space(char c) { return (byte_class[(uint8_t)c] & SPACE) != 0; }

static void skip_space(sagi_cursor *cursor) {
    const char *p = cursor->next, *const end = cursor->end;
    for (; p != end; p++) {
        if (*p == '#') {
            const char *newline = memchr(p, '\n', (size_t)(end - p));
            p = newline ? newline : end - 1;
        } else if (!is_space(*p)) {
            break;
        }
    }
    cursor->next = p;
}

sag_status sagi_cursor_next(sagi_cursor *cursor, sagi_token *token, sag_error *error) {
    skip_space(cursor);
    const char *p = cursor->next, *const end = cursor->end;
    *token = (sagi_token){.place = {cursor->source, p}};
    if (p == end) return SAG_OK;
    if (*p == '[' || *p == ']') {
        token->kind = *p == '[' ? SAGI_TOKEN_OPEN : SAGI_TOKEN_CLOSE;
        token->text = (sagi_slice){p, 1};
        cursor->next = p + 1;
        return SAG_OK;
    }
    if (*p == '"') {
        const char *q = p + 1;
        for (; q != end && *q != '"' && *q != '\n' && *q != '\0'; q++)
            if (*q == '\\' && q + 1 != end && q[1] != '\n') q++;
        if (q != end && *q == '\0')
            return sagi_place_error((sagi_place){cursor->source, q}, error, "a zero byte in a string");
        if (q == end || *q == '\n')
            return sagi_place_error(token->place, error, "this string has no closing quote");
        token->kind = SAGI_TOKEN_STRING;
        token->text = (sagi_slice){p + 1, (size_t)(q - p) - 1};
        cursor->next = q + 1;
        return SAG_OK;
    }
    const char *q = p;
    const char *const limit = end - p > MAX_WORD_BYTES ? p + MAX_WORD_BYTES : end;
    while (q != limit && !(byte_class[(uint8_t)*q] & ENDS_WORD)) q++;
    if (q - p >= MAX_WORD_BYTES) return sagi_place_error(token->place, error, "this is no text of a scene");
    token->kind = SAGI_TOKEN_WORD;
    token->text = (sagi_slice){p, (size_t)(q - p)};
    cursor->next = q;
    return SAG_OK;
}

// ---- parameter lists

static const struct {
    const char *name;
    sagi_type type;
} type_names[] = {
    {"integer", SAGI_TYPE_INTEGER}, {"float", SAGI_TYPE_FLOAT},       {"bool", SAGI_TYPE_BOOL},
    {"string", SAGI_TYPE_STRING},   {"point2", SAGI_TYPE_POINT2},     {"vector2", SAGI_TYPE_VECTOR2},
    {"point3", SAGI_TYPE_POINT3},   {"point", SAGI_TYPE_POINT3},      {"vector3", SAGI_TYPE_VECTOR3},
    {"vector", SAGI_TYPE_VECTOR3},  {"normal3", SAGI_TYPE_NORMAL},    {"normal", SAGI_TYPE_NORMAL},
    {"rgb", SAGI_TYPE_RGB},         {"spectrum", SAGI_TYPE_SPECTRUM}, {"blackbody", SAGI_TYPE_BLACKBODY},
    {"texture", SAGI_TYPE_TEXTURE},
};
#define TYPE_COUNT (sizeof type_names / sizeof *type_names)

static const char *type_name(unsigned types) {
    for (size_t i = TYPE_COUNT; i-- > 0;)
        if (type_names[i].type & types) return type_names[i].name;
    return "?";
}

static bool reserve(const sag_context *context, void **items, size_t *allocated, size_t needed,
                    size_t item_bytes) {
    if (needed <= *allocated) return true;
    const size_t larger = needed > 2 * *allocated ? (needed < 64 ? 64 : needed) : 2 * *allocated;
    void *fresh = sag_allocate(context, larger * item_bytes);
    if (!fresh) return false;
    if (*allocated) memcpy(fresh, *items, *allocated * item_bytes);
    sag_release(context, *items, *allocated * item_bytes);
    *items = fresh;
    *allocated = larger;
    return true;
}

static sag_status out_of_memory(sagi_params *params) {
    return params->status =
               sag_error_set(params->error, SAG_ERROR_MEMORY, "out of memory reading %s", params->what);
}

void sagi_params_clear(sagi_params *params) {
    sag_release(params->context, params->items, params->allocated * sizeof *params->items);
    sag_release(params->context, params->numbers, params->number_allocated * sizeof *params->numbers);
    sag_release(params->context, params->strings, params->string_allocated * sizeof *params->strings);
    *params = (sagi_params){.context = params->context, .error = params->error};
}

static bool add_number(sagi_params *params, double value) {
    void *pool = params->numbers;
    if (!reserve(params->context, &pool, &params->number_allocated, params->number_count + 1, sizeof(double)))
        return false;
    params->numbers = pool;
    params->numbers[params->number_count++] = value;
    return true;
}

static bool add_string(sagi_params *params, sagi_slice value) {
    void *pool = params->strings;
    if (!reserve(params->context, &pool, &params->string_allocated, params->string_count + 1,
                 sizeof(sagi_slice)))
        return false;
    params->strings = pool;
    params->strings[params->string_count++] = value;
    return true;
}

// Splits "type name" and finds the type.
static sag_status parse_declaration(sagi_params *params, const sagi_token *token, sagi_param *param) {
    const char *p = token->text.text, *const end = p + token->text.length;
    while (p != end && is_space(*p)) p++;
    const char *type_begin = p;
    while (p != end && !is_space(*p)) p++;
    const sagi_slice type = {type_begin, (size_t)(p - type_begin)};
    while (p != end && is_space(*p)) p++;
    const char *name_end = end;
    while (name_end != p && is_space(name_end[-1])) name_end--;
    *param = (sagi_param){.place = token->place, .name = {p, (size_t)(name_end - p)}};
    for (size_t i = 0; i < TYPE_COUNT; i++)
        if (sagi_slice_is(type, type_names[i].name)) param->type = type_names[i].type;
    if (param->name.length == 0)
        return params->status = sagi_place_error(token->place, params->error,
                                                 "\"%.*s\": a parameter is written \"type name\"",
                                                 (int)token->text.length, token->text.text);
    if (!param->type)
        return params->status =
                   sagi_place_error(token->place, params->error, "unknown parameter type \"%.*s\"%s",
                                    (int)(type.length < 60 ? type.length : 60), type.text,
                                    sagi_slice_is(type, "color") ? ": pbrt-v4 calls it \"rgb\"" : "");
    return SAG_OK;
}

static bool is_integer(double value) {
    return value >= INT32_MIN && value <= UINT32_MAX && value == (double)(int64_t)value;
}

// Adds the value a token holds, if it suits the type.
static sag_status add_value(sagi_params *params, const sagi_param *param, const sagi_token *token) {
    const sagi_slice text = token->text;
    const bool wants_string = (param->type & (SAGI_TYPE_STRING | SAGI_TYPE_TEXTURE)) != 0;
    if (param->type == SAGI_TYPE_BOOL && (sagi_slice_is(text, "true") || sagi_slice_is(text, "false")))
        return add_number(params, text.length == 4) ? SAG_OK : out_of_memory(params);
    if (token->kind == SAGI_TOKEN_STRING && (wants_string || param->type == SAGI_TYPE_SPECTRUM))
        return add_string(params, text) ? SAG_OK : out_of_memory(params);
    double value;
    const char *const end = text.text + text.length;
    if (token->kind == SAGI_TOKEN_WORD && !wants_string && param->type != SAGI_TYPE_BOOL &&
        sagi_parse_number(text.text, end, &value) == end) {
        if (param->type == SAGI_TYPE_INTEGER && !is_integer(value))
            return params->status =
                       sagi_place_error(token->place, params->error, "%.*s is not an integer of 32 bits",
                                        (int)(text.length < 40 ? text.length : 40), text.text);
        return add_number(params, value) ? SAG_OK : out_of_memory(params);
    }
    return params->status = sagi_place_error(
               token->place, params->error, "%s expected for \"%s %.*s\", not %s%.*s%s",
               wants_string                        ? "a string"
               : param->type == SAGI_TYPE_BOOL     ? "true or false"
               : param->type == SAGI_TYPE_SPECTRUM ? "a number or string"
                                                   : "a number",
               type_name(param->type), (int)param->name.length, param->name.text,
               token->kind == SAGI_TOKEN_STRING ? "\"" : "", (int)(text.length < 40 ? text.length : 40),
               text.text, token->kind == SAGI_TOKEN_STRING ? "\"" : "");
}

// The quick way through a bracket full of numbers: as many as stand there plainly.
static bool add_numbers(sagi_params *params, sagi_cursor *cursor, bool whole) {
    for (;;) {
        if (cursor->next != cursor->end && is_space(*cursor->next)) cursor->next++;
        if (cursor->next == cursor->end || is_space(*cursor->next) || *cursor->next == '#')
            skip_space(cursor);
        double value;
        const char *stop = sagi_parse_number(cursor->next, cursor->end, &value);
        if (!stop || (stop != cursor->end && !is_space(*stop) && *stop != ']' && *stop != '#')) return true;
        if (whole && !is_integer(value)) return true;
        if (params->number_count < params->number_allocated)
            params->numbers[params->number_count++] = value;
        else if (!add_number(params, value))
            return false;
        cursor->next = stop;
    }
}

// Steps over a long array of numbers; the cursor is behind the [.
static bool skim_values(sagi_cursor *cursor, sagi_param *param) {
    const char *const begin = cursor->next;
    const size_t left = (size_t)(cursor->end - begin);
    const char *const close = memchr(begin, ']', left);
    const size_t length = close ? (size_t)(close - begin) : 0;
    if (length < MIN_SKIMMED_BYTES || memchr(begin, '#', length) || memchr(begin, '"', length)) return false;
    param->text = (sagi_slice){begin, length};
    param->skimmed = true;
    cursor->next = close + 1;
    return true;
}

static sag_status parse_values(sagi_params *params, sagi_cursor *cursor, sagi_param *param) {
    sagi_token token;
    if ((params->status = sagi_cursor_next(cursor, &token, params->error)) != SAG_OK) return params->status;
    if (token.kind == SAGI_TOKEN_WORD || token.kind == SAGI_TOKEN_STRING)
        return add_value(params, param, &token);
    if (token.kind != SAGI_TOKEN_OPEN)
        return params->status =
                   sagi_place_error(param->place, params->error, "\"%s %.*s\" has no value",
                                    type_name(param->type), (int)param->name.length, param->name.text);
    const sagi_place open = token.place;
    const bool whole = param->type == SAGI_TYPE_INTEGER;
    const unsigned plain = SAGI_TYPE_INTEGER | SAGI_TYPE_FLOAT | SAGI_TYPE_POINT2 | SAGI_TYPE_VECTOR2 |
                           SAGI_TYPE_POINT3 | SAGI_TYPE_VECTOR3 | SAGI_TYPE_NORMAL | SAGI_TYPE_RGB;
    if (params->skim && (param->type & plain) && skim_values(cursor, param)) return SAG_OK;
    for (;;) {
        if ((param->type & plain) && !add_numbers(params, cursor, whole)) return out_of_memory(params);
        if ((params->status = sagi_cursor_next(cursor, &token, params->error)) != SAG_OK)
            return params->status;
        if (token.kind == SAGI_TOKEN_CLOSE) {
            if (params->skim) param->text = (sagi_slice){open.at + 1, (size_t)(token.place.at - open.at) - 1};
            return SAG_OK;
        }
        if (token.kind == SAGI_TOKEN_END)
            return params->status = sagi_place_error(open, params->error, "this [ is never closed");
        if (token.kind == SAGI_TOKEN_OPEN)
            return params->status = sagi_place_error(token.place, params->error, "a [ within [ ]");
        if (add_value(params, param, &token) != SAG_OK) {
            // A directive among the values most likely means that a ] is missing.
            if (token.kind == SAGI_TOKEN_WORD && token.text.text[0] >= 'A' && token.text.text[0] <= 'Z')
                return params->status = sagi_place_error(open, params->error, "this [ is never closed");
            return params->status;
        }
    }
}

void sagi_params_empty(sagi_params *params) {
    params->count = params->number_count = params->string_count = 0;
    params->status = SAG_OK;
}

sag_status sagi_params_parse(sagi_params *params, sagi_cursor *cursor) {
    for (;;) {
        skip_space(cursor);
        if (cursor->next == cursor->end || *cursor->next != '"') return SAG_OK;
        sagi_token token;
        sagi_param param;
        if ((params->status = sagi_cursor_next(cursor, &token, params->error)) != SAG_OK)
            return params->status;
        if (parse_declaration(params, &token, &param) != SAG_OK) return params->status;
        param.first_number = params->number_count;
        param.first_string = params->string_count;
        if (parse_values(params, cursor, &param) != SAG_OK) return params->status;
        param.number_count = params->number_count - param.first_number;
        param.string_count = params->string_count - param.first_string;
        void *items = params->items;
        if (!reserve(params->context, &items, &params->allocated, params->count + 1, sizeof *params->items))
            return out_of_memory(params);
        params->items = items;
        params->items[params->count++] = param;
    }
}

// ---- looking up

sag_status sagi_params_fail(sagi_params *params, const sagi_param *param, const char *format, ...) {
    if (params->status != SAG_OK) return params->status;
    char message[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return params->status = sagi_place_error(param ? param->place : params->place, params->error, "%s: %s",
                                             params->what, message);
}

sagi_param *sagi_params_find(sagi_params *params, const char *name, unsigned types) {
    for (size_t i = params->count; i-- > 0;) {
        sagi_param *param = &params->items[i];
        if (!sagi_slice_is(param->name, name)) continue;
        param->used = true;
        if (param->type & types) return param;
        sagi_params_fail(params, param, "\"%s\" is of type %s here, %s expected", name,
                         type_name(param->type), type_name(types));
        return NULL;
    }
    return NULL;
}

static const double *find_numbers(sagi_params *params, const char *name, unsigned types, size_t count) {
    const sagi_param *param = sagi_params_find(params, name, types);
    if (!param) return NULL;
    if (param->number_count == count && param->string_count == 0)
        return params->numbers + param->first_number;
    sagi_params_fail(params, param, "\"%s\" has %zu numbers, not %zu", name, param->number_count, count);
    return NULL;
}

double sagi_params_float(sagi_params *params, const char *name, double otherwise) {
    const double *value = find_numbers(params, name, SAGI_TYPE_FLOAT | SAGI_TYPE_INTEGER, 1);
    return value ? *value : otherwise;
}

int32_t sagi_params_integer(sagi_params *params, const char *name, int32_t otherwise) {
    const double *value = find_numbers(params, name, SAGI_TYPE_INTEGER, 1);
    return value ? (int32_t)(*value > INT32_MAX ? INT32_MAX : *value) : otherwise;
}

bool sagi_params_bool(sagi_params *params, const char *name, bool otherwise) {
    const double *value = find_numbers(params, name, SAGI_TYPE_BOOL, 1);
    return value ? *value != 0 : otherwise;
}

void sagi_params_string(sagi_params *params, const char *name, const char *otherwise, char *text,
                        size_t size) {
    snprintf(text, size, "%s", otherwise);
    const sagi_param *param = sagi_params_find(params, name, SAGI_TYPE_STRING | SAGI_TYPE_TEXTURE);
    if (!param) return;
    if (param->string_count != 1) {
        sagi_params_fail(params, param, "\"%s\" has %zu strings, not one", name, param->string_count);
        return;
    }
    const sagi_slice value = params->strings[param->first_string];
    size_t length = 0;
    for (size_t i = 0; i < value.length; i++) {
        if (length + 1 >= size) {
            sagi_params_fail(params, param, "\"%s\" is longer than %zu bytes", name, size - 1);
            return;
        }
        if (value.text[i] == '\\' && i + 1 < value.length) i++;
        text[length++] = value.text[i];
    }
    text[length] = '\0';
}

sagi_slice sagi_params_name(const sagi_params *params, size_t string, char room[SAGI_MAX_NAME]) {
    const sagi_slice value = params->strings[string];
    // One that is too long is no name: nothing has been given one.
    if (value.length > SAGI_MAX_NAME || !memchr(value.text, '\\', value.length)) return value;
    size_t length = 0;
    for (size_t i = 0; i < value.length; i++) {
        if (value.text[i] == '\\' && i + 1 < value.length) i++;
        room[length++] = value.text[i];
    }
    return (sagi_slice){room, length};
}

bool sagi_params_triple(sagi_params *params, const char *name, double triple[3]) {
    const double *value =
        find_numbers(params, name, SAGI_TYPE_POINT3 | SAGI_TYPE_VECTOR3 | SAGI_TYPE_NORMAL, 3);
    if (!value) return false;
    memcpy(triple, value, 3 * sizeof *triple);
    return true;
}

const double *sagi_params_numbers(sagi_params *params, const char *name, unsigned types, size_t group,
                                  size_t *count) {
    *count = 0;
    const sagi_param *param = sagi_params_find(params, name, types);
    if (!param) return NULL;
    if (param->number_count % group != 0) {
        sagi_params_fail(params, param, "\"%s\" has %zu numbers, not a multiple of %zu", name,
                         param->number_count, group);
        return NULL;
    }
    *count = param->number_count;
    return params->numbers + param->first_number;
}
