// SPDX-License-Identifier: MIT
// The quick way through PLY data: what nearly every large file holds, little-endian vertices of single
// numbers (float where we want them) and triangles as one list of a byte and 32-bit indices. Their places in
// memory are known beforehand, so nothing is decided for each number; a triangle that is none, or an index
// that is negative, is left to the general way, which knows what to do or to say.
#include "formats/ply.h"

#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define IS_LITTLE_ENDIAN 1
#else
#define IS_LITTLE_ENDIAN 0
#endif

bool sagi_ply_quick_vertices(sagi_ply_reader *r, size_t count, const sagi_ply_property *properties,
                             int property_count) {
    if (!IS_LITTLE_ENDIAN || r->encoding != SAGI_PLY_LITTLE_ENDIAN || !r->mesh->positions_f32) return false;
    size_t offsets[SAGI_PLY_ROLE_COUNT] = {0}, stride = 0;
    for (int i = 0; i < property_count; i++) {
        const sagi_ply_property *p = &properties[i];
        if (p->count_type != SAGI_PLY_NONE) return false;
        if (p->role != SAGI_PLY_IGNORED && p->type != SAGI_PLY_FLOAT32) return false;
        offsets[p->role] = stride; // the last of a name counts, as in the general way
        stride += sagi_ply_size(p->type);
    }
    if (stride == 0 || (size_t)(r->end - r->next) / stride < count) return false;
    const sagi_mesh_data *mesh = r->mesh;
    float *positions = mesh->positions_f32, *normals = mesh->normals, *texcoords = mesh->texcoords;
    const uint8_t *from = r->next;
    for (size_t i = 0; i < count; i++, from += stride) {
        memcpy(positions + 3 * i, from + offsets[SAGI_PLY_X], 4);
        memcpy(positions + 3 * i + 1, from + offsets[SAGI_PLY_Y], 4);
        memcpy(positions + 3 * i + 2, from + offsets[SAGI_PLY_Z], 4);
        if (normals) {
            memcpy(normals + 3 * i, from + offsets[SAGI_PLY_NX], 4);
            memcpy(normals + 3 * i + 1, from + offsets[SAGI_PLY_NY], 4);
            memcpy(normals + 3 * i + 2, from + offsets[SAGI_PLY_NZ], 4);
        }
        if (texcoords) {
            memcpy(texcoords + 2 * i, from + offsets[SAGI_PLY_U], 4);
            memcpy(texcoords + 2 * i + 1, from + offsets[SAGI_PLY_V], 4);
        }
    }
    r->next = from;
    return true;
}

size_t sagi_ply_quick_triangles(sagi_ply_reader *r, size_t count, const sagi_ply_property *properties,
                                int property_count) {
    const sagi_ply_property *const p = &properties[0];
    if (!IS_LITTLE_ENDIAN || r->encoding != SAGI_PLY_LITTLE_ENDIAN || property_count != 1 ||
        p->role != SAGI_PLY_INDICES || (p->count_type != SAGI_PLY_UINT8 && p->count_type != SAGI_PLY_INT8) ||
        (p->type != SAGI_PLY_INT32 && p->type != SAGI_PLY_UINT32))
        return 0;
    sagi_mesh_data *mesh = r->mesh;
    uint32_t *to = mesh->triangles + 3 * (size_t)mesh->triangle_count;
    const uint8_t *from = r->next;
    size_t done = 0;
    for (; done < count && r->end - from >= 13 && from[0] == 3; done++, from += 13, to += 3) {
        memcpy(to, from + 1, 12);
        uint32_t largest = to[0] > to[1] ? to[0] : to[1];
        if (to[2] > largest) largest = to[2];
        if (largest > INT32_MAX) break;
        if (!r->largest_at || largest > r->largest_index) {
            r->largest_index = largest;
            r->largest_at = from + 1 + (to[0] == largest ? 0 : to[1] == largest ? 4 : 8);
        }
    }
    mesh->triangle_count += (uint32_t)done;
    r->next = from;
    return done;
}
