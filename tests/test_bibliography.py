"""Keys of publications: each one that is cited is in the bibliography, each entry is cited."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACES = ("src", "docs", "harness", "hil_profiles", "benchmarks", "examples", "tests/reference")
SUFFIXES = {".py", ".md", ".toml", ".j2", ".json"}
BIBLIOGRAPHY = ROOT / "docs" / "bibliography.md"
KEY = re.compile(r"\[([A-Z][A-Za-z]+(?:[12]\d{3}|Script))\]")
NUMBER = re.compile(r"\b[Ss]ources? 00\d\b")


def texts() -> dict[Path, str]:
    files = [file for place in PLACES for file in (ROOT / place).rglob("*")]
    return {file: file.read_text("utf-8") for file in files if file.suffix in SUFFIXES}


def test_cited_works_and_entries_are_the_same() -> None:
    entries = re.findall(r"^- \*\*\[(\w+)\]\*\*", BIBLIOGRAPHY.read_text("utf-8"), re.MULTILINE)
    assert len(entries) == len(set(entries))
    cited = {key for file, text in texts().items() if file != BIBLIOGRAPHY
             for key in KEY.findall(text)}  # fmt: skip
    assert cited == set(entries)


def test_no_work_is_cited_by_a_number_of_our_own() -> None:
    assert [file for file, text in texts().items() if NUMBER.search(text)] == []


def test_entries_of_a_section_are_sorted() -> None:
    for section in BIBLIOGRAPHY.read_text("utf-8").split("\n## ")[1:]:
        entries = re.findall(r"^- \*\*\[(\w+)\]\*\*", section, re.MULTILINE)
        assert entries == sorted(entries)
