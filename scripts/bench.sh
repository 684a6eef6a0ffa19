#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs the benchmarks of a build: the generated model, and the meshes beside the project where they are (SAGITTA_DATA).
set -eu
data=${SAGITTA_DATA:-../shared}
set -- "$1"
for mesh in stanford-bunny.obj nefertiti.obj dragon.ply; do
  found=$(find "$data/meshes" -name "$mesh" 2>/dev/null | head -n 1)
  [ -z "$found" ] || set -- "$@" "$found"
done
build=$1
shift
"$build/bench_trace"
[ $# -eq 0 ] || "$build/bench_trace" "$@"
