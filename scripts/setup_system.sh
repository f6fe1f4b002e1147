#!/bin/sh
# Installs the Debian packages of the named groups that are still missing:
#
#   scripts/setup_system.sh build test lint cross
#
# Says what it installs; does nothing, not even refresh the package lists, when all are there.
set -eu

say() { printf 'setup_system: %s\n' "$*"; }

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

installed() {
    [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

packages_of() {
    case $1 in
    python) echo python3 python3-venv ;;
    # librandom123-dev: the counter-based random generator of host_sim, headers only
    build) echo gcc libc6-dev librandom123-dev make python3 python3-venv ;;
    test) echo ruby ;;
    lint) echo clang cppcheck shellcheck ;;
    cross) echo gcc-avr avr-libc binutils-avr gcc-arm-none-eabi libnewlib-arm-none-eabi ;;
    *)
        say "no such group: $1" >&2
        exit 2
        ;;
    esac
}

# The sanitizer and fuzzer runtimes carry the version of the distribution's default clang in their
# name, so the name is known only once clang itself is installed.
clang_runtime() {
    dpkg-query --show --showformat='${Depends}' clang |
        sed -n 's/.*clang-\([0-9]\+\).*/libclang-rt-\1-dev/p'
}

missing_of() {
    for package in "$@"; do
        installed "$package" || printf '%s ' "$package"
    done
}

install_missing() {
    missing=$(missing_of "$@")
    [ -n "$missing" ] || return 0
    say "installing $missing"
    # Refreshed once a run, however many rounds of installing there are.
    if [ -z "${refreshed:-}" ]; then
        as_root apt-get -qq -o DPkg::Lock::Timeout=300 update
        refreshed=yes
    fi
    # The package list is meant to fall apart into words.
    # shellcheck disable=SC2086
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 \
        install --no-install-recommends $missing </dev/null >/dev/null
}

wanted=
for group in "$@"; do
    wanted="$wanted $(packages_of "$group")"
done
# shellcheck disable=SC2086
install_missing $wanted
case " $* " in
*" lint "*) install_missing "$(clang_runtime)" ;;
esac
