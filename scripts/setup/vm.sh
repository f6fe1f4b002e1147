#!/bin/sh
# Fetches what the virtual machine of the bench boots, into build/vm: a kernel with vcan and gpio-sim.
#
# Only Debian's later releases build gpio-sim, so the kernel comes from testing, and is unpacked, never
# installed. The meta package names the version; a pinned one would vanish from the mirror. Does
# nothing when all is there. Ends with 77 and a line that says why where it cannot be had.
set -eu

suite=testing
meta=linux-image-amd64
# What tests/bench/vm_init.sh loads; gpio-sim pulls in what else the kernel makes a module.
modules="virtio_pci 9pnet_virtio 9p vcan can-raw can-dev sch_tbf gpio-sim"

scripts=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/setup/apt_aside.sh
. "$scripts/setup/apt_aside.sh"
vm=$(dirname "$scripts")/build/vm

say() { printf 'setup_vm: %s\n' "$*"; }

skip() {
    say "$*"
    exit 77
}

[ "$(uname -m)" = x86_64 ] || skip "the virtual machine of the bench needs an x86_64 host"
"$scripts/setup/system.sh" vm rig || skip "no qemu-system-x86, or busybox-static to be had here"
wanted=$vm/wanted # with which modules it was made
[ ! -f "$vm/version" ] || [ "$(cat "$wanted" 2>/dev/null)" != "$modules" ] || exit 0

scratch=$vm/scratch
rm -rf "$vm"
trap 'rm -rf "$scratch"' EXIT

say "looking up the kernel of Debian $suite"
begin_aside "$scratch" "$suite" || skip "no Debian mirror here to take the kernel of Debian $suite from"
mkdir "$scratch/root"
image=$(depends_aside "$meta" | grep '^linux-image-[0-9]' | head -n 1)
[ -n "$image" ] || skip "$meta of Debian $suite names no kernel"
# The image of today is itself a meta package of these two; an older one was a package in one piece.
parts=$(depends_aside "$image" | grep -E '^linux-(binary|modules)-[0-9]' || true)
say "fetching ${image#linux-image-}"
# shellcheck disable=SC2086
fetch_aside ${parts:-$image} || skip "no kernel of Debian $suite to be had"
for package in "$scratch"/deb/*.deb; do
    dpkg --extract "$package" "$scratch/root"
done

tree=$(find "$scratch/root" -type d -path '*/lib/modules/*' -name kernel -prune | head -n 1)
kernel=$(find "$scratch/root" \( -name vmlinuz -o -name 'vmlinuz-*' \) | head -n 1)
[ -n "$tree" ] || skip "$image holds no modules"
[ -n "$kernel" ] || skip "$image holds no kernel"

unpacked() {
    case $1 in
    *.xz) xz --decompress --stdout "$1" ;;
    *.zst) zstd --decompress --stdout --quiet "$1" ;;
    *) cat "$1" ;;
    esac
}

# A file spells a module with - or _, as it likes.
file_of() {
    find "$tree" -name "$(echo "$1" | sed 's/[-_]/[-_]/g').ko*" | head -n 1
}

# add_module NAME: unpack it after what it needs, and note it in the order of loading.
add_module() {
    added=$vm/modules/$(echo "$1" | tr - _).ko
    [ ! -f "$added" ] || return 0
    packed=$(file_of "$1")
    [ -n "$packed" ] || return 0 # built into the kernel, or the tests will miss it loudly
    unpacked "$packed" >"$added"
    for needed in $(tr '\0' '\n' <"$added" | sed -n 's/^depends=//p' | tr ',' ' '); do
        add_module "$needed"
    done
    echo "$1" | tr - _ >>"$vm/modules/order"
}

mkdir -p "$vm/modules"
cp "$kernel" "$vm/vmlinuz"
for module in $modules; do
    add_module "$module"
done
echo "$modules" >"$wanted"
echo "${image#linux-image-}" >"$vm/version"
say "kernel $(cat "$vm/version") with $(tr '\n' ' ' <"$vm/modules/order")"
