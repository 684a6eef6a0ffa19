// SPDX-License-Identifier: MIT
// Nearly all of a large scene file is numbers in brackets. Where an array begins and ends is known without
// reading them, so they are cut into pieces of equal length, whatever meshes they belong to, and each piece
// is a task of its own: first its words are counted, which says where in the array its numbers go; then they
// are converted and put there. A word belongs to the piece in which it begins. Results do not depend on the
// pieces or the threads.
//
// Whatever is not plain good numbers is only noticed here, not told: the reader of parameter lists goes over
// such a mesh again and says what is wrong, and where, as it always does.
#include "formats/mesh_text.h"

#include "formats/number.h"

#include <string.h>

#define PIECE_BYTES ((size_t)1 << 18)

typedef struct piece {
    sagi_mesh_text *mesh;
    sagi_mesh_array array;
    const char *begin, *end;
    size_t count, first; // words that begin here; the number of the first of them in the array
    bool wrong;
} piece;

typedef struct work {
    piece *pieces;
    size_t piece_count;
    void (*others)(void *argument, size_t index);
    void *argument;
    size_t other_count;
} work;

static inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

static size_t pieces_of(sagi_slice text) { return (text.length + PIECE_BYTES - 1) / PIECE_BYTES; }

static void cut(sagi_mesh_text *mesh, sagi_mesh_array array, piece *out) {
    const sagi_slice text = mesh->arrays[array];
    for (size_t at = 0; at < text.length; at += PIECE_BYTES, out++) {
        const size_t left = text.length - at;
        *out = (piece){.mesh = mesh,
                       .array = array,
                       .begin = text.text + at,
                       .end = text.text + at + (left < PIECE_BYTES ? left : PIECE_BYTES)};
    }
}

// Words begin where something stands after a space. (Bytes of 0 and 1 are summed by the compiler sixteen and
// more at a time, in runs short enough for a byte.)
static void count_words(void *argument, size_t index) {
    piece *const q = &((work *)argument)->pieces[index];
    const char *const text = q->mesh->arrays[q->array].text, *p = q->begin;
    size_t count = 0;
    if (p == text) count += !is_space(*p++);
    while (p != q->end) {
        const size_t left = (size_t)(q->end - p), run = left < 240 ? left : 240;
        uint8_t sum = 0;
        for (size_t i = 0; i < run; i++) {
            const uint8_t c = (uint8_t)p[i], b = (uint8_t)p[(ptrdiff_t)i - 1];
            const uint8_t here = (uint8_t)((c == ' ') | ((uint8_t)(c - '\t') < 5));
            const uint8_t before = (uint8_t)((b == ' ') | ((uint8_t)(b - '\t') < 5));
            sum = (uint8_t)(sum + (before & (here ^ 1)));
        }
        count += sum;
        p += run;
    }
    q->count = count;
}

static bool store(const piece *q, size_t at, double value) {
    const sagi_mesh_data *data = &q->mesh->data;
    if (q->array == SAGI_MESH_POSITIONS) {
        data->positions_f64[at] = value;
    } else if (q->array == SAGI_MESH_INDICES) {
        if (!(value >= 0 && value < data->vertex_count)) return false;
        data->triangles[at] = (uint32_t)value;
        return (double)data->triangles[at] == value;
    } else {
        (q->array == SAGI_MESH_NORMALS ? data->normals : data->texcoords)[at] = (float)value;
    }
    return true;
}

static void convert(piece *q) {
    if (q->mesh->wrong || q->mesh->no_memory) return;
    const sagi_slice text = q->mesh->arrays[q->array];
    const char *p = q->begin, *const all = text.text + text.length;
    if (p != text.text && !is_space(p[-1]))
        while (p != q->end && !is_space(*p)) p++; // the word before's
    for (size_t at = q->first, end = q->first + q->count; at < end; at++) {
        while (is_space(*p)) p++; // ends: a word of this piece is still to come
        double value;
        p = sagi_parse_number(p, all, &value);
        if (!p || (p != all && !is_space(*p)) || !store(q, at, value)) {
            q->wrong = true;
            return;
        }
    }
}

