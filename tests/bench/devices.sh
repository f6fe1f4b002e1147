# The devices of the bench on gpio-sim and vcan, made anew: vcan0 up, and a chip of eight lines named
# "bench". Sourced by a shell that is root; sets
#
#   BENCH_CAN        vcan0
#   BENCH_CHIP       /dev/gpiochipN
#   BENCH_PULLS      folder with sim_gpioK/pull and sim_gpioK/value of line K
#   BENCH_CONFIG     folder of the chip in configfs, with `live`
#
# With BENCH_BIT_RATE (bit/s) in the environment vcan0 takes as long for its frames as a bus of that
# rate, and queues them; needs tc, sch_tbf, and vcan loaded with echo=1.
# shellcheck shell=sh

if command -v ip >/dev/null; then ip=ip; else ip='busybox ip'; fi

make_can() {
    BENCH_CAN=${BENCH_CAN:-vcan0}
    [ -e "/sys/class/net/$BENCH_CAN" ] || $ip link add dev "$BENCH_CAN" type vcan || return
    $ip link set "$BENCH_CAN" up || return
    [ -z "${BENCH_BIT_RATE:-}" ] || limit_can
}

# The kernel counts a classic frame as 16 bytes, and 128 bits are what one of eight bytes takes on a
# bus (111 and stuffing). Room for two frames at once, as a controller has, and 256 in the queue.
limit_can() {
    [ "$(cat /sys/module/vcan/parameters/echo)" = Y ] ||
        { echo "devices: BENCH_BIT_RATE needs: modprobe -r vcan; modprobe vcan echo=1" >&2; return 1; }
    tc qdisc replace dev "$BENCH_CAN" root tbf rate "${BENCH_BIT_RATE}bit" burst 32 limit 4096
}

make_chip() {
    BENCH_CONFIG=/sys/kernel/config/gpio-sim/${BENCH_NAME:-skiplatch}
    if [ ! -d "$BENCH_CONFIG" ]; then
        mkdir -p "$BENCH_CONFIG/bank0" || return
        echo 8 >"$BENCH_CONFIG/bank0/num_lines"
        echo bench >"$BENCH_CONFIG/bank0/label"
        for line in 0 1 2 3 4 5 6 7; do
            mkdir "$BENCH_CONFIG/bank0/line$line"
            echo "bench-$line" >"$BENCH_CONFIG/bank0/line$line/name"
        done
    fi
    [ "$(cat "$BENCH_CONFIG/live")" = 1 ] || echo 1 >"$BENCH_CONFIG/live" || return
    chip=$(cat "$BENCH_CONFIG/bank0/chip_name")
    BENCH_CHIP=/dev/$chip
    BENCH_PULLS=/sys/devices/platform/$(cat "$BENCH_CONFIG/dev_name")/$chip
}

make_can && make_chip && export BENCH_CAN BENCH_CHIP BENCH_PULLS BENCH_CONFIG
