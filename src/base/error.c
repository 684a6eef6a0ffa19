// SPDX-License-Identifier: MIT
// Status codes and error messages.
#include <sagitta/base.h>
#include <stdarg.h>
#include <stdio.h>

const char *sag_status_name(sag_status status) {
    switch (status) {
    case SAG_OK: return "ok";
    case SAG_ERROR_ARGUMENT: return "bad argument";
    case SAG_ERROR_GEOMETRY: return "bad geometry";
    case SAG_ERROR_MEMORY: return "out of memory";
    case SAG_ERROR_IO: return "input/output failed";
    case SAG_ERROR_FORMAT: return "malformed file";
    case SAG_ERROR_STATE: return "not possible in this state";
    case SAG_ERROR_CANCELLED: return "cancelled";
    }
    return "unknown status";
}

// The arguments may point into *error (a message that quotes an earlier one), so everything is put together
// aside first.
static sag_status fill(sag_error *error, sag_status status, const char *file, int line, int column,
                       const char *format, va_list arguments) {
    sag_error e = {.status = status, .line = line, .column = column};
    if (vsnprintf(e.message, sizeof e.message, format, arguments) < 0) e.message[0] = 0;
    if (file != NULL) snprintf(e.file, sizeof e.file, "%s", file);
    *error = e;
    return status;
}

sag_status sag_error_set(sag_error *error, sag_status status, const char *format, ...) {
    if (error == NULL) return status;
    va_list arguments;
    va_start(arguments, format);
    fill(error, status, NULL, 0, 0, format, arguments);
    va_end(arguments);
    return status;
}

sag_status sag_error_set_at(sag_error *error, sag_status status, const char *file, int line, int column,
                            const char *format, ...) {
    if (error == NULL) return status;
    va_list arguments;
    va_start(arguments, format);
    fill(error, status, file, line, column, format, arguments);
    va_end(arguments);
    return status;
}
