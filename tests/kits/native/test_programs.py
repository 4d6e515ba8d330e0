"""Programs by a grammar: their C does what their Python does, or there is none."""

from __future__ import annotations

import importlib.util
import subprocess
from collections.abc import Mapping, Sequence
from itertools import chain, count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.fmi.compiler import HERE, SEMANTICS
from seatrial.fmi.components.source import ComponentSource
from seatrial.model.component import Component
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.native.translation.domain import TranslationError
from seatrial_kits.native.translation.unit import Unit
from tests.kits.native.programs import HEADER, Program, component, shorter, smaller, written

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

_NUMBERS = count()
SAID = (
    *("more than 64 bits", "too large a number", "beyond 2^53", "no whole number of 32 bits"),
    *("entries wait", "whether one NaN", "is no real number"),
)
"""What C says where it cannot go on as Python does: that is no other number."""
SEEN: dict[str, int] = {"programs": 0, "in C": 0}


def loaded(folder: Path, text: str) -> tuple[type[Component], Path, str]:
    """Return the component of a module that is written and imported, its file and module."""
    module = f"grammar_{next(_NUMBERS)}"
    path = folder / f"{module}.py"
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(module, path)
    assert spec is not None
    assert spec.loader is not None
    made: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made.Written, path, module


def fails(cls: type[Component]) -> bool:
    """Return whether a component fails within some steps."""
    try:
        own = cls("x")
        own.setup(0.0)
        own.initialise()
        own.begin()
        for k in range(10):
            own.advance(k * 0.1, 0.1)
    except Exception:
        return True
    return False


def quick(sources: Mapping[str, bytes], _platform: str) -> bytes:
    """Compile without optimisation: the numbers are the same."""
    with TemporaryDirectory() as folder:
        for name, content in sources.items():
            Path(folder, name).write_bytes(content)
        names = [name for name in sources if name.endswith(".c")]
        flags = ("-std=c99", "-O0", "-shared", "-fPIC", "-fvisibility=hidden", *SEMANTICS)
        subprocess.run(["cc", *flags, *names, "-o", "out.so", "-lm"], cwd=folder, check=True)
        return Path(folder, "out.so").read_bytes()


def refuse_difference(folder: Path, some: Sequence[Program]) -> None:
    """Raise InputError where the C of programs, all in one component, differs from the Python."""
    _cls, _path, module = loaded(folder, HEADER + component("Written", some))
    source = ComponentSource(module, module, module, "Written", module, folder)
    build_native_fmu(source, folder / "x.fmu", (HERE,), None, quick)


def check(some: Sequence[Program]) -> None:
    """Check programs: those that can be in C all at once, those that fail one by one."""
    with TemporaryDirectory() as name:
        folder, together = Path(name), []
        for program in some:
            SEEN["programs"] += 1
            try:
                cls, _, _ = loaded(folder, HEADER + component("Written", [program]))
                Unit(cls()).translate()
            except (TranslationError, SyntaxError):
                continue
            SEEN["in C"] += 1
            if fails(cls):
                refuse_difference(folder, [program])
            else:
                together.append(program)
        try:
            if together:
                refuse_difference(folder, together)
        except TranslationError:  # one reads what another has set
            for program in together:
                refuse_difference(folder, [program])


def differs(some: Sequence[Program]) -> str:
    """Return what differs between the C and the Python of programs, empty if nothing."""
    try:
        check(some)
    except InputError as error:
        return "" if any(text in str(error) for text in SAID) else str(error)
    return ""


def shrunk(program: Program) -> Program:
    """Return a small program whose C still differs: halves and quarters are taken out first."""
    for each in chain(shorter(program), smaller(program)):
        if differs([each]):
            return shrunk(each)
    return program


def check_seeds(first: int, count: int) -> None:
    """Check programs by their seeds; fail with a small one of those that differ."""
    some = [written(seed) for seed in range(first, first + count)]
    if not differs(some):
        return
    alone = next((each for each in some if differs([each])), None)
    if alone is None:
        pytest.fail(f"seeds {first} to {first + count}, together: {differs(some)}")
    small = shrunk(alone)
    pytest.fail(f"{small!r}\n{differs([small])}")


DIFFERED = {
    "the target of a loop without turns keeps its value": (
        "for i in range(3):\n    pass\nfor i in range(self.n % 4):\n    pass\nself.v_NO_ += i"
    ),
    "what fails in one branch of a choice": (
        "self.maybe_NO_ = {'one': math.floor(self.x)}.get(self.mode, 0.0)\n"
        "if self.shared < self.help_NO_(self.shared) < self.pair_NO_[1] or self.maybe_NO_ is None:\n"
        "    self.row_NO_ = [self.x, self.z, 0.5]\n"
        "    match self.n:\n"
        "        case 0:\n"
        "            pass\n"
        "        case _:\n"
        "            self.v_NO_ %= math.dist((self.maybe_NO_ + self.row_NO_[1], 1.0), (0.0, 0.5))"
    ),
}
"""Statements that once had a C of their own."""
HELP = """
    def help_NO_(self, x):
        self.v_NO_ += x
        return self.v_NO_
"""
ENDLESS = (
    *("10**9 ** 10**9", "len('x' * 10**9)", "len([1.0] * 10**9)", "math.factorial(10**9)"),
    *("sorted(range(10**10))[0]", "len('x'.ljust(10**10))", "max(range(10**10))"),
)
"""Expressions whose values, known before the run, take too long or too much."""


@pytest.mark.parametrize("text", DIFFERED.values(), ids=DIFFERED)
def test_what_differed_once(text: str) -> None:
    program = Program(text.split("\n"), [HELP])
    assert not differs([program])


@pytest.mark.parametrize("text", ENDLESS)
def test_what_takes_for_ever_has_no_c(text: str, tmp_path: Path) -> None:
    program = Program([f"self.v_NO_ += self.z and ({text})"], [])
    cls, _, _ = loaded(tmp_path, HEADER + component("Written", [program]))
    with pytest.raises(TranslationError, match="has no C"):
        Unit(cls()).translate()


MANY_KINDS = """
for w in reversed(self.row_NO_):
    if self.n < 2.5:
        self.maybe_NO_ = frozenset((1.0, 2.0))
if self.maybe_NO_ is None:
    self.v_NO_ += 1.0
else:
    self.maybe_NO_ = None
    if self.help_NO_(self.v_NO_) > 1.0:
        self.maybe_NO_ = None
        self.maybe_NO_ = frozenset((1.0, 2.0))
"""


@pytest.mark.parametrize(
    ("text", "why"),
    [("self.maybe_NO_ = (1.0 - 3.0) ** 0.5", "no real number"), (MANY_KINDS, "more than 32 kinds")],
)
def test_values_of_ever_more_kinds_have_no_c(text: str, why: str, tmp_path: Path) -> None:
    """Each is an object of its own, so that the types of attributes would grow without end."""
    program = Program(text.strip().split("\n"), [HELP])
    cls, _, _ = loaded(tmp_path, HEADER + component("Written", [program]))
    with pytest.raises(TranslationError, match=why):
        Unit(cls()).translate()


@pytest.mark.slow
@pytest.mark.parametrize("first", [0, 1000])
def test_some_programs(first: int) -> None:
    check_seeds(first, 12)


@pytest.mark.long
@pytest.mark.parametrize("part", range(100))
def test_a_hundred_thousand_programs(part: int) -> None:
    """Seeds that no other part has."""
    for first in range(part * 10_000, part * 10_000 + 1000, 20):
        check_seeds(first, 20)
