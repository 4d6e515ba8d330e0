"""Names of bundles that the cache keeps: the same as made anew, whatever changes on disk."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from seatrial.fmi.building import bundle_name as module
from seatrial.fmi.building.bundle import bundle
from seatrial.fmi.building.bundle_name import bundle_name

SOURCE = b"import boat\nimport colorsys\nfrom seatrial.fmi.slave import Slave\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "boats"
    folder.mkdir()
    (folder / "boat.py").write_text('DATA_FILES = ("hull.csv",)\nmass = 1\n')
    (folder / "hull.csv").write_text("1,2\n")
    return folder


def source(folder: Path) -> Any:
    """A component's source, with a script of its own."""
    return SimpleNamespace(stem="script", script=SOURCE, folder=folder, package=None)


def made_anew(folder: Path) -> str:
    return bundle("script", SOURCE, folder).script


def no_bundle(*_: object) -> None:
    raise AssertionError("made anew")


@pytest.fixture
def kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A name that is kept, as if all files were old."""
    monkeypatch.setattr(module, "_SETTLED_NS", -(10**18))
    name = bundle_name(source(folder))
    assert name == made_anew(folder)
    return name


def test_a_kept_name_is_not_made_again(folder, kept, monkeypatch) -> None:
    monkeypatch.setattr(module, "bundled", no_bundle)
    assert bundle_name(source(folder)) == kept


def edit(path: Path, text: str) -> None:
    """Write a file so that its size and time of modification stay."""
    status = path.stat()
    path.write_text(text)
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert path.stat().st_size == status.st_size


@pytest.mark.parametrize(
    ("file", "text"),
    [("boat.py", 'DATA_FILES = ("hull.csv",)\nmass = 2\n'), ("hull.csv", "1,3\n")],
)
def test_an_edit_that_leaves_size_and_time(folder, kept, file: str, text: str) -> None:
    edit(folder / file, text)
    assert bundle_name(source(folder)) == made_anew(folder) != kept


def test_a_module_that_takes_the_place_of_another(folder, kept) -> None:
    (folder / "colorsys.py").write_text("x = 1\n")
    assert bundle_name(source(folder)) == made_anew(folder) != kept


def test_a_file_that_is_gone(folder, kept) -> None:
    (folder / "boat.py").rename(folder / "ship.py")
    (folder / "boat").mkdir()
    (folder / "boat" / "__init__.py").write_text("mass = 1\n")
    assert bundle_name(source(folder)) == made_anew(folder) != kept


def test_what_was_just_written_is_not_kept(folder, monkeypatch) -> None:
    """It may be written again before the clock of its stamps goes on."""
    bundle_name(source(folder))
    monkeypatch.setattr(module, "bundled", no_bundle)
    with pytest.raises(AssertionError, match="made anew"):
        bundle_name(source(folder))


def test_a_damaged_cache_is_made_anew(folder, kept, tmp_path) -> None:
    (file,) = (tmp_path / "cache" / "bundles").iterdir()
    for text in ("", "[]", "{}", '{"name": 1, "stamps": 2}'):
        file.write_text(text)
        assert bundle_name(source(folder)) == kept
