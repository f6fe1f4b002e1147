#!/bin/sh
# Sees to the model checker CBMC, version 6 or later, for `make prove`; build/cbmc/cbmc starts it.
#
# Debian 13 and later have it: there it is installed like any other package. For Debian 12 it is
# unpacked from trixie into build/cbmc, with the libraries that it wants, and started by its own
# loader, so that nothing of the system changes. (PyPI's cbmc is an unrelated program.)
#
# Ends with 77 and a line that says why where it cannot be had.
set -eu

suite=trixie
# The checker, and the libraries that ldd names of it.
packages="cbmc libc6 libstdc++6 libgcc-s1 zlib1g minisat"

scripts=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/setup/apt_aside.sh
. "$scripts/setup/apt_aside.sh"
target=$(dirname "$scripts")/build/cbmc
launcher=$target/cbmc

say() { printf 'setup_cbmc: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

skip() {
    say "$*"
    exit 77
}

runs() { "$1" --version 2>/dev/null | grep -q '^[6-9]\.'; }

launch() { # COMMAND…
    mkdir -p "$target"
    printf '#!/bin/sh\nexec %s "$@"\n' "$*" >"$launcher"
    chmod 755 "$launcher"
    runs "$launcher"
}

[ ! -x "$launcher" ] || ! runs "$launcher" || exit 0
if ! command -v cbmc >/dev/null && apt-cache policy cbmc | grep -q 'Candidate: [6-9]'; then
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq --yes -o DPkg::Lock::Timeout=300 \
        -o Dpkg::Use-Pty=0 install --no-install-recommends cbmc </dev/null >/dev/null || true
fi
if command -v cbmc >/dev/null && launch "$(command -v cbmc)"; then
    exit 0
fi

[ "$(uname -m)" = x86_64 ] || skip "no CBMC 6 here, and it is unpacked aside for x86_64 only"
say "unpacking CBMC from $suite into build/cbmc"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
begin_aside "$scratch" "$suite" || skip "no CBMC 6 here, and no Debian $suite to take it from"
# shellcheck disable=SC2086
fetch_aside $packages || skip "no CBMC to be had from $suite"
mkdir -p "$target/root"
for package in "$scratch"/deb/*.deb; do
    dpkg --extract "$package" "$target/root"
done
libraries=$(dirname "$(find "$target/root" -name 'libstdc++.so.6' | head -n 1)")
loader=$(find "$target/root" -name ld-linux-x86-64.so.2 -type f | head -n 1)
c=$(dirname "$(find "$target/root" -name libc.so.6 | head -n 1)")
launch "'$loader'" --library-path "'$libraries:$c:$target/root/usr/lib'" "'$target/root/usr/bin/cbmc'" ||
    skip "the CBMC of $suite does not run here"
