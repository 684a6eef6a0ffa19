// SPDX-License-Identifier: MIT
// Finding all that shines: from the world's own scene through instances of instances, each shining geometry
// once for every way it is reached. A hit tells the way by its instance path, and a table leads from there to
// the light.
//
// Parts of a solid shine too, but where their surfaces are is not known without rays: they are left to the
// sampling of surfaces. So are lights beyond MOST_INSTANCED that come by instances.
#include "area.h"

#include "math/hash.h"
#include "shapes/mesh.h"
#include <sagitta/solid.h>

#include <stdlib.h>
#include <string.h>

#define MOST_INSTANCED (1u << 24)

typedef enum shining { UNKNOWN, DARK, SHINING } shining;

// A scene of the world, for looking up by its address.
typedef struct known_scene {
    const sag_scene *scene;
    uint32_t first; // of its shining appearances, by next[]; SAG_INVALID_ID: none
    shining shines; // it or something that it shows
} known_scene;

typedef struct finder {
    sagi_areas *areas;
    const sag_context *context;
    known_scene *scenes; // by address
    uint32_t scene_count;
    uint32_t *next; // by appearance index
    uint64_t total;
    bool left_out;
    sag_status status;
} finder;

static const sagi_appearance *appearances_of(const sagi_areas *areas) {
    return areas->world->appearances.items;
}

static int by_address(const void *a, const void *b) {
    const known_scene *x = a, *y = b;
    return ((uintptr_t)x->scene > (uintptr_t)y->scene) - ((uintptr_t)x->scene < (uintptr_t)y->scene);
}

static known_scene *find_scene(const finder *f, const sag_scene *scene) {
    const known_scene key = {.scene = scene};
    return scene ? bsearch(&key, f->scenes, f->scene_count, sizeof key, by_address) : NULL;
}

static bool list_scenes(finder *f) {
    const sag_world *world = f->areas->world;
    const sagi_world_object *objects = world->objects.items;
    f->scene_count = (uint32_t)world->objects.count + 1;
    f->scenes = sag_allocate(f->context, f->scene_count * sizeof *f->scenes);
    f->next = sag_allocate(f->context, f->areas->appearance_count * sizeof *f->next);
    if (!f->scenes || !f->next) return false;
    for (uint32_t i = 0; i < f->scene_count; i++)
        f->scenes[i] =
            (known_scene){.scene = i == 0 ? world->scene : objects[i - 1].scene, .first = SAG_INVALID_ID};
    qsort(f->scenes, f->scene_count, sizeof *f->scenes, by_address);
    const sagi_appearance *all = appearances_of(f->areas);
    for (uint32_t i = f->areas->appearance_count; i-- > 0;) {
        if (!(all[i].brightness > 0)) continue;
        known_scene *scene = find_scene(f, all[i].scene);
        if (!scene) continue;
        f->next[i] = scene->first;
        scene->first = i;
    }
    return true;
}

static bool is_solid(const sag_scene *scene) { return sag_scene_get_solid(scene).step_count > 0; }

// Whether the scene shows anything that shines, `depth` levels down at most.
static bool shines(const finder *f, known_scene *scene, int depth) {
    if (scene->shines != UNKNOWN) return scene->shines == SHINING;
    bool found = scene->first != SAG_INVALID_ID;
    const uint32_t count = depth > 0 ? sag_scene_geometry_count(scene->scene) : 0;
    if (is_solid(scene->scene)) found = false;
    for (uint32_t i = 0; i < count && !found && !is_solid(scene->scene); i++) {
        known_scene *child = find_scene(f, sag_instance_scene(scene->scene, i));
        found = child && shines(f, child, depth - 1);
    }
    scene->shines = found ? SHINING : DARK;
    return found;
}

