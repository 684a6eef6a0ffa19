// SPDX-License-Identifier: MIT
// Reading a scene's text is quick, reading its meshes is not: most of the time goes to numbers that say
// nothing about the rest of the scene. So a mesh gets its geometry, transform and look at once, as a single
// triangle that keeps its place, and waits; all that wait are read together, on all threads, when enough of
// them have come or the text is at its end. Then the triangle gives way to the mesh. Ids, bits and messages
// are those of reading one thing after the other: what is to be said meanwhile waits in the same line, and
// when a directive fails, meshes before it come first.
//
// An object is committed where it ends, since instances want a committed scene, and once more when its meshes
// are there. Pictures wait in the same line: a texture needs no more than their ids.
#include "formats/pbrt_later.h"

#include "formats/mesh_text.h"
#include "formats/pbrt_shape.h"
#include "formats/picture.h"
#include "render/world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// More than that does not wait: so much memory, and no more, is taken twice.
#define MAX_WAITING_BYTES ((size_t)256 << 20)
#define MAX_WAITING       65536

typedef enum waiting_kind { MESSAGE, TRIANGLES, PLY, PICTURE, COMMIT } waiting_kind;

struct sagi_waiting {
    waiting_kind kind;
    sagi_place place;       // of the shape, or the object's end
    sagi_place name;        // of a file's name
    sagi_cursor parameters; // of a mesh in the text
    char *text;             // a message, the path of a mesh's file, or for what a picture is
    size_t text_bytes, bytes;
    sag_scene *scene;
    uint32_t geometry, object; // object: number + 1; 0: none
    sagi_mesh_text mesh;
    uint32_t dropped, triangle_count;
    bool shines, has_area;
    sag_affine placed;
    sag_picture_id picture;
    sag_status status;
    sag_error *error;
};

static struct sagi_waiting *next_waiting(sagi_pbrt *p, waiting_kind kind, sagi_place place) {
    void *items = p->waiting;
    if (!sagi_pbrt_reserve(p, &items, &p->waiting_allocated, p->waiting_count, sizeof *p->waiting))
        return NULL;
    p->waiting = items;
    struct sagi_waiting *const w = &p->waiting[p->waiting_count];
    *w = (struct sagi_waiting){.kind = kind,
                               .place = place,
                               .shines = p->state.area_light.on && !p->options->geometry_only,
                               .placed = p->state.ctm,
                               .object = p->in_object ? (uint32_t)p->object_count : 0};
    return w;
}

static bool keep_text(const sagi_pbrt *p, struct sagi_waiting *w, const char *text) {
    w->text_bytes = strlen(text) + 1;
    w->text = sag_allocate(p->context, w->text_bytes);
    if (w->text) memcpy(w->text, text, w->text_bytes);
    return w->text != NULL;
}

bool sagi_pbrt_may_wait(const sagi_pbrt *p) { return !p->solid.scene; }

// Puts the triangle that keeps the place into the scene.
static sag_status add_place_holder(sagi_pbrt *p, struct sagi_waiting *w) {
    static const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t corners[3] = {0, 1, 2};
    const sag_mesh triangle = {
        .positions_f64 = positions, .triangles = corners, .vertex_count = 3, .triangle_count = 1};
    w->scene = p->scene;
    return sagi_pbrt_add_numbered(p, SAG_SHAPE_MESH, &triangle, 1, &p->state.ctm, &w->geometry);
}

static void waits(sagi_pbrt *p, const struct sagi_waiting *w) {
    p->waiting_bytes += w->bytes;
    p->waiting_count++;
}

static size_t file_bytes(const char *path) {
    struct stat information;
    return stat(path, &information) == 0 && information.st_size > 0 ? (size_t)information.st_size : 0;
}

sag_status sagi_pbrt_ply_later(sagi_pbrt *p, const char *path, sagi_place name) {
    struct sagi_waiting *const w = next_waiting(p, PLY, p->params.place);
    if (!w || !keep_text(p, w, path)) return sagi_pbrt_out_of_memory(p);
    w->bytes = file_bytes(path);
    w->name = name;
    w->mesh.data.context = p->context;
    const sag_status status = add_place_holder(p, w);
    if (status == SAG_OK)
        waits(p, w);
    else
        sag_release(p->context, w->text, w->text_bytes);
    return status;
}

