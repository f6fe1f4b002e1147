#!/bin/sh
# Sees to the emulator rp2040js in build/rp2040js, of exactly the contents that the lock file beside
# the tests says, and to `node` there, a link to the one that runs it.
#
# node and npm come from Debian (packages nodejs and npm) where they are absent. Ends with 77 and a
# line that says why where something cannot be had.
set -eu

folder=$(cd "$(dirname "$0")" && pwd)
project=$(cd "$folder/../../.." && pwd)
target=$project/build/rp2040js

say() { printf 'rp2040: %s\n' "$*"; }

skip() {
    say "$*"
    exit 77
}

here() { command -v node >/dev/null && command -v npm >/dev/null; }

# Whatever is found of an earlier set-up is not taken for this one's.
rm -f "$target/node"
here || "$project/scripts/setup/system.sh" node || true
here || skip "no node or npm here, and no packages nodejs and npm to be had"
node -e 'process.exit(parseInt(process.versions.node) >= 18 ? 0 : 1)' ||
    skip "node is version $(node --version) here, and rp2040js wants 18 or later"

mkdir -p "$target"
cp "$folder/tests/package.json" "$folder/tests/package-lock.json" "$target/"
say "installing rp2040js into build/rp2040js"
(cd "$target" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >/dev/null) ||
    skip "no rp2040js to be had, or not the one of package-lock.json"
ln -sf "$(command -v node)" "$target/node"
