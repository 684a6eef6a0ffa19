// SPDX-License-Identifier: MIT
// glTF 2.0 (Khronos), whose JSON says where in its buffers everything stands. Assimp 5.2 checks most of that;
// what it does not is done here:
//
// - Skins and animations move a mesh, which here stands still. Assimp reads them all the same, and takes a
//   joint's number from the file as it is: so they are left out, with the vertices' joints and weights.
// - A sparse accessor replaces some of another's elements by `count` ones of its own (3.6.2.3). Whether so
//   many are there Assimp does not ask.
// - How strongly a material shines (KHR_materials_emissive_strength) it does not know: the number goes into
//   the colour that it does know.
//
// A binary file (4.4) is a header of 12 bytes, a chunk of JSON and one of bytes, each with a header of 8 and
// a length that is a multiple of 4.
#include "formats/gltf.h"

#include "formats/output.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

#define HEADER 12
#define CHUNK  8

static uint32_t word_at(const uint8_t *n) {
    return n[0] | (uint32_t)n[1] << 8 | (uint32_t)n[2] << 16 | (uint32_t)n[3] << 24;
}

static void put_word(uint8_t *to, size_t value) {
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(value >> 8 * i);
}

// Where in the file the JSON is. False for binary files of version 1, which are laid out otherwise; that the
// chunks of others are within the file has been seen before (import_file.c).
static bool find_json(const sagi_file *file, bool binary, const char **json, size_t *size) {
    *json = (const char *)file->bytes, *size = file->size;
    if (!binary) return true;
    if (file->size < HEADER + CHUNK || word_at(file->bytes + 4) != 2) return false;
    *json += HEADER + CHUNK, *size = word_at(file->bytes + HEADER);
    return *size <= file->size - HEADER - CHUNK;
}

static const cJSON *member(const cJSON *object, const char *name) {
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

// A number that should be whole and not negative, and may be missing; NaN where it is not that.
static double whole(const cJSON *object, const char *name, double missing) {
    const cJSON *item = member(object, name);
    if (item == NULL) return missing;
    const double x = cJSON_IsNumber(item) ? item->valuedouble : NAN;
    return x >= 0 && x <= 0x1p53 && x == floor(x) ? x : NAN;
}

static double component_bytes(double type) {
    if (type == 5120 || type == 5121) return 1;
    if (type == 5122 || type == 5123) return 2;
    return type == 5125 || type == 5126 ? 4 : NAN;
}

static double components(const cJSON *accessor) {
    static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    static const double counts[] = {1, 2, 3, 4, 4, 9, 16};
    const char *type = cJSON_GetStringValue(member(accessor, "type"));
    for (size_t i = 0; type != NULL && i < sizeof names / sizeof *names; i++)
        if (strcmp(type, names[i]) == 0) return counts[i];
    return NAN;
}

// Whether so many bytes are in the buffer view that `part` names, from its offset on. NaN are in none.
static bool is_in_view(const cJSON *root, const cJSON *part, double bytes) {
    const cJSON *views = member(root, "bufferViews");
    const double number = whole(part, "bufferView", NAN), offset = whole(part, "byteOffset", 0);
    if (!(number < cJSON_GetArraySize(views))) return false;
    return offset + bytes <= whole(cJSON_GetArrayItem(views, (int)number), "byteLength", NAN);
}

static bool is_sparse_part_there(const cJSON *root, const cJSON *accessor) {
    const cJSON *sparse = member(accessor, "sparse");
    if (sparse == NULL) return true;
    const cJSON *indices = member(sparse, "indices"), *values = member(sparse, "values");
    const double count = whole(sparse, "count", NAN);
    const double index_bytes = component_bytes(whole(indices, "componentType", NAN));
    const double value_bytes = components(accessor) * component_bytes(whole(accessor, "componentType", NAN));
    return count <= whole(accessor, "count", NAN) && is_in_view(root, indices, count * index_bytes) &&
           is_in_view(root, values, count * value_bytes);
}

sag_status sagi_gltf_check(const sagi_file *file, bool binary, const char *path, sag_error *error) {
    const char *json, *end = NULL;
    size_t size;
    if (!find_json(file, binary, &json, &size)) return SAG_OK;
    cJSON *root = cJSON_ParseWithLengthOpts(json, size, &end, false);
    if (root == NULL) {
        uint32_t line = 1, column = 1;
        for (const char *p = json; p < end; p++) column = *p == '\n' ? (line++, 1) : column + 1;
        return binary ? sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0, "its JSON is damaged")
                      : sag_error_set_at(error, SAG_ERROR_FORMAT, path, line, column,
                                         "this is not JSON, which glTF is written in");
    }
    sag_status status = SAG_OK;
    const cJSON *accessor;
    int number = 0;
    cJSON_ArrayForEach(accessor, member(root, "accessors")) {
        if (status == SAG_OK && !is_sparse_part_there(root, accessor))
            status = sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0,
                                      "accessors[%d].sparse is not within its buffer views", number);
        number++;
    }
    cJSON_Delete(root);
    return status;
}

