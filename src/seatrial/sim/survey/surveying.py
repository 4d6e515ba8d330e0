"""A folder of FMUs surveyed, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from ...errors import InputError, SimulationError
from ...fmi.files.options import FmuOptions
from ...fmi.interfaces.loaded import LoadedFmu
from ...fmi.loading.built import with_library
from ...fmi.loading.load import load_fmu
from .agreement import LIMITS, SOLVERS, Difference, difference
from .child import in_child
from .experiment import Experiment, experiment_of
from .ways import WAYS, NotThisWay, Rows, Way, compared

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
