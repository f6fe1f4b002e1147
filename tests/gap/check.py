"""``make gap-check``: diagnose campaigns whose effects are sealed, then open the seals.

The generator, the diagnosis and the scorer are processes of their own. The diagnosis is started in
an empty folder and is given one campaign; the labels lie elsewhere until all is diagnosed.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from skiplatch.statistics import proportion
from skiplatch.tables import table

ROOT = Path(__file__).parents[2]
SKIPLATCH = Path(sys.executable).with_name("skiplatch")
NOTHING = "(none)"


@dataclass(frozen=True, slots=True)
class Scored:
    """One campaign: what was sealed, what was found."""

    label: dict[str, Any]
    found: dict[str, Any]
    seconds: float

    @property
    def case(self) -> str:
        """How it was drawn: single, two, none, stranger or dull."""
        return str(self.label["case"])

    @property
    def truth(self) -> set[str]:
        """Ids of the effects in it."""
        return set(self.label["effects"])

    @property
    def named(self) -> list[str]:
        """Ids that the diagnosis named."""
        return [effect["id"] for effect in self.found["effects"]]

    @property
    def covered(self) -> set[str]:
        """True effects that were named, or given as an alternative."""
        groups = ({e["id"], *e["alternatives"]} for e in self.found["effects"])
        return self.truth & set[str]().union(*groups)

    @property
    def strays(self) -> int:
        """Named effects whose group holds no true one."""
        groups = ({e["id"], *e["alternatives"]} for e in self.found["effects"])
        return sum(not group & self.truth for group in groups)

    @property
    def is_right(self) -> bool:
        """All effects covered and nothing else named; for none, dull and strangers, no name."""
        return self.covered == self.truth and self.strays == 0


def generate(out: Path, seed: int, count: int) -> None:
    """Let the generator write campaigns and sealed labels."""
    command = [sys.executable, "-m", "tests.gap.generate", str(out)]
    options = ["--seed", str(seed), "--count", str(count), "--touches", "200", "1000"]
    subprocess.run([*command, *options], cwd=ROOT, check=True, stderr=subprocess.DEVNULL)


def diagnose(campaign: Path, seed: int) -> tuple[dict[str, Any], float]:
    """Diagnose in an empty folder; gives the JSON and the seconds."""
    with tempfile.TemporaryDirectory() as empty:
        out = Path(empty) / "diagnosis.json"
        begin = time.perf_counter()
        command = [str(SKIPLATCH), "diagnose", str(campaign), "--json", str(out)]
        subprocess.run(
            [*command, "--seed", str(seed)], cwd=empty, check=True, stdout=subprocess.DEVNULL
        )
        return json.loads(out.read_text()), time.perf_counter() - begin


def rate(hits: int, total: int) -> str:
    """Give a share with its 95 % interval."""
    if total == 0:
        return "none drawn"
    share = proportion(hits, total)
    return f"{hits}/{total} ({share.low:.0%} … {share.high:.0%})"


def show(results: list[Scored]) -> None:
    """Print accuracy by case, the misses, and what was taken for what."""
    cases = ("single", "two", "none", "dull", "stranger")
    rows = []
    for case in cases:
        here = [r for r in results if r.case == case]
        rows.append((case, rate(sum(r.is_right for r in here), len(here))))
    print(table(("case", "right"), rows))
    singles = [r for r in results if r.case == "single"]
    print(f"\neffects covered: {rate(sum(len(r.covered) for r in results), _effects(results))}")
    print(f"wrong names: {sum(r.strays for r in results)} in {len(results)} campaigns")
    print(f"abstained on a single effect: {rate(sum(not r.named for r in singles), len(singles))}")
    print(f"median seconds: {sorted(r.seconds for r in results)[len(results) // 2]:.1f}")
    confusion = Counter(
        (", ".join(sorted(r.truth)) or r.case, ", ".join(r.named) or NOTHING, r.found["verdict"])
        for r in results
        if not r.is_right
    )
    if confusion:
        print("\n" + table(("sealed", "named", "verdict"), sorted(confusion)))


def _effects(results: list[Scored]) -> int:
    return sum(len(r.truth) for r in results)


def main() -> None:
    """Run the check."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        generate(out, options.seed, options.count)
        campaigns = sorted((out / "campaigns").iterdir())
        found = [diagnose(path, options.seed) for path in tqdm(campaigns, disable=None)]
        labels = [
            json.loads((out / "sealed" / path.name / "label.json").read_text())
            for path in campaigns
        ]
    results = [Scored(label, *one) for label, one in zip(labels, found, strict=True)]
    show(results)


if __name__ == "__main__":
    main()