sag_status sagi_pbrt_picture_later(sagi_pbrt *p, const char *path, sagi_place name, sag_encoding encoding,
                                   double gamma, sag_picture_id *id) {
    bool is_new;
    *id = sagi_picture_reserve(p->world, path, encoding, gamma, &is_new);
    if (*id == 0) return sagi_pbrt_out_of_memory(p);
    if (!is_new) return SAG_OK;
    struct sagi_waiting *const w = next_waiting(p, PICTURE, name);
    if (!w || !keep_text(p, w, p->params.what)) return sagi_pbrt_out_of_memory(p);
    w->bytes = file_bytes(path);
    w->picture = *id;
    waits(p, w);
    return SAG_OK;
}

bool sagi_pbrt_triangles_later(sagi_pbrt *p, sagi_cursor parameters, sag_status *status) {
    static const struct {
        const char *name;
        unsigned types;
    } arrays[SAGI_MESH_ARRAY_COUNT] = {
        [SAGI_MESH_POSITIONS] = {"P", SAGI_TYPE_POINT3},
        [SAGI_MESH_NORMALS] = {"N", SAGI_TYPE_NORMAL | SAGI_TYPE_VECTOR3},
        [SAGI_MESH_TEXCOORDS] = {"uv", SAGI_TYPE_POINT2 | SAGI_TYPE_VECTOR2 | SAGI_TYPE_FLOAT},
        [SAGI_MESH_INDICES] = {"indices", SAGI_TYPE_INTEGER}};
    struct sagi_waiting *const w = next_waiting(p, TRIANGLES, p->params.place);
    if (!w) return false;
    for (int k = 0; k < SAGI_MESH_ARRAY_COUNT; k++) {
        const sagi_param *param = sagi_params_find(&p->params, arrays[k].name, arrays[k].types);
        if (!param) continue;
        if (!param->text.text || memchr(param->text.text, '#', param->text.length)) return false;
        w->mesh.arrays[k] = param->text;
        w->bytes += param->text.length;
    }
    // The numbers of an array that nobody asks for are to be good ones too.
    for (size_t i = 0; i < p->params.count; i++)
        if (p->params.items[i].skimmed && !p->params.items[i].used) return false;
    if (p->params.status != SAG_OK) return false;
    w->parameters = parameters;
    *status = add_place_holder(p, w);
    if (*status == SAG_OK) waits(p, w);
    return *status == SAG_OK;
}

bool sagi_pbrt_commit_later(sagi_pbrt *p, sagi_place place, uint32_t object, sag_status *status) {
    bool found = false;
    for (size_t i = p->waiting_count; i-- > 0 && !found && p->waiting[i].kind != COMMIT;)
        found = p->waiting[i].object == object + 1 &&
                (p->waiting[i].kind == TRIANGLES || p->waiting[i].kind == PLY);
    if (!found) return false;
    struct sagi_waiting *const w = next_waiting(p, COMMIT, place);
    *status = w ? SAG_OK : sagi_pbrt_out_of_memory(p);
    if (!w) return true;
    w->object = object + 1;
    w->scene = p->objects[object].scene;
    waits(p, w);
    return true;
}

bool sagi_pbrt_message_later(sagi_pbrt *p, const char *message) {
    if (p->waiting_count == 0 || p->catching_up) return false;
    struct sagi_waiting *const w = next_waiting(p, MESSAGE, (sagi_place){0});
    if (!w || !keep_text(p, w, message)) return false; // said too early is better than never
    waits(p, w);
    return true;
}

// ---- what threads do

static void fail(const sagi_pbrt *p, struct sagi_waiting *w, sag_status status, const sag_error *error) {
    w->status = status;
    w->error = sag_allocate(p->context, sizeof *w->error);
    if (w->error) *w->error = *error;
}

// Gives the scene the mesh, in place of the triangle.
static void take_mesh(const sagi_pbrt *p, struct sagi_waiting *w) {
    sagi_mesh_data *data = &w->mesh.data;
    const sag_mesh mesh = sagi_mesh_data_view(data);
    sag_error error = {0};
    w->dropped = p->options->on_mesh ? 0 : sagi_mesh_data_not_finite(data);
    w->triangle_count = data->triangle_count;
    w->has_area = !w->shines || sagi_mesh_data_has_area(data, &w->placed);
    const sag_status status = sag_geometry_set_shape(w->scene, w->geometry, SAG_SHAPE_MESH, &mesh, &error);
    sagi_mesh_data_clear(data);
    if (status != SAG_OK) fail(p, w, status, &error);
}

