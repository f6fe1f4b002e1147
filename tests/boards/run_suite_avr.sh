#!/bin/sh
# Runs one suite on an AVR in simavr and writes its report for count_tests.py:
#
#   tests/boards/run_suite_avr.sh MCU PROGRAM RESULT.log
#
# What cannot run there is skipped and says so: RESULT.check takes the place of RESULT.log.
set -eu

mcu=$1 program=$2 log=$3
suite=$(basename "$program")
skip() {
    rm -f "$log"
    echo "SKIPPED: $mcu $suite: $*" | tee "${log%.log}.check"
    exit 0
}

mkdir -p "$(dirname "$log")"
case $suite in
test_overtravel) skip "it holds the sums to 64 bits, and avr-gcc's double has 32" ;;
esac
status=0
timeout 300 build/host/avr_test_run "$mcu" "$program" >"$log" 2>&1 || status=$?
echo "exit status $status" >>"$log"
printf '%-40s %s\n' "$mcu $suite" "$(grep -aE '^[0-9]+ Tests ' "$log" || tail -n 1 "$log")"
