"""``seatrial convergence``: a trial at halved communication steps."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from ..errors import InputError
from ..model.readable import number, person_scale
from ..trial.files.trial import load_trial
from ..trial.records.accuracy import Accuracy, by_port, order_text, spread_text
from ..trial.reports.playing import play
from ..trial.reports.report import write_report
from ..trial.running.convergence import Convergence, run_convergence
from ..trial.running.hooks import Hooks
from ..trial.running.run import Result
from .answer import answer
from .options import (
    Autopilot,
    Choices,
    EngineName,
    Out,
    Settings,
    Vehicle,
    changes_of,
    engine_named,
    is_campaign,
)
from .show import console, print_notes
from .statuses import FAILED
from .stopping import stoppable
from .watch import Watch


def convergence(
    trial: Annotated[str, typer.Argument(help="A trial: a name, a file or a package.")],
    halvings: Annotated[int, typer.Option(help="Number of halvings of the step, at least 2.")] = 2,
    settings: Settings = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    engine: EngineName = "fmu",
    out: Out = None,
) -> None:
    """Halve a trial's communication step: order and error of each output; status 1 if erratic."""
    chosen = engine_named(engine)
    changes = changes_of(settings, choices, vehicle, autopilot)
    if is_campaign(trial):
        raise InputError(f"convergence works with a trial; {trial} is a campaign")
    loaded = load_trial(trial, changes=changes, origin="--set")
    print_notes(loaded.notes)
    with stoppable() as stop:
        with Watch(loaded.name) as watch:

            def done(result: Result) -> None:
                watch.log(lambda: None)
                write_report(result.folder, play=play)

            hooks = Hooks(
                building=watch.building,
                progress=watch.progress,
                stop_requested=stop.requested,
                interruptible=stop.interruptible,
            )
            watch.expect(halvings + 1)
            folder, found = run_convergence(
                loaded, out, halvings=halvings, engine=chosen, hooks=hooks, done=done
            )
        page = write_report(folder, play=play)
    answer.result = {
        "folder": str(folder),
        "steps_s": found.steps,
        "converges": found.converges,
        "outputs": [asdict(output) for output in found.outputs],
        "discrete": [asdict(one) for one in found.discrete],
    }
    _print(found)
    console.print(f"report: {page}", soft_wrap=True)
    if not found.converges:
        raise typer.Exit(FAILED)


def _print(found: Convergence) -> None:
    """Print the worst output of each port, and what does not converge, differs or is exact."""
    own, half = (f"{number(step * 1e3, 9)} ms" for step in found.steps[:2])
    rows = [
        worst for worst in by_port(found.outputs, found.components) if worst.behaviour != "exact"
    ]
    if rows:
        title = f"{found.trial}, estimated errors"
        table = Table(title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
        table.add_column("output", overflow="fold")
        table.add_column("unit")
        for heading in ("order", f"at {own}", "of range", f"at {half}"):
            table.add_column(heading, justify="right")
        for worst in rows:
            table.add_row(*_row(worst))
        console.print(table)
        console.print(f"the trial's own step is {own}; of each port the worst axis is shown")
    exact = [output.signal for output in found.outputs if output.behaviour == "exact"]
    if exact:
        console.print(f"{len(exact)} outputs are exact: they differ by round-off, or not at all")
    for one in found.discrete:
        at = next(at for at in one.differs_at if at is not None)
        console.print(f"{escape(one.signal)} differs between steps, first at {number(at, 9)} s")
    wrong = sum(output.behaviour == "not converging" for output in found.outputs)
    if wrong:
        console.print(f"[red]{wrong} of {len(found.outputs)} outputs do not converge[/red]")


def _row(worst: Accuracy) -> list[str]:
    factor, unit = person_scale(worst.unit)
    name = escape(worst.signal)
    spread = spread_text(worst.orders)
    order = order_text(worst.orders[-1]) + (f" ({spread})" if spread else "")
    if worst.behaviour == "not converging":
        apart = number(worst.differences[0] * factor, 3)
        return [name, unit, f"[red]{order}[/red]", f"{apart} apart", _share(worst), "?"]
    own, half = (number(error * factor, 3) for error in worst.errors[:2])
    return [name, unit, order, own, _share(worst), half]


def _share(worst: Accuracy) -> str:
    return f"{number(100 * worst.relative, 2)} %" if worst.range else "constant"