typedef struct crew {
    sagi_pbrt *p;
    struct sagi_waiting **files, **texts, **commits; // the files by size
    sagi_mesh_text **meshes;                         // of the texts
    size_t file_count, text_count, commit_count;
} crew;

static void read_file(void *argument, size_t index) {
    const crew *c = argument;
    struct sagi_waiting *const w = c->files[index];
    sag_error error = {0};
    const bool is_mesh = w->kind == PLY;
    const sag_status status = is_mesh ? sagi_ply_read(c->p->context, w->text, &w->mesh.data, &error)
                                      : sagi_picture_read(w->picture, c->p->world, &error);
    if (status != SAG_OK)
        fail(c->p, w, status, &error);
    else if (is_mesh)
        take_mesh(c->p, w);
}

static void take_text(void *argument, size_t index) {
    const crew *c = argument;
    struct sagi_waiting *const w = c->texts[index];
    if (!w->mesh.wrong && !w->mesh.no_memory) {
        take_mesh(c->p, w);
        return;
    }
    sagi_mesh_data_clear(&w->mesh.data);
    if (w->mesh.no_memory) w->status = SAG_ERROR_MEMORY;
}

static void commit_object(void *argument, size_t index) {
    const crew *c = argument;
    struct sagi_waiting *const w = c->commits[index];
    sag_error error = {0};
    const sag_status status = sag_scene_commit(w->scene, &error);
    if (status != SAG_OK) fail(c->p, w, status, &error);
}

// ---- all of it

// Largest first, so that no thread is left alone with one at the end.
static int by_size(const void *a, const void *b) {
    const size_t x = (*(struct sagi_waiting *const *)a)->bytes, y = (*(struct sagi_waiting *const *)b)->bytes;
    return (x < y) - (x > y);
}

// Reads a mesh once more as the text of one shape, to say what is wrong with it.
static sag_status read_again(sagi_pbrt *p, struct sagi_waiting *w) {
    snprintf(p->params.what, sizeof p->params.what, "Shape \"trianglemesh\"");
    p->params.place = w->place;
    p->params.error = p->error;
    p->params.skim = false;
    sagi_cursor cursor = w->parameters;
    sagi_params_empty(&p->params);
    sag_status status = sagi_params_parse(&p->params, &cursor);
    if (status == SAG_OK) status = sagi_pbrt_read_triangles(p, &w->mesh.data);
    if (status != SAG_OK)
        sagi_mesh_data_clear(&w->mesh.data);
    else
        take_mesh(p, w);
    return status;
}

static sag_status mesh_error(sagi_pbrt *p, const struct sagi_waiting *w) {
    if (w->status == SAG_ERROR_MEMORY || !w->error) return sagi_pbrt_out_of_memory(p);
    if (w->kind == COMMIT)
        sagi_place_error(w->place, p->error, "the object cannot be built: %.400s", w->error->message);
    else if (w->kind == PICTURE)
        sagi_place_error(w->place, p->error, "%.120s: %.200s: %.180s", w->text,
                         sagi_world_picture_entry(p->world, w->picture)->path, w->error->message);
    else if (w->kind == PLY && w->status == SAG_ERROR_IO) // the place of the name is what helps
        sagi_place_error(w->name, p->error, "Shape \"plymesh\": %.250s: %.120s", w->text, w->error->message);
    else
        *p->error = *w->error;
    return p->error->status = w->status;
}

