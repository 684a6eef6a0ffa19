// SPDX-License-Identifier: MIT
// A scene's geometries as the caller builds and changes them. Nothing here touches what queries read: that is
// commit's.
#include "scene/scene.h"
#include "base/context.h"
#include "math/affine_inverse.h"
#include "shapes/shape.h"
#include <string.h>

sag_scene *sag_scene_create(sag_context *context) {
    sag_scene *scene = sag_allocate(context, sizeof *scene);
    sagi_cell *cell = sag_allocate(context, sizeof *cell);
    if (scene == NULL || cell == NULL) {
        sag_release(context, scene, sizeof *scene);
        sag_release(context, cell, sizeof *cell);
        return NULL;
    }
    atomic_init(&cell->references, 1);
    cell->context = context;
    cell->current = NULL;
    cell->owner = scene;
    memset(scene, 0, sizeof *scene);
    scene->context = context;
    scene->kernel = sagi_kernel_pick(context->isa);
    scene->cell = cell;
    return scene;
}

static void forget(sagi_geometry *g) {
    sagi_store_release(g->store);
    sagi_cell_release(g->child);
    g->store = NULL, g->child = NULL;
    g->removed = true;
}

void sag_scene_destroy(sag_scene *scene) {
    if (scene == NULL) return;
    for (uint32_t i = 0; i < scene->count; i++) forget(&scene->geometries[i]);
    sag_release(scene->context, scene->geometries, scene->capacity * sizeof *scene->geometries);
    scene->cell->owner = NULL;
    sagi_cell_release(scene->cell);
    sag_release(scene->context, scene->solid_steps, scene->solid_step_count * sizeof *scene->solid_steps);
    sag_release(scene->context, scene, sizeof *scene);
}

// Keeps the first failure for sag_scene_commit.
static uint32_t fail(sag_scene *scene, const sag_error *error) {
    if (scene->add_error.status == SAG_OK) scene->add_error = *error;
    return SAG_INVALID_ID;
}

static uint32_t fail_with(sag_scene *scene, sag_status status, const char *message) {
    sag_error error = {0};
    sag_error_set(&error, status, "%s", message);
    return fail(scene, &error);
}

// Makes room for one more geometry.
static bool reserve(sag_scene *scene) {
    if (scene->count < scene->capacity) return true;
    if (scene->capacity > UINT32_MAX / 2) return false;
    uint32_t capacity = scene->capacity == 0 ? 8 : scene->capacity * 2;
    sagi_geometry *grown = sag_allocate(scene->context, capacity * sizeof *grown);
    if (grown == NULL) return false;
    if (scene->count > 0) memcpy(grown, scene->geometries, scene->count * sizeof *grown);
    sag_release(scene->context, scene->geometries, scene->capacity * sizeof *grown);
    scene->geometries = grown;
    scene->capacity = capacity;
    return true;
}

uint32_t sag_add_shape(sag_scene *scene, sag_shape_kind kind, const void *shape) {
    if ((unsigned)kind >= SAGI_SHAPE_KIND_COUNT || kind == SAG_SHAPE_INSTANCE || shape == NULL)
        return fail_with(scene, SAG_ERROR_ARGUMENT, "not a shape that can be added");
    sag_error error = {0};
    if (sagi_shape_classes[kind].validate(shape, &error) != SAG_OK) return fail(scene, &error);
    sagi_store *store = reserve(scene) ? sagi_store_create(scene->context, kind, shape) : NULL;
    if (store == NULL) return fail_with(scene, SAG_ERROR_MEMORY, "out of memory for a geometry");
    scene->geometries[scene->count] = (sagi_geometry){.kind = kind, .store = store};
    return scene->count++;
}

uint32_t sag_add_instance(sag_scene *scene, sag_scene *child, const sag_affine *to_parent) {
    if (child == NULL || child == scene)
        return fail_with(scene, SAG_ERROR_ARGUMENT, "an instance needs another scene");
    if (child->cell->current == NULL)
        return fail_with(scene, SAG_ERROR_STATE, "an instance needs a committed scene");
    if (to_parent != NULL && !sagi_affine_has_inverse(to_parent))
        return fail_with(scene, SAG_ERROR_GEOMETRY, "the instance's transform is singular");
    if (!reserve(scene)) return fail_with(scene, SAG_ERROR_MEMORY, "out of memory for an instance");
    sagi_geometry g = {.kind = SAG_SHAPE_INSTANCE, .child = sagi_cell_retain(child->cell)};
    g.placed = to_parent != NULL && !sag_affine_is_identity(to_parent);
    if (g.placed) g.to_scene = *to_parent;
    scene->geometries[scene->count] = g;
    return scene->count++;
}

