#!/bin/sh
# Runs LinuxCNC without a screen: run.sh MODULES FOLDER MODE BASE_NS SERVO_NS, as root.
# MODE is beside, debounced or through: which of these .hal files is taken.
#
# FOLDER has plan.json and gets touches.csv, probe.log, program.ngc. MODULES has touchrig.so and skiplatch.so.
# LinuxCNC gets processes, shared memory, network and /tmp of its own, so several can run at once and
# nothing is left behind; its programs refuse root, so they run as nobody.
set -eu
modules=$(realpath "$1")
folder=$(realpath "$2")
here=$(realpath "$(dirname "$0")")

if [ "${INSIDE:-}" != yes ]; then
    exec env INSIDE=yes unshare --ipc --mount --net --pid --fork --mount-proc "$0" "$@"
fi
mount --bind "$folder" /mnt # it may lie in the /tmp that is hidden now
mount -t tmpfs tmpfs /tmp
mkdir /tmp/modules /tmp/rig
cp -r /usr/lib/linuxcnc/modules/* "$modules"/*.so /tmp/modules/
cp "$here"/*.hal "$here"/driver.py /mnt/plan.json /tmp/rig/
sed "s/@MODE@/$3/; s/@BASE_NS@/$4/; s/@SERVO_NS@/$5/" "$here"/rig.ini >/tmp/rig/rig.ini
chmod -R a+rX /tmp/modules /tmp/rig
chown -R nobody /tmp/rig
mount --bind /tmp/modules /usr/lib/linuxcnc/modules
ip link set lo up 2>/dev/null || true
cd /tmp/rig
HOME=/tmp/rig setpriv --reuid=nobody --clear-groups --regid=nogroup \
    timeout 600 linuxcnc rig.ini >log.txt 2>&1 </dev/null || true
# Without a terminal its script writes here what its programs say.
cat linuxcnc_print.txt linuxcnc_debug.txt >>log.txt 2>/dev/null || true
cp touches.csv probe.log program.ngc log.txt /mnt/ 2>/dev/null || true
[ -e finished ] || { tail -n 40 log.txt >&2; exit 1; }
exit 0
