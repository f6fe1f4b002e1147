# Sourced by set-up scripts that take single packages from another release of Debian.
#
# They come from the mirror this machine already uses, with a source list, package lists and a cache
# of their own in a scratch folder, so that nothing else can ever come from that release. The network
# belongs to apt-get alone: it checks the signed index, the index the package. What is named in
# aside.lock has to be what was there when it was locked, whatever the index says of it.
#
# Whoever sources this has said where the folder `scripts` is.
#
# shellcheck shell=sh

# debian_codename: the release that runs here.
debian_codename() {
    # shellcheck source=/dev/null
    (. /etc/os-release && echo "${VERSION_CODENAME:-}")
}

# begin_aside SCRATCH SUITE: read the package lists of a release; 1 if there is no mirror, no key to
# check it with, or nothing to be read.
begin_aside() {
    aside=$1
    # apt expands these itself.
    # shellcheck disable=SC2016
    mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' \
        'Created-By: Packages' | sed -n "s/^Debian $(debian_codename) //p" | head -n 1)
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -n "$mirror" ] && [ -f "$keyring" ] || return 1
    mkdir -p "$aside/lists/partial" "$aside/cache/archives/partial" "$aside/deb"
    chmod 755 "$aside" # apt fetches as a user of its own
    : >"$aside/status"
    echo "deb [signed-by=$keyring] $mirror $2 main" >"$aside/sources.list"
    aside_options="-o Dir::Etc::sourcelist=$aside/sources.list -o Dir::Etc::sourceparts=/dev/null
        -o Dir::State::Lists=$aside/lists -o Dir::State::status=$aside/status
        -o Dir::Cache=$aside/cache -o Dir::Cache::archives=$aside/cache/archives
        -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o Acquire::Languages=none
        -o Acquire::IndexTargets::deb::Contents-deb::DefaultEnabled=false
        -o APT::Sandbox::User=$(id -un)"
    # The options are meant to fall apart into words.
    # shellcheck disable=SC2086
    apt-get -qq $aside_options update
}

# fetch_aside PACKAGE…: download them into SCRATCH/deb; 1 where one is not to be had, or is forged.
fetch_aside() {
    # shellcheck disable=SC2086
    (cd "$aside/deb" && apt-get -qq $aside_options download "$@") && check_aside
}

# check_aside: hold what was downloaded to aside.lock; what has moved on since then is told.
check_aside() {
    for package in "$aside"/deb/*.deb; do
        name=$(basename "$package")
        # shellcheck disable=SC2154
        hash=$(awk -v name="$name" '$2 == name { print $1 }' "$scripts/setup/aside.lock")
        if [ -z "$hash" ]; then
            echo "$name is not in aside.lock, and taken as the signed index has it" >&2
        elif ! echo "$hash  $package" | sha256sum --check --status; then
            echo "$name is not the one of aside.lock" >&2
            return 1
        fi
    done
}

# depends_aside PACKAGE: what it depends on, a line each.
depends_aside() {
    # shellcheck disable=SC2086
    apt-cache $aside_options depends --no-recommends --no-suggests "$1" |
        sed -n 's/^ *Depends: //p'
}