// The geometry, NULL for an id that is unknown or removed.
static sagi_geometry *find(const sag_scene *scene, uint32_t id) {
    return id < scene->count && !scene->geometries[id].removed ? &scene->geometries[id] : NULL;
}

uint32_t sag_scene_geometry_count(const sag_scene *scene) { return scene->count; }

const sag_scene *sag_instance_scene(const sag_scene *scene, uint32_t instance) {
    const sagi_geometry *g = find(scene, instance);
    return g != NULL && g->child != NULL ? g->child->owner : NULL;
}

sag_status sag_geometry_set_transform(sag_scene *scene, uint32_t geometry, const sag_affine *to_scene) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    if (to_scene != NULL && !sagi_affine_has_inverse(to_scene)) return SAG_ERROR_GEOMETRY;
    g->placed = to_scene != NULL && !sag_affine_is_identity(to_scene);
    if (g->placed) g->to_scene = *to_scene;
    return SAG_OK;
}

sag_status sag_geometry_set_mask(sag_scene *scene, uint32_t geometry, uint32_t mask) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    g->mask = mask;
    return SAG_OK;
}

sag_status sag_geometry_set_user_data(sag_scene *scene, uint32_t geometry, uint64_t user_data) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    g->user_data = user_data;
    return SAG_OK;
}

sag_status sag_geometry_set_face_forward(sag_scene *scene, uint32_t geometry, bool face_forward) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    g->face_forward = face_forward;
    return SAG_OK;
}

sag_status sag_geometry_set_enabled(sag_scene *scene, uint32_t geometry, bool enabled) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    g->disabled = !enabled;
    return SAG_OK;
}

sag_status sag_geometry_set_update(sag_scene *scene, uint32_t geometry, sag_update update) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    switch (update) {
    case SAG_UPDATE_STATIC:
    case SAG_UPDATE_REBUILD:
    case SAG_UPDATE_REFIT: g->update = update; return SAG_OK;
    }
    return SAG_ERROR_ARGUMENT;
}

sag_status sag_geometry_set_shape(sag_scene *scene, uint32_t geometry, sag_shape_kind kind, const void *shape,
                                  sag_error *error) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL || g->store == NULL || g->kind != kind || shape == NULL)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "geometry %u is no %s", (unsigned)geometry,
                             sag_shape_kind_name(kind));
    sag_status status = sagi_shape_classes[kind].validate(shape, error);
    if (status != SAG_OK) return status;
    sagi_store *store = sagi_store_create(scene->context, kind, shape);
    if (store == NULL) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a geometry");
    sagi_store_release(g->store);
    g->store = store;
    return SAG_OK;
}

sag_status sag_geometry_remove(sag_scene *scene, uint32_t geometry) {
    sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    forget(g);
    return SAG_OK;
}

sag_status sag_scene_set_quality(sag_scene *scene, sag_quality quality) {
    switch (quality) {
    case SAG_QUALITY_DEFAULT:
    case SAG_QUALITY_FAST:
    case SAG_QUALITY_HIGH: scene->quality = quality; return SAG_OK;
    }
    return SAG_ERROR_ARGUMENT;
}

sag_status sag_geometry_get(const sag_scene *scene, uint32_t geometry, sag_shape_kind *kind,
                            const void **shape) {
    const sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    if (kind != NULL) *kind = g->kind;
    if (shape != NULL) *shape = g->store != NULL ? g->store->shape : NULL;
    return SAG_OK;
}

sag_status sag_geometry_get_transform(const sag_scene *scene, uint32_t geometry, sag_affine *to_scene) {
    const sagi_geometry *g = find(scene, geometry);
    if (g == NULL) return SAG_ERROR_ARGUMENT;
    *to_scene = g->placed ? g->to_scene : sag_affine_identity();
    return SAG_OK;
}
