"""Words of the field: none of those that were replaced comes back, but where it is right."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.kit import needs_kits

ROOT = Path(__file__).resolve().parents[1]
PLACES = ("src", "tests", "docs", "examples", "harness", "hil_profiles", "fmus", "benchmarks")
PAGES = ("README.md", "CONTRIBUTING.md", "Makefile", "pyproject.toml")
SUFFIXES = {".py", ".md", ".toml", ".j2", ".c", ".cpp", ".h", ".ino", ".js", ".sh", ".yml"}
LEFT_OUT = ("__pycache__", "node_modules", "tests/test_words.py")
"""This file lists the words."""

REPLACED = {
    "gateway": "door doors",
    "reference tool, cross-check, evaluate": "judge judges judged judging judgement judgements",
    "safe-state bytes": "farewell farewells",
    "connection": "wire wires wired wiring",
    "override, release": "pin pins pinned pinning unpin unpins unpinned",
    "dialect": "flavour flavours flavor flavors",
    "manual control, deflection": "stick sticks",
    "receive": "hear hears heard hearing",
    "error injector": "fate fates",
    "termination conditions": "endings",
    "module, architecture, margin": "house houses room rooms",
    "bus log": "journal journals",
    "notified, reported": "told",
    "repaired, corrected": "mend mends mended mending",
}
"""By the field's word: words of names and prose, in any case."""
WORDS = {word: better for better, words in REPLACED.items() for word in words.split()}
WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
"""The words of ``snake_case``, ``CamelCase`` and prose."""

PHRASES = {
    "transport": r"\b(class|import|:|->) ?(Air|Radio)\b|\b(Air|Radio)\(",
    "is valid, is regarded as": r"(?<!\ba )\bcounts? (as|too|only|for \d)\b|\b(do|does|no longer) (not )?counts?\b",
    "tests/interop": r"tests[/.]peers\b",
    "parameter validation": r"\bgiven\.py\b|\bfrom \.+given import\b",
    "serialisation": r"\bplain\.py\b|\bfrom \.+plain import\b",
}
"""By the field's word: patterns."""


class Right(NamedTuple):
    """Words that stay by right, in files, and in lines with ``pattern``."""

    words: str
    files: str
    pattern: str
    reason: str


BY_RIGHT = (
    Right("wire, wires, wired, wiring", "*arduino*", "", "electrical, and Arduino's library Wire"),
    Right("pin, pins", "*arduino*", "", "of a board"),
    Right("pins", "docs/vehicles/gloria.md", "", "of a board"),
    Right("pin", "*gprs*", "", "of a SIM card"),
    Right("pin", "docs/reference/link-keys.md", "SIM card", "of a SIM card"),
    Right("room", "src/seatrial_kits/arduino/*", "", "free space of a buffer"),
    Right("wire", "*harness/*firmware/*", r"\bWire\b", "Arduino's library"),
    Right("pin, pins", "*harness/*firmware/*", "", "of a board"),
    Right("pin, pins, wire, wires, wiring", "*sketch*", "", "of a board"),
    Right("pin, wires, wired", "*test-with-pytest*", "", "of a board"),
    Right("pin, wires", "*tutorials/ci.md*", "", "of a board"),
    Right("pin", "*mavlink/*", "LEAK1_PIN", "of ArduPilot's parameters"),
    Right("pin, wires", "docs/reference/*", r"PIN KIND|PROFILE:LINK", "of a board"),
    Right("wires, pin, pins", "*hil_profiles/*", "", "of a board"),
    Right(
        "stick",
        "src/seatrial_kits/videoray/driving/keys.py",
        r"[Ll]eft stick|stick's way",
        "of a gamepad",
    ),
    Right(
        "stick", "docs/kits/videoray/videoray-stream.md", r"left stick|stick down", "of a gamepad"
    ),
)


class Found(NamedTuple):
    """A word that was replaced, where it is, and the field's own."""

    file: str
    line: int
    word: str
    better: str
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.word!r} -> {self.better}: {self.text}"


