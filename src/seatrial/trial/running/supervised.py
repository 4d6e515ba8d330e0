"""The child of a `Supervisor`: it runs the trials that it is ordered to."""

from __future__ import annotations

import gc
import os
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...errors import InputError, SeatrialError, SimulationError
from ...system.system import Engine, System
from ..files.trial import Trial
from .forked_child import Child, forward_output
from .hooks import Hooks, Observer
from .link import Frame
from .measuring import measure_together, measure_trial
from .memory import resident_bytes
from .run import Result, check_trial, run_trial

Page = Callable[[Path], object]
"""Writes the report of a run's folder."""


def no_page(_folder: Path) -> None:
    """Write no report."""


def serve(
    trials: Sequence[Trial],
    engine: Engine,
    page: Page,
    observer: Observer | None,
    keep_going: bool,
    child: Child,
) -> None:
    """Carry out orders until there are no more: each is an `Order` of the supervision.

    ``page`` writes the report of a run's folder, ``observer`` looks at the runs, which
    ``keep_going`` without a lost link.

    Each ends with one frame: ``done`` or ``error``.
    """
    forward_output(child.link)
    here = Path.cwd()
    while (orders := child.link.receive()) is not None:
        for order in orders:
            os.chdir(here)  # a component may have left it
            with _limited(child, order[0]):
                seen = child, observer, keep_going
                done = _carried_out(order, trials, engine, page, seen)
            child.link.send(*done)
            gc.collect(0)  # a trial's objects refer to each other: thousands of them would pile up


def _carried_out(
    order: Frame,
    trials: Sequence[Trial],
    engine: Engine,
    page: Page,
    seen: tuple[Child, Observer | None, bool],
) -> Frame:
    what, number, folder, changes, several = order
    try:
        out = None if folder is None else Path(folder)
        if what == "report" and out is not None:
            page(out)
            return ["done", {}]
        if what == "measure together":
            return ["done", {"found": _together(several, trials, engine, _unnoted(seen[0]))}]
        trial = _changed(trials, number, changes)
        is_noted = what != "measure" or trial.file.limit.is_of_run
        hooks = _hooks(*seen) if is_noted else _unnoted(seen[0])
        if what == "check":
            return ["done", {"alone": check_trial(trial, engine, hooks)}]
        if what == "measure":
            return ["done", vars(measure_trial(trial, engine=engine, hooks=hooks))]
        result = run_trial(trial, out, engine=engine, hooks=hooks)
        return ["done", _written(result)]
    except SeatrialError as error:
        return ["error", type(error).__name__, str(error)]
    except OSError as error:
        what = f"cannot read or write {error.filename or 'a file'}: {error.strerror}"
        return ["error", SimulationError.__name__, what]
    except KeyboardInterrupt:
        return ["error", KeyboardInterrupt.__name__, ""]
    except BaseException as error:  # SystemExit too: nothing that a component does is an end
        text = "".join(traceback.format_exception(error)).strip()
        return ["error", SimulationError.__name__, f"an error of seatrial itself:\n{text}"]


def _changed(trials: Sequence[Trial], number: int, changes: Any) -> Trial:
    return trials[number] if changes is None else trials[number].changed(*changes)


def _together(
    several: Sequence[tuple[int, Any]], trials: Sequence[Trial], engine: Engine, hooks: Hooks
) -> list[dict[str, Any] | None]:
    """Return what trials come to that can share a compiled program; None of each other."""
    made: dict[int, Trial] = {}
    for place, (number, changes) in enumerate(several):
        with suppress(InputError):  # the order for it alone will say so
            made[place] = _changed(trials, number, changes)
    measured = measure_together(list(made.values()), engine, hooks, len(trials))
    found = dict(zip(made, measured, strict=True))
    return [None if (each := found.get(i)) is None else vars(each) for i in range(len(several))]


@contextmanager
def _limited(child: Child, what: str) -> Iterator[None]:
    """Let the keeper see that a run goes on, which has limits."""
    trace = child.call_trace
    is_run = what in ("measure", "measure together", "run")
    trace.before = resident_bytes(os.getpid()) if is_run else 0
    trace.runs += is_run
    child.notes = True
    try:
        yield
    finally:
        trace.runs += is_run


def _unnoted(child: Child) -> Hooks:
    """Return hooks without a note of each call: who dies is run again, with them."""

    def assembled(_system: System, _manifest: object) -> None:
        child.notes = False

    return Hooks(
        assembled=assembled,
        stop_requested=child.asked,
        interruptible=child.interruptible,
        begun=child.begun,
    )


def _hooks(child: Child, observer: Observer | None, keep_going: bool) -> Hooks:
    link, trace = child.link, child.call_trace

    def assembled(system: System, manifest: dict[str, Any]) -> None:
        for number, part in enumerate(system.parts.values()):
            part.instance = trace.traced(part.instance, number)
        link.send("assembled", manifest)

    return Hooks(
        building=lambda what: link.send("building", what),
        progress=lambda passed, whole: link.send("progress", passed, whole),
        reachable=lambda name, where: link.send("reachable", name, where),
        assembled=assembled,
        claimed=lambda folder: link.send("claimed", str(folder)),
        stop_requested=child.asked,
        interruptible=child.interruptible,
        begun=child.begun,
        observer=observer,
        keep_going=keep_going,
    )


def _written(result: Result) -> dict[str, object]:
    verdicts = [(name, check, asdict(verdict)) for name, check, verdict in result.verdicts]
    return {
        "status": result.status,
        "error": result.error,
        "verdicts": verdicts,
        "notes": result.notes,
        "wall": result.wall,
        "seed": result.seed,
        "figures": result.figures,
    }
