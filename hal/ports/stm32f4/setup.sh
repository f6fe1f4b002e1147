#!/bin/sh
# Sees to QEMU's qemu-system-arm, version 9 or later, in build/qemu: before that the USARTs of its
# STM32F405 raise no interrupt when they have sent.
#
# Debian 13 has it. For Debian 12 it is unpacked from its backports, so that nothing of the system
# changes; its libraries are those of the QEMU that is installed here.
#
# Ends with 77 and a line that says why where it cannot be had.
set -eu

project=$(cd "$(dirname "$0")/../../.." && pwd)
scripts=$project/scripts
# shellcheck source=scripts/setup/apt_aside.sh
. "$scripts/setup/apt_aside.sh"
target=$project/build/qemu
program=$target/qemu-system-arm

say() { printf 'stm32f4: %s\n' "$*"; }

skip() {
    say "$*"
    exit 77
}

runs() { "$1" --version 2>/dev/null | grep -qE 'version (9|[1-9][0-9])\.'; }

mkdir -p "$target"
[ ! -x "$program" ] || ! runs "$program" || exit 0
installed=$(command -v qemu-system-arm || true)
if [ -n "$installed" ] && runs "$installed"; then
    ln -sf "$installed" "$program"
    exit 0
fi

backports=$(debian_codename)-backports
say "unpacking QEMU from $backports into build/qemu"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
begin_aside "$scratch" "$backports" || skip "no QEMU 9 here, and no Debian $backports to take it from"
fetch_aside qemu-system-arm || skip "no qemu-system-arm in $backports"
dpkg --extract "$scratch"/deb/qemu-system-arm_*.deb "$target/root"
runs "$target/root/usr/bin/qemu-system-arm" || skip "the QEMU of $backports does not run here"
ln -sf root/usr/bin/qemu-system-arm "$program"
