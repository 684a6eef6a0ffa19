#!/bin/sh
# SPDX-License-Identifier: MIT
# Renders the pictures of README.md and docs: each examples/gallery/*.pbrt to docs/images/gallery, examples/solids/*.pbrt to
# docs/images/solids, and the showcase. Takes some minutes.
# Usage: scripts/gallery.sh [path of the program, default build/release/sagitta]
set -eu
cd "$(dirname "$0")/.."
sagitta=${1:-build/release/sagitta}
for folder in gallery solids; do
    mkdir -p "docs/images/$folder"
    for scene in examples/$folder/*.pbrt; do
        name=$(basename "$scene" .pbrt)
        case $name in stage | studio) continue ;; esac # what the scenes of a folder share
        "$sagitta" render "$scene" -o "docs/images/$folder/$name.png" --quiet
    done
done
"$sagitta" render examples/showcase.pbrt -o docs/images/showcase.png --quiet
