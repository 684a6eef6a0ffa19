// SPDX-License-Identifier: MIT
// What Assimp gets to read. It reads a file whole before it looks at it, takes noise for text and makes room
// for whatever a header claims, so what cannot be a file of the format its name promises is refused
// beforehand. And of a file with materials (MTL) it gets what begins with the first material: what stands
// before has none to belong to, and Assimp writes it to address 0. Of glTF, see gltf.h.
#include "formats/import_file.h"

#include "formats/file.h"
#include "formats/gltf.h"

#include <assimp/cimport.h>
#include <string.h>
#include <strings.h>

static const char *ending_of(const char *path) {
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    return dot && (!slash || dot > slash) ? dot : "";
}

static bool begins(const sagi_file *file, const char *magic) {
    return file->size >= strlen(magic) && memcmp(file->bytes, magic, strlen(magic)) == 0;
}

static bool is_text(const sagi_file *file) {
    const size_t n = file->size < 4096 ? file->size : 4096;
    for (size_t i = 0; i < n; i++) {
        const uint8_t c = file->bytes[i];
        if (c < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f') return false;
    }
    return true;
}

// Whether an OFF file is long enough for the numbers of vertices and faces that it begins with: Assimp makes
// room for them before it looks.
static bool holds_its_counts(const sagi_file *file) {
    const uint8_t *p = file->bytes, *const end = p + file->size;
    for (int numbers = 0; numbers < 2 && p != end;) {
        if (*p == '#') {
            while (p != end && *p != '\n') p++;
        } else if (*p >= '0' && *p <= '9') {
            uint64_t count = 0;
            for (; p != end && *p >= '0' && *p <= '9' && count <= file->size; p++)
                count = 10 * count + (*p - '0');
            if (count > file->size) return false;
            numbers++;
        } else { // the format's name: OFF, STOFF, 4OFF …; its digits are no numbers too large
            p++;
        }
    }
    return true;
}

static uint64_t word_at(const sagi_file *file, size_t at) {
    const uint8_t *n = file->bytes + at;
    return n[0] | (uint64_t)n[1] << 8 | (uint64_t)n[2] << 16 | (uint64_t)n[3] << 24;
}

// Whether the first two chunks of binary glTF (of version 1: its scene) are within the file.
static bool holds_its_chunks(const sagi_file *file) {
    if (file->size < 20) return false;
    const uint64_t first = word_at(file, 12), left = file->size - 20;
    if (first > left) return false;
    return left - first < 8 || word_at(file, 4) < 2 || word_at(file, 20 + (size_t)first) <= left - first - 8;
}

static bool is_binary_gltf(const char *ending) { return strcasecmp(ending, ".glb") == 0; }
static bool is_gltf(const char *ending) { return strcasecmp(ending, ".gltf") == 0 || is_binary_gltf(ending); }

// Whether the content may be of the format the name promises.
static bool is_plausible(const sagi_file *file, const char *ending) {
    static const char *const text[] = {".obj", ".off", ".gltf", ".dae", ".x3d", ".wrl",
                                       ".ac",  ".ase", ".nff",  ".smd", ".raw", ".xml"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        if (strcasecmp(ending, text[i]) == 0)
            return is_text(file) && (strcasecmp(ending, ".off") != 0 || holds_its_counts(file));
    if (strcasecmp(ending, ".stl") == 0) {
        if (file->size < 84) return begins(file, "solid") && is_text(file);
        const uint64_t count = word_at(file, 80);
        // Binary: 50 bytes a triangle; some writers leave a little behind them.
        const uint64_t bytes = 84 + 50 * count;
        if (count > 0 && bytes <= file->size && file->size - bytes <= 50 * count + (1u << 20)) return true;
        return begins(file, "solid") && is_text(file);
    }
    if (is_binary_gltf(ending)) return begins(file, "glTF") && holds_its_chunks(file);
    if (strcasecmp(ending, ".fbx") == 0) return begins(file, "Kaydara FBX Binary") || is_text(file);
    if (strcasecmp(ending, ".3ds") == 0) return begins(file, "MM");
    if (strcasecmp(ending, ".blend") == 0) return begins(file, "BLENDER");
    if (strcasecmp(ending, ".3mf") == 0) return begins(file, "PK");
    return true;
}

sag_status sagi_import_check(const sag_context *context, const char *path, sag_error *error) {
    const char *ending = ending_of(path);
    sagi_file file;
    const sag_status status = sagi_file_open(context, path, &file, error);
    if (status != SAG_OK) return status;
    const bool plausible = is_plausible(&file, ending), empty = file.size == 0;
    const bool utf16 = begins(&file, "\xff\xfe") || begins(&file, "\xfe\xff");
    const sag_status inside = plausible && !empty && is_gltf(ending)
                                  ? sagi_gltf_check(&file, is_binary_gltf(ending), path, error)
                                  : SAG_OK;
    sagi_file_close(&file);
    if (!ending[0] || !aiIsExtensionSupported(ending))
        return sag_error_set_at(
            error, SAG_ERROR_FORMAT, path, 0, 0,
            "unknown kind of scene \"%.20s\": .pbrt, .ply, .obj, .stl, .gltf, .glb, .fbx … can be read",
            ending);
    if (empty) return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0, "the file is empty");
    if (!plausible && utf16)
        return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0,
                                "its text is in UTF-16, which cannot be read: save it as UTF-8");
    if (!plausible)
        return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0,
                                "the content is not that of a %.20s file", ending);
    return inside;
}

