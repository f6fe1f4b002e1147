#!/bin/sh
# Boots the virtual machine of the bench and runs SCRIPT in it as root:
#
#   tests/bench/run_vm.sh SCRIPT [ARGUMENT...]
#
# Inside, the host's files stand where they stand outside, read-only, /tmp is empty and the working
# directory is the project's; vcan0 is up, and a gpio-sim chip of eight lines is there (see guest.sh).
# What SCRIPT prints is printed, its status returned; 125 if the machine did not get that far.
#
# Environment: BENCH_OUT, a folder that SCRIPT finds under the same name and may write to;
# VM_TIMEOUT_S (600), VM_CPUS (1: of two emulated processors one
# stands still whenever the host is busy, and edges are lost that no real machine loses),
# VM_MEMORY_MIB (768).
set -eu

script=$(realpath "$1")
shift
project=$(cd "$(dirname "$0")/../.." && pwd)
vm=$project/build/vm

"$project/scripts/setup/vm.sh"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
out=${BENCH_OUT:-$scratch/out}
mkdir -p "$scratch/root/bin" "$scratch/root/modules" "$scratch/share" "$out"

# ---- what boots: busybox, the modules and guest.sh as init ---------------------------------------

cp /bin/busybox "$scratch/root/bin/busybox"
cp "$vm"/modules/* "$scratch/root/modules"
cp "$project/tests/bench/guest.sh" "$scratch/root/init"
chmod +x "$scratch/root/init"
(cd "$scratch/root" && find . | busybox cpio --quiet -o -H newc | gzip -1) >"$scratch/initramfs"

# ---- what it is to do: a folder of its own, so that machines can run side by side ----------------

cp "$script" "$scratch/share/script"
chmod +x "$scratch/share/script"
for argument in "$@"; do
    printf '%s\n' "$argument"
done >"$scratch/share/arguments"
printf '%s\n' "$project" >"$scratch/share/project"
realpath "$out" >"$scratch/share/out"

# share NAME PATH [OPTION]: a folder of the host under that mount tag
share() {
    printf '%s' "local,path=$2,mount_tag=$1,security_model=none,multidevs=remap${3:-}"
}

# No network, no disk, no display: a console for the kernel and a second one for the script. A host
# that lets nobody use KVM emulates the processor in software.
accelerator=tcg
if [ -w /dev/kvm ] && grep -qE '^flags.*\<(vmx|svm)\>' /proc/cpuinfo; then accelerator=kvm; fi
status=0
timeout --foreground "${VM_TIMEOUT_S:-600}" qemu-system-x86_64 \
    -accel "$accelerator" -cpu max -smp "${VM_CPUS:-1}" -m "${VM_MEMORY_MIB:-768}" \
    -nodefaults -no-user-config -no-reboot -nic none -display none -vga none -monitor none \
    -serial "file:$scratch/console" -serial stdio \
    -virtfs "$(share host / ,readonly=on)" \
    -virtfs "$(share project "$project" ,readonly=on)" \
    -virtfs "$(share job "$scratch/share")" \
    -virtfs "$(share out "$(realpath "$out")")" \
    -kernel "$vm/vmlinuz" -initrd "$scratch/initramfs" \
    -append "console=ttyS0 quiet panic=-1 accelerator=$accelerator" </dev/null || status=$?

if [ ! -s "$scratch/share/status" ]; then
    echo "run_vm: the machine ended before the script did (qemu: status $status)" >&2
    tail -n 20 "$scratch/console" >&2 || true
    exit 125
fi
exit "$(cat "$scratch/share/status")"
