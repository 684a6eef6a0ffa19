// SPDX-License-Identifier: MIT
#include "support/hostile.h"
#include "support/random_scene.h"

#include <sagitta/solid.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

place hostile_find(const saved *file, sagi_file_tag tag, uint32_t scene) {
    for (size_t at = sizeof(sagi_file_head); at < file->count;) {
        const sagi_file_section *s = (const void *)(file->bytes + at);
        at += sizeof *s;
        if (s->tag == (uint32_t)tag && s->scene == scene) return (place){at, s->bytes};
        at += (s->bytes + SAGI_FILE_ALIGNMENT - 1) / SAGI_FILE_ALIGNMENT * SAGI_FILE_ALIGNMENT;
    }
    fail();
    return (place){0, 0};
}

static void ask_everything(rng *r, sag_scene *scene) {
    for (int i = 0; i < 12; i++) {
        sag_ray ray = random_scene_ray(r, 1);
        sag_hit hits[8], hit;
        sag_surface surface;
        sag_closest closest;
        sag_span spans[4];
        sag_scene_spans(scene, &ray, spans, 4);
        size_t count = sag_intersect_all(scene, &ray, hits, 8);
        for (size_t k = 0; k < count && k < 8; k++) sag_surface_at(scene, &ray, &hits[k], &surface);
        if (sag_intersect(scene, &ray, &hit)) sag_surface_at(scene, &ray, &hit, &surface);
        sag_occluded(scene, &ray);
        sag_contains(scene, ray.origin);
        sag_closest_point(scene, ray.origin, INFINITY, &closest);
    }
}

// A camera's rays, which go through the tree together.
static void ask_many(rng *r, const sag_scene *scene) {
    sag_ray rays[64];
    sag_hit hits[64];
    bool occluded[64];
    sag_vec3 eye = rng_vec3(r, 4);
    for (int i = 0; i < 64; i++)
        rays[i] =
            sag_ray_make(eye, sag_sub(sag_vec3_make(0.2 * (i % 8) - 0.7, 0.2 * (i / 8) - 0.7, 0.1), eye));
    sag_intersect_batch(scene, rays, hits, 64);
    sag_occluded_batch(scene, rays, occluded, 64);
}

bool hostile_try(rng *r, sag_context *context, saved *file) {
    sag_scene *scene = NULL;
    sag_error error = {0};
    saved_seal(file);
    sag_status status = saved_read(context, file->bytes, file->count, &scene, &error);
    if (status != SAG_OK) {
        assert_null(scene);
        assert_true(error.message[0] != 0);
        return false;
    }
    ask_everything(r, scene);
    ask_many(r, scene);
    for (uint32_t id = 0; id < 3; id++) {
        sag_affine map = sag_affine_translate(sag_vec3_make(0.01, 0, 0));
        sag_geometry_set_transform(scene, id, rng_one_in(r, 2) ? &map : NULL);
    }
    sag_add_sphere(scene, &(sag_sphere){.radius = 0.1});
    if (sag_scene_commit(scene, &error) == SAG_OK) ask_everything(r, scene);
    sag_scene_destroy(scene);
    return true;
}

uint32_t hostile_word(rng *r, uint32_t now) {
    static const uint32_t words[] = {0,          1,          8,          9,          0x7FFFFFFF, 0x80000000,
                                     0xFFFFFFFF, 0x7F800000, 0xFF800000, 0x7FC00000, 0x3F800000, 0x80000001,
                                     0x7FF00000, 0xFFF00000, 0x7FEFFFFF, 0x00000100, 0x01000000, 0x00010000};
    switch (rng_below(r, 4)) {
    case 0: return words[rng_below(r, sizeof words / sizeof *words)];
    case 1: return now + (rng_one_in(r, 2) ? 1u : UINT32_MAX);
    case 2: return now ^ 1u << rng_below(r, 32);
    default: return (uint32_t)rng_bits(r);
    }
}

void hostile_words(rng *r, sag_context *context, saved (*make)(uint64_t seed), uint64_t seeds,
                   uint32_t tries) {
    uint32_t loaded = 0;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        saved file = make(seed), copy = file;
        copy.bytes = malloc(file.count);
        assert_non_null(copy.bytes);
        for (uint32_t i = 0; i < tries / seeds; i++) {
            memcpy(copy.bytes, file.bytes, file.count);
            uint32_t *words = (void *)copy.bytes;
            for (uint32_t k = 1 + rng_below(r, 3); k > 0; k--) {
                const uint32_t at = rng_below(r, (uint32_t)(file.count / 4));
                words[at] = hostile_word(r, words[at]);
            }
            loaded += hostile_try(r, context, &copy);
        }
        saved_free(&copy), saved_free(&file);
    }
    assert_true(loaded > 0 && loaded < tries);
}