def files() -> Iterator[str]:
    """Yield the texts of the project, by their paths from its root."""
    for place in PLACES:
        for path in sorted((ROOT / place).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if path.suffix in SUFFIXES and not any(part in name for part in LEFT_OUT):
                yield name
    yield from (page for page in PAGES if (ROOT / page).exists())


def found_in(file: str, text: str) -> list[Found]:
    """Return the replaced words of a text, without those that are there by right."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        words = {word.lower(): WORDS[word.lower()] for word in WORD.findall(line)
                 if word.lower() in WORDS}  # fmt: skip
        for better, phrase in PHRASES.items():
            words.update({match.group(): better for match in re.finditer(phrase, line)})
        found += [
            Found(file, number, word, better, line.strip())
            for word, better in words.items()
            if not any(is_right(right, file, word, line) for right in BY_RIGHT)
        ]
    return found


def is_right(right: Right, file: str, word: str, line: str) -> bool:
    return (
        word in right.words.split(", ")
        and fnmatch(file, right.files)
        and re.search(right.pattern, line) is not None
    )


def read(name: str) -> str:
    return (ROOT / name).read_text("utf-8")


@pytest.mark.slow
def test_no_replaced_word_is_back() -> None:
    found = [
        each for name in files() for each in (*found_in(name, name), *found_in(name, read(name)))
    ]
    assert not found, "\n".join(map(str, found))


@needs_kits("arduino", "gprs", "mavlink", "videoray")
@pytest.mark.parametrize("right", BY_RIGHT, ids=lambda right: f"{right.words}-{right.files}")
def test_what_stays_by_right_is_there(right: Right) -> None:
    lines = ((name, line) for name in files() if fnmatch(name, right.files)
             for line in read(name).splitlines())  # fmt: skip
    assert any(
        is_right(right, name, word.lower(), line)
        for name, line in lines
        for word in WORD.findall(line)
    )


@pytest.mark.parametrize("word", WORDS)
def test_a_word_is_found_in_names_and_prose(word: str) -> None:
    texts = (
        f"a {word}",
        f"def last_{word}(n):",
        f"class My{word.title()}Set:",
        f"{word.upper()}_S = 3",
    )
    for text in texts:
        (found,) = found_in("src/seatrial/model/expressions.py", text)
        assert (found.word, found.better) == (word, WORDS[word])


@pytest.mark.parametrize(
    "text",
    [
        "from .radio import Radio", "def send(air: Air) -> None:", "a position counts for 3 s",
        "beta counts as pi", "it does not count", "python -m tests.peers.x", "in given.py",
        "from ..plain import copied",
    ],
)  # fmt: skip
def test_a_phrase_is_found(text: str) -> None:
    assert found_in("src/seatrial/model/expressions.py", text)


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("src/seatrial_kits/arduino/wiring.py", "wire.place is a pin"),
        ("harness/firmware/x/x.ino", "#include <Wire.h>"),
        (
            "src/seatrial/model/expressions.py",
            "air density, counts of turns, warehouse, spinning, pint",
        ),
        ("src/seatrial_kits/mavlink/x.py", "a radio link; the radio's channels count from 1"),
    ],
)
def test_what_is_right_is_not_found(file: str, text: str) -> None:
    assert found_in(file, text) == []


def modules() -> list[str]:
    return [name for name in files() if name.endswith(".py")]


QUESTIONS = {"What", "Where", "Who", "Whom", "Whose", "How", "When", "Which", "Why"}


def asks(tree: ast.Module) -> bool:
    """Return whether the docstring of a module asks, instead of naming the thing."""
    return (ast.get_docstring(tree) or "-").split()[0].strip(",:.") in QUESTIONS


def packed(tree: ast.Module) -> list[int]:
    """Return the lines of calls such as ``f(*(a, b), c)``, which are ``f(a, b, c)``."""
    return [
        node.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        for argument in node.args
        if isinstance(argument, ast.Starred) and isinstance(argument.value, ast.Tuple | ast.List)
    ]


@pytest.mark.slow
def test_docstrings_of_modules_name_the_thing_and_calls_are_plain() -> None:
    found = []
    for name in modules():
        tree = ast.parse(read(name))
        found += [f"{name} asks"] if asks(tree) else []
        found += [f"{name}:{line}" for line in packed(tree)]
    assert found == []


def test_questions_and_packed_calls_are_found() -> None:
    assert asks(ast.parse('"""Who has the helm."""'))
    assert not asks(ast.parse('"""Whole runs."""'))
    assert packed(ast.parse("f(*(a, b), c)\nf(*rest)\nf(\n    *[a, *b],\n)")) == [1, 3]