static void do_one(void *argument, size_t index) {
    work *const w = argument;
    if (index < w->other_count)
        w->others(w->argument, index);
    else
        convert(&w->pieces[index - w->other_count]);
}

// What read_arrays of pbrt_mesh.c asks for.
static bool counts_fit(const sagi_mesh_text *mesh) {
    const size_t *n = mesh->counts, points = n[SAGI_MESH_POSITIONS] / 3;
    if (points == 0 || n[SAGI_MESH_POSITIONS] % 3 || points > UINT32_MAX) return false;
    if (n[SAGI_MESH_NORMALS] && n[SAGI_MESH_NORMALS] != 3 * points) return false;
    if (n[SAGI_MESH_TEXCOORDS] && n[SAGI_MESH_TEXCOORDS] != 2 * points) return false;
    return n[SAGI_MESH_INDICES] && n[SAGI_MESH_INDICES] % 3 == 0 && n[SAGI_MESH_INDICES] / 3 <= UINT32_MAX;
}

static bool allocate(const sag_context *context, sagi_mesh_text *mesh) {
    const size_t *n = mesh->counts;
    sagi_mesh_data *data = &mesh->data;
    data->vertex_count = (uint32_t)(n[SAGI_MESH_POSITIONS] / 3);
    data->positions_f64 = sag_allocate(context, n[SAGI_MESH_POSITIONS] * sizeof(double));
    if (n[SAGI_MESH_NORMALS]) data->normals = sag_allocate(context, n[SAGI_MESH_NORMALS] * sizeof(float));
    if (n[SAGI_MESH_TEXCOORDS])
        data->texcoords = sag_allocate(context, n[SAGI_MESH_TEXCOORDS] * sizeof(float));
    if (!data->positions_f64 || (n[SAGI_MESH_NORMALS] && !data->normals) ||
        (n[SAGI_MESH_TEXCOORDS] && !data->texcoords) ||
        !sagi_mesh_data_reserve(data, n[SAGI_MESH_INDICES] / 3))
        return false;
    data->triangle_count = (uint32_t)(n[SAGI_MESH_INDICES] / 3);
    return true;
}

bool sagi_mesh_texts_read(const sag_context *context, sagi_mesh_text *const *texts, size_t text_count,
                          void (*others)(void *argument, size_t index), void *argument, size_t other_count) {
    work w = {.others = others, .argument = argument, .other_count = other_count};
    for (size_t i = 0; i < text_count; i++)
        for (int k = 0; k < SAGI_MESH_ARRAY_COUNT; k++) w.piece_count += pieces_of(texts[i]->arrays[k]);
    const size_t bytes = w.piece_count * sizeof *w.pieces;
    w.pieces = sag_allocate(context, bytes ? bytes : 1);
    if (!w.pieces) return false;
    size_t next = 0;
    for (size_t i = 0; i < text_count; i++)
        for (int k = 0; k < SAGI_MESH_ARRAY_COUNT; k++) {
            cut(texts[i], (sagi_mesh_array)k, w.pieces + next);
            next += pieces_of(texts[i]->arrays[k]);
        }
    sag_parallel_for(context, w.piece_count, count_words, &w);
    for (size_t i = 0; i < w.piece_count; i++) {
        piece *q = &w.pieces[i];
        q->first = q->mesh->counts[q->array];
        q->mesh->counts[q->array] += q->count;
    }
    for (size_t i = 0; i < text_count; i++) {
        texts[i]->data.context = context;
        texts[i]->wrong = !counts_fit(texts[i]);
        texts[i]->no_memory = !texts[i]->wrong && !allocate(context, texts[i]);
    }
    sag_parallel_for(context, other_count + w.piece_count, do_one, &w);
    for (size_t i = 0; i < w.piece_count; i++) w.pieces[i].mesh->wrong |= w.pieces[i].wrong;
    sag_release(context, w.pieces, bytes ? bytes : 1);
    return true;
}
