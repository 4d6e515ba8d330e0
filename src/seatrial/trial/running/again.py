"""A trial run again in a new interpreter, with a note of each call to what no file decides.

That process shares no imported module with this one, and orders sets of texts in another way.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from ...errors import SeatrialError, SimulationError
from ...system.system import Engine
from ..files.trial import Trial
from .hooks import Hooks, StoppedError
from .outside_calls import OutsideCalls
from .run import run_trial

_SLICE_S = 0.2


@dataclass
class Again:
    """A run that was repeated."""

    folder: Path
    calls: dict[str, list[str]]
    """A line for each kind of call to what no file decides, by component."""


def run_again(
    trial: Trial, engine: Engine, folder: Path, stop_requested: Callable[[], int]
) -> Again:
    """Run ``trial`` into ``folder`` in a new interpreter. Raises SimulationError, StoppedError."""
    environment = {**os.environ, "PYTHONHASHSEED": "random"}
    with TemporaryFile() as order, TemporaryFile() as said:
        order.write(pickle.dumps((trial, engine, folder, sys.path)))
        order.seek(0)
        process = subprocess.Popen(
            [sys.executable, "-c", f"from {__name__} import main; main()"],
            stdin=order, stdout=said, stderr=said, env=environment,
        )  # fmt: skip
        try:
            while _goes_on(process):
                if stop_requested():
                    raise StoppedError("stopped before all runs were repeated")
        finally:
            process.kill()
            process.wait()
        said.seek(0)
        shown = said.read().decode("utf-8", "replace").strip()
    outcome = _outcome_of(folder)
    if not outcome.is_file():
        raise SimulationError(f"{trial.name}: its run in a new interpreter has died: {shown}")
    content = json.loads(outcome.read_text("utf-8"))
    if "error" in content:
        raise SimulationError(f"{trial.name}: in a new interpreter: {content['error']}")
    return Again(folder, content["calls"])


def main() -> None:
    """Carry out the order that stands on the standard input."""
    trial, engine, folder, path = pickle.load(sys.stdin.buffer)
    sys.path[:] = path
    content: dict[str, Any]
    calls = OutsideCalls()
    hooks = Hooks(building=calls.building, assembled=calls.assembled)
    try:
        with calls.noted():
            run_trial(trial, folder, engine=engine, hooks=hooks)
        content = {"calls": calls.found()}
    except SeatrialError as error:
        content = {"error": str(error)}
    _outcome_of(folder).write_text(json.dumps(content), "utf-8")


def _outcome_of(folder: Path) -> Path:
    """Return the file beside a run's folder with what the run has come to."""
    return folder.with_name(f"{folder.name}.json")


def _goes_on(process: subprocess.Popen[bytes]) -> bool:
    """Wait a moment, and say if a process has not ended."""
    try:
        process.wait(_SLICE_S)
    except subprocess.TimeoutExpired:
        return True
    return False
