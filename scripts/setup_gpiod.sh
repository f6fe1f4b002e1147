#!/bin/sh
# Sees to libgpiod version 2, which the Linux port needs.
#
# Debian 13, Ubuntu 25.04 and later have it: there it is installed like any other package. Debian 12
# has version 1 and, in its backports, version 2. From there header and library are taken with a
# package list of its own and unpacked into build/gpiod, so that nothing of the system changes. The
# library is linked in whole, and the programs run without build/gpiod.
#
# Where neither can be had, it says so and succeeds: what needs the library is then left out.
set -eu

scripts=$(cd "$(dirname "$0")" && pwd)
target=$scripts/../build/gpiod

say() { printf 'setup_gpiod: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

# is_version_2 HEADER: version 1 has no such function.
is_version_2() { grep -qs gpiod_chip_request_lines "$1"; }

skip() {
    say "SKIPPED: $*; the Linux port will be left out"
    exit 0
}

is_version_2 /usr/include/gpiod.h && exit 0
is_version_2 "$target/usr/include/gpiod.h" && exit 0

candidate() { apt-cache policy libgpiod-dev 2>/dev/null | sed -n 's/^ *Candidate: //p'; }

# Without package lists nothing is known of any package.
[ -n "$(candidate)" ] || as_root apt-get -qq -o DPkg::Lock::Timeout=300 update ||
    skip "package lists cannot be read"
case $(candidate) in
[2-9].*)
    "$scripts/setup_system.sh" bench || skip "libgpiod-dev cannot be installed"
    is_version_2 /usr/include/gpiod.h || skip "libgpiod-dev is not version 2"
    exit 0
    ;;
esac

# shellcheck source=/dev/null
codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
# apt expands these itself.
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
    sed -n "s/^Debian $codename //p" | head -n 1)
[ -n "$mirror" ] || skip "no libgpiod 2 here, and no Debian mirror to take it from"

say "unpacking libgpiod 2 from $codename-backports into build/gpiod"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
chmod 755 "$scratch" # apt fetches as a user of its own
mkdir -p "$scratch/lists/partial" "$scratch/cache/archives/partial" "$scratch/deb"

keyring=/usr/share/keyrings/debian-archive-keyring.gpg
options=
[ ! -f "$keyring" ] || options="[signed-by=$keyring]"
echo "deb $options $mirror $codename-backports main" >"$scratch/sources.list"

# The network belongs to apt-get alone: it checks the signed index, the index the package.
apt_aside() {
    apt-get -qq \
        -o Dir::Etc::sourcelist="$scratch/sources.list" -o Dir::Etc::sourceparts=/dev/null \
        -o Dir::State::Lists="$scratch/lists" \
        -o Dir::Cache="$scratch/cache" -o Dir::Cache::archives="$scratch/cache/archives" \
        -o Acquire::Languages=none -o APT::Sandbox::User="$(id -un)" "$@"
}
apt_aside update || skip "$codename-backports cannot be read"
(cd "$scratch/deb" && apt_aside download libgpiod-dev) || skip "no libgpiod-dev in $codename-backports"

mkdir -p "$target"
dpkg -x "$scratch"/deb/libgpiod-dev_*.deb "$target"
is_version_2 "$target/usr/include/gpiod.h" || skip "$codename-backports has no libgpiod 2"
