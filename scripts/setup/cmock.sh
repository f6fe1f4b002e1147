#!/bin/sh
# Installs Debian's package cmock (Unity and CMock under /usr/share/cmock).
#
# Debian 13, Ubuntu 24.04 and later have it. Debian 12 lacks it, but the package of the next release
# is architecture-independent and needs only Ruby, so this one file is taken from there.
set -eu

suite=trixie
version=2.5.3+git40-g379a9a8-2

scripts=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/setup/apt_aside.sh
. "$scripts/setup/apt_aside.sh"

say() { printf 'setup_cmock: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

has_candidate() {
    apt-cache policy cmock | grep -q 'Candidate: [^(]'
}

[ -f /usr/share/cmock/lib/cmock.rb ] && exit 0

"$scripts/setup/system.sh" test

has_candidate || as_root apt-get -qq -o DPkg::Lock::Timeout=300 update
if has_candidate; then
    say "installing cmock"
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 \
        install --no-install-recommends cmock </dev/null >/dev/null
    exit 0
fi

say "installing cmock $version from $suite"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
if ! begin_aside "$scratch" "$suite"; then
    say "no package cmock here, and no Debian mirror to take it from" >&2
    exit 1
fi
fetch_aside "cmock=$version"

package=$(find "$scratch/deb" -name 'cmock_*.deb')
as_root dpkg --install "$package" >/dev/null
