// SPDX-License-Identifier: MIT
#include "support/solid_model.h"
#include "shapes/shape.h"
#include <string.h>

solid_model *solid_model_create(void) { return calloc(1, sizeof(solid_model)); }

model_part *solid_model_add(solid_model *model) {
    model_part *part = calloc(1, sizeof *part);
    if (!part || model->step_count >= MODEL_MAX_STEPS) abort();
    part->map = part->back = sag_affine_identity();
    model->steps[model->step_count++] = (sag_solid_step){SAG_SOLID_PART, model->part_count};
    model->parts[model->part_count++] = part;
    return part;
}

void solid_model_map(model_part *part, const sag_affine *map) {
    part->map = *map;
    part->mapped = sag_affine_inverse(map, &part->back);
    if (!part->mapped) abort();
    inverse_map_make(&part->inverse, map);
}

void solid_model_step(solid_model *model, sag_solid_operation operation, uint32_t operands) {
    if (model->step_count >= MODEL_MAX_STEPS) abort();
    model->steps[model->step_count++] = (sag_solid_step){operation, operands};
}

sag_status solid_model_finish(solid_model *model, sag_context *context, rng *r, sag_error *error) {
    static uint32_t order[MODEL_MAX_STEPS];
    static sag_solid_step steps[MODEL_MAX_STEPS];
    model->scene = sag_scene_create(context);
    for (uint32_t i = 0; i < model->part_count; i++) {
        uint32_t k = rng_below(r, i + 1);
        order[i] = order[k], order[k] = i;
        model_part *part = model->parts[i];
        part->state = model->state_count;
        model->state_count += 1 + (part->child ? part->child->state_count : 0);
        if (!part->child) region_make(&part->region, part->shape.kind, &part->shape.as);
    }
    for (uint32_t i = 0; i < model->part_count; i++) {
        model_part *part = model->parts[order[i]];
        if (part->child)
            part->id = sag_add_instance(model->scene, part->child->scene, &part->map);
        else
            part->id = sag_add_shape(model->scene, part->shape.kind, &part->shape.as);
        if (!part->child && part->mapped) sag_geometry_set_transform(model->scene, part->id, &part->map);
        if (part->disabled) sag_geometry_set_enabled(model->scene, part->id, false);
    }
    for (uint32_t i = 0; i < model->step_count; i++) {
        steps[i] = model->steps[i];
        if (steps[i].operation == SAG_SOLID_PART) steps[i].number = model->parts[steps[i].number]->id;
    }
    sag_solid solid = {steps, model->step_count};
    sag_status status = sag_scene_set_solid(model->scene, &solid, error);
    return status == SAG_OK ? sag_scene_commit(model->scene, error) : status;
}

void solid_model_destroy(solid_model *model) {
    if (!model) return;
    sag_scene_destroy(model->scene);
    for (uint32_t i = 0; i < model->part_count; i++) {
        if (!model->parts[i]->child && model->parts[i]->region.rules) region_clear(&model->parts[i]->region);
        solid_model_destroy(model->parts[i]->child);
        free(model->parts[i]);
    }
    free(model);
}

static membership reduce(sag_solid_operation operation, const membership *operand, uint32_t count) {
    int value = (int)operand[0];
    for (uint32_t i = 1; i < count; i++) {
        int other = (int)operand[i];
        switch (operation) {
        case SAG_SOLID_PART: break;
        case SAG_SOLID_UNION: value = other > value ? other : value; break;
        case SAG_SOLID_INTERSECTION: value = other < value ? other : value; break;
        case SAG_SOLID_DIFFERENCE: value = -other < value ? -other : value; break;
        case SAG_SOLID_XOR: value = -value * other; break;
        }
    }
    return (membership)value;
}

membership solid_model_value(const solid_model *model, const membership *states) {
    membership stack[MODEL_MAX_STEPS];
    stack[0] = MEMBER_OUT;
    uint32_t top = 0;
    for (uint32_t i = 0; i < model->step_count; i++) {
        sag_solid_step step = model->steps[i];
        if (step.operation == SAG_SOLID_PART) {
            stack[top++] = states[model->parts[step.number]->state];
        } else {
            top -= step.number;
            stack[top] = reduce(step.operation, stack + top, step.number);
            top++;
        }
    }
    return stack[0];
}

