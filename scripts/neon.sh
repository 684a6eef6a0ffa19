#!/bin/sh
# SPDX-License-Identifier: MIT
# Compiles the core library and tests/cross/answers.c for 64-bit ARM with one command and no flags but those that C17 needs, and
# runs it under qemu-user: NEON and portable code give the bits that x86 gives. scripts/neon.sh [FOLDER]; exit code 77, which
# CTest takes for skipped, where the cross compiler or qemu are absent ("scripts/deps.sh cross" installs them).
set -eu
cc=${CROSS_CC:-aarch64-linux-gnu-gcc}
folder=${1:-build/neon}
emulator=${QEMU:-qemu-aarch64}
command -v "$emulator" >/dev/null || emulator=$emulator-static
for tool in "$cc" "$emulator"; do
  command -v "$tool" >/dev/null || { echo "NEON is not tested: there is no $tool."; exit 77; }
done
cd "$(dirname "$0")/.."
mkdir -p "$folder"
# One object a source, two at a time: xargs is make enough for this.
ls src/base/*.c src/math/*.c src/shapes/*.c src/solid/*.c src/bvh/*.c src/kernel/*.c src/scene/*.c src/measure/*.c |
  xargs -P "$(getconf _NPROCESSORS_ONLN)" -I '{}' sh -c '
    object="$2/$(echo "$3" | tr / _).o"
    [ -z "$(find src include -newer "$object" 2>/dev/null || echo absent)" ] ||
      "$1" -std=c17 -O2 -ffp-contract=off -D_POSIX_C_SOURCE=200809L -Wno-psabi -Iinclude -Isrc -c "$3" -o "$object"
  ' sh "$cc" "$folder" '{}'
"$cc" -std=c17 -O2 -ffp-contract=off -D_POSIX_C_SOURCE=200809L -Iinclude -Itests -static -o "$folder/answers" \
  tests/cross/answers.c "$folder"/*.o -lm -lpthread
for isa in neon portable; do
  SAG_ISA=$isa "$emulator" "$folder/answers" "$isa" || { echo "64-bit ARM ($isa) gives other answers."; exit 1; }
done
