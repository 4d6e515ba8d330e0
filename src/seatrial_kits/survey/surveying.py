"""A folder of FMUs surveyed, one after the other."""

from __future__ import annotations

import math
import multiprocessing
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.files.options import FmuOptions
from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.fmi.isolation.exit_status import how_ended
from seatrial.fmi.loading.built import with_library
from seatrial.fmi.loading.load import load_fmu
from seatrial.model.component import NS

from .experiment import Experiment, experiment_of
from .ways import WAYS, NotThisWay, Rows, Way, compared

SOLVERS = 1e-8
"""Relative tolerance of both solvers in model exchange, where each tool has one of its own."""
LIMITS = {"co-simulation": 1e-9, "model exchange": 1e3 * SOLVERS}
"""Greatest difference of two runs that agree."""
_SMALLEST = 1e-12
"""Least scale of an output: differences of outputs that are all but zero are round-off."""


@dataclass(frozen=True)
class Difference:
    """The greatest difference of two runs, relative to the greatest value of its output."""

    value: float
    output: str
    time: float
    """s, of the first communication point beyond the limit, else of the greatest difference."""

    def __str__(self) -> str:
        """Return the difference in words."""
        return f"{self.output} by {self.value:.3g} at t = {self.time:g} s"


def difference(ours: Rows, theirs: Rows, experiment: Experiment, limit: float) -> Difference:
    """Return the greatest difference of all outputs, of which there is one at least.

    Both end where the FMU asks for that, one of them perhaps a point later: the common points are
    compared. Of runs whose ends lie further apart the difference is infinite.
    """
    return max(
        (
            _of_output(name, ours[name], values, experiment, limit)
            for name, values in theirs.items()
        ),
        key=lambda one: one.value,
    )


def _of_output(
    name: str, found: Sequence[Any], values: Sequence[Any], experiment: Experiment, limit: float
) -> Difference:
    scale = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    apart = [_apart(a, b) / max(scale, _SMALLEST) for a, b in zip(found, values, strict=False)]
    if abs(len(found) - len(values)) > 1:
        apart.append(math.inf)
    worst = max(apart)
    at = next((i for i, value in enumerate(apart) if value > limit), apart.index(worst))
    return Difference(worst, name, (experiment.start_ns + at * experiment.step_ns) / NS)


def _apart(a: Any, b: Any) -> float:
    if a == b or (math.isnan(a) and math.isnan(b)):
        return 0.0
    apart = abs(float(a) - float(b))
    return math.inf if math.isnan(apart) else apart


_REFERENCE = "FMPy"


@dataclass(frozen=True)
class Surveyed:
    """An FMU as it was found."""

    path: Path
    kind: str = ""
    """Version of FMI and interface, of an FMU that is loaded."""
    experiment: Experiment | None = None
    outputs: int = 0
    """How many outputs are compared."""
    unfit: str = ""
    """Why it is not loaded, or not run at all."""
    problems: Mapping[str, str] = field(default_factory=dict)
    """Why it does not run, by way."""
    ways: tuple[str, ...] = ()
    """Those in which it ran to the end."""
    differences: Mapping[str, Difference] = field(default_factory=dict)
    """By way, from FMPy's run; if that failed, from the first other."""
    limit: float = 0.0

    @property
    def differing(self) -> dict[str, Difference]:
        """Differences that are beyond the limit."""
        return {way: one for way, one in self.differences.items() if not one.value <= self.limit}

    @property
    def status(self) -> str:
        """The state in a word or two."""
        if self.unfit:
            return "not run" if self.kind else "not loaded"
        if any(way in self.problems for way in WAYS if way != _REFERENCE):
            return "fails"
        if self.differing:
            return "differs"
        if self.problems:
            return "runs, FMPy fails"
        return "agrees" if self.outputs else "runs, no outputs"


def fmus_in(folder: Path) -> list[Path]:
    """Return the FMUs in a folder and those inside, sorted. Raises InputError if there is none."""
    if not folder.is_dir():
        raise InputError(f"{folder}: is no folder")
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() == ".fmu")
    if not found:
        raise InputError(f"{folder}: no .fmu file is in it, or in a folder inside")
    return found


