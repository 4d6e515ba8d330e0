"""Native code is the Python or does not exist: what is refused is named, what is taken is the same."""

from __future__ import annotations

import random
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial_kits.native import cached, export, selfcheck
from seatrial_kits.native.carriers import why_python
from seatrial_kits.native.translation.constants import fingerprint
from tests.fmi import odd_components
from tests.kits.native.programs import BEYOND, HEADER, ODD, Program, Writer, component
from tests.kits.native.test_programs import differs, loaded

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

ALL = [
    own
    for own in vars(odd_components).values()
    if isinstance(own, type)
    and issubclass(own, odd_components.Base)
    and own is not odd_components.Base
]
IN_C = {"Decorated", "Chained", "Lists", "MinusZero", "Divided"}
"""Odd components that are translated."""
REFUSED_WHEN_BUILT = {"Large", "Exact", "NotANumber"}
"""Odd components whose C ends the run where Python goes on."""


@pytest.mark.sampled(6)
@pytest.mark.parametrize("cls", ALL, ids=lambda cls: cls.__name__)
def test_odd_components_stay_python_or_are_the_same(cls: Any, tmp_path: Path) -> None:
    why = why_python(cls)
    assert (not why) == (cls.__name__ in IN_C | REFUSED_WHEN_BUILT), why
    if why:
        assert "has no C" in why
        return
    source = find_source(f"{odd_components.__file__}:{cls.__name__}", tmp_path)
    assert isinstance(source, ComponentSource)
    refused = pytest.raises(InputError, match="Python: goes on, its C: ")
    with refused if cls.__name__ in REFUSED_WHEN_BUILT else nullcontext():
        export.build_native_fmu(source, tmp_path / "x.fmu", (HERE,), None, library_here)


def _texts() -> list[str]:
    beyond = [text.strip() for kind in BEYOND.values() for text in kind.split(";")]
    return [*ODD.strip().split("\n"), *(f"self.v_NO_ += float({each})" for each in beyond if each)]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(6))
def test_what_lies_just_beyond(part: int) -> None:
    """Each odd statement and expression of the grammar, filled in three ways."""
    helper = "\n    def help_NO_(self, x):\n        self.v_NO_ += x\n        return self.v_NO_\n"
    found = []
    for number, text in enumerate(_texts()[part::6]):
        for seed in range(3):
            lines = Writer(random.Random(1000 * number + seed)).filled(text, 1).split(";")
            found.append(Program(lines, [helper]))
    if said := differs(found):
        alone = [(each, differs([each])) for each in found]
        pytest.fail(f"{said}\n" + "\n".join(f"{p!r}: {d}" for p, d in alone if d))


def test_a_mistake_of_the_translator_is_a_refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever goes wrong inside, the component stays Python, with the line where it went wrong."""
    from seatrial_kits.native.translation import expressions

    def broken(*_: Any) -> Any:
        raise KeyError("inside")

    monkeypatch.setattr(expressions, "compared", broken)
    why = why_python(odd_components.Chained)
    assert "odd_components.py" in why
    assert "KeyError" in why


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    folder.mkdir()
    monkeypatch.setattr(cached, "cache_folder", lambda _: folder)
    return folder


@pytest.mark.slow
def test_c_that_differs_is_refused_with_both_values(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even where the translation is wrong, its numbers are never used; the refusal is kept."""
    from seatrial_kits.native.translation import operations

    monkeypatch.setitem(operations._C, operations.ast.Mult, "+")
    monkeypatch.setattr(selfcheck, "_STEPS", 40)
    source = find_source(f"{__file__}:Tripled", Path.cwd())
    assert isinstance(source, ComponentSource)
    with pytest.raises(InputError, match=r"y is .* in Python, .* in C.*fault of seatrial"):
        cached.native_fmu(source)
    monkeypatch.setattr(export, "_sources", None)  # nothing is translated or compiled again
    with pytest.raises(InputError, match="fault of seatrial"):
        cached.native_fmu(source)
    assert not list(own_cache.glob("*.fmu"))


def test_constants_of_the_environment_are_part_of_the_key(tmp_path: Path) -> None:
    """The same text with another constant is another component."""
    text = HEADER + "\nimport os\nGAIN = float(os.environ.get('GAIN', '1.0'))\n"
    text += component("Written", [Program(["self.v_NO_ += GAIN"], [])])
    own, _, _ = loaded(tmp_path, text)
    before = fingerprint(own)
    own.run0.__globals__["GAIN"] = 2.0  # type: ignore[attr-defined]
    assert fingerprint(own) != before
    own.run0.__globals__["GAIN"] = 1.0  # type: ignore[attr-defined]
    assert fingerprint(own) == before


class Tripled(odd_components.Base):
    """Three times the input."""

    def work(self, t: float, h: float) -> float:
        return 3.0 * self.u
