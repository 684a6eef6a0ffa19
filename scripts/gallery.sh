#!/bin/sh
# SPDX-License-Identifier: MIT
# The pictures of README.md and docs, and the scene lines that docs/gallery quotes.
#
# Usage: scripts/gallery.sh [--program PROGRAM] [--quote | --check | NAME…]
#   without more   renders all: examples/gallery and examples/solids to docs/images, and the showcase. Takes an hour on two cores
#   NAME…          renders these, such as gallery/materials/metals or gallery/lights
#   --quote        writes captions and scene lines anew into docs/gallery/*.md, between <!-- NAME… --> and <!-- end -->
#   --check        says whether they are up to date
# A scene's first comment is its caption; "# $ --option" in it are options it is rendered with; "# ..." begins and ends what is not
# quoted. Files that other scenes include have no caption for themselves and are in stages/ or named below.
set -eu
cd "$(dirname "$0")/.."
sagitta=build/release/sagitta
[ "${1-}" = --program ] && { sagitta=$2; shift 2; }

is_part() {
    case $1 in */stages/* | */stage | */studio | */soft | */edges | */hall | */room_lit | */prism | */caustic) return 0 ;; esac
    return 1
}

render() { # of a name without ending, such as gallery/materials/metals
    scene=examples/$1.pbrt
    [ -f "$scene" ] || { [ -f "examples/$1.gltf" ] && scene=examples/$1.gltf; } || scene=examples/$1.obj
    case $1 in
    */models/*) options="--size 900x450 --crop 480x210+225+125 --spp 40" ;;
    *) options=$(sed -n 's/^# \$ //p' "$scene") ;;
    esac
    mkdir -p "docs/images/$(dirname "$1")"
    # shellcheck disable=SC2086 # options are several words
    "$sagitta" render "$scene" $options -o "docs/images/$1.png" --quiet
}

# What a scene shows, as Markdown (as=page) or as a row of a table (as=row).
show() {
    awk -v name="$1" -v as="$2" '
        function escaped(s) { gsub(/&/, "\\&amp;", s); gsub(/</, "\\&lt;", s); gsub(/>/, "\\&gt;", s); return s }
        function coded(s) { while (match(s, /`[^`]*`/)) # for HTML
            s = substr(s, 1, RSTART - 1) "<code>" substr(s, RSTART + 1, RLENGTH - 2) "</code>" substr(s, RSTART + RLENGTH)
            return s }
        !body && /^# \$ / { lines = lines "sagitta render " name ".pbrt " substr($0, 5) "\n"; next }
        !body && /^# / && !/^# \.\.\.$/ { caption = caption (caption == "" ? "" : " ") substr($0, 3); next }
        { body = 1 }
        /^# \.\.\.$/ { if (!hidden) lines = lines "# ...\n"; hidden = !hidden; next }
        hidden || /^(Sampler|Include|PixelFilter|Scale -1 1 1$|WorldBegin)/ { next }
        /^CoordSysTransform "[1-5]" (Rotate 90 0 0 1 )?Shape "sphere"$/ { next } # said once, on the page
        /^Integrator/ && name !~ /^integrators/ { next }
        /^Film "rgb" "integer xresolution" 240 "integer yresolution" 176( "float maxcomponentvalue" 3)?$/ { next }
        { lines = lines $0 "\n" }
        END {
            sub(/(# \.\.\.\n)+$/, "", lines)
            picture = "../images/gallery/" name ".png"
            scene = "../../examples/gallery/" name ".pbrt"
            if (as == "row") {
                printf "<tr><td><a href=\"%s\"><img src=\"%s\" alt=\"%s\"></a></td>\n", scene, picture, name
                printf "<td>%s\n<pre>\n%s</pre></td></tr>\n", coded(escaped(caption)), escaped(lines)
            } else {
                printf "[![%s](%s)](%s)\n\n%s.\n", name, picture, scene, caption
                if (lines != "") printf "\n```\n%s```\n", lines
            }
        }' "examples/gallery/$1.pbrt"
}

quoted() { # a page with its blocks written anew
    inside=
    while IFS= read -r line; do
        case $line in
        "<!-- end -->") inside= ;;
        "<!-- "*" -->")
            printf '%s\n' "$line"
            names=${line#<!-- }
            names=${names% -->}
            inside=yes
            case $names in
            *" "*)
                echo "<table>"
                for name in $names; do show "$name" row; done
                echo "</table>"
                ;;
            *) show "$names" page ;;
            esac
            ;;
        esac
        [ -n "$inside" ] || printf '%s\n' "$line"
    done <"$1"
}

case ${1-} in
--quote)
    for page in docs/gallery/*.md; do
        quoted "$page" >"$page.new"
        mv "$page.new" "$page"
    done
    exit
    ;;
--check)
    status=0
    for page in docs/gallery/*.md; do
        quoted "$page" | cmp -s - "$page" || { echo "$page: does not quote its scenes as they are: scripts/gallery.sh --quote" >&2; status=1; }
    done
    exit $status
    ;;
esac

for w; do
    ls "examples/$w".* >/dev/null 2>&1 || [ -d "examples/$w" ] || { echo "gallery.sh: no examples/$w" >&2; exit 2; }
done
# Sheets are put together from pictures, so they come after all others.
find examples/gallery examples/solids -name '*.pbrt' -o -path '*/models/*.gltf' -o -path '*/models/*.obj' | LC_ALL=C sort |
    sed 's|^examples/||; s|\.[a-z]*$||' | awk '/\/sheets\// { last = last $0 "\n"; next } { print } END { printf "%s", last }' |
    while read -r name; do
        is_part "$name" && continue
        if [ $# -gt 0 ]; then
            wanted=
            for w; do case $name in "$w" | "$w"/*) wanted=yes ;; esac; done
            [ -n "$wanted" ] || continue
        fi
        render "$name"
    done
if [ $# = 0 ]; then "$sagitta" render examples/showcase.pbrt -o docs/images/showcase.png --quiet; fi