def survey(paths: list[Path], timeout_s: float) -> Iterator[Surveyed]:
    """Yield each FMU as it is found; a run that takes longer than ``timeout_s`` has failed.

    Raises InputError where processes cannot be copied.
    """
    for path in paths:
        yield _surveyed(path, timeout_s)


def _surveyed(path: Path, timeout_s: float) -> Surveyed:
    try:
        fmu = load_fmu(path)
        if fmu.interface == "model exchange":
            fmu = load_fmu(path, FmuOptions(tolerance=SOLVERS))
        lacking = with_library(fmu).lacking
    except InputError as error:
        lacking = str(error).removeprefix(f"{path}: ").removeprefix(f"{path.resolve()}: ")
    if lacking:
        return Surveyed(path, unfit=lacking)
    kind = f"{fmu.description.fmiVersion} {fmu.interface}"
    if addresses := fmu.variables.of_role("address"):
        return Surveyed(path, kind, unfit=f"it would open its links: {', '.join(addresses)}")
    experiment, outputs = experiment_of(fmu), compared(fmu)
    runs: dict[str, Rows] = {}
    problems = {}
    for name, way in WAYS.items():
        try:
            runs[name] = in_child(partial(_run, way, fmu, experiment), timeout_s)
        except SimulationError as error:
            problems[name] = str(error).removeprefix(f"{fmu.path}: ")
    ran = {name: rows for name, rows in runs.items() if rows is not None}
    limit = LIMITS[fmu.interface]
    reference = _REFERENCE if _REFERENCE in ran else next(iter(ran), "")
    differences = {
        name: difference(rows, ran[reference], experiment, limit)
        for name, rows in ran.items()
        if name != reference and outputs
    }
    return Surveyed(
        path,
        kind,
        experiment,
        len(outputs),
        problems=problems,
        ways=tuple(ran),
        differences=differences,
        limit=limit,
    )


def _run(way: Way, fmu: LoadedFmu, experiment: Experiment) -> Rows | None:
    try:
        return way(fmu, experiment)
    except NotThisWay:
        return None


_STREAMS = (1, 2)
_LONGEST = 300
"""Characters of what an FMU says on its end."""


def in_child(call: Callable[[], Any], timeout_s: float) -> Any:
    """Return what ``call`` returns in a child of this process; its streams go nowhere.

    Raises SimulationError for every exception there, if the child ends without an answer, and
    if it takes longer than ``timeout_s``; InputError where processes cannot be copied.
    """
    if os.name != "posix":
        raise InputError("a survey needs Linux or another POSIX system")
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    with tempfile.TemporaryFile() as said, receiver:
        child = context.Process(target=_answer, args=(call, sender, said), daemon=False)
        child.start()
        sender.close()
        try:
            if not receiver.poll(timeout_s):
                raise SimulationError(f"took longer than {timeout_s:g} s")
            kind, result = receiver.recv()
        except EOFError:
            child.join()
            last = f"; it said: {text}" if (text := _last_line(said)) else ""
            raise SimulationError(f"its process {how_ended(child.exitcode or 0)}{last}") from None
        finally:
            child.kill()
            child.join()
    if kind is not None:
        raise SimulationError(f"{kind}: {result}" if kind else result)
    return result


def _answer(call: Callable[[], Any], sender: Connection, said: IO[bytes]) -> None:
    for stream in _STREAMS:
        os.dup2(said.fileno(), stream)
    try:
        answer: tuple[str | None, Any] = None, call()
    except (InputError, SimulationError) as error:
        answer = "", str(error)
    except BaseException as error:  # whatever the other tool raises is its answer
        answer = type(error).__name__, str(error)
    sender.send(answer)
    os._exit(0)  # no FMU's library has a part in the end


def _last_line(said: IO[bytes]) -> str:
    said.seek(0)
    lines = [line.strip() for line in said.read().decode(errors="replace").splitlines()]
    return next((line[:_LONGEST] for line in reversed(lines) if line), "")
