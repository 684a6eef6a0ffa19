// SPDX-License-Identifier: MIT
#define _GNU_SOURCE // MAP_ANONYMOUS
#include "support/guarded_memory.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define POISONS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define POISONS 1
#endif
#endif
#ifdef POISONS
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(at, bytes)   ((void)(at), (void)(bytes))
#define ASAN_UNPOISON_MEMORY_REGION(at, bytes) ((void)(at), (void)(bytes))
#endif

enum { UNTOUCHED = 0xA5 };

// A block lies in pages of its own, `before` bytes from where they begin, between two that nobody may touch.
typedef struct layout {
    size_t page, bytes, before, after; // bytes: of the pages between
} layout;

static layout layout_of(guarded_side side, size_t bytes, size_t alignment) {
    layout l = {.page = (size_t)sysconf(_SC_PAGESIZE)};
    l.bytes = (bytes + l.page - 1) / l.page * l.page;
    if (side == GUARDED_END) l.before = (l.bytes - bytes) / alignment * alignment;
    l.after = l.bytes - l.before - bytes;
    return l;
}

static void *allocate(guarded_side side, size_t bytes, size_t alignment) {
    if (bytes > SIZE_MAX / 2) return NULL;
    layout l = layout_of(side, bytes, alignment);
    if (alignment > l.page) return NULL;
    unsigned char *map = mmap(NULL, l.bytes + 2 * l.page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED) return NULL;
    unsigned char *pages = map + l.page;
    if (mprotect(pages, l.bytes, PROT_READ | PROT_WRITE) != 0) {
        munmap(map, l.bytes + 2 * l.page);
        return NULL;
    }
    memset(pages, UNTOUCHED, l.bytes); // whoever reads before writing shall notice
    ASAN_POISON_MEMORY_REGION(pages, l.before);
    ASAN_POISON_MEMORY_REGION(pages + l.before + bytes, l.after);
    return pages + l.before;
}

static void expect(bool good, const char *what) {
    if (good) return;
    fprintf(stderr, "guarded memory: %s\n", what);
    abort();
}

static void release(guarded_side side, void *memory, size_t bytes, size_t alignment) {
    layout l = layout_of(side, bytes, alignment);
    unsigned char *pages = (unsigned char *)memory - l.before;
    expect((uintptr_t)pages % l.page == 0, "released with another size than it was allocated with");
    ASAN_UNPOISON_MEMORY_REGION(pages, l.bytes);
    for (size_t i = 0; i < l.before; i++) expect(pages[i] == UNTOUCHED, "written to before a block");
    for (size_t i = l.bytes - l.after; i < l.bytes; i++)
        expect(pages[i] == UNTOUCHED, "written to after a block");
    expect(munmap(pages - l.page, l.bytes + 2 * l.page) == 0, "cannot be released");
}

static void *allocate_at_end(void *user, size_t bytes, size_t alignment) {
    (void)user;
    return allocate(GUARDED_END, bytes, alignment);
}
static void release_at_end(void *user, void *memory, size_t bytes, size_t alignment) {
    (void)user;
    release(GUARDED_END, memory, bytes, alignment);
}
static void *allocate_at_begin(void *user, size_t bytes, size_t alignment) {
    (void)user;
    return allocate(GUARDED_BEGIN, bytes, alignment);
}
static void release_at_begin(void *user, void *memory, size_t bytes, size_t alignment) {
    (void)user;
    release(GUARDED_BEGIN, memory, bytes, alignment);
}

sag_allocator guarded_allocator(guarded_side side) {
    if (side == GUARDED_END) return (sag_allocator){.allocate = allocate_at_end, .release = release_at_end};
    return (sag_allocator){.allocate = allocate_at_begin, .release = release_at_begin};
}

sag_allocator guarded_if_asked(void) {
    return getenv("SAGITTA_GUARDED") != NULL ? guarded_allocator(GUARDED_END) : (sag_allocator){.user = NULL};
}

void *guarded_copy(const void *from, size_t bytes) {
    if (from == NULL || bytes == 0) return NULL;
    void *copy = allocate(GUARDED_END, bytes, 1);
    expect(copy != NULL, "no memory");
    return memcpy(copy, from, bytes);
}

void guarded_free(void *copy, size_t bytes) {
    if (copy != NULL) release(GUARDED_END, copy, bytes, 1);
}
