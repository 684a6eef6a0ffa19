// SPDX-License-Identifier: MIT
// What is wrong with a mesh, and whether it is closed.
//
// Files often repeat a vertex for each of its triangles, so equal positions are made one first: a hash table
// gives every vertex the lowest index that has its position. An edge is then a pair of such indices, and a
// triangle with all its good neighbours is found by sorting: edges fall into one bucket for each lower index
// (a counting sort), and each bucket is sorted by the higher index and the direction. Equal keys lie side by
// side and are counted. Triangles over the same three vertices are found in the same way. A bucket can be
// large (the hub of a fan), so its sort must not be quadratic: it is a heap sort, which needs no memory of
// its own. All in all O(n log n) time; 24 bytes a triangle and 20 a vertex.
//
// The report speaks of good triangles. Whether a mesh bounds a volume is a weaker question (mesh_closed.c):
// there triangles without area count, but their edges of no length do not.
#include "math/hash.h"
#include "shapes/closed.h"
#include "shapes/mesh.h"

typedef struct check {
    const sag_mesh *mesh;
    uint32_t *same;     // of each vertex, the first one with its position
    uint32_t *table;    // open addressing over positions; then the buckets' ends
    size_t table_count; // a power of two, at least vertex_count + 2
    uint64_t *keys;     // 3 for each triangle
    bool with_flat;     // triangles without area count too
} check;

// NaN positions equal nothing; their triangles are not looked at again.
static void merge_vertices(check *c) {
    memset(c->table, 0xFF, c->table_count * sizeof *c->table);
    for (uint32_t i = 0; i < c->mesh->vertex_count; i++) {
        sag_vec3 p = sagi_mesh_vertex(c->mesh, i);
        c->same[i] = i;
        if (!sag_is_finite(p)) continue;
        for (size_t slot = sagi_fingerprint_of(p).part[0];; slot++) {
            uint32_t *entry = &c->table[slot & (c->table_count - 1)];
            if (*entry == UINT32_MAX) {
                *entry = i;
                break;
            }
            sag_vec3 q = sagi_mesh_vertex(c->mesh, *entry);
            if (p.x == q.x && p.y == q.y && p.z == q.z) {
                c->same[i] = *entry;
                break;
            }
        }
    }
}

static void sift_down(uint64_t *keys, size_t at, size_t count) {
    uint64_t key = keys[at];
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        if (child + 1 < count && keys[child + 1] > keys[child]) child++;
        if (keys[child] <= key) break;
        keys[at] = keys[child];
    }
    keys[at] = key;
}

static void heap_sort(uint64_t *keys, size_t count) {
    for (size_t i = count / 2; i-- > 0;) sift_down(keys, i, count);
    for (size_t end = count; end-- > 1;) {
        uint64_t top = keys[0];
        keys[0] = keys[end];
        keys[end] = top;
        sift_down(keys, 0, end);
    }
}

// An item to be sorted: its bucket and its key there.
typedef struct item {
    uint32_t bucket;
    uint64_t key;
} item;

// The corners of triangle i, if it counts, by merged index.
static bool corners(const check *c, uint32_t i, uint32_t out[3]) {
    sag_vec3 p[3];
    sagi_triangle_state state = sagi_mesh_triangle_state(c->mesh, i, p);
    if (state != SAGI_TRIANGLE_GOOD && !(c->with_flat && state == SAGI_TRIANGLE_NO_AREA)) return false;
    for (int k = 0; k < 3; k++) out[k] = c->same[c->mesh->triangles[3 * (size_t)i + (size_t)k]];
    return true;
}

// The edge from → to: bucket is the lower index, key the higher one and whether the direction is upward.
static item edge_item(uint32_t from, uint32_t to) {
    bool up = from < to;
    return (item){up ? from : to, (uint64_t)(up ? to : from) << 1 | up};
}

