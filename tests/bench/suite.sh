#!/bin/sh
# The suite of the rig, run as root where devices.sh has made its devices: contract suites on the
# Linux port, the tests of programs, latencies. Outcomes go to BENCH_OUT, arguments NAME=VALUE into
# the environment.
set -u

for setting in "$@"; do
    export "${setting?}"
done

status=0
tests/bench/run_contract.sh "$BENCH_OUT" || status=1
.venv/bin/python -m pytest -c scripts/pyproject.toml --rootdir=. -p no:cacheprovider \
    -p tests.bench.fixtures --quiet --color=no --tb=short --durations=5 -rP \
    --junitxml="$BENCH_OUT/pytest.xml" tests/bench || status=1
if [ "${BENCH_ROUNDS:-3}" -gt 0 ]; then
    .venv/bin/python -m tests.bench.latency || status=1
fi
exit "$status"
