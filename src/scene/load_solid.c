// SPDX-License-Identifier: MIT
// Reading a solid (file.h has the layout). Its tree comes as steps, which go through the same doors as those
// of a caller. The meshes' own trees are read in place of being built; the boxes of the parts follow from all
// that, to the same bits.
#include "scene/reader.h"

sag_status sagi_load_steps(sagi_reader *r, const sagi_file_scene *d, sag_scene *scene) {
    uint64_t bytes = (uint64_t)d->step_count * sizeof(sagi_file_step);
    if (!sagi_reader_has(r, bytes)) return sagi_reader_wrong(r, "a solid larger than the file");
    size_t step_bytes = d->step_count * sizeof(sag_solid_step);
    sagi_file_step *table = sag_allocate(r->context, (size_t)bytes);
    sag_solid_step *steps = sag_allocate(r->context, step_bytes);
    sag_status status = table != NULL && steps != NULL ? SAG_OK : sagi_reader_no_memory(r);
    if (status == SAG_OK)
        status =
            sagi_reader_get(r, (sagi_file_section){.tag = SAGI_FILE_SOLID, .scene = r->count, .bytes = bytes},
                            "a solid's steps", table);
    for (uint32_t i = 0; i < d->step_count && status == SAG_OK; i++) {
        steps[i] = (sag_solid_step){(sag_solid_operation)table[i].operation, table[i].number};
        if (table[i].operation > SAG_SOLID_XOR) status = sagi_reader_wrong(r, "a solid's step that is none");
    }
    sag_error why = {0};
    if (status == SAG_OK)
        status =
            sagi_reader_told(r, sag_scene_set_solid(scene, &(sag_solid){steps, d->step_count}, &why), &why);
    sag_release(r->context, table, (size_t)bytes);
    sag_release(r->context, steps, step_bytes);
    return status;
}

// The tree of a solid's mesh.
static sag_status get_alone(sagi_reader *r, sagi_snapshot *s, uint32_t id) {
    sagi_file_scene d;
    sagi_file_section head = {.tag = SAGI_FILE_SCENE, .scene = r->count, .geometry = id, .part = 1};
    head.bytes = sizeof d;
    sag_status status = sagi_reader_get(r, head, "a mesh of a solid", &d);
    if (status != SAG_OK) return status;
    if (d.geometry_count != 1 || d.quality != (uint32_t)s->quality || d.step_count != 0 || d.zero != 0)
        return sagi_reader_wrong(r, "a mesh of a solid that is another scene");
    sagi_snapshot *alone = sagi_snapshot_create_alone(s, id);
    if (alone == NULL) return sagi_reader_no_memory(r);
    sagi_snapshot_take_alone(s, id, alone);
    return sagi_load_structure(r, &d, alone, head);
}

sag_status sagi_load_fill(sagi_reader *r, const sagi_file_scene *d, const sag_scene *scene,
                          sagi_snapshot *s) {
    sag_error why = {0};
    sag_status status = SAG_OK;
    s->quality = (sag_quality)d->quality;
    if (d->step_count > 0) status = sagi_reader_told(r, sagi_snapshot_set_solid(s, scene, &why), &why);
    if (status == SAG_OK) status = sagi_snapshot_fill(s, scene, r->error);
    if (d->step_count == 0) return status;
    for (uint32_t i = 0; i < s->count && status == SAG_OK; i++)
        if (s->entries[i].present && s->items[i].kind == SAG_SHAPE_MESH) status = get_alone(r, s, i);
    if (status == SAG_OK) status = sagi_reader_told(r, sagi_solid_check_parts(s, &why), &why);
    if (status == SAG_OK) status = sagi_reader_told(r, sagi_snapshot_measure_parts(s, NULL, &why), &why);
    return status;
}
