// SPDX-License-Identifier: MIT
// PLY, the Stanford triangle format (Greg Turk, 1994): a header of text that declares elements (vertex, face,
// …) and their properties in order, then the elements' values, as text or binary in either byte order. Any
// property of any type may stand anywhere; those of no use here are stepped over.
//
// A reader of our own because the general importer does not do what is promised for these files: it says
// nothing of where a damaged file is damaged, reads what is left of a truncated one, drops vertices that are
// not numbers, and takes several times the memory and time for meshes of millions of triangles.
#include "formats/ply.h"

#include "formats/file.h"
#include "formats/names.h"
#include "formats/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// SAG_ERROR_FORMAT with line and column, or the byte for binary data.
static sag_status fail(const sagi_ply_reader *r, const uint8_t *at, bool is_text, const char *message) {
    if (!is_text)
        return sag_error_set_at(r->error, SAG_ERROR_FORMAT, r->path, 0, 0, "byte %zu: %s",
                                (size_t)(at - r->begin), message);
    int line = 1;
    const uint8_t *line_begin = r->begin;
    for (const uint8_t *p = r->begin; p < at; p++)
        if (*p == '\n') line_begin = p + 1, line++;
    return sag_error_set_at(r->error, SAG_ERROR_FORMAT, r->path, line, (int)(at - line_begin) + 1, "%s",
                            message);
}

