#!/bin/sh
# Records the campaigns of docs/BENCH.md, as root where devices.sh has made its devices:
#
#   BENCH_OUT=build/recorded tests/bench/run_vm.sh tests/bench/record.sh [NAME=VALUE...]
#
# First a quiet campaign to believe the bench from, then with that belief the plans nominal, cpu_load,
# bus_load and debounce. All of them on a bus of BENCH_BIT_RATE (500000) bit/s. TOUCHES, if given, goes
# in place of the plans' touches, PLANS in place of the four; a BENCH_OUT/believed.toml that is there
# is believed. Writes BENCH_OUT/believed.toml and BENCH_OUT/NAME/.
set -eu

for setting in "$@"; do
    export "${setting?}"
done
export BENCH_BIT_RATE="${BENCH_BIT_RATE:-500000}"
# shellcheck source=tests/bench/devices.sh
. tests/bench/devices.sh

plans=$(mktemp -d)
cp scripts/samples/plans/*.toml "$plans"
[ -z "${TOUCHES:-}" ] || sed -i "s/^touches = .*/touches = $TOUCHES/" "$plans"/*.toml

# record PLAN NAME SEED BELIEF
record() {
    .venv/bin/skiplatch bench run "$plans/$1.toml" --out "$BENCH_OUT/$2" --json "$BENCH_OUT/$2.json" \
        --seed "$3" --nominal "$4" --can "$BENCH_CAN" --chip "$BENCH_CHIP" --line 0 \
        --sim-pull "$BENCH_PULLS/sim_gpio0/pull" --cpu 0 --fifo 70 --injector-fifo 95
}

if [ ! -f "$BENCH_OUT/believed.toml" ]; then
    record nominal quiet 1 "$plans/believed.toml"
    .venv/bin/skiplatch bench believe "$BENCH_OUT/quiet" --out "$BENCH_OUT/believed.toml" \
        --json "$BENCH_OUT/believed.json"
fi
seed=2
for plan in ${PLANS:-nominal cpu_load bus_load debounce}; do
    record "$plan" "$plan" "$seed" "$BENCH_OUT/believed.toml"
    seed=$((seed + 1))
done
