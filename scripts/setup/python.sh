#!/bin/sh
# Makes .venv with exactly what requirements.lock names, and the package itself as an editable
# install. Keeps a .venv that was already made from the same lock file.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
venv=$root/.venv
python=${PYTHON:-python3}

say() { printf 'setup_python: %s\n' "$*"; }

pip_install() {
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check "$@"
}

# up_to_date NAME KEY: whether this step was last done with the same key.
up_to_date() { [ "$(cat "$venv/$1.key" 2>/dev/null)" = "$2" ]; }

if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    say "$python is missing or older than 3.11; name another one with PYTHON=" >&2
    exit 1
fi

# The place and the interpreter belong to the key: neither a moved .venv nor one whose Python was
# replaced works.
key=$({
    cat "$root/scripts/requirements.lock"
    echo "$venv"
    "$python" -c 'import sys; print(sys.version_info[:2], sys.base_prefix)'
} | sha256sum | cut -d' ' -f1)

if ! up_to_date packages "$key" || ! "$venv/bin/python" -c ''; then
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
        "$root/scripts/setup/system.sh" python
    fi
    say "making $venv"
    rm -rf "$venv"
    "$python" -m venv "$venv"
    pip_install --require-hashes --requirement "$root/scripts/requirements.lock"
    echo "$key" >"$venv/packages.key"
fi

# The optional extras on top: what is there stays.
for extra in fleet cluster; do
    lock=$root/scripts/requirements-$extra.lock
    key=$(cat "$lock" "$venv/packages.key" | sha256sum | cut -d' ' -f1)
    if ! up_to_date "$extra" "$key"; then
        pip_install --require-hashes --requirement "$lock"
        echo "$key" >"$venv/$extra.key"
    fi
done

key=$(sha256sum "$root/scripts/pyproject.toml" | cut -d' ' -f1)
if ! up_to_date skiplatch "$key"; then
    say "installing skiplatch into $venv"
    pip_install --no-deps --no-build-isolation --editable "$root/scripts"
    "$venv/bin/python" -m pip check --disable-pip-version-check >/dev/null
    echo "$key" >"$venv/skiplatch.key"
fi
touch "$venv/skiplatch.key"
