"""The list of packages, and the check of their licences."""

import json
from pathlib import Path

import pytest

import sbom

PINS = "click==0.1 \\\n    --hash=sha256:ab \\\n    --hash=sha256:cd\n    # via x\n"


def test_a_package_of_another_version_or_absent_is_a_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "lock").write_text(PINS + PINS.replace("click", "no-such-package"))

    assert sbom.main(tmp_path / "out.json", tmp_path / "lock") == 1

    said = capsys.readouterr().out
    assert "1 packages, 2 faults\nclick: installed is " in said
    assert "no-such-package is not installed" in said
    (component,) = json.loads((tmp_path / "out.json").read_text())["components"]
    assert component["purl"] == "pkg:pypi/click@0.1"
    assert [item["content"] for item in component["hashes"]] == ["ab", "cd"]


def test_a_licence_is_allowed_in_all_its_parts_or_not_at_all() -> None:
    assert sbom.is_allowed("MIT AND (Apache-2.0 OR BSD-2-Clause)")
    assert not sbom.is_allowed("MIT AND GPL-3.0-only")
    assert not sbom.is_allowed("none stated")


def test_what_is_for_another_system_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "lock").write_text(PINS.replace("0.1 ", "0.1 ; sys_platform == 'none' "))

    assert sbom.main(tmp_path / "out.json", tmp_path / "lock") == 1  # nothing is left

    assert not json.loads((tmp_path / "out.json").read_text())["components"]


def test_a_package_of_two_locks_is_listed_once(tmp_path: Path) -> None:
    (tmp_path / "lock").write_text(PINS)
    (tmp_path / "extra.lock").write_text(PINS + PINS.replace("click", "pytest"))

    sbom.main(tmp_path / "out.json", tmp_path / "lock", tmp_path / "extra.lock")

    listed = json.loads((tmp_path / "out.json").read_text())["components"]
    assert [component["name"] for component in listed] == ["click", "pytest"]
