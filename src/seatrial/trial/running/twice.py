"""Cases run again, to see whether the same inputs give the same bytes, and which component not."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory

from ...errors import InputError
from ...system.system import Engine
from ..files.trial import Trial
from ..records.run_folder import SIGNALS, VERDICTS, read_manifest
from .again import Again, run_again

_UNCALLED = (
    "no call to a clock, a global generator or the environment was noted; processes differ in the "
    "order of sets of texts, too"
)
MOST = 5
"""Cases of a campaign that run again."""


@dataclass(frozen=True)
class First:
    """A run that is to be repeated."""

    name: str
    trial: Trial
    folder: Path | None
    """None if it is not kept."""


@dataclass(frozen=True)
class Twice:
    """What became of a run and its repetition."""

    name: str
    difference: str = ""
    """The first one, empty if there is none."""
    components: Sequence[str] = ()
    """Those whose outputs make it."""
    calls: Mapping[str, list[str]] = field(default_factory=dict)
    """A line for each kind of call to a clock, a global generator or the environment."""

    def lines(self) -> Iterator[str]:
        """Yield what a person should see of it."""
        yield f"{self.name}: {self.difference}" if self.difference else self.name
        for component in self.components:
            calls = self.calls.get(component, [])
            yield f"{component}: {', '.join(calls) or _UNCALLED}"
        for component, calls in self.calls.items():
            if component not in self.components:
                yield f"{component}: {', '.join(calls)}"


def sample(count: int) -> list[int]:
    """Return the numbers of at most `MOST` of ``count`` cases: first, last, and evenly between."""
    if count <= MOST:
        return list(range(count))
    return [round(k * (count - 1) / (MOST - 1)) for k in range(MOST)]


def has_ended(status: str) -> bool:
    """Say if a run came to an end that its repetition must come to, too."""
    return status not in ("failed", "stopped")


def check_repeatable(trial: Trial) -> None:
    """Raise InputError for a trial that keeps to wall time."""
    if trial.file.real_time is not None:
        raise InputError(f"--twice: {trial.name} keeps to wall time: no two runs of it are alike")


def repeated(
    runs: Sequence[First], engine: Engine, stop_requested: Callable[[], int]
) -> Iterator[Twice]:
    """Repeat runs one after the other, each in a new interpreter, and yield what became of each.

    A run without its folder is repeated twice. Raises what `run_again` raises.
    """
    with TemporaryDirectory(prefix="seatrial-twice-") as below:
        for number, first in enumerate(runs):
            again = run_again(first.trial, engine, Path(below, f"{number}-a"), stop_requested)
            folder = first.folder
            if folder is None:
                folder = Path(below, f"{number}-b")
                run_again(first.trial, engine, folder, stop_requested)
            yield _compared(first.name, folder, again)


def _compared(name: str, folder: Path, again: Again) -> Twice:
    """Compare a run's folder with that of its repetition: signals, end and verdicts."""
    if found := _first_difference(folder / SIGNALS, again.folder / SIGNALS):
        time, pairs = found
        components = list(dict.fromkeys(_component(signal) for signal in pairs))
        components = [each for each in components if each in again.calls] or components
        signal = next(signal for signal in pairs if _component(signal) in components)
        one, other = pairs[signal]
        said = f"{signal} differs from t = {time} s on: {one} and {other}"
        return Twice(name, said, components, again.calls)
    for what, of in (("end", _end), ("verdicts", _verdicts)):
        one, other = of(folder), of(again.folder)
        if one != other:
            said = f"signals are the same, and its {what} differs: {one} and {other}"
            return Twice(name, said, (), again.calls)
    return Twice(name, calls=again.calls)


def _component(signal: str) -> str:
    return signal.rpartition(".")[0]


def _end(folder: Path) -> str:
    manifest = read_manifest(folder)
    return ": ".join(filter(None, (manifest["status"], manifest.get("error"))))


def _verdicts(folder: Path) -> str:
    path = folder / VERDICTS
    return path.read_text("utf-8") if path.is_file() else ""


def _first_difference(one: Path, other: Path) -> tuple[str, dict[str, tuple[str, str]]] | None:
    """Return time and values, by signal, of the first row that two records do not share."""
    if one.read_bytes() == other.read_bytes():
        return None
    with one.open(newline="", encoding="utf-8") as a, other.open(newline="", encoding="utf-8") as b:
        rows, others = csv.reader(a), csv.reader(b)
        names = next(rows)
        if names != next(others):
            return "", {"header": ("one", "another")}
        none: list[str] = []
        for row, twin in zip_longest(rows, others, fillvalue=none):
            if row != twin:
                values = zip_longest(names, row, twin, fillvalue="no row")
                differing = {name: (x, y) for name, x, y in values if x != y}
                return (row or twin)[0], differing
    return None
