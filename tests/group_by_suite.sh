#!/usr/bin/env bash
# group_by_suite.sh PROGRAM LIST [LEFT_OUT]: writes the LIST of a program's tests for ctest, up to eight of a suite in one
# process, because a process takes a tenth of a second to begin, a quarter under sanitizers. Tests whose names match a
# pattern (grep -E) of the file LEFT_OUT are not in it.
set -euo pipefail
patterns=$(grep -v '^#' "${3-/dev/null}" || true)
"$1" --gtest_list_tests | awk '/^[^ ]/ {suite = $1} /^ / {print suite $1}' | grep -vE "${patterns:-^$}" |
  awk -F. -v program="$1" '
    function write_group() {
      if (!n) return
      printf "add_test([=[%s.%d]=] [=[%s]=] [=[--gtest_filter=%s]=])\n", suite, group, program, names
      printf "set_tests_properties([=[%s.%d]=] PROPERTIES TIMEOUT 1800)\n", suite, group
      names = ""
      n = 0
    }
    $1 != suite || n == 8 {
      write_group()
      group = $1 == suite ? group + 1 : 1
      suite = $1
    }
    {names = names (n++ ? ":" : "") $0}
    END {write_group()}' >"$2"
