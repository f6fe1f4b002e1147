#!/bin/busybox sh
# shellcheck shell=dash
# The first process of the virtual machine: makes the host's files, vcan0 and a gpio-sim chip ready,
# runs the script that run_vm.sh put into the share, writes its status there and switches off.
/bin/busybox mkdir -p /sbin /usr/bin /usr/sbin /proc /sys /dev /host /job
/bin/busybox --install -s
export PATH=/sbin:/usr/sbin:/bin:/usr/bin

mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
# Plain bytes, no carriage returns, to whoever reads the second console.
stty -F /dev/ttyS1 raw

# With echo, a frame comes back to those who listen here when the device has sent it, as from a real
# controller, not when it is queued.
while read -r module; do
    options=
    [ "$module" != vcan ] || options=echo=1
    # shellcheck disable=SC2086
    insmod "/modules/$module.ko" $options || echo "guest: no module $module" >/dev/ttyS1
done </modules/order

# The kernel may keep what it has read of files that nobody changes, but not of the shares.
share() {
    mount -t 9p -o "trans=virtio,version=9p2000.L,msize=262144,$3" "$1" "$2"
}
share host /host ro,cache=loose
share job /job cache=none
project=$(cat /job/project)
out=$(cat /job/out)

# The project may lie under /tmp, so it is shared by itself and laid over the empty one.
mount -t tmpfs tmp /host/tmp
mount -t tmpfs run /host/run
mkdir -p "/host$project" "/host$out" /host/tmp/job
share project "/host$project" ro,cache=loose
share out "/host$out" cache=none
mount --bind /job /host/tmp/job
mount --bind /proc /host/proc
mount --bind /sys /host/sys
mount --bind /dev /host/dev
mkdir -p /host/dev/shm /host/dev/pts
mount -t tmpfs shm /host/dev/shm
mount -t devpts pts /host/dev/pts
mount -t configfs configfs /host/sys/kernel/config

cat >/host/tmp/job/run <<'RUN'
#!/bin/sh
cd "$(cat /tmp/job/project)" || exit 125
export HOME=/tmp USER=root LANG=C.UTF-8 PYTHONDONTWRITEBYTECODE=1 BENCH_MACHINE=vm
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
BENCH_OUT=$(cat /tmp/job/out)
export BENCH_OUT
. tests/bench/devices.sh
set --
while IFS= read -r argument; do
    set -- "$@" "$argument"
done </tmp/job/arguments
exec /tmp/job/script "$@"
RUN
chroot /host /bin/sh /tmp/job/run </dev/null >/dev/ttyS1 2>&1
echo $? >/job/status
sync
poweroff -f
