"""What a release needs, tried on a repository of its own: each fault alone stands in the way."""

import sys
from pathlib import Path

import pytest

import release

LOG = "# Changelog\n\n## Unreleased\n\n## 1.2.3 - 2026-01-02\n\n- A thing.\n"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A repository that is ready for its release 1.2.3."""
    for name, text in {
        "firmware/skiplatch.h": '#define SKIPLATCH_VERSION "1.2.3"\n',
        "scripts/pyproject.toml": '[project]\nversion = "1.2.3"\n',
        "CITATION.cff": "cff-version: 1.2.0\nversion: 1.2.3\n",
        "CHANGELOG.md": LOG,
        "Containerfile": "# podman build --tag skiplatch:1.2.3 .\n",
        "docs/FLEET.md": "image: skiplatch:1.2.3\n",
        "docs/PACKAGES.md": "pip install skiplatch-1.2.3-py3-none-any.whl\n",
        "firmware/examples/desk/CMakeLists.txt": "find_package(skiplatch 1.2 REQUIRED)\n",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    release.git(tmp_path, "init", "--quiet")
    release.git(tmp_path, "config", "user.name", "a")
    release.git(tmp_path, "config", "user.email", "a@b")
    commit(tmp_path)
    return tmp_path


def commit(root: Path) -> None:
    release.git(root, "add", "--all")
    release.git(root, "commit", "--quiet", "--message", "a: b")


def test_tag_is_made_only_when_asked(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["release.py"])
    assert release.main(root) == 0
    assert release.git(root, "tag") == ""

    monkeypatch.setattr(sys, "argv", ["release.py", "--tag"])
    assert release.main(root) == 0
    assert release.git(root, "tag") == "v1.2.3"
    assert release.git(root, "cat-file", "-t", "v1.2.3") == "tag"
    assert release.main(root) == 1


@pytest.mark.parametrize(
    ("name", "old", "new", "fault"),
    [
        ("CITATION.cff", "1.2.3", "1.2.2", "CITATION.cff: states 1.2.2"),
        ("scripts/pyproject.toml", "version", "versions", "states no version"),
        ("firmware/skiplatch.h", "1.2.3", "1.2", "expected a version such as 1.2.3"),
        ("docs/FLEET.md", "1.2.3", "1.2.2", "an example names 1.2.2"),
        ("docs/PACKAGES.md", "1.2.3", "1.20.3", "an example names 1.20.3"),
        ("firmware/examples/desk/CMakeLists.txt", "1.2", "1.1", "an example names 1.1"),
        ("CHANGELOG.md", "## 1.2.3 - 2026-01-02", "## 1.2.3", "expected a section"),
        ("CHANGELOG.md", "- A thing.\n", "", "expected a section"),
        ("CHANGELOG.md", "Unreleased\n", "Unreleased\n\n- More.\n", "lines under Unreleased"),
    ],
)
def test_each_fault_stands_in_the_way(
    name: str, old: str, new: str, fault: str, root: Path
) -> None:
    text = (root / name).read_text()
    (root / name).write_text(text.replace(old, new, 1))
    commit(root)

    found = release.faults(root, None)

    assert any(fault in line for line in found)


def test_what_is_not_committed_not_built_or_tagged_later_is_told(root: Path) -> None:
    assert release.faults(root, None) == []
    release.git(root, "tag", "v1.10.0")
    (root / "new").write_text("")

    found = release.faults(root, root / "nowhere")

    assert [line.split(" ")[0] for line in found[:2]] == ["1", "v1.10.0"]
    assert "no skiplatch-1.2.3-*.whl" in found[2]
    assert "no skiplatch-1.2.3.tar.gz" in found[3]


def test_versions_of_this_project_agree() -> None:
    project = Path(__file__).parents[2]

    assert list(release.version_faults(project, release.stated(project, release.HOME))) == []
