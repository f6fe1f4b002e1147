#!/bin/sh
# Runs the suite of the rig and copies its outcomes to where they are counted:
#
#   tests/bench/run_suite.sh vm|host RESULTS
#
# Environment: BENCH_TRIGGERS, BENCH_PERIOD_US, BENCH_ROUNDS (0: no latencies), see docs/BENCH.md.
# Ends with 77, and a last line that says why, where there is nothing to run it on.
set -eu

machine=$1
results=$2
project=$(cd "$(dirname "$0")/../.." && pwd)
cd "$project"

out=$project/build/bench-$machine
rm -rf "$out"
mkdir -p "$out"
export BENCH_OUT="$out"

skip() {
    echo "$*"
    exit 77
}

run_in_vm() {
    status=0
    scripts/setup/vm.sh || status=$?
    [ "$status" -eq 0 ] || exit "$status"
    tests/bench/run_vm.sh tests/bench/suite.sh "BENCH_TRIGGERS=${BENCH_TRIGGERS:-100000}" \
        "BENCH_PERIOD_US=${BENCH_PERIOD_US:-500}" "BENCH_ROUNDS=${BENCH_ROUNDS:-3}" >"$out/log" 2>&1
}

run_on_host() {
    [ "$(id -u)" -eq 0 ] || skip "only root may make vcan and gpio-sim: sudo make bench-host"
    modprobe --all vcan gpio-sim 2>/dev/null || true
    # shellcheck source=tests/bench/devices.sh
    (. tests/bench/devices.sh) >"$out/log" 2>&1 ||
        skip "no vcan or gpio-sim in this kernel: modprobe vcan gpio-sim, or make bench-vm"
    scripts/setup/system.sh rig
    sh -c '. tests/bench/devices.sh && . tests/bench/suite.sh' >"$out/log" 2>&1
}

status=0
if [ "$machine" = vm ]; then run_in_vm || status=$?; else run_on_host || status=$?; fi
cp "$out"/*.log "$out"/*.xml "$out"/*.check "$results" 2>/dev/null || true
# Under make, what a check prints is shown only if it failed.
tee "$results/bench.txt" <"$out/log"
exit "$status"
