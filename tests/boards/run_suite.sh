#!/bin/sh
# Runs one suite on a board and writes its report for count_tests.py:
#
#   tests/boards/run_suite.sh BOARD PROGRAM RESULT.log COMMAND…
#
# COMMAND takes the program as its last argument; its exit status is that of the suite.
set -eu

board=$1 program=$2 log=$3
shift 3

mkdir -p "$(dirname "$log")"
status=0
timeout 300 "$@" "$program" >"$log" 2>&1 || status=$?
echo "exit status $status" >>"$log"
printf '%-40s %s\n' "$board $(basename "$program")" \
    "$(grep -aE '^[0-9]+ Tests ' "$log" || tail -n 1 "$log")"
