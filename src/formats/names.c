// SPDX-License-Identifier: MIT
// A hash table with linear probing and FNV-1a (Fowler, Noll, Vo). It doubles when half full, so a probe sees
// two slots on average and always ends.
#include "formats/names.h"

#include <string.h>

struct sagi_name {
    char *text; // NULL: the slot is free
    size_t length;
    uint64_t hash;
    uint32_t value;
};

static uint64_t hash_of(sagi_slice name) {
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < name.length; i++) hash = (hash ^ (uint8_t)name.text[i]) * 1099511628211u;
    return hash;
}

// The slot of the name, or the free one where it would go.
static struct sagi_name *find(const sagi_names *names, sagi_slice name, uint64_t hash) {
    size_t i = (size_t)hash & (names->slot_count - 1);
    for (;; i = (i + 1) & (names->slot_count - 1)) {
        struct sagi_name *slot = &names->slots[i];
        if (!slot->text || (slot->hash == hash && slot->length == name.length &&
                            memcmp(slot->text, name.text, name.length) == 0))
            return slot;
    }
}

static bool grow(sagi_names *names) {
    const size_t count = names->slot_count ? 2 * names->slot_count : 64;
    sagi_names larger = {.context = names->context, .slot_count = count, .name_count = names->name_count};
    larger.slots = sag_allocate(names->context, count * sizeof *larger.slots);
    if (!larger.slots) return false;
    memset(larger.slots, 0, count * sizeof *larger.slots);
    for (size_t i = 0; i < names->slot_count; i++) {
        const struct sagi_name *slot = &names->slots[i];
        if (slot->text) *find(&larger, (sagi_slice){slot->text, slot->length}, slot->hash) = *slot;
    }
    sag_release(names->context, names->slots, names->slot_count * sizeof *names->slots);
    *names = larger;
    return true;
}

bool sagi_names_set(sagi_names *names, sagi_slice name, uint32_t value) {
    if (2 * names->name_count >= names->slot_count && !grow(names)) return false;
    const uint64_t hash = hash_of(name);
    struct sagi_name *slot = find(names, name, hash);
    if (!slot->text) {
        char *text = sag_allocate(names->context, name.length + 1);
        if (!text) return false;
        if (name.length) memcpy(text, name.text, name.length);
        text[name.length] = '\0';
        *slot = (struct sagi_name){text, name.length, hash, value};
        names->name_count++;
    }
    slot->value = value;
    return true;
}

bool sagi_names_get(const sagi_names *names, sagi_slice name, uint32_t *value) {
    if (names->slot_count == 0) return false;
    const struct sagi_name *slot = find(names, name, hash_of(name));
    if (!slot->text) return false;
    if (value) *value = slot->value;
    return true;
}

void sagi_names_clear(sagi_names *names) {
    for (size_t i = 0; i < names->slot_count; i++)
        if (names->slots[i].text)
            sag_release(names->context, names->slots[i].text, names->slots[i].length + 1);
    sag_release(names->context, names->slots, names->slot_count * sizeof *names->slots);
    *names = (sagi_names){.context = names->context};
}
