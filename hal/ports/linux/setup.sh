#!/bin/sh
# Sees to libgpiod version 2, which the Linux port needs.
#
# Debian 13, Ubuntu 25.04 and later have it: there it is installed like any other package. Debian 12
# has version 1 and, in its backports, version 2. From there header and library are unpacked into
# build/gpiod, so that nothing of the system changes. The library is linked in whole, and the programs run without build/gpiod.
#
# Ends with 77 and a line that says why where neither can be had.
set -eu

project=$(cd "$(dirname "$0")/../../.." && pwd)
scripts=$project/scripts
# shellcheck source=scripts/setup/apt_aside.sh
. "$scripts/setup/apt_aside.sh"
target=$project/build/gpiod

say() { printf 'linux: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

# is_version_2 HEADER: version 1 has no such function.
is_version_2() { grep -qs gpiod_chip_request_lines "$1"; }

skip() {
    say "$*"
    exit 77
}

is_version_2 /usr/include/gpiod.h && exit 0
is_version_2 "$target/usr/include/gpiod.h" && exit 0

candidate() { apt-cache policy libgpiod-dev 2>/dev/null | sed -n 's/^ *Candidate: //p'; }

# Without package lists nothing is known of any package.
[ -n "$(candidate)" ] || as_root apt-get -qq -o DPkg::Lock::Timeout=300 update ||
    skip "package lists cannot be read"
case $(candidate) in
[2-9].*)
    "$project/scripts/setup/system.sh" bench || skip "libgpiod-dev cannot be installed"
    is_version_2 /usr/include/gpiod.h || skip "libgpiod-dev is not version 2"
    exit 0
    ;;
esac

backports=$(debian_codename)-backports
say "unpacking libgpiod 2 from $backports into build/gpiod"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
begin_aside "$scratch" "$backports" || skip "no libgpiod 2 here, and no Debian $backports to take it from"
fetch_aside libgpiod-dev || skip "no libgpiod-dev in $backports"

mkdir -p "$target"
dpkg -x "$scratch"/deb/libgpiod-dev_*.deb "$target"
is_version_2 "$target/usr/include/gpiod.h" || skip "$backports has no libgpiod 2"