// Says what is to be said, in order.
static sag_status finish(sagi_pbrt *p, struct sagi_waiting *w) {
    if (w->kind == MESSAGE) {
        sag_context_log(p->context, SAG_LOG_WARNING, "%s", w->text);
        return SAG_OK;
    }
    if (w->mesh.wrong) {
        const sag_status status = read_again(p, w);
        if (status != SAG_OK) return status;
    }
    if (w->status != SAG_OK) return mesh_error(p, w);
    if (w->kind == COMMIT || w->kind == PICTURE) return SAG_OK;
    if (w->object) p->objects[w->object - 1].weight += w->triangle_count - 1;
    const char *const shape = w->kind == PLY ? "plymesh" : "trianglemesh";
    const bool tells = w->dropped || !w->has_area;
    int line = 0, column = 0;
    if (p->options->on_mesh || tells) sagi_place_find(w->place, &line, &column); // counts all lines
    const void *mesh;
    if (p->options->on_mesh && sag_geometry_get(w->scene, w->geometry, NULL, &mesh) == SAG_OK) {
        char name[SAGI_MAX_PATH + 32];
        snprintf(name, sizeof name, "%s:%d", w->place.source->path, line);
        p->options->on_mesh(p->options->user, w->kind == PLY ? w->text : name, mesh);
    }
    if (w->dropped)
        sag_context_log(p->context, SAG_LOG_WARNING,
                        "%s:%d:%d: warning: Shape \"%s\": triangles with a vertex that is NaN, infinite or "
                        "beyond 2^100 are left out: %u of %u",
                        w->place.source->path, line, column, shape, w->dropped, w->triangle_count);
    if (!w->has_area) {
        sag_context_log(p->context, SAG_LOG_WARNING,
                        "%s:%d:%d: warning: Shape \"%s\": a light without area: it does not shine",
                        w->place.source->path, line, column, shape);
        sagi_world_darken(p->world, w->scene, w->geometry);
    }
    return SAG_OK;
}

static void forget(sagi_pbrt *p) {
    for (size_t i = 0; i < p->waiting_count; i++) {
        struct sagi_waiting *const w = &p->waiting[i];
        sag_release(p->context, w->text, w->text_bytes);
        sag_release(p->context, w->error, sizeof *w->error);
        if (w->mesh.data.context) sagi_mesh_data_clear(&w->mesh.data);
    }
    p->waiting_count = p->waiting_bytes = 0;
}

static sag_status finish_all(sagi_pbrt *p, const crew *c) {
    bool good = true;
    sag_status status = SAG_OK;
    for (size_t i = 0; i < p->waiting_count; i++)
        good = good && p->waiting[i].status == SAG_OK && !p->waiting[i].mesh.wrong;
    // Objects are built when all meshes are there: many at a time, or each on all threads.
    if (good) {
        if (c->commit_count > 2 * (size_t)sag_context_thread_count(p->context))
            sag_parallel_for(p->context, c->commit_count, commit_object, (void *)c);
        else
            for (size_t i = 0; i < c->commit_count; i++) commit_object((void *)c, i);
    }
    for (size_t i = 0; i < p->waiting_count && status == SAG_OK; i++) status = finish(p, &p->waiting[i]);
    return status;
}

sag_status sagi_pbrt_catch_up(sagi_pbrt *p) {
    const size_t n = p->waiting_count, bytes = 4 * n * sizeof(void *);
    if (n == 0) return SAG_OK;
    p->catching_up = true;
    void **room = sag_allocate(p->context, bytes);
    sag_status status = SAG_ERROR_MEMORY;
    if (room) {
        crew c = {.p = p,
                  .files = (struct sagi_waiting **)room,
                  .texts = (struct sagi_waiting **)room + n,
                  .commits = (struct sagi_waiting **)room + 2 * n,
                  .meshes = (sagi_mesh_text **)room + 3 * n};
        for (size_t i = 0; i < n; i++) {
            struct sagi_waiting *const w = &p->waiting[i];
            if (w->kind == PLY || w->kind == PICTURE) c.files[c.file_count++] = w;
            if (w->kind == COMMIT) c.commits[c.commit_count++] = w;
            if (w->kind == TRIANGLES) c.meshes[c.text_count] = &w->mesh, c.texts[c.text_count++] = w;
        }
        if (c.file_count) qsort(c.files, c.file_count, sizeof *c.files, by_size);
        if (sagi_mesh_texts_read(p->context, c.meshes, c.text_count, read_file, &c, c.file_count)) {
            sag_parallel_for(p->context, c.text_count, take_text, &c);
            status = finish_all(p, &c);
        } else {
            status = sagi_pbrt_out_of_memory(p);
        }
    } else {
        status = sagi_pbrt_out_of_memory(p);
    }
    sag_release(p->context, room, bytes);
    forget(p);
    p->catching_up = false;
    return status;
}

sag_status sagi_pbrt_catch_up_partly(sagi_pbrt *p) {
    return p->waiting_bytes > MAX_WAITING_BYTES || p->waiting_count > MAX_WAITING ? sagi_pbrt_catch_up(p)
                                                                                  : SAG_OK;
}

void sagi_pbrt_later_clear(sagi_pbrt *p) {
    forget(p);
    sag_release(p->context, p->waiting, p->waiting_allocated * sizeof *p->waiting);
}