// How the primitives of a geometry are sampled, and how many there are; the rest are sampled as a whole. 0:
// they are not.
static uint32_t classify(sagi_area_group *group) {
    const sag_shape_kind kind = group->shape_kind;
    group->kind = SAGI_AREA_ANY;
    group->flat = kind == SAG_SHAPE_POLYGON || kind == SAG_SHAPE_DISK;
    if (kind == SAG_SHAPE_SPHERE || kind == SAG_SHAPE_SPHERES) group->kind = SAGI_AREA_BALL;
    if (kind == SAG_SHAPE_MESH || kind == SAG_SHAPE_TRIANGLE || kind == SAG_SHAPE_RECTANGLE)
        group->kind = SAGI_AREA_FACET, group->flat = true;
    if (kind == SAG_SHAPE_BILINEAR_PATCH) {
        const sag_bilinear_patch *p = group->shape;
        const sag_vec3 twist = sag_sub(sag_sub(p->p11, p->p10), sag_sub(p->p01, p->p00));
        const sag_vec3 across = sag_sub(p->p11, p->p00);
        group->kind = SAGI_AREA_PATCH;
        if (sag_dot(twist, twist) <= 0x1p-40 * sag_dot(across, across))
            group->kind = SAGI_AREA_FACET, group->flat = true;
    }
    if (kind == SAG_SHAPE_MESH) return ((const sag_mesh *)group->shape)->triangle_count;
    if (kind == SAG_SHAPE_SPHERES) return ((const sag_spheres *)group->shape)->count;
    return kind == SAG_SHAPE_INSTANCE || kind == SAG_SHAPE_USER ? 0 : 1;
}

static void add_group(finder *f, uint32_t appearance, sagi_area_group group) {
    const sagi_appearance *look = &appearances_of(f->areas)[appearance];
    group.geometry = look->geometry, group.appearance = appearance;
    if (sag_geometry_get(group.scene, group.geometry, &group.shape_kind, &group.shape) != SAG_OK) return;
    if (sag_geometry_get_transform(group.scene, group.geometry, &group.to_world) != SAG_OK) return;
    group.count = classify(&group);
    if (group.count == 0) return;
    if (group.depth > 0) {
        group.to_world = sag_affine_multiply(&group.outward, &group.to_world);
        group.outward_volume = fabs(sag_affine_determinant(&group.outward));
        if (!sag_affine_inverse(&group.outward, &group.inward)) return;
        if (f->total + group.count > MOST_INSTANCED) {
            f->left_out = true;
            return;
        }
    }
    group.moved = !sag_affine_is_identity(&group.to_world);
    group.first = (uint32_t)f->total;
    f->total += group.count;
    sagi_area_group *slot = sagi_list_grow(f->context, &f->areas->groups, sizeof *slot);
    if (f->total >= SAGI_LIGHT_LEAF) f->status = SAG_ERROR_ARGUMENT;
    if (!slot) f->status = SAG_ERROR_MEMORY;
    if (f->status != SAG_OK) return;
    if (group.depth == 0) f->areas->group_of[appearance] = (uint32_t)f->areas->groups.count;
    *slot = group;
    f->areas->groups.count++;
}

// All lights of a scene that is reached as `here` says. Not deeper than instances nest.
static void visit(finder *f, const known_scene *scene, const sagi_area_group *here) {
    if (is_solid(scene->scene)) return;
    for (uint32_t i = scene->first; i != SAG_INVALID_ID && f->status == SAG_OK; i = f->next[i])
        add_group(f, i, *here);
    if (here->depth == SAG_MAX_INSTANCE_DEPTH) return;
    const uint32_t count = f->scene_count > 1 ? sag_scene_geometry_count(scene->scene) : 0;
    for (uint32_t i = 0; i < count && f->status == SAG_OK; i++) {
        known_scene *child = find_scene(f, sag_instance_scene(scene->scene, i));
        if (!child || !shines(f, child, SAG_MAX_INSTANCE_DEPTH)) continue;
        const sag_box3 box = sag_geometry_bounds(scene->scene, i, 0);
        sagi_area_group inner = *here;
        sag_affine place;
        if (sag_box3_is_empty(&box) || sag_geometry_get_transform(scene->scene, i, &place) != SAG_OK)
            continue;
        inner.outward = here->depth == 0 ? place : sag_affine_multiply(&here->outward, &place);
        inner.path[inner.depth++] = i;
        inner.scene = child->scene;
        visit(f, child, &inner);
    }
}

static uint64_t way_hash(uint32_t appearance, uint32_t depth, const uint32_t *path) {
    uint64_t hash = sagi_mix(appearance + UINT64_C(0x9E3779B97F4A7C15) * (depth + 1));
    for (uint32_t i = 0; i < depth; i++) hash = sagi_mix(hash + path[i] + UINT64_C(0xD1B54A32D192ED03));
    return hash;
}

