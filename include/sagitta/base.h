// SPDX-License-Identifier: MIT
/// @file base.h
/// Status codes and errors, the allocator, and the context: everything other libraries keep global.
#ifndef SAGITTA_BASE_H
#define SAGITTA_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(SAG_SHARED)
#ifdef SAG_BUILD
#define SAG_API __declspec(dllexport)
#else
#define SAG_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define SAG_API __attribute__((visibility("default")))
#else
#define SAG_API
#endif

#if defined(__GNUC__)
#define SAG_PRINTF(format_index, first_argument) __attribute__((format(printf, format_index, first_argument)))
#else
#define SAG_PRINTF(format_index, first_argument)
#endif

#define SAG_VERSION_MAJOR 0
#define SAG_VERSION_MINOR 1
#define SAG_VERSION_PATCH 0
#define SAG_VERSION       "0.1.0"

#ifdef __cplusplus
extern "C" {
#endif

/// What a call that can fail returns. Ray queries cannot fail and do not return one.
typedef enum sag_status {
    SAG_OK = 0,
    SAG_ERROR_ARGUMENT,  ///< a parameter is out of its documented range
    SAG_ERROR_GEOMETRY,  ///< a shape is not what it must be: NaN, negative radius, open polygon, index out of
                         ///< range
    SAG_ERROR_MEMORY,    ///< the allocator returned NULL; nothing was changed
    SAG_ERROR_IO,        ///< a file could not be opened, read, written or renamed
    SAG_ERROR_FORMAT,    ///< a file's content is malformed; file, line and column say where
    SAG_ERROR_STATE,     ///< the call needs a committed scene, or one that is not in use
    SAG_ERROR_CANCELLED, ///< the caller's callback asked to stop
} sag_status;

/// Why a call failed and where. Filled only on failure; the caller may pass NULL where an error is asked for.
/// `message` and `file` always end in a zero byte; `line` and `column` count from 1, 0 means unknown.
typedef struct sag_error {
    sag_status status;
    int line;
    int column;
    char message[512];
    char file[512];
} sag_error;

/// A short name of a status ("out of memory"), never NULL. Thread-safe; the string is static.
SAG_API const char *sag_status_name(sag_status status);

/// Fills *error (when not NULL) with a status and a printf-style message, place unknown. Returns `status`, so
/// that `return sag_error_set(error, SAG_ERROR_ARGUMENT, "…")` is one line. Messages over 511 bytes are cut.
/// Thread-safe.
SAG_API sag_status sag_error_set(sag_error *error, sag_status status, const char *format, ...)
    SAG_PRINTF(3, 4);

/// Like sag_error_set, with the place in a file. `file` may be NULL; `line` and `column` 0 mean unknown.
SAG_API sag_status sag_error_set_at(sag_error *error, sag_status status, const char *file, int line,
                                    int column, const char *format, ...) SAG_PRINTF(6, 7);

/// Where all memory comes from. Zero-initialised: libc's. `allocate` gets a size > 0 and a power-of-two
/// alignment and returns NULL when it cannot; `release` gets the pointer and the very size and alignment it
/// was allocated with. Both are called from any thread.
typedef struct sag_allocator {
    void *user;
    void *(*allocate)(void *user, size_t size_bytes, size_t alignment_bytes);
    void (*release)(void *user, void *memory, size_t size_bytes, size_t alignment_bytes);
} sag_allocator;

/// The caller's own scheduler, in place of the context's threads. `run` calls `task(argument, i)` once for
/// each i in [0, count), on any threads, in any order, and returns when all are done. Their stacks should
/// have 512 KiB or more: a batch takes 40, and each level of instances 10, or 20 where it shows a solid.
/// Zero-initialised: the context's pool.
typedef struct sag_executor {
    void *user;
    uint32_t thread_count; ///< how many run at once, for sizing the pieces; 0 counts as 1
    void (*run)(void *user, void (*task)(void *argument, size_t index), void *argument, size_t count);
} sag_executor;

typedef enum sag_log_level { SAG_LOG_INFO, SAG_LOG_WARNING, SAG_LOG_ERROR } sag_log_level;

/// Gets every message of the library; the library itself never prints. Called from any thread, one call at a
/// time.
typedef void (*sag_log_callback)(void *user, sag_log_level level, const char *message);

/// How to make a context. Zero-initialised: libc's malloc, a thread a core, the best instruction set, no log.
typedef struct sag_context_options {
    sag_allocator allocator;
    sag_executor executor;
    uint32_t
        thread_count; ///< 0: as many as the process may use (its affinity mask); ignored with an executor
    const char *isa;  ///< NULL: the environment's SAG_ISA, or else the best; see sag_context_isa
    sag_log_callback log;
    void *log_user;
} sag_context_options;

/// Everything others keep global: allocator, threads, instruction set, log. Two contexts never meet.
typedef struct sag_context sag_context;

/// Makes a context; `options` may be NULL (the defaults). NULL when memory or threads are not to be had or
/// `isa` (or the environment's SAG_ISA) names no instruction set that this machine and this library have.
/// Threads start at the first parallel call, not here.
SAG_API sag_context *sag_context_create(const sag_context_options *options);

/// Stops the threads and frees the context. Everything made from it must be gone. NULL does nothing.
SAG_API void sag_context_destroy(sag_context *context);

/// How many threads a parallel call uses, the calling one included; at least 1.
SAG_API uint32_t sag_context_thread_count(const sag_context *context);

/// The instruction set whose kernels are in use: "portable", "sse42", "avx2", "avx512" or "neon".
SAG_API const char *sag_context_isa(const sag_context *context);

/// Bytes now held from the allocator on behalf of this context, and the most ever held at once. Either may be
/// NULL.
SAG_API void sag_context_memory(const sag_context *context, size_t *bytes, size_t *peak_bytes);

/// Sends a printf-style message to the context's log callback; without one nothing happens. Thread-safe.
SAG_API void sag_context_log(const sag_context *context, sag_log_level level, const char *format, ...)
    SAG_PRINTF(3, 4);

/// Calls `task(argument, i)` once for each i in [0, count) on the context's threads (or executor) and returns
/// when all are done. Order and thread are not defined, so a task's result must not depend on them. A call
/// made inside a task runs its tasks on the calling thread. After fork (outside of a task) the child may go
/// on using the context: its first parallel call, made by one thread, starts threads of its own.
/// (tests/unit/test_context.c)
SAG_API void sag_parallel_for(const sag_context *context, size_t count,
                              void (*task)(void *argument, size_t index), void *argument);

/// Allocates from the context's allocator, aligned to 64 bytes; NULL when size_bytes is 0 or there is none
/// left.
SAG_API void *sag_allocate(const sag_context *context, size_t size_bytes);

/// Gives back what sag_allocate gave, with the same size. NULL does nothing.
SAG_API void sag_release(const sag_context *context, void *memory, size_t size_bytes);

#ifdef __cplusplus
}
#endif
#endif