static item triangle_item(const uint32_t corner[3]) {
    uint32_t a = corner[0], b = corner[1], c = corner[2], t;
    if (a > b) t = a, a = b, b = t;
    if (b > c) t = b, b = c, c = t;
    if (a > b) t = a, a = b, b = t;
    return (item){a, (uint64_t)b << 32 | c};
}

static int items_of(const uint32_t corner[3], bool edges, item out[3]) {
    if (!edges) {
        out[0] = triangle_item(corner);
        return 1;
    }
    int count = 0;
    for (int k = 0; k < 3; k++)
        if (corner[k] != corner[(k + 1) % 3]) out[count++] = edge_item(corner[k], corner[(k + 1) % 3]);
    return count;
}

// Counting sort into buckets, then a heap sort of each: keys of bucket b end up in order from begin[b] to
// begin[b + 1].
static const uint32_t *sort_items(check *c, bool edges) {
    uint32_t *begin = c->table, vertices = c->mesh->vertex_count, corner[3];
    item items[3];
    memset(begin, 0, ((size_t)vertices + 2) * sizeof *begin);
    for (uint32_t i = 0; i < c->mesh->triangle_count; i++)
        if (corners(c, i, corner))
            for (int k = items_of(corner, edges, items); k-- > 0;) begin[(size_t)items[k].bucket + 2]++;
    for (size_t b = 2; b < (size_t)vertices + 2; b++) begin[b] += begin[b - 1];
    for (uint32_t i = 0; i < c->mesh->triangle_count; i++)
        if (corners(c, i, corner))
            for (int k = items_of(corner, edges, items); k-- > 0;)
                c->keys[begin[(size_t)items[k].bucket + 1]++] = items[k].key;
    for (size_t b = 0; b < vertices; b++) heap_sort(c->keys + begin[b], begin[b + 1] - begin[b]);
    return begin;
}

static void count_edges(check *c, sag_mesh_report *report) {
    const uint32_t *first = sort_items(c, true);
    for (uint32_t b = 0; b < c->mesh->vertex_count; b++) {
        uint32_t next;
        for (uint32_t i = first[b]; i < first[b + 1]; i = next) {
            uint32_t upward = 0;
            for (next = i; next < first[b + 1] && c->keys[next] >> 1 == c->keys[i] >> 1; next++)
                upward += c->keys[next] & 1;
            if (next - i > 2) report->crowded_edge_count++;
            if (next - i == 2 && upward != 1) report->flipped_edge_count++;
            if (next - i > 1) continue;
            if (report->open_edge_count++ == 0) {
                report->open_edge[0] = b;
                report->open_edge[1] = (uint32_t)(c->keys[i] >> 1);
            }
        }
    }
}

static void count_duplicates(check *c, sag_mesh_report *report) {
    const uint32_t *first = sort_items(c, false);
    for (uint32_t b = 0; b < c->mesh->vertex_count; b++)
        for (uint32_t i = first[b]; i + 1 < first[b + 1]; i++)
            report->duplicate_count += c->keys[i] == c->keys[i + 1];
}

static void examine(check *c, sag_mesh_report *report) {
    uint32_t good = 0;
    report->triangle_count = c->mesh->triangle_count;
    for (uint32_t i = 0; i < c->mesh->triangle_count; i++) {
        sag_vec3 p[3];
        sagi_triangle_state state = sagi_mesh_triangle_state(c->mesh, i, p);
        good += state == SAGI_TRIANGLE_GOOD;
        report->not_finite_count += state == SAGI_TRIANGLE_NOT_FINITE;
        report->degenerate_count += state == SAGI_TRIANGLE_NO_AREA;
    }
    merge_vertices(c);
    count_edges(c, report);
    count_duplicates(c, report);
    report->closed =
        good > 0 && report->open_edge_count + report->crowded_edge_count + report->flipped_edge_count == 0;
}

// What an examination needs of memory.
typedef struct sizes {
    size_t table, same, keys;
} sizes;

