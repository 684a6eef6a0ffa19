// SPDX-License-Identifier: MIT
// A name that is used before it is defined gets its id at once, of a grey texture or material that the
// definition then takes the place of. Instances wait until the end.
#include "formats/pbrt_promise.h"

#include "formats/pbrt_solid.h"
#include "render/world.h"

#include <stdio.h>
#include <string.h>

// What a map says of a name that is promised: this and the promise's number.
#define PROMISED 0x80000000u

struct sagi_promise {
    sagi_place used_at; // first
    const sagi_names *names;
    uint32_t id;
    bool kept, is_mix;
    char name[101];
};

struct sagi_promised_instance {
    sagi_place place;
    sag_affine to_world;
    char *name;
    size_t name_bytes;
};

bool sagi_pbrt_find(const sagi_pbrt *p, const sagi_names *names, sagi_slice name, uint32_t *id) {
    if (!sagi_names_get(names, name, id)) return false;
    if (*id & PROMISED) *id = p->promises[*id - PROMISED].id;
    return true;
}

bool sagi_pbrt_is_made(const sagi_names *names, sagi_slice name) {
    uint32_t value;
    return sagi_names_get(names, name, &value) && !(value & PROMISED);
}

static struct sagi_promise *next_promise(sagi_pbrt *p, sagi_place place) {
    void *promises = p->promises;
    if (!sagi_pbrt_reserve(p, &promises, &p->promise_allocated, p->promise_count, sizeof *p->promises))
        return NULL;
    p->promises = promises;
    struct sagi_promise *promise = &p->promises[p->promise_count];
    *promise = (struct sagi_promise){.used_at = place};
    return promise;
}

sag_status sagi_pbrt_promise(sagi_pbrt *p, sagi_place place, sagi_names *names, sagi_slice name,
                             uint32_t *id) {
    struct sagi_promise *promise = next_promise(p, place);
    if (!promise) return sagi_pbrt_out_of_memory(p);
    *id = names == &p->materials ? sagi_material_reserve(p->world)
                                 : sagi_texture_reserve(p->world, names == &p->float_textures);
    if (!*id || !sagi_names_set(names, name, PROMISED + (uint32_t)p->promise_count))
        return sagi_pbrt_out_of_memory(p);
    promise->names = names;
    promise->id = *id;
    const int length = (int)(name.length < 100 ? name.length : 100);
    snprintf(promise->name, sizeof promise->name, "%.*s", length, name.text);
    p->promise_count++;
    return SAG_OK;
}

uint32_t sagi_pbrt_promised(const sagi_pbrt *p, const sagi_names *names, const char *name) {
    uint32_t value;
    if (!sagi_names_get(names, (sagi_slice){name, strlen(name)}, &value) || !(value & PROMISED)) return 0;
    return p->promises[value - PROMISED].id;
}

void sagi_pbrt_keep(sagi_pbrt *p, sagi_names *names, const char *name) {
    const sagi_slice key = {name, strlen(name)};
    uint32_t value;
    if (!sagi_names_get(names, key, &value) || !(value & PROMISED)) return;
    struct sagi_promise *promise = &p->promises[value - PROMISED];
    promise->kept = true;
    sagi_names_set(names, key, promise->id); // the name is there: no memory is asked for
}

sag_status sagi_pbrt_promise_mix(sagi_pbrt *p, sagi_place place, uint32_t material) {
    struct sagi_promise *promise = next_promise(p, place);
    if (!promise) return sagi_pbrt_out_of_memory(p);
    promise->is_mix = true;
    promise->id = material;
    p->promise_count++;
    return SAG_OK;
}

sag_status sagi_pbrt_promise_instance(sagi_pbrt *p, sagi_place place, const char *name) {
    void *instances = p->promised_instances;
    if (!sagi_pbrt_reserve(p, &instances, &p->promised_instance_allocated, p->promised_instance_count,
                           sizeof *p->promised_instances))
        return sagi_pbrt_out_of_memory(p);
    p->promised_instances = instances;
    struct sagi_promised_instance *instance = &p->promised_instances[p->promised_instance_count];
    *instance = (struct sagi_promised_instance){
        .place = place, .to_world = p->state.ctm, .name_bytes = strlen(name) + 1};
    instance->name = sag_allocate(p->context, instance->name_bytes);
    if (!instance->name) return sagi_pbrt_out_of_memory(p);
    memcpy(instance->name, name, instance->name_bytes);
    p->promised_instance_count++;
    return SAG_OK;
}

static bool mixes_interface(const sagi_pbrt *p, uint32_t id) {
    const sagi_material *materials = p->world->materials.items;
    const uint32_t *parts = materials[id - 1].material.materials;
    return materials[parts[0] - 1].material.kind == SAG_MATERIAL_INTERFACE ||
           materials[parts[1] - 1].material.kind == SAG_MATERIAL_INTERFACE;
}

sag_status sagi_pbrt_check_promises(sagi_pbrt *p) {
    bool has_textures = false;
    for (size_t i = 0; i < p->promise_count; i++) {
        const struct sagi_promise *promise = &p->promises[i];
        if (promise->is_mix) {
            if (mixes_interface(p, promise->id))
                return sagi_place_error(promise->used_at, p->error, "an interface cannot be mixed");
            continue;
        }
        if (!promise->kept)
            return sagi_place_error(promise->used_at, p->error, "there is no %s \"%s\"",
                                    promise->names == &p->materials ? "material" : "texture", promise->name);
        has_textures |= promise->names != &p->materials;
    }
    if (has_textures && sagi_textures_settle(p->world))
        for (size_t i = 0; i < p->promise_count; i++)
            if (!p->promises[i].is_mix && p->promises[i].names != &p->materials)
                return sagi_place_error(p->promises[i].used_at, p->error,
                                        "the textures \"%s\" is made of nest too deep, or in a circle",
                                        p->promises[i].name);
    for (size_t i = 0; i < p->promised_instance_count; i++) {
        const struct sagi_promised_instance *instance = &p->promised_instances[i];
        const sag_status status =
            sagi_pbrt_place_object(p, instance->place, instance->name, &instance->to_world);
        if (status != SAG_OK) return status;
    }
    return SAG_OK;
}

void sagi_pbrt_promises_clear(sagi_pbrt *p) {
    for (size_t i = 0; i < p->promised_instance_count; i++)
        sag_release(p->context, p->promised_instances[i].name, p->promised_instances[i].name_bytes);
    sag_release(p->context, p->promised_instances,
                p->promised_instance_allocated * sizeof *p->promised_instances);
    sag_release(p->context, p->promises, p->promise_allocated * sizeof *p->promises);
}
