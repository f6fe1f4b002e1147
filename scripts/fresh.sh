#!/bin/sh
# Tries the project in a Debian that has nothing yet:
#
#   scripts/fresh.sh SUITE TARGET…        SUITE is bookworm or trixie
#
# Makes a bare system with debootstrap in build/fresh, clones what is committed here into it, and
# runs each `make TARGET` there. What they print is also kept in build/fresh/SUITE.log. The system
# is taken away again, also after an interruption. Exit status: 0 if all targets passed, 1 if one
# failed, 2 for a wrong call, 77 if something is missing here.
set -eu

project=$(cd "$(dirname "$0")/.." && pwd)
keyring=/usr/share/keyrings/debian-archive-keyring.gpg

say() { printf 'fresh: %s\n' "$*"; }

skip() {
    echo "SKIPPED: fresh: $*"
    exit 77
}

# The mirror this machine already uses.
debian_mirror() {
    # apt expands these itself.
    # shellcheck disable=SC2016
    apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
        grep -v security | sed -n 's/^Debian //p' | head -n 1
}

# How this machine reaches the network: names, certificates, what pip and npm take theirs from.
lend_network() {
    mkdir -p "$root/etc/ssl"
    cp /etc/resolv.conf "$root/etc/"
    cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/lent.crt"
    [ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
    [ ! -f /etc/npmrc ] || cp /etc/npmrc "$root/etc/"
}

in_root() {
    # The variables of pip are meant to fall apart into words; none of them has blanks.
    # shellcheck disable=SC2046
    chroot "$root" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        $(env | grep -E '^(PIP_|https?_proxy=|no_proxy=)[^ ]*$') \
        SSL_CERT_FILE=/etc/ssl/lent.crt PIP_CERT=/etc/ssl/lent.crt NODE_EXTRA_CA_CERTS=/etc/ssl/lent.crt \
        sh -c "$1"
}

# Runs in namespaces of its own: its mounts and processes end with it.
inside() {
    say "a bare $suite from $mirror"
    debootstrap --variant=minbase --keyring="$keyring" "$suite" "$root" "$mirror" >/dev/null
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --rbind /sys "$root/sys"
    git clone --quiet "$project" "$root/project"
    lend_network
    in_root 'apt-get -qq update && apt-get -qq --yes --no-install-recommends \
        install make git ca-certificates >/dev/null 2>&1'
    sum='' status=0
    for target in "$@"; do
        say "make $target"
        outcome=passed
        in_root "cd /project && make $target" || outcome=failed status=1
        sum="$sum $target $outcome,"
    done
    say "$suite:${sum%,}"
    return $status
}

if [ "${1:-}" = --inside ]; then
    suite=$2 root=$3 mirror=$4
    shift 4
    inside "$@"
    exit
fi

suite=${1:-}
case $suite in
bookworm | trixie) shift ;;
*)
    echo "fresh: which Debian? scripts/fresh.sh bookworm|trixie TARGET…" >&2
    exit 2
    ;;
esac
[ "$#" -gt 0 ] || { echo "fresh: which targets of make?" >&2 && exit 2; }
[ "$(id -u)" -eq 0 ] || skip "only root may make a system: sudo make fresh SUITE=$suite"
command -v debootstrap >/dev/null || skip "no debootstrap here: scripts/setup/system.sh fresh"
[ -f "$keyring" ] || skip "no $keyring here"
mirror=$(debian_mirror)
[ -n "$mirror" ] || skip "no mirror of Debian is set up here"

mkdir -p "$project/build/fresh"
root=$(mktemp -d "$project/build/fresh/$suite.XXXXXX")
chmod 755 "$root"
log=$project/build/fresh/$suite.log
# Nothing is mounted out here; should it be, it is left alone.
trap 'rm -rf --one-file-system "$root"' EXIT
trap 'exit 130' INT TERM HUP

: >"$log"
tail -n +1 -f "$log" &
shown=$!
unshare --mount --pid --fork --kill-child --propagation private \
    "$0" --inside "$suite" "$root" "$mirror" "$@" >>"$log" 2>&1 &
made=$!
# Called by the trap; unshare takes no milder signal.
# shellcheck disable=SC2317
end() {
    kill -KILL "$made" "$shown" 2>/dev/null || true
    wait || true
    rm -rf --one-file-system "$root"
}
trap end EXIT
status=0
wait "$made" || status=$?
sleep 1 # until the end of the log is shown
exit "$status"