static bool is_space(uint8_t c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// ---- header

static sagi_ply_type type_of(sagi_slice word) {
    static const struct {
        const char *name;
        sagi_ply_type type;
    } names[] = {{"char", SAGI_PLY_INT8},      {"int8", SAGI_PLY_INT8},       {"uchar", SAGI_PLY_UINT8},
                 {"uint8", SAGI_PLY_UINT8},    {"short", SAGI_PLY_INT16},     {"int16", SAGI_PLY_INT16},
                 {"ushort", SAGI_PLY_UINT16},  {"uint16", SAGI_PLY_UINT16},   {"int", SAGI_PLY_INT32},
                 {"int32", SAGI_PLY_INT32},    {"uint", SAGI_PLY_UINT32},     {"uint32", SAGI_PLY_UINT32},
                 {"float", SAGI_PLY_FLOAT32},  {"float32", SAGI_PLY_FLOAT32}, {"double", SAGI_PLY_FLOAT64},
                 {"float64", SAGI_PLY_FLOAT64}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (sagi_slice_is(word, names[i].name)) return names[i].type;
    return SAGI_PLY_NONE;
}

static sagi_ply_role role_of(sagi_slice word, bool is_list) {
    static const struct {
        const char *name;
        sagi_ply_role role;
    } names[] = {{"x", SAGI_PLY_X},         {"y", SAGI_PLY_Y},         {"z", SAGI_PLY_Z}, {"nx", SAGI_PLY_NX},
                 {"ny", SAGI_PLY_NY},       {"nz", SAGI_PLY_NZ},       {"u", SAGI_PLY_U}, {"s", SAGI_PLY_U},
                 {"texture_u", SAGI_PLY_U}, {"texture_s", SAGI_PLY_U}, {"v", SAGI_PLY_V}, {"t", SAGI_PLY_V},
                 {"texture_v", SAGI_PLY_V}, {"texture_t", SAGI_PLY_V}};
    if (is_list)
        return sagi_slice_is(word, "vertex_indices") || sagi_slice_is(word, "vertex_index")
                   ? SAGI_PLY_INDICES
                   : SAGI_PLY_IGNORED;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (sagi_slice_is(word, names[i].name)) return names[i].role;
    return SAGI_PLY_IGNORED;
}

// The words of the next header line; false at the end of the file.
static bool next_line(sagi_ply_reader *r, sagi_slice words[8], int *count) {
    *count = 0;
    const uint8_t *p = r->next;
    for (int i = 0; i < 8; i++) words[i] = (sagi_slice){"", 0};
    while (p != r->end && *p != '\n') {
        if (is_space(*p)) {
            p++;
            continue;
        }
        const uint8_t *word = p;
        while (p != r->end && !is_space(*p)) p++;
        if (*count < 8) words[(*count)++] = (sagi_slice){(const char *)word, (size_t)(p - word)};
    }
    if (p == r->end) return false;
    r->next = p + 1;
    return true;
}

// ---- values

size_t sagi_ply_size(sagi_ply_type t) {
    static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[t];
}

static double load(const uint8_t *p, sagi_ply_type t, sagi_ply_encoding e) {
    uint64_t bits = 0;
    const size_t size = sagi_ply_size(t);
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)p[e == SAGI_PLY_BIG_ENDIAN ? size - 1 - i : i] << (8 * i);
    switch (t) {
    case SAGI_PLY_INT8: return (int8_t)bits;
    case SAGI_PLY_UINT8: return (uint8_t)bits;
    case SAGI_PLY_INT16: return (int16_t)bits;
    case SAGI_PLY_UINT16: return (uint16_t)bits;
    case SAGI_PLY_INT32: return (int32_t)bits;
    case SAGI_PLY_UINT32: return (uint32_t)bits;
    case SAGI_PLY_FLOAT32: {
        const uint32_t narrow = (uint32_t)bits;
        float value;
        memcpy(&value, &narrow, 4);
        return (double)value;
    }
    case SAGI_PLY_FLOAT64: {
        double value;
        memcpy(&value, &bits, 8);
        return value;
    }
    case SAGI_PLY_NONE: break;
    }
    return 0;
}

// The next value, whatever the encoding; false with the error set.
static bool next_value(sagi_ply_reader *r, sagi_ply_type t, double *value) {
    if (r->encoding != SAGI_PLY_ASCII) {
        const size_t size = sagi_ply_size(t);
        if ((size_t)(r->end - r->next) < size) {
            fail(r, r->end, false, "the file is cut short");
            return false;
        }
        *value = load(r->next, t, r->encoding);
        r->next += size;
        return true;
    }
    while (r->next != r->end && is_space(*r->next)) r->next++;
    if (r->next == r->end) {
        fail(r, r->end, true, "the file is cut short");
        return false;
    }
    const char *stop = sagi_parse_number((const char *)r->next, (const char *)r->end, value);
    if (!stop || ((const uint8_t *)stop != r->end && !is_space((uint8_t)*stop))) {
        fail(r, r->next, true, "a number expected");
        return false;
    }
    r->next = (const uint8_t *)stop;
    return true;
}

static sag_status out_of_memory(const sagi_ply_reader *r) {
    return sag_error_set_at(r->error, SAG_ERROR_MEMORY, r->path, 0, 0, "out of memory for the mesh");
}

// ---- elements

static sag_status read_vertices(sagi_ply_reader *r, uint64_t count, const sagi_ply_property *properties,
                                int property_count) {
    bool has[SAGI_PLY_ROLE_COUNT] = {false}, wide = false;
    for (int i = 0; i < property_count; i++) {
        has[properties[i].role] = true;
        if (properties[i].role >= SAGI_PLY_X && properties[i].role <= SAGI_PLY_Z)
            wide = wide || properties[i].type == SAGI_PLY_FLOAT64 || properties[i].type == SAGI_PLY_INT32 ||
                   properties[i].type == SAGI_PLY_UINT32;
    }
    if (!has[SAGI_PLY_X] || !has[SAGI_PLY_Y] || !has[SAGI_PLY_Z])
        return fail(r, r->next, true, "the vertices have no x, y and z");
    // A vertex takes at least a byte a property: a claim of more than the file holds must not cost memory.
    if (count > UINT32_MAX || count * 3 > (uint64_t)(r->end - r->next))
        return fail(r, r->end, r->encoding == SAGI_PLY_ASCII, "the file is cut short");
    sagi_mesh_data *mesh = r->mesh;
    if (count == 0) return SAG_OK;
    mesh->vertex_count = (uint32_t)count;
    const size_t n = (size_t)count;
    const bool with_normals = has[SAGI_PLY_NX] && has[SAGI_PLY_NY] && has[SAGI_PLY_NZ],
               with_texcoords = has[SAGI_PLY_U] && has[SAGI_PLY_V];
    if (wide)
        mesh->positions_f64 = sag_allocate(r->context, 3 * n * sizeof(double));
    else
        mesh->positions_f32 = sag_allocate(r->context, 3 * n * sizeof(float));
    if (with_normals) mesh->normals = sag_allocate(r->context, 3 * n * sizeof(float));
    if (with_texcoords) mesh->texcoords = sag_allocate(r->context, 2 * n * sizeof(float));
    if (!(wide ? (void *)mesh->positions_f64 : (void *)mesh->positions_f32) ||
        (with_normals && !mesh->normals) || (with_texcoords && !mesh->texcoords))
        return out_of_memory(r);
    if (sagi_ply_quick_vertices(r, n, properties, property_count)) return SAG_OK;
    for (size_t i = 0; i < n; i++) {
        double values[SAGI_PLY_ROLE_COUNT] = {0};
        for (int k = 0; k < property_count; k++) {
            double list = 1;
            if (properties[k].count_type && !next_value(r, properties[k].count_type, &list))
                return SAG_ERROR_FORMAT;
            for (double j = 0; j < list; j++)
                if (!next_value(r, properties[k].type, &values[properties[k].role])) return SAG_ERROR_FORMAT;
        }
        for (int c = 0; c < 3; c++) {
            if (wide)
                mesh->positions_f64[3 * i + (size_t)c] = values[SAGI_PLY_X + c];
            else
                mesh->positions_f32[3 * i + (size_t)c] = (float)values[SAGI_PLY_X + c];
            if (with_normals) mesh->normals[3 * i + (size_t)c] = (float)values[SAGI_PLY_NX + c];
            if (with_texcoords && c < 2) mesh->texcoords[2 * i + (size_t)c] = (float)values[SAGI_PLY_U + c];
        }
    }
    return SAG_OK;
}

// One face's list of indices, as a fan of triangles around its first corner.
static sag_status read_face(sagi_ply_reader *r, const sagi_ply_property *p) {
    double corners, value;
    const uint8_t *list_at = r->next;
    if (!next_value(r, p->count_type, &corners)) return SAG_ERROR_FORMAT;
    if (!(corners >= 0 && corners <= SAGI_PLY_MAX_CORNERS))
        return fail(r, list_at, r->encoding == SAGI_PLY_ASCII, "a face with an impossible number of corners");
    uint32_t fan[3] = {0, 0, 0};
    for (double corner = 0; corner < corners; corner++) {
        while (r->encoding == SAGI_PLY_ASCII && r->next != r->end && is_space(*r->next)) r->next++;
        const uint8_t *at = r->next;
        if (!next_value(r, p->type, &value)) return SAG_ERROR_FORMAT;
        if (!(value >= 0 && value < UINT32_MAX && value == floor(value)))
            return fail(r, at, r->encoding == SAGI_PLY_ASCII, "a vertex index that is no natural number");
        const uint32_t index = (uint32_t)value;
        if (!r->largest_at || index > r->largest_index) r->largest_index = index, r->largest_at = at;
        if (corner == 0) {
            fan[0] = index;
        } else {
            fan[1] = fan[2];
            fan[2] = index;
            if (corner >= 2 && !sagi_mesh_data_add(r->mesh, fan[0], fan[1], fan[2])) return out_of_memory(r);
        }
    }
    return SAG_OK;
}

static sag_status read_others(sagi_ply_reader *r, uint64_t count, const sagi_ply_property *properties,
                              int property_count, bool faces) {
    uint64_t first = 0;
    // A face takes a byte and more: so many triangles are no more memory than the file is.
    if (faces && property_count > 0 && count <= (uint64_t)(r->end - r->next) &&
        count <= UINT32_MAX - r->mesh->triangle_count) {
        if (!sagi_mesh_data_reserve(r->mesh, r->mesh->triangle_count + (size_t)count))
            return out_of_memory(r);
        first = sagi_ply_quick_triangles(r, (size_t)count, properties, property_count);
    }
    for (uint64_t i = first; i < count; i++) {
        for (int k = 0; k < property_count; k++) {
            const sagi_ply_property *p = &properties[k];
            double list = 1, value;
            if (faces && p->role == SAGI_PLY_INDICES) {
                const sag_status status = read_face(r, p);
                if (status != SAG_OK) return status;
                continue;
            }
            if (p->count_type && !next_value(r, p->count_type, &list)) return SAG_ERROR_FORMAT;
            for (double j = 0; j < list; j++)
                if (!next_value(r, p->type, &value)) return SAG_ERROR_FORMAT;
        }
        // Elements without properties take no bytes; a count of 10¹⁸ of them must not take time.
        if (property_count == 0) break;
    }
    return SAG_OK;
}

typedef struct element {
    sagi_slice name;
    uint64_t count;
    int property_count;
    sagi_ply_property properties[SAGI_PLY_MAX_PROPERTIES];
} element;

#define MAX_ELEMENTS 16
typedef struct header {
    int element_count;
    element elements[MAX_ELEMENTS];
} header;

static sag_status read_property(const sagi_ply_reader *r, header *h, const sagi_slice words[8], int count,
                                const uint8_t *line) {
    if (h->element_count == 0) return fail(r, line, true, "a property before any element");
    element *e = &h->elements[h->element_count - 1];
    if (e->property_count == SAGI_PLY_MAX_PROPERTIES)
        return fail(r, line, true, "an element has too many properties");
    const bool is_list = sagi_slice_is(words[1], "list");
    sagi_ply_property *p = &e->properties[e->property_count++];
    p->count_type = is_list ? type_of(words[2]) : SAGI_PLY_NONE;
    p->type = type_of(words[is_list ? 3 : 1]);
    p->role = role_of(words[is_list ? 4 : 2], is_list);
    if (count < (is_list ? 5 : 3) || !p->type || (is_list && !p->count_type))
        return fail(r, line, true, "\"property TYPE NAME\" or \"property list TYPE TYPE NAME\" expected");
    return SAG_OK;
}

static sag_status read_header(sagi_ply_reader *r, header *h) {
    bool has_format = false;
    for (;;) {
        const uint8_t *line = r->next;
        sagi_slice words[8];
        int count;
        if (!next_line(r, words, &count)) return fail(r, line, true, "the header has no end_header");
        if (sagi_slice_is(words[0], "end_header")) break;
        if (sagi_slice_is(words[0], "format")) {
            has_format = true;
            if (sagi_slice_is(words[1], "ascii"))
                r->encoding = SAGI_PLY_ASCII;
            else if (sagi_slice_is(words[1], "binary_little_endian"))
                r->encoding = SAGI_PLY_LITTLE_ENDIAN;
            else if (sagi_slice_is(words[1], "binary_big_endian"))
                r->encoding = SAGI_PLY_BIG_ENDIAN;
            else
                return fail(r, line, true,
                            "unknown format: ascii, binary_little_endian or binary_big_endian expected");
        } else if (sagi_slice_is(words[0], "element")) {
            int64_t elements;
            if (h->element_count == MAX_ELEMENTS) return fail(r, line, true, "too many elements");
            const char *const end = words[2].text + words[2].length;
            if (count < 3 || sagi_parse_integer(words[2].text, end, &elements) != end || elements < 0)
                return fail(r, line, true, "\"element NAME COUNT\" expected");
            element *e = &h->elements[h->element_count++];
            e->name = words[1];
            e->count = (uint64_t)elements;
            e->property_count = 0;
        } else if (sagi_slice_is(words[0], "property")) {
            const sag_status status = read_property(r, h, words, count, line);
            if (status != SAG_OK) return status;
        } else if (count > 0 && !sagi_slice_is(words[0], "comment") && !sagi_slice_is(words[0], "obj_info") &&
                   !sagi_slice_is(words[0], "ply") && !sagi_slice_is(words[0], "Created")) {
            // "Created by Blender3D 247 …" stands there without "comment" in files of that time.
            return fail(r, line, true, "unknown word in the header");
        }
    }
    return has_format ? SAG_OK : fail(r, r->next, true, "the header names no format");
}

static sag_status read_all(sagi_ply_reader *r) {
    if ((size_t)(r->end - r->begin) < 4 || memcmp(r->begin, "ply", 3) != 0 || !is_space(r->begin[3]))
        return fail(r, r->begin, true, "not a PLY file: it does not begin with \"ply\"");
    header h = {0};
    sag_status status = read_header(r, &h);
    for (int i = 0; status == SAG_OK && i < h.element_count; i++) {
        const element *e = &h.elements[i];
        const bool vertices = sagi_slice_is(e->name, "vertex") && !r->seen_vertices;
        const bool faces = sagi_slice_is(e->name, "face");
        status = vertices ? read_vertices(r, e->count, e->properties, e->property_count)
                          : read_others(r, e->count, e->properties, e->property_count, faces);
        r->seen_vertices = r->seen_vertices || vertices;
        r->seen_faces = r->seen_faces || faces;
    }
    if (status != SAG_OK) return status;
    if (!r->seen_vertices || r->mesh->triangle_count == 0)
        return sag_error_set_at(r->error, SAG_ERROR_FORMAT, r->path, 0, 0, "the mesh has no %s",
                                r->seen_vertices ? "triangles" : "vertices");
    if (r->largest_index >= r->mesh->vertex_count) {
        char message[96];
        snprintf(message, sizeof message, "vertex index %u is out of range: there are %u vertices",
                 r->largest_index, r->mesh->vertex_count);
        return fail(r, r->largest_at, r->encoding == SAGI_PLY_ASCII, message);
    }
    return SAG_OK;
}

sag_status sagi_ply_read(const sag_context *context, const char *path, sagi_mesh_data *mesh,
                         sag_error *error) {
    sagi_file file;
    sag_status status = sagi_file_open(context, path, &file, error);
    if (status != SAG_OK) return status;
    *mesh = (sagi_mesh_data){.context = context};
    sagi_ply_reader r = {.context = context,
                         .path = path,
                         .error = error,
                         .begin = file.bytes,
                         .next = file.bytes,
                         .end = file.bytes + file.size,
                         .mesh = mesh};
    status = read_all(&r);
    if (status != SAG_OK) sagi_mesh_data_clear(mesh);
    sagi_file_close(&file);
    return status;
}