static membership at(const solid_model *model, const spot *where, membership *states, bool exactly) {
    for (uint32_t i = 0; i < model->part_count; i++) {
        const model_part *part = model->parts[i];
        membership *state = states + part->state;
        if (part->disabled) {
            *state = MEMBER_OUT; // those of a child are not looked at
        } else if (exactly && (*state != MEMBER_UNKNOWN || part->mapped)) {
            continue;
        } else {
            spot mapped;
            if (part->mapped) mapped = spot_map(&part->inverse, where);
            const spot *local = part->mapped ? &mapped : where;
            *state = part->child ? at(part->child, local, state + 1, exactly)
                     : exactly   ? region_exact(&part->region, local)
                                 : region_filter(&part->region, local);
        }
    }
    return solid_model_value(model, states);
}

membership solid_model_at(const solid_model *model, const spot *where, membership *states) {
    membership value = at(model, where, states, false);
    return value == MEMBER_UNKNOWN && where->exact ? at(model, where, states, true) : value;
}

static int by_time(const void *a, const void *b) {
    const model_crossing *x = a, *y = b;
    if (x->t != y->t) return x->t < y->t ? -1 : 1;
    return x->state < y->state ? -1 : x->state > y->state;
}

static size_t collect(const solid_model *model, const sag_ray *ray, uint32_t state, size_t count,
                      model_crossing **list, size_t *capacity) {
    for (uint32_t i = 0; i < model->part_count; i++) {
        const model_part *part = model->parts[i];
        if (part->disabled) continue;
        sag_ray local = part->mapped ? sag_ray_transform(&part->back, ray) : *ray;
        local.t_min = -INFINITY, local.t_max = INFINITY;
        uint32_t own = state + part->state;
        if (part->child) {
            count = collect(part->child, &local, own + 1, count, list, capacity);
            continue;
        }
        sag_hit hits[64];
        size_t n = sagi_shape_classes[part->shape.kind].crossings(&part->shape.as, &local, hits, 64);
        if (n > 64) abort();
        if (count + n > *capacity) {
            *capacity = 2 * (count + n) + 64;
            *list = realloc(*list, *capacity * sizeof **list);
            if (!*list) abort();
        }
        for (size_t k = 0; k < n; k++) (*list)[count++] = (model_crossing){hits[k].t, own, hits[k].primitive};
    }
    return count;
}

size_t solid_model_crossings(const solid_model *model, const sag_ray *ray, model_crossing **list,
                             size_t *capacity) {
    size_t count = collect(model, ray, 0, 0, list, capacity);
    if (count) qsort(*list, count, sizeof **list, by_time);
    return count;
}

const model_part *solid_model_find(const solid_model *model, const uint32_t *path, uint32_t depth,
                                   uint32_t geometry, uint32_t *state) {
    *state = 0;
    for (uint32_t level = 0;; level++) {
        uint32_t id = level < depth ? path[level] : geometry;
        const model_part *found = NULL;
        for (uint32_t i = 0; i < model->part_count && !found; i++)
            if (model->parts[i]->id == id) found = model->parts[i];
        if (!found || (found->child != NULL) != (level < depth)) return NULL;
        *state += found->state;
        if (level == depth) return found;
        *state += 1;
        model = found->child;
    }
}

uint32_t solid_model_owner(const solid_model *model, const membership *before, const membership *after) {
    membership was = solid_model_value(model, before);
    const model_part *owner = NULL;
    membership *changed = malloc(model->state_count * sizeof *changed);
    if (!changed) abort();
    memcpy(changed, before, model->state_count * sizeof *changed);
    for (int together = 0; together < 2 && !owner; together++)
        for (uint32_t i = 0; i < model->part_count && !owner; i++) {
            uint32_t s = model->parts[i]->state;
            if (before[s] == after[s]) continue;
            changed[s] = after[s];
            if (solid_model_value(model, changed) != was) owner = model->parts[i];
            if (!together) changed[s] = before[s];
        }
    free(changed);
    if (!owner || !owner->child) return owner ? owner->state : UINT32_MAX;
    uint32_t below = owner->state + 1;
    return below + solid_model_owner(owner->child, before + below, after + below);
}