static bool make_slots(sagi_areas *areas, const sag_context *context) {
    const sagi_area_group *groups = areas->groups.items;
    uint32_t count = 0;
    for (size_t i = 0; i < areas->groups.count; i++) count += groups[i].depth > 0;
    if (count == 0) return true;
    areas->slot_count = 4;
    while (areas->slot_count < 2 * count) areas->slot_count *= 2;
    areas->slots = sag_allocate(context, areas->slot_count * sizeof *areas->slots);
    if (!areas->slots) return false;
    memset(areas->slots, 0xFF, areas->slot_count * sizeof *areas->slots);
    for (uint32_t i = 0; i < areas->groups.count; i++) {
        if (groups[i].depth == 0) continue;
        uint64_t at = way_hash(groups[i].appearance, groups[i].depth, groups[i].path);
        while (areas->slots[at & (areas->slot_count - 1)] != SAG_INVALID_ID) at++;
        areas->slots[at & (areas->slot_count - 1)] = i;
    }
    return true;
}

uint32_t sagi_area_find(const sagi_areas *areas, const sag_hit *hit, const sag_surface *surface) {
    const uint64_t id = surface->user_data;
    if (id == 0 || id > areas->appearance_count || areas->count == 0) return SAG_INVALID_ID;
    const uint32_t appearance = (uint32_t)id - 1, depth = hit->instance_depth;
    const sagi_area_group *groups = areas->groups.items;
    uint32_t found = SAG_INVALID_ID;
    if (depth == 0) {
        found = areas->group_of[appearance];
    } else if (areas->slots) {
        uint64_t at = way_hash(appearance, depth, hit->instance_path);
        for (;; at++) {
            found = areas->slots[at & (areas->slot_count - 1)];
            if (found == SAG_INVALID_ID) break;
            const sagi_area_group *g = &groups[found];
            if (g->appearance == appearance && g->depth == depth &&
                memcmp(g->path, hit->instance_path, depth * sizeof *g->path) == 0)
                break;
        }
    }
    if (found == SAG_INVALID_ID) return SAG_INVALID_ID;
    const uint32_t primitive = groups[found].count > 1 ? hit->primitive : 0;
    return primitive < groups[found].count ? groups[found].first + primitive : SAG_INVALID_ID;
}

// The area of a primitive in the world's space. (Of curved shapes under maps that are no similarities:
// about.)
static double world_area(const sagi_areas *areas, const sagi_area_group *group, uint32_t index) {
    const uint32_t primitive = index - group->first;
    sagi_facet facet = {.parallelogram = false};
    if (group->kind == SAGI_AREA_FACET) sagi_area_facet(areas, index, &facet);
    const double flat = sag_length(sag_cross(facet.e, facet.f)) * (facet.parallelogram ? 1 : 0.5);
    if (group->kind == SAGI_AREA_PATCH ||
        (group->kind == SAGI_AREA_FACET && group->shape_kind != SAG_SHAPE_MESH)) {
        const sag_box3 box = sag_geometry_bounds(group->scene, group->geometry, 0);
        if (sag_box3_is_empty(&box)) return 0;
        return group->kind == SAGI_AREA_PATCH ? sagi_area_of_patch(group) : flat;
    }
    const double area = sag_geometry_area(group->scene, group->geometry, primitive);
    if (group->depth == 0 || !(area > 0)) return area;
    if (group->kind == SAGI_AREA_FACET) return flat;
    double sum = 0;
    for (int i = 0; i < 16; i++) {
        sag_surface at;
        double density;
        const sag_vec2 random = {(i % 4 + 0.5) / 4, (i / 4 + 0.5) / 4};
        if (!sag_geometry_sample(group->scene, group->geometry, primitive, random, &at, &density)) return 0;
        sum += sagi_area_enlargement(group, at.geometric_normal) / 16;
    }
    return area * sum;
}

