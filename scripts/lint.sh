#!/bin/sh
# SPDX-License-Identifier: MIT
# Formatting, static analysis and the project's own rules: scripts/lint.sh GCC_BUILD CLANG_BUILD (both built before). Every
# check runs, whatever the others found; the exit code says whether all were content.
set -u
gcc_build=$1 clang_build=$2
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
status=0
complain() { echo "lint: $*" >&2; status=1; }
tracked() { git ls-files --cached --others --exclude-standard -- "$@"; }
newest() { command -v "$1-14" || command -v "$1"; } # version 14 where there is one: formatting differs between versions

echo "== clang-format"
tracked '*.c' '*.h' | xargs "$(newest clang-format)" --dry-run -Werror || complain "run: git ls-files '*.[ch]' | xargs clang-format -i"

echo "== clang-tidy"
# Of the compile database: everything but the tests, whose helpers provoke on purpose.
python3 - "$clang_build/compile_commands.json" "$PWD" >"$clang_build/tidy-files" <<'END'
import json, sys
root = sys.argv[2]
for entry in json.load(open(sys.argv[1])):
    path = entry["file"]
    if path.startswith(root + "/") and path[len(root) + 1:].split("/")[0] in ("src", "tools", "examples", "bench"):
        print(path)
END
sort -u "$clang_build/tidy-files" | xargs -P "$jobs" -n 4 "$(newest clang-tidy)" -p "$clang_build" --quiet --warnings-as-errors='*' \
  >"$clang_build/tidy.log" 2>&1 || { grep -v 'warnings generated' "$clang_build/tidy.log" >&2; complain "clang-tidy"; }

echo "== cppcheck"
mkdir -p "$gcc_build/cppcheck"
cppcheck --project="$gcc_build/compile_commands.json" --cppcheck-build-dir="$gcc_build/cppcheck" -j "$jobs" --quiet --inline-suppr \
  --enable=warning,performance,portability --error-exitcode=1 --suppressions-list=.cppcheck-suppressions \
  -i "$gcc_build" || complain "cppcheck"

echo "== headers"
for header in include/sagitta/*.h include/sagitta/*/*.h; do
  name=${header#include/}
  for language in "c -std=c11" "c++ -std=c++17"; do
    # shellcheck disable=SC2086 # two words are meant
    echo "#include <$name>" | gcc -fsyntax-only -Wall -Wextra -Wundef -pedantic-errors -Werror -Iinclude -x $language - ||
      complain "$header does not compile alone as ${language#*=}"
  done
  # A comment stands right before each block of declarations; a blank line ends the block.
  awk -v file="$header" '
    /^\/\/\//                { documented = 1; next }
    /^[[:space:]]*$/         { documented = 0; next }
    /^SAG_API/ && !documented { printf "lint: %s:%d: no doc comment: %s\n", file, FNR, $0; bad = 1 }
    END { exit bad }' "$header" >&2 || status=1
done

echo "== gallery"
scripts/gallery.sh --check || status=1

echo "== sources"
tracked 'src/*' 'include/*' 'docs/skeleton/*' 'tools/*' 'tests/*' 'bench/*' 'examples/*.c' 'scripts/*' 'python/*' 'cmake/*' CMakeLists.txt Makefile |
  grep -vE '\.(png|exr|pfm|jpg|ply|npy|csv|pbrt|md|json)$' >"$gcc_build/lint-files"
while read -r file; do
  [ -f "$file" ] || continue
  lines=$(wc -l <"$file")
  [ "$lines" -le 600 ] || complain "$file: $lines lines; a file is one idea, at most 600"
  grep -q 'SPDX-License-Identifier: MIT' "$file" || complain "$file: no SPDX line"
done <"$gcc_build/lint-files"
left=$(grep -v '^scripts/lint.sh$' "$gcc_build/lint-files" | xargs grep -nE '\bTODO\b|\bFIXME\b|\bXXX\b|^[[:space:]]*#[[:space:]]*if 0' 2>/dev/null)
[ -z "$left" ] || complain "left to do:
$left"

echo "== documents"
# What they quote are examples that the tests compile and run, from the first #include to the end.
quotes() { # quotes PAGE EXAMPLE
  awk '/^```c$/ { quoting = 1; next } /^```$/ { quoting = 0 } quoting' "$1" >"$gcc_build/quoted.c"
  awk '/^#include/ { quoting = 1 } quoting' "$2" | cmp -s - "$gcc_build/quoted.c" || complain "$1 does not quote $2 as it is"
}
quotes README.md examples/first_ray.c
quotes docs/solids.md examples/solid.c
# Every link between documents leads somewhere.
for page in *.md docs/*.md; do
  grep -oE '\]\([^)#]+|(src|href)="[^"#]+' "$page" | sed -E 's/^(\]\(|(src|href)=")//' | grep -v '^https*:' | while read -r link; do
    [ -e "$(dirname "$page")/$link" ] || echo "lint: $page links to $link, which is not there"
  done
done | grep . >&2 && status=1

echo "== libraries"
core=$gcc_build/libsagitta.so
foreign=$(readelf -d "$core" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -vE '^(libc|libm|libpthread|ld-linux[-a-z0-9_]*)\.so')
[ -z "$foreign" ] || complain "$core links more than libc, libm and pthreads: $foreign"
for library in "$core" "$gcc_build/libsagitta-render.so"; do
  [ -f "$library" ] || continue
  alien=$(nm -D --defined-only "$library" | awk '{ print $NF }' | grep -v '^sag_')
  [ -z "$alien" ] || complain "$library exports what is not sag_*: $alien"
done
# Nothing in the libraries prints, exits or aborts.
nm "$gcc_build/libsagitta.a" 2>/dev/null | awk '$1 == "U" { print $2 }' | sort -u |
  grep -xE 'printf|puts|putchar|exit|abort|_exit|quick_exit|perror|stdout|stderr|vprintf|__assert_fail' |
  while read -r symbol; do echo "lint: $core calls $symbol" >&2; done | grep . >&2 && status=1
# Nor do they call what no standard rounds: src/math/elementary.h has the same for every machine. (stb_image
# does in conversions that are not used.)
for library in "$gcc_build/libsagitta.a" "$gcc_build/libsagitta-render.a"; do
  nm -A "$library" 2>/dev/null | grep -v ':stb\.c\.' | awk '$(NF - 1) == "U" { print $NF }' | sort -u |
    grep -xE '(sin|cos|sincos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erf)f?' |
    while read -r symbol; do echo "lint: $library calls $symbol, whose bits differ between machines" >&2; done | grep . >&2 && status=1
done

[ "$status" = 0 ] && echo "lint: clean"
exit "$status"