static sag_status begin(const sag_context *context, check *c, sizes *bytes, sag_error *error) {
    if (c->mesh->triangle_count > UINT32_MAX / 3) {
        sag_error_set(error, SAG_ERROR_ARGUMENT, "mesh.triangle_count is %u: more than %u cannot be checked",
                      c->mesh->triangle_count, UINT32_MAX / 3);
        return SAG_ERROR_ARGUMENT;
    }
    c->table_count = 4;
    while (c->table_count < (size_t)c->mesh->vertex_count * 3 / 2 + 2) c->table_count *= 2;
    *bytes = (sizes){c->table_count * sizeof *c->table, c->mesh->vertex_count * sizeof *c->same,
                     3 * (size_t)c->mesh->triangle_count * sizeof *c->keys};
    c->table = sag_allocate(context, bytes->table);
    c->same = sag_allocate(context, bytes->same);
    c->keys = sag_allocate(context, bytes->keys);
    if (c->table && c->same && c->keys) return SAG_OK;
    sag_error_set(error, SAG_ERROR_MEMORY, "mesh check: no memory for %zu bytes",
                  bytes->table + bytes->same + bytes->keys);
    return SAG_ERROR_MEMORY;
}

static void end(const sag_context *context, check *c, const sizes *bytes) {
    sag_release(context, c->table, bytes->table);
    sag_release(context, c->same, bytes->same);
    sag_release(context, c->keys, bytes->keys);
}

sag_status sag_mesh_check(const sag_context *context, const sag_mesh *mesh, sag_mesh_report *report,
                          sag_error *error) {
    sag_status status = sag_mesh_validate(mesh, error);
    if (status != SAG_OK) return status;
    check c = {.mesh = mesh};
    sizes bytes = {0};
    status = begin(context, &c, &bytes, error);
    if (status == SAG_OK) {
        *report = (sag_mesh_report){0};
        examine(&c, report);
    }
    end(context, &c, &bytes);
    return status;
}

static void count_odd(check *c, sagi_odd_edges *odd) {
    const uint32_t *first = sort_items(c, true);
    for (uint32_t b = 0; b < c->mesh->vertex_count; b++) {
        uint32_t next;
        for (uint32_t i = first[b]; i < first[b + 1]; i = next) {
            for (next = i + 1; next < first[b + 1] && c->keys[next] >> 1 == c->keys[i] >> 1;) next++;
            if ((next - i) % 2 == 0 || odd->count++ > 0) continue;
            odd->vertex[0] = b, odd->vertex[1] = (uint32_t)(c->keys[i] >> 1);
            odd->triangles = next - i;
        }
    }
}

// Where the ends of other edges lie on this one: p is no further from its line than 2⁻²⁰ of its length.
static uint32_t find_on_edge(const sag_mesh *mesh, const uint32_t vertex[2]) {
    const sag_vec3 a = sagi_mesh_vertex(mesh, vertex[0]), b = sagi_mesh_vertex(mesh, vertex[1]);
    const sag_vec3 along = sag_sub(b, a);
    const double square = sag_dot(along, along);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        sag_vec3 p = sag_sub(sagi_mesh_vertex(mesh, i), a), across = sag_cross(p, along);
        double place = sag_dot(p, along);
        if (place > 0x1p-20 * square && place < (1 - 0x1p-20) * square &&
            sag_dot(across, across) <= 0x1p-40 * square * square)
            return i;
    }
    return SAG_INVALID_ID;
}

sag_status sagi_mesh_find_odd_edges(const sag_context *context, const sag_mesh *mesh, sagi_odd_edges *odd) {
    check c = {.mesh = mesh, .with_flat = true};
    sizes bytes = {0};
    sag_status status = begin(context, &c, &bytes, NULL);
    *odd = (sagi_odd_edges){.on_it = SAG_INVALID_ID};
    if (status == SAG_OK) {
        merge_vertices(&c);
        count_odd(&c, odd);
    }
    end(context, &c, &bytes);
    if (odd->count > 0) odd->on_it = find_on_edge(mesh, odd->vertex);
    return status;
}
