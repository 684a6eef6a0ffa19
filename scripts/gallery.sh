#!/bin/sh
# SPDX-License-Identifier: MIT
# Renders README's pictures: each examples/gallery/*.pbrt to docs/images/gallery, and the showcase. Takes some minutes.
# Usage: scripts/gallery.sh [path of the program, default build/release/sagitta]
set -eu
cd "$(dirname "$0")/.."
sagitta=${1:-build/release/sagitta}
mkdir -p docs/images/gallery
for scene in examples/gallery/*.pbrt; do
    name=$(basename "$scene" .pbrt)
    [ "$name" = stage ] && continue
    "$sagitta" render "$scene" -o "docs/images/gallery/$name.png" --quiet
done
"$sagitta" render examples/showcase.pbrt -o docs/images/showcase.png --quiet
