// SPDX-License-Identifier: MIT
// The program: picks the subcommand.
#include "tool.h"

#include <locale.h>
#include <string.h>
#include <unistd.h>

#define COMMAND_COUNT 4
static const tool_command *const commands[COMMAND_COUNT] = {&tool_render, &tool_cast, &tool_measure,
                                                            &tool_info};

static int print_help(FILE *file) {
    fputs("Sagitta " SAG_VERSION ": what does this ray hit?\n\n"
          "usage: sagitta COMMAND [OPTIONS] [FILE]\n\n",
          file);
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        fprintf(file, "  %-8s %s\n", commands[i]->name, commands[i]->summary);
    fputs(
        "\nFILE is a pbrt-v4 scene (.pbrt) or any mesh Assimp reads (.obj .ply .stl .gltf .glb .fbx ...).\n\n"
        "  sagitta render dragon.ply -o dragon.png\n"
        "  sagitta cast bunny.obj --rays rays.csv -o hits.csv\n"
        "  sagitta measure part.stl\n"
        "  sagitta info scene.pbrt\n\n"
        "'sagitta COMMAND --help' says more of each; 'sagitta --version' prints the version.\n"
        "Exit code: 0 fine, 1 failed, 2 bad usage.\n",
        file);
    return file == stdout ? close_stdout() : TOOL_USAGE;
}

static const tool_command *find_command(const char *name) {
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(commands[i]->name, name) == 0) return commands[i];
    }
    return NULL;
}

static int unknown_command(const char *name) {
    const char *names[COMMAND_COUNT + 2] = {"help"};
    for (size_t i = 0; i < COMMAND_COUNT; i++) names[i + 1] = commands[i]->name;
    if (name[0] == '-') return usage_error(NULL, "unknown option '%s'", name);
    if (strchr(name, '.') || access(name, F_OK) == 0) {
        return usage_error(NULL, "'%s' is no command; to make a picture of it: sagitta render %s", name,
                           name);
    }
    const char *near = nearest_word(name, names);
    return near ? usage_error(NULL, "unknown command '%s'; did you mean '%s'?", name, near)
                : usage_error(NULL, "unknown command '%s'", name);
}

int main(int argc, char **argv) {
    setlocale(LC_CTYPE, "");  // for the progress bar; numbers keep the C locale's point
    signal(SIGPIPE, SIG_IGN); // a closed pipe is a failed write, with a message
    if (argc < 2) return print_help(stderr);
    const char *name = argv[1];
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        printf("sagitta " SAG_VERSION "\n");
        return close_stdout();
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return print_help(stdout);
    if (strcmp(name, "help") == 0) {
        if (argc < 3) return print_help(stdout);
        const tool_command *asked = find_command(argv[2]);
        if (!asked) return unknown_command(argv[2]);
        fputs(asked->help, stdout);
        return close_stdout();
    }
    const tool_command *command = find_command(name);
    return command ? command->run(command, argc - 2, argv + 2) : unknown_command(name);
}
