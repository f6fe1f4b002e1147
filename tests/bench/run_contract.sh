#!/bin/sh
# Runs the contract suites on the Linux port, where gpio-sim and vcan are (see devices.sh):
#
#   tests/bench/run_contract.sh OUT
#
# Writes OUT/test_….log of each in the form that count_tests.py reads. Exits with 1 if any of them
# failed, with 77 where the devices are not.
set -u

out=$1
if [ -z "${BENCH_CHIP:-}" ]; then
    echo 'no gpio-sim and vcan here: make bench-vm'
    exit 77
fi
status=0
mkdir -p "$out"
for suite in build/host/contract-linux/test_*; do
    case $suite in *'*') echo "no suites: make contract-linux-programs" >&2 && exit 2 ;; esac
    log=$out/$(basename "$suite").log
    timeout 300 "$suite" >"$log" 2>&1
    echo "exit status $?" >>"$log"
    grep -q '^exit status 0$' "$log" || status=1
    printf '%-28s %s\n' "$(basename "$suite")" "$(grep -E '^[0-9]+ Tests ' "$log" || tail -n 1 "$log")"
    grep -E ':(FAIL|IGNORE)' "$log"
done
exit $status
