#!/bin/sh
# Installs the Debian packages of the named groups that are still missing:
#
#   scripts/setup/system.sh build test lint cross
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
    emulators) echo simavr libsimavr-dev libelf-dev qemu-system-arm ;;
    # what runs an emulator that is written in JavaScript, and what fetches it
    node) echo nodejs npm ;;
    # apart, so that a distribution without them has the others; its QEMU has been split since
    riscv) echo gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf "$(riscv_emulator)" ;;
    # the virtual machine of the Linux bench; what works in it, or on a host with the devices
    vm) echo qemu-system-x86 busybox-static xz-utils zstd ;;
    rig) echo iproute2 rt-tests can-utils ;;
    # a bare Debian to try the project in: scripts/fresh.sh
    fresh) echo debootstrap ;;
    # what the packages of the firmware are built with; see docs/PACKAGES.md
    packages) echo g++ cmake ninja-build pkg-config ;;
    # the real controller that the latch is held beside; see docs/LINUXCNC.md
    linuxcnc) echo linuxcnc-uspace linuxcnc-uspace-dev ;;
    arduino) echo arduino-builder arduino-core-avr ;;
    # On distributions that have version 2; see the setup.sh of the port that wants it.
    bench) echo libgpiod-dev ;;
    *)
        say "no such group: $1" >&2
        exit 2
        ;;
    esac
}

riscv_emulator() {
    if to_be_had qemu-system-riscv; then echo qemu-system-riscv; else echo qemu-system-misc; fi
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

# Refreshed once a run, however many rounds of installing there are.
refresh() {
    [ -z "${refreshed:-}" ] || return 0
    as_root apt-get -qq -o DPkg::Lock::Timeout=300 update
    refreshed=yes
}

install_missing() {
    missing=$(missing_of "$@")
    [ -n "$missing" ] || return 0
    say "installing $missing"
    refresh
    # The package list is meant to fall apart into words.
    # shellcheck disable=SC2086
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 \
        install --no-install-recommends $missing </dev/null >/dev/null
}

# to_be_had PACKAGE: whether the distribution has it; refreshes package lists only if there are none.
to_be_had() {
    ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1 || refresh
    apt-cache show "$1" >/dev/null 2>&1
}

# Debian has a browser as a package, Ubuntu as a snap only, which sees no temporary files.
install_browser() {
    if installed chromium || to_be_had chromium; then
        install_missing chromium
    else
        say "no package chromium here: the tests that open a page in a browser will be skipped"
    fi
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
case " $* " in
*" test "*) install_browser ;;
esac
