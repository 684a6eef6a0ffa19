#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs every CTest test of the given build folders and ends with one line that counts, from CTest's own record:
#     N passed, N failed[, N skipped]
# Exit code 0 only when something ran and nothing failed.
set -u
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
passed=0 failed=0 skipped=0 broken=0
for folder in "$@"; do
  record=$folder/test-results.xml
  rm -f "$record"
  ctest --test-dir "$folder" -j "$jobs" --output-on-failure --output-junit "$PWD/$record" || broken=1
  if [ ! -s "$record" ]; then
    echo "$folder: ctest left no record" >&2
    broken=1 failed=$((failed + 1))
    continue
  fi
  counts=$(awk '
    /<testcase / { if (/status="run"/) ran++; else if (/status="fail"/) bad++; else if (/status="notrun"|status="disabled"/) left++ }
    END { printf "%d %d %d", ran, bad, left }' "$record")
  # shellcheck disable=SC2086 # three words are meant
  set_counts() { passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3)); }
  set_counts $counts
done
[ "$skipped" = 0 ] || echo "Skipped tests say why in LastTest.log (data beside the project that is absent, mostly)."
line="$passed passed, $failed failed"
[ "$skipped" = 0 ] || line="$line, $skipped skipped"
echo "$line"
[ "$broken" = 0 ] && [ "$failed" = 0 ] && [ "$passed" -gt 0 ]
