// SPDX-License-Identifier: MIT
// Runs another program: a peer that is measured as its users run it.
#define _DEFAULT_SOURCE // wait4
#include "program.h"
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

bool program_run(char *const arguments[], const char *log, size_t *peak_bytes) {
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0) return false;
    pid_t child = 0;
    int status = 0;
    struct rusage used = {0};
    bool good = posix_spawn_file_actions_addopen(&actions, 1, log, O_WRONLY | O_CREAT | O_TRUNC, 0644) == 0 &&
                posix_spawn_file_actions_adddup2(&actions, 1, 2) == 0 &&
                posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    good = good && wait4(child, &status, 0, &used) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (peak_bytes != NULL) *peak_bytes = (size_t)used.ru_maxrss * 1024;
    return good;
}
