#!/bin/sh
# Runs one suite on the Cortex-M3 in QEMU and writes its report for count_tests.py:
#
#   tests/boards/run_suite_arm.sh PROGRAM RESULT.log
set -eu

program=$1 log=$2

mkdir -p "$(dirname "$log")"
status=0
timeout 300 .venv/bin/python -m tests.boards.qemu_suite "$program" >"$log" 2>&1 || status=$?
echo "exit status $status" >>"$log"
printf '%-40s %s\n' "cortex_m3 $(basename "$program")" \
    "$(grep -aE '^[0-9]+ Tests ' "$log" || tail -n 1 "$log")"
