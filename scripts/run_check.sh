#!/bin/sh
# Runs one check and writes its outcome for count_tests.py:
#
#   scripts/run_check.sh RESULT_FILE NAME COMMAND...
#
# Always succeeds; the outcome stands in the file. A command that exits with 77 was skipped, and the
# last line it printed says why.
set -u

result=$1
name=$2
shift 2

mkdir -p "$(dirname "$result")"
output=$result.out
"$@" >"$output" 2>&1 </dev/null
status=$?

case $status in
0)
    outcome="PASS: $name"
    ;;
77)
    outcome="SKIPPED: $name: $(tail -n 1 "$output")"
    ;;
*)
    cat "$output"
    outcome="FAIL: $name"
    ;;
esac
echo "$outcome" | tee "$result"
