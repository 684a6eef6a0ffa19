// SPDX-License-Identifier: MIT
// Rays from CSV. A block of whole lines is cut into pieces at line ends. One pass counts the lines of each
// piece, which says where its rays go and what its lines are called in messages; a second parses all pieces
// side by side; then the gaps that blank lines left are closed. Of several errors the first in the file is
// reported.
#include "formats/number.h"
#include "formats/ray_reader.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#define PIECE_BYTES ((size_t)32 << 10)

// What is wrong and where.
typedef struct csv_issue {
    uint64_t line;
    int column; // 0: nothing is wrong
    char message[160];
} csv_issue;

typedef struct csv_piece {
    const char *begin, *end;
    uint64_t first_line, line_count;
    size_t offset, count; // its rays, in the reader's array
    csv_issue issue;
} csv_piece;

typedef struct csv_block {
    sagi_ray_reader *reader;
    csv_piece pieces[SAGI_RAY_MAX_PIECE];
} csv_block;

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
static bool is_comma(char c) { return c == ',' || c == ';'; }
static bool ends_here(const char *p, const char *end) { return p == end || *p == '#'; }
static bool ends_field(const char *p, const char *end) {
    return ends_here(p, end) || is_blank(*p) || is_comma(*p);
}

static const char *skip_blanks(const char *p, const char *end) {
    while (p < end && is_blank(*p)) p++;
    return p;
}

static const char *line_end(const char *p, const char *end) {
    const char *newline = memchr(p, '\n', (size_t)(end - p));
    return newline ? newline : end;
}

// The field at p, cut and with what is not printable replaced, for a message.
static void quote(const char *p, const char *end, char text[32]) {
    size_t length = 0;
    for (; !ends_field(p, end) && length < 24; p++) text[length++] = *p >= ' ' && *p <= '~' ? *p : '?';
    if (!ends_field(p, end)) text[length++] = '.', text[length++] = '.', text[length++] = '.';
    text[length] = 0;
}

static int not_a_number(const char *line, const char *p, const char *end, const char *hint,
                        csv_issue *issue) {
    char text[32];
    quote(p, end, text);
    issue->column = (int)(p - line) + 1;
    snprintf(issue->message, sizeof issue->message, "'%s' is not a number%s", text, hint);
    return -1;
}

// The numbers of a line: how many, 0 for a blank line or a comment, -1 when something is wrong.
static int parse_fields(const char *line, const char *end, double *values, int *columns, csv_issue *issue) {
    const char *p = skip_blanks(line, end);
    if (ends_here(p, end)) return 0;
    for (int count = 0;;) {
        if (ends_here(p, end) || is_comma(*p)) {
            issue->column = (int)(p - line) + 1;
            snprintf(issue->message, sizeof issue->message, "column %d is empty", count + 1);
            return -1;
        }
        if (count == SAGI_RAY_COLUMNS) {
            issue->column = (int)(p - line) + 1;
            snprintf(issue->message, sizeof issue->message,
                     "more than %d columns; a ray is ox,oy,oz,dx,dy,dz[,tmin,tmax]", SAGI_RAY_COLUMNS);
            return -1;
        }
        const char *after = sagi_parse_number(p, end, &values[count]);
        if (!after || !ends_field(after, end)) return not_a_number(line, p, end, "", issue);
        columns[count++] = (int)(p - line) + 1;
        p = skip_blanks(after, end);
        if (ends_here(p, end)) return count;
        if (is_comma(*p)) p = skip_blanks(p + 1, end);
    }
}

