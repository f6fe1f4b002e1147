"""Write an SBOM of the locked Python packages and check their licences: `sbom.py OUT LOCK…`.

The SBOM is CycloneDX 1.5 as JSON: of each package its version, the hashes of the lock and the
licence that the installed package states. Ends with 1 if a package is not installed in the locked
version, or states a licence that is not among those that Apache-2.0 software can stand beside.
"""

import json
import re
import sys
from collections.abc import Iterator, Sequence
from importlib.metadata import PackageMetadata, PackageNotFoundError, metadata
from pathlib import Path

from packaging.markers import Marker

# Those of weak copyleft (LGPL, MPL) are imported unchanged, and nothing of them is shipped.
ALLOWED = frozenset(
    {
        *("0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "CC0-1.0", "LGPL-2.1-or-later"),
        *("LGPL-3.0-only", "LGPL-3.0-or-later", "MIT", "MIT-0", "MIT-CMU", "MPL-2.0", "PSF-2.0"),
        "Zlib",
    }
)
SPDX = {
    "Apache 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD": "BSD-3-Clause",
    "BSD License": "BSD-3-Clause",
    "GNU Library or Lesser General Public License (LGPL)": "LGPL-3.0-or-later",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "Python Software Foundation License": "PSF-2.0",
}
"""What older packages state instead of an identifier; of the LGPL, what the files of Pebble say."""
PIN = re.compile(r"^([\w.-]+)==(\S+)(?: ; (.*))? \\\n((?: +--hash=.*\n)+)", re.MULTILINE)
HASH = re.compile(r"--hash=sha256:(\w+)")


def licence(stated: PackageMetadata) -> str:
    """Give the licence as an SPDX expression, or as it is stated where it is none."""
    if "License-Expression" in stated:
        return stated["License-Expression"]
    kinds = stated.get_all("Classifier") or []
    found = [kind.split(" :: ")[-1] for kind in kinds if kind.startswith("License ::")]
    found = found or (stated.get_all("License") or ["none stated"])
    return " AND ".join(SPDX.get(name, name) for name in found)


def is_allowed(expression: str) -> bool:
    """Tell whether each licence of the expression is allowed."""
    return all(name in ALLOWED for name in re.split(r" AND | OR |[()]", expression) if name)


def component(name: str, version: str, hashes: str, stated: str) -> dict[str, object]:
    """Describe a package."""
    return {
        "type": "library",
        "name": name,
        "version": version,
        "purl": f"pkg:pypi/{name}@{version}",
        "hashes": [{"alg": "SHA-256", "content": content} for content in HASH.findall(hashes)],
        "licenses": [{"expression": stated}],
    }


def pins(locks: Sequence[Path]) -> Iterator[tuple[str, str, str, str]]:
    """Give name, version, marker and hashes of each package once; locks agree on versions."""
    known = set()
    for lock in locks:
        for name, version, marker, hashes in PIN.findall(lock.read_text(encoding="utf-8")):
            if (name, version, marker) not in known:
                known.add((name, version, marker))
                yield name, version, marker, hashes


def main(out: Path, *locks: Path) -> int:
    """Write the SBOM, print the licences, and tell what is wrong with them."""
    components, wrong = [], []
    for name, version, marker, hashes in pins(locks):
        if marker and not Marker(marker).evaluate():
            print(f"{name:24} {version:16} left out: {marker}")
            continue
        try:
            installed = metadata(name)
        except PackageNotFoundError:
            wrong.append(f"{name} is not installed")
            continue
        stated = licence(installed)
        components.append(component(name, version, hashes, stated))
        print(f"{name:24} {version:16} {stated}")
        if installed["Version"] != version:
            wrong.append(f"{name}: installed is {installed['Version']}")
        if not is_allowed(stated):
            wrong.append(f"{name}: licence {stated} is not among those allowed")
    document = {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1}
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(document | {"components": components}, indent=1) + "\n")
    print(f"{out}: {len(components)} packages, {len(wrong)} faults", *wrong, sep="\n")
    return 1 if wrong or not components else 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
