#!/bin/sh
# Installs Debian's package cmock (Unity and CMock under /usr/share/cmock).
#
# Debian 13, Ubuntu 24.04 and later have it. Debian 12 lacks it, but the package of the next release
# is architecture-independent and needs only Ruby, so this one file is taken from there: from the
# mirror this machine already uses, with a package list of its own in a scratch folder, so that
# nothing else can ever come from that release.
set -eu

suite=trixie
version=2.5.3+git40-g379a9a8-2
sha256=166e45090937251892363d10860b5e7aa5353d5553fde2cbaba514760ba3785e

scripts=$(cd "$(dirname "$0")" && pwd)

say() { printf 'setup_cmock: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

has_candidate() {
    apt-cache policy cmock | grep -q 'Candidate: [^(]'
}

[ -f /usr/share/cmock/lib/cmock.rb ] && exit 0

"$scripts/setup_system.sh" test

has_candidate || as_root apt-get -qq -o DPkg::Lock::Timeout=300 update
if has_candidate; then
    say "installing cmock"
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 \
        install --no-install-recommends cmock </dev/null >/dev/null
    exit 0
fi

# shellcheck source=/dev/null
codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
# apt expands these itself.
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
    sed -n "s/^Debian $codename //p" | head -n 1)
if [ -z "$mirror" ]; then
    say "no package cmock here, and no Debian mirror to take it from" >&2
    exit 1
fi

say "installing cmock $version from $suite"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
chmod 755 "$scratch" # apt fetches as a user of its own
mkdir -p "$scratch/lists/partial" "$scratch/cache/archives/partial" "$scratch/deb"

keyring=/usr/share/keyrings/debian-archive-keyring.gpg
options=
[ ! -f "$keyring" ] || options="[signed-by=$keyring]"
echo "deb $options $mirror $suite main" >"$scratch/sources.list"

# The network belongs to apt-get alone: it checks the signed index, the index the package.
apt_aside() {
    apt-get -qq \
        -o Dir::Etc::sourcelist="$scratch/sources.list" -o Dir::Etc::sourceparts=/dev/null \
        -o Dir::State::Lists="$scratch/lists" \
        -o Dir::Cache="$scratch/cache" -o Dir::Cache::archives="$scratch/cache/archives" \
        -o Acquire::Languages=none -o APT::Sandbox::User="$(id -un)" "$@"
}
apt_aside update
(cd "$scratch/deb" && apt_aside download "cmock=$version")

package=$(find "$scratch/deb" -name 'cmock_*.deb')
echo "$sha256  $package" | sha256sum --check --quiet
as_root dpkg --install "$package" >/dev/null