static sag_status fill_areas(finder *f) {
    sagi_areas *areas = f->areas;
    const sagi_area_group *groups = areas->groups.items;
    areas->count = (uint32_t)f->total;
    if (areas->count == 0) return SAG_OK;
    areas->areas = sag_allocate(f->context, areas->count * sizeof *areas->areas);
    if (!areas->areas) {
        areas->count = 0;
        return SAG_ERROR_MEMORY;
    }
    for (uint32_t g = 0; g < areas->groups.count; g++) {
        const sagi_area_group *group = &groups[g];
        bool usable = false;
        for (uint32_t i = 0; i < group->count; i++) {
            sagi_area *area = &areas->areas[group->first + i];
            *area = (sagi_area){.group = g, .ball = SAG_INVALID_ID};
            const double size = world_area(areas, group, group->first + i);
            if (size > 0 && isfinite(size) && isfinite(1 / size)) area->density = 1 / size;
            usable |= !(size == 0);
            sagi_ball ball;
            if (group->kind != SAGI_AREA_BALL || !(area->density > 0) ||
                !sagi_ball_find(group->shape_kind, group->shape, &group->to_world, i, &ball))
                continue;
            sagi_ball *slot = sagi_list_grow(f->context, &areas->balls, sizeof *slot);
            if (!slot) return SAG_ERROR_MEMORY;
            *slot = ball;
            area->ball = (uint32_t)areas->balls.count++;
        }
        if (!usable)
            sag_context_log(f->context, SAG_LOG_WARNING, "geometry %u shines but has no area: left out",
                            group->geometry);
    }
    return make_slots(areas, f->context) && sagi_flats_init(areas, f->context) ? SAG_OK : SAG_ERROR_MEMORY;
}

sag_status sagi_areas_init(sagi_areas *areas, const sag_world *world, sag_error *error) {
    *areas = (sagi_areas){.world = world, .appearance_count = (uint32_t)world->appearances.count};
    if (areas->appearance_count == 0) return SAG_OK;
    const sagi_appearance *all = appearances_of(areas);
    for (uint32_t i = 0; i < areas->appearance_count; i++) {
        const sag_rgb e = all[i].look.emission;
        if (!(e.r >= 0 && e.g >= 0 && e.b >= 0) || !sagi_rgb_is_finite(e))
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "geometry %u has a negative or infinite emission",
                                 all[i].geometry);
    }
    finder f = {.areas = areas, .context = world->context, .status = SAG_OK};
    areas->group_of = sag_allocate(f.context, areas->appearance_count * sizeof *areas->group_of);
    if (areas->group_of) memset(areas->group_of, 0xFF, areas->appearance_count * sizeof *areas->group_of);
    if (!areas->group_of || !list_scenes(&f)) f.status = SAG_ERROR_MEMORY;
    if (f.status == SAG_OK) {
        known_scene *top = find_scene(&f, world->scene);
        const sagi_area_group here = {.scene = world->scene};
        if (shines(&f, top, SAG_MAX_INSTANCE_DEPTH)) visit(&f, top, &here);
    }
    if (f.status == SAG_OK) f.status = fill_areas(&f);
    sag_release(f.context, f.scenes, f.scene_count * sizeof *f.scenes);
    sag_release(f.context, f.next, areas->appearance_count * sizeof *f.next);
    if (f.left_out)
        sag_context_log(world->context, SAG_LOG_WARNING,
                        "instances show more than %u lights: those beyond are found by surfaces only",
                        MOST_INSTANCED);
    if (f.status == SAG_ERROR_ARGUMENT)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "too many shining primitives");
    return f.status == SAG_OK ? SAG_OK : sag_error_set(error, f.status, "out of memory");
}

void sagi_areas_clear(sagi_areas *areas) {
    if (!areas->world) return;
    const sag_context *context = areas->world->context;
    sagi_list_clear(context, &areas->groups, sizeof(sagi_area_group));
    sagi_list_clear(context, &areas->balls, sizeof(sagi_ball));
    if (areas->flats) sag_release(context, areas->flats, areas->count * sizeof *areas->flats);
    if (areas->areas) sag_release(context, areas->areas, areas->count * sizeof *areas->areas);
    sag_release(context, areas->group_of, areas->appearance_count * sizeof *areas->group_of);
    sag_release(context, areas->slots, areas->slot_count * sizeof *areas->slots);
    *areas = (sagi_areas){0};
}