// ---- a file, open

typedef struct open_file {
    struct aiFile io;
    sagi_file file;
    const uint8_t *bytes; // what there is to read
    size_t size, position;
    uint8_t *rewritten; // glTF, `size` bytes; or NULL
} open_file;

static open_file *opened(struct aiFile *io) { return (open_file *)(void *)io->UserData; }

static size_t on_read(struct aiFile *io, char *to, size_t size, size_t count) {
    open_file *f = opened(io);
    if (size == 0) return 0;
    const size_t left = (f->size - f->position) / size, n = count < left ? count : left;
    if (n > 0) memcpy(to, f->bytes + f->position, n * size);
    f->position += n * size;
    return n;
}
static size_t on_write(struct aiFile *io, const char *from, size_t size, size_t count) {
    (void)io, (void)from, (void)size, (void)count;
    return 0;
}
static size_t on_tell(struct aiFile *io) { return opened(io)->position; }
static size_t on_size(struct aiFile *io) { return opened(io)->size; }
static void on_flush(struct aiFile *io) { (void)io; }

static enum aiReturn on_seek(struct aiFile *io, size_t offset, enum aiOrigin origin) {
    open_file *f = opened(io);
    const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->position : f->size;
    const size_t to = from + offset; // backward it is 2⁶⁴ less
    if (to > f->size) return aiReturn_FAILURE;
    f->position = to;
    return aiReturn_SUCCESS;
}

// Where the first material of an MTL file begins.
static size_t first_material(const sagi_file *file) {
    static const char word[] = "newmtl";
    bool at_line = true;
    for (size_t i = 0; i < file->size; i++) {
        const uint8_t c = file->bytes[i];
        if (at_line && file->size - i >= sizeof word && memcmp(file->bytes + i, word, sizeof word - 1) == 0)
            return i;
        const bool mark = i < 3 && c >= 0x80; // that it is UTF-8
        at_line = c == '\n' || c == '\r' || (at_line && (c == ' ' || c == '\t' || mark));
    }
    return file->size;
}

static void on_close(struct aiFileIO *io, struct aiFile *file) {
    if (!file) return;
    open_file *f = opened(file);
    const sag_context *context = (const sag_context *)(const void *)io->UserData;
    if (f->rewritten) sag_release(context, f->rewritten, f->size);
    sagi_file_close(&f->file);
    sag_release(context, f, sizeof *f);
}

static struct aiFile *on_open(struct aiFileIO *io, const char *path, const char *mode) {
    static const char nothing[] = "# no materials\n";
    const sag_context *context = (const sag_context *)(const void *)io->UserData;
    if (strchr(mode, 'r') == NULL) return NULL;
    size_t size;
    open_file *f = sag_allocate(context, sizeof *f);
    if (!f) return NULL;
    *f = (open_file){.io = {on_read, on_write, on_tell, on_size, on_seek, on_flush, (aiUserData)f}};
    if (sagi_file_open(context, path, &f->file, NULL) != SAG_OK) {
        sag_release(context, f, sizeof *f);
        return NULL;
    }
    f->bytes = f->file.bytes, f->size = f->file.size;
    const bool utf16 = begins(&f->file, "\xff\xfe") || begins(&f->file, "\xfe\xff");
    if (strcasecmp(ending_of(path), ".mtl") == 0 && !utf16) {
        const size_t skipped = first_material(&f->file);
        f->bytes += skipped, f->size -= skipped;
        if (f->size == 0) f->bytes = (const uint8_t *)nothing, f->size = sizeof nothing - 1;
    }
    if (is_gltf(ending_of(path))) {
        if (!sagi_gltf_still(&f->file, is_binary_gltf(ending_of(path)), &f->rewritten, &size)) {
            on_close(io, &f->io);
            return NULL;
        }
        if (f->rewritten) f->bytes = f->rewritten, f->size = size;
    }
    return &f->io;
}

struct aiFileIO sagi_import_files(const sag_context *context) {
    struct aiFileIO io = {on_open, on_close, NULL};
    memcpy(&io.UserData, &context, sizeof context); // const, where the type has no room for that
    return io;
}
