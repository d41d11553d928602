#!/usr/bin/env bash
# by_suite.sh PROGRAM PATTERN: runs the tests of PROGRAM whose names do not match PATTERN (grep -E), up to eight of a suite in one
# process, because an instrumented program takes a quarter of a second to begin.
set -euo pipefail
export program=$1 OMP_WAIT_POLICY=passive  # tests run side by side: threads that wait should sleep
run() {
  local output
  if ! output=$(timeout 1800 "$program" --gtest_brief=1 --gtest_filter="$1" 2>&1); then
    echo "$output"
    echo "failed: $program --gtest_filter='$1'"
    return 1
  fi
}
export -f run
names=$("$program" --gtest_list_tests | awk '/^[^ ]/ {suite = $1} /^ / {print suite $1}' | grep -vE "$2")
awk -F. '{n[$1]++; if (n[$1] > 8) {print group[$1]; n[$1] = 1; group[$1] = ""} group[$1] = group[$1] (n[$1] > 1 ? ":" : "") $0}
  END {for (suite in group) print group[suite]}' <<<"$names" | xargs -P "$(nproc)" -d '\n' -I{} bash -c 'run "{}"'
echo "passed: $(wc -l <<<"$names") tests"
