// SPDX-License-Identifier: MIT
// with_isa NAME PROGRAM …: runs a program with SAG_ISA=NAME. Exits with 77, which CTest takes for skipped,
// where the machine has no such instruction set.
#include "base/cpu.h"
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int main(int argc, char **argv) {
    sagi_isa isa;
    if (argc < 3) return 2;
    if (!sagi_isa_choose(argv[1], &isa)) {
        printf("this machine has no %s\n", argv[1]);
        return 77;
    }
    if (setenv("SAG_ISA", argv[1], 1) != 0) return 1;
    execv(argv[2], argv + 2);
    perror(argv[2]);
    return 1;
}