// All members of that name: of a file that has several the first is not the only one.
static void leave_out(cJSON *object, const char *name) {
    while (cJSON_HasObjectItem(object, name)) cJSON_DeleteItemFromObject(object, name);
}

static void leave_out_beginning(cJSON *object, const char *begin) {
    for (cJSON *item = object ? object->child : NULL, *next; item != NULL; item = next) {
        next = item->next;
        if (item->string != NULL && strncmp(item->string, begin, strlen(begin)) == 0)
            cJSON_Delete(cJSON_DetachItemViaPointer(object, item));
    }
}

static void make_still(cJSON *root) {
    cJSON *item, *primitive;
    leave_out(root, "skins"), leave_out(root, "animations");
    cJSON_ArrayForEach(item, member(root, "nodes")) leave_out(item, "skin");
    cJSON_ArrayForEach(item, member(root, "meshes")) {
        cJSON_ArrayForEach(primitive, member(item, "primitives")) {
            cJSON *attributes = cJSON_GetObjectItemCaseSensitive(primitive, "attributes");
            leave_out_beginning(attributes, "JOINTS_"), leave_out_beginning(attributes, "WEIGHTS_");
        }
    }
}

static void make_strong(cJSON *root) {
    static const char name[] = "KHR_materials_emissive_strength";
    cJSON *material, *channel;
    cJSON_ArrayForEach(material, member(root, "materials")) {
        cJSON *extensions = cJSON_GetObjectItemCaseSensitive(material, "extensions");
        const cJSON *item = member(member(extensions, name), "emissiveStrength");
        const double strength = cJSON_IsNumber(item) ? item->valuedouble : 1;
        leave_out(extensions, name); // later Assimps know it
        if (!(strength >= 0 && strength <= 1e15)) continue;
        cJSON_ArrayForEach(channel, member(material, "emissiveFactor")) if (cJSON_IsNumber(channel) &&
                                                                            channel->valuedouble <= 1e15)
            cJSON_SetNumberValue(channel, channel->valuedouble * strength);
    }
}

// Text, or the whole binary file with this text in place of its own.
static uint8_t *written(const sagi_file *file, bool binary, const char *text, size_t *size) {
    const size_t length = strlen(text), padded = (length + 3) & ~(size_t)3;
    const size_t old = binary ? HEADER + CHUNK + word_at(file->bytes + HEADER) : 0;
    const size_t before = binary ? HEADER + CHUNK : 0, after = binary ? file->size - old : 0;
    *size = before + padded + after;
    uint8_t *out = *size <= UINT32_MAX || !binary ? sag_allocate(file->context, *size) : NULL;
    if (out == NULL) return NULL;
    memcpy(out, file->bytes, before);
    memcpy(out + before, text, length), memset(out + before + length, ' ', padded - length);
    if (after > 0) memcpy(out + before + padded, file->bytes + old, after);
    if (binary) put_word(out + 8, *size), put_word(out + HEADER, padded);
    return out;
}

bool sagi_gltf_still(const sagi_file *file, bool binary, uint8_t **out, size_t *size) {
    const char *json;
    size_t length;
    *out = NULL;
    if (!find_json(file, binary, &json, &length)) return true;
    cJSON *root = cJSON_ParseWithLength(json, length);
    if (root == NULL) return false; // it has been read before
    const char *version = cJSON_GetStringValue(member(member(root, "asset"), "version"));
    const bool is_2 = version != NULL && version[0] == '2';
    if (is_2) {
        make_still(root), make_strong(root);
        char *text = cJSON_PrintUnformatted(root);
        if (text != NULL) *out = written(file, binary, text, size);
        cJSON_free(text);
    }
    cJSON_Delete(root);
    return !is_2 || *out != NULL;
}
