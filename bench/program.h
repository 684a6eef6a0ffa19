// SPDX-License-Identifier: MIT
// Another program as a peer, found along PATH; its output and errors go to the file `log`. True: it ended
// with 0. *peak_bytes, unless NULL: the most memory it had, as the system counts it.
#ifndef BENCH_PROGRAM_H
#define BENCH_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

bool program_run(char *const arguments[], const char *log, size_t *peak_bytes);

#endif
