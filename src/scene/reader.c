// SPDX-License-Identifier: MIT
// Sections out of a stream of bytes that may be cut, damaged or made by somebody to do harm: each has to be
// the one that is expected, as long as is expected, and to have its checksums.
#include "scene/reader.h"
#include "base/checksum.h"

sag_status sagi_reader_wrong(sagi_reader *r, const char *what) {
    return sag_error_set(r->error, SAG_ERROR_FORMAT, "byte %llu: %s", (unsigned long long)r->offset, what);
}

sag_status sagi_reader_no_memory(sagi_reader *r) {
    return sag_error_set(r->error, SAG_ERROR_MEMORY, "out of memory");
}

sag_status sagi_reader_take(sagi_reader *r, void *data, uint64_t bytes) {
    if (bytes > r->bytes - r->offset) return sagi_reader_wrong(r, "the file ends too soon");
    if (bytes > 0 && !r->read(r->user, data, (size_t)bytes))
        return sagi_reader_wrong(r, "the file is cut off here");
    r->offset += bytes;
    return SAG_OK;
}

bool sagi_all_zero(const void *data, size_t bytes) {
    const unsigned char *p = data;
    while (bytes > 0 && *p == 0) p++, bytes--;
    return bytes == 0;
}

// The head of the section that has to come next.
static sag_status get_head(sagi_reader *r, const sagi_file_section *expected, const char *name,
                           uint64_t *checksum) {
    sagi_file_section head;
    sag_status status = sagi_reader_take(r, &head, sizeof head);
    if (status != SAG_OK) return status;
    r->offset -= sizeof head;
    if (head.head_checksum != sagi_checksum(&head, offsetof(sagi_file_section, head_checksum)))
        return sagi_reader_wrong(r, "damaged: a section's head does not have its checksum");
    if (head.tag != expected->tag || head.scene != expected->scene || head.geometry != expected->geometry ||
        head.part != expected->part || head.bytes != expected->bytes ||
        !sagi_all_zero(head.zeros, sizeof head.zeros))
        return sag_error_set(r->error, SAG_ERROR_FORMAT, "byte %llu: not the section for %s",
                             (unsigned long long)r->offset, name);
    r->offset += sizeof head;
    *checksum = head.checksum;
    return SAG_OK;
}

// A section with this very content length.
sag_status sagi_reader_get(sagi_reader *r, sagi_file_section head, const char *name, void *data) {
    unsigned char zeros[SAGI_FILE_ALIGNMENT];
    uint64_t checksum = 0;
    sag_status status = get_head(r, &head, name, &checksum);
    if (status == SAG_OK) status = sagi_reader_take(r, data, head.bytes);
    if (status != SAG_OK) return status;
    if (sagi_checksum(data, (size_t)head.bytes) != checksum)
        return sag_error_set(r->error, SAG_ERROR_FORMAT, "byte %llu: damaged: %s do not have their checksum",
                             (unsigned long long)(r->offset - head.bytes), name);
    size_t rest = (SAGI_FILE_ALIGNMENT - head.bytes % SAGI_FILE_ALIGNMENT) % SAGI_FILE_ALIGNMENT;
    status = sagi_reader_take(r, zeros, rest);
    if (status != SAG_OK) return status;
    return sagi_all_zero(zeros, rest) ? SAG_OK
                                      : sagi_reader_wrong(r, "damaged: what fills up to here is not 0");
}

sag_status sagi_reader_told(sagi_reader *r, sag_status status, const sag_error *why) {
    if (status == SAG_OK) return SAG_OK;
    if (status == SAG_ERROR_MEMORY) return sagi_reader_no_memory(r);
    return sag_error_set(r->error, SAG_ERROR_FORMAT, "byte %llu: %.400s", (unsigned long long)r->offset,
                         why->message);
}