// 1: a ray; 0: a line without one; -1: something is wrong.
static int parse_line(const sagi_ray_reader *reader, const char *line, const char *end, sag_ray *ray,
                      csv_issue *issue) {
    double values[SAGI_RAY_COLUMNS], numbers[SAGI_RAY_COLUMNS] = {[7] = INFINITY};
    int columns[SAGI_RAY_COLUMNS], column_of[SAGI_RAY_COLUMNS] = {0};
    int count = parse_fields(line, end, values, columns, issue);
    if (count <= 0) return count;
    if ((uint32_t)count != reader->columns) {
        issue->column = columns[count - 1];
        snprintf(issue->message, sizeof issue->message, "%d column%s, but %u %s", count,
                 count == 1 ? "" : "s", reader->columns,
                 reader->has_header ? "in the header" : "in the first ray");
        return -1;
    }
    for (int i = 0; i < count; i++) {
        numbers[reader->meaning[i]] = values[i];
        column_of[reader->meaning[i]] = columns[i];
    }
    int which;
    const char *problem = sagi_ray_from_numbers(numbers, ray, &which);
    if (!problem) return 1;
    issue->column = column_of[which];
    snprintf(issue->message, sizeof issue->message, "%s", problem);
    return -1;
}

// Which of ox … tmax the field at p names, or -1.
static int column_named(const char *p, const char *end) {
    static const char *const names[] = {"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "x", "y", "z"};
    for (int i = 0; i < 11; i++) {
        const char *q = p, *name = names[i];
        while (q < end && *name && (*q | 0x20) == *name) q++, name++;
        if (!*name && ends_field(q, end)) return i < SAGI_RAY_COLUMNS ? i : i - SAGI_RAY_COLUMNS;
    }
    return -1;
}

static int parse_header(sagi_ray_reader *reader, const char *line, const char *end, csv_issue *issue) {
    unsigned seen = 0;
    int count = 0;
    for (const char *p = skip_blanks(line, end); !ends_here(p, end); count++) {
        int name = column_named(p, end);
        if (name < 0)
            return not_a_number(line, p, end, ", nor a column's name: ox,oy,oz,dx,dy,dz[,tmin,tmax]", issue);
        issue->column = (int)(p - line) + 1;
        if (seen >> name & 1) {
            snprintf(issue->message, sizeof issue->message, "the header names a column twice");
            return -1;
        }
        seen |= 1u << name;
        reader->meaning[count] = (uint8_t)name;
        while (!ends_field(p, end)) p++;
        p = skip_blanks(p, end);
        if (p < end && is_comma(*p)) p = skip_blanks(p + 1, end);
    }
    if (seen != 0x3F && seen != 0xFF) {
        snprintf(issue->message, sizeof issue->message,
                 "the header must name ox,oy,oz,dx,dy,dz and may name tmin and tmax");
        return -1;
    }
    issue->column = 0;
    reader->columns = (uint32_t)count;
    reader->has_header = true;
    return 0;
}

// Finds out what the columns are from the first line that is not blank; a header is used up.
static int learn_columns(sagi_ray_reader *reader, const char **text, const char *end, csv_issue *issue) {
    while (*text < end && reader->columns == 0) {
        const char *line = *text, *stop = line_end(line, end), *p = skip_blanks(line, stop);
        issue->line = reader->line + 1;
        double value;
        bool is_ray = !ends_here(p, stop) && (is_comma(*p) || sagi_parse_number(p, stop, &value));
        if (is_ray) {
            double values[SAGI_RAY_COLUMNS];
            int columns[SAGI_RAY_COLUMNS] = {0}, count = parse_fields(line, stop, values, columns, issue);
            if (count < 1) return -1;
            if (count != 6 && count != 8) {
                issue->column = columns[count - 1];
                snprintf(issue->message, sizeof issue->message,
                         "%d column%s; a ray has 6 (ox,oy,oz,dx,dy,dz) or 8 (tmin,tmax as well)", count,
                         count == 1 ? "" : "s");
                return -1;
            }
            for (uint8_t i = 0; i < SAGI_RAY_COLUMNS; i++) reader->meaning[i] = i;
            reader->columns = (uint32_t)count;
            return 0;
        }
        if (!ends_here(p, stop) && parse_header(reader, line, stop, issue) < 0) return -1;
        reader->line++;
        *text = stop < end ? stop + 1 : end;
    }
    return 0;
}

static void count_lines(void *argument, size_t index) {
    csv_piece *piece = &((csv_block *)argument)->pieces[index];
    for (const char *p = piece->begin; p < piece->end; p++) {
        p = line_end(p, piece->end);
        piece->line_count++;
    }
}

static void parse_piece(void *argument, size_t index) {
    csv_block *block = argument;
    csv_piece *piece = &block->pieces[index];
    uint64_t number = piece->first_line;
    for (const char *line = piece->begin; line < piece->end; number++) {
        const char *end = line_end(line, piece->end);
        int found = parse_line(block->reader, line, end, &block->reader->rays[piece->offset + piece->count],
                               &piece->issue);
        if (found < 0) {
            piece->issue.line = number;
            return;
        }
        piece->count += (size_t)found;
        line = end < piece->end ? end + 1 : piece->end;
    }
}

static sag_status report(const sagi_ray_reader *reader, const csv_issue *issue, sag_error *error) {
    int line = issue->line > INT_MAX ? 0 : (int)issue->line;
    return sag_error_set_at(error, SAG_ERROR_FORMAT, reader->file, line, line ? issue->column : 0, "%s",
                            issue->message);
}

// Parses whole lines; their rays go to the front of the reader's array.
static sag_status parse_block(sagi_ray_reader *reader, const char *text, const char *end, size_t *count,
                              sag_error *error) {
    csv_block block = {.reader = reader};
    size_t piece_count = 0, line_count = 0, size = (size_t)(end - text) / SAGI_RAY_MAX_PIECE + 1;
    if (size < PIECE_BYTES) size = PIECE_BYTES;
    for (const char *p = text; p < end; piece_count++) {
        const char *stop = (size_t)(end - p) > size ? line_end(p + size, end) : end;
        if (stop < end) stop++;
        block.pieces[piece_count] = (csv_piece){.begin = p, .end = stop};
        p = stop;
    }
    sag_parallel_for(reader->context, piece_count, count_lines, &block);
    for (size_t i = 0; i < piece_count; i++) {
        block.pieces[i].offset = line_count;
        block.pieces[i].first_line = reader->line + line_count + 1;
        line_count += block.pieces[i].line_count;
    }
    sag_status status = sagi_ray_reader_reserve(reader, line_count, error);
    if (status != SAG_OK) return status;
    sag_parallel_for(reader->context, piece_count, parse_piece, &block);
    size_t used = 0;
    for (size_t i = 0; i < piece_count; i++) {
        const csv_piece *piece = &block.pieces[i];
        if (piece->issue.column > 0) return report(reader, &piece->issue, error);
        if (piece->offset != used)
            memmove(reader->rays + used, reader->rays + piece->offset, piece->count * sizeof *reader->rays);
        used += piece->count;
    }
    reader->line += line_count;
    *count = used;
    return SAG_OK;
}

// Where the last whole line of the buffer ends; NULL when there is none.
static const char *whole_lines(const sagi_ray_reader *reader) {
    const char *end = reader->buffer + reader->filled;
    if (reader->at_end) return end;
    while (end > reader->buffer && end[-1] != '\n') end--;
    return end > reader->buffer ? end : NULL;
}

sag_status sagi_ray_csv_next(sagi_ray_reader *reader, size_t *count, sag_error *error) {
    static const char mark[3] = {'\xEF', '\xBB', '\xBF'};
    for (*count = 0; *count == 0;) {
        const char *text = reader->buffer, *end = whole_lines(reader);
        if (!end && reader->filled < SAGI_RAY_MAX_LINE) {
            sag_status status = sagi_ray_reader_fill(reader, error);
            if (status != SAG_OK) return status;
            continue;
        }
        if (reader->filled == 0) return SAG_OK;
        if (!end) {
            csv_issue issue = {.line = reader->line + 1,
                               .column = 1,
                               .message = "the line is longer than 1 MiB: this is no table of rays"};
            return report(reader, &issue, error);
        }
        if (reader->line == 0 && reader->read_bytes == reader->filled && end - text >= 3 &&
            memcmp(text, mark, 3) == 0)
            text += 3;
        csv_issue issue = {0};
        if (learn_columns(reader, &text, end, &issue) < 0) return report(reader, &issue, error);
        sag_status status = parse_block(reader, text, end, count, error);
        if (status != SAG_OK) return status;
        reader->filled -= (size_t)(end - reader->buffer);
        memmove(reader->buffer, end, reader->filled);
    }
    return SAG_OK;
}
