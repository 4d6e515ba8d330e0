"""The commands and how their errors reach the user."""

from __future__ import annotations

import os
import signal
import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from .. import __version__
from ..cosim.files import available
from ..cosim.system import Engine
from ..errors import InputError, SeatrialError, SimulationError
from ..fmi.source import shipped_sources
from ..links.hardware import allow as allow_hardware
from ..trials.campaign import Campaign, Case, load_campaign, run_campaign
from ..trials.campaign_report import write_campaign_report
from ..trials.compare import compare as compare_runs
from ..trials.convergence import run_convergence
from ..trials.report import write_report
from ..trials.run import Hooks, Result, run_trial
from ..trials.trial import Trial, load_trial
from .convergence import print_convergence
from .decode import decode_app
from .design import design
from .doctor import doctor
from .drive import drive
from .export import export
from .fmu import fmu_app
from .identify import identify
from .profile import profile_app
from .show import (
    Watch,
    console,
    print_case,
    print_listing,
    print_notes,
    print_reachable,
    print_verdicts,
)
from .sketch import sketch_app
from .ssp import ssp_app

_FAILED, _BAD_INPUT, _BROKEN = 1, 2, 3

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Sea trials before the water: co-simulated trials of marine vehicles.",
)
app.add_typer(fmu_app, name="fmu", help="List, build, check and describe FMUs.")
app.add_typer(profile_app, name="profile", help="Check and describe profiles of electronics.")
app.add_typer(decode_app, name="decode", help="Show recorded streams as text.")
app.add_typer(sketch_app, name="sketch", help="Check, build and run Arduino sketches.")
app.add_typer(ssp_app, name="ssp", help="Export and check SSP packages.")


def main() -> None:
    """Run the command line; every error meant for the user is one message and a status."""
    try:
        app()
    except InputError as error:
        _complain(error, _BAD_INPUT)
    except SeatrialError as error:
        _complain(error, _BROKEN)
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        _complain(SimulationError(f"cannot read or write{where}: {error.strerror}"), _BROKEN)
    except KeyboardInterrupt:
        _complain(SimulationError("stopped"), _BROKEN)
    finally:
        _forget_closed_streams()


def _forget_closed_streams() -> None:
    """Drop what was printed to readers that are gone: Python would end with status 120."""
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)


def _complain(error: SeatrialError, status: int) -> None:
    print(f"seatrial: {error}", file=sys.stderr)
    sys.exit(status)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"seatrial {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Options before the command."""


_Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set component.port, or a trial's key."),
]
_EngineName = Annotated[
    str, typer.Option("--engine", help="'fmu': every component is an FMU; 'direct': in process.")
]
_Out = Annotated[
    Path | None, typer.Option("--out", help="Folder of the run (default: runs/NAME-DATE-TIME).")
]


@app.command()
def run(
    trial: Annotated[
        str, typer.Argument(help="A trial or campaign: a name, a .toml or an .ssp file.")
    ],
    settings: _Settings = None,
    engine: _EngineName = "fmu",
    out: _Out = None,
    real_time: Annotated[
        float | None,
        typer.Option(metavar="FACTOR", help="Simulated seconds per second of wall time."),
    ] = None,
    in_real_time: Annotated[
        bool, typer.Option("--realtime", help="In real time: as the trial says, or factor 1.")
    ] = False,
    overrun: Annotated[
        str | None,
        typer.Option(metavar="POLICY", help="In real time: 'catch-up', 'slip' or 'abort'."),
    ] = None,
    hardware: Annotated[
        bool, typer.Option("--hardware", help="Allow real ports; what is behind them may move.")
    ] = False,
) -> None:
    """Run a trial, or a campaign of trials, and say what holds."""
    chosen = _engine(engine)
    if hardware:
        allow_hardware()
    changes = dict(_setting(text) for text in settings or [])
    pace = {"factor": real_time, "overrun": overrun}
    pace = {key: value for key, value in pace.items() if value is not None}
    if _is_campaign(trial):
        campaign = load_campaign(trial)
        if changes:
            raise InputError("--set works with a trial; a campaign sets its own parameters")
        if pace:
            raise InputError("--real-time and --overrun work with a trial, not with a campaign")
        if in_real_time:
            raise InputError("--realtime works with a trial, not with a campaign")
        _run_campaign(campaign, out, chosen)
        return
    loaded = load_trial(trial, changes=changes, origin="--set")
    if in_real_time and loaded.file.real_time is None:
        pace.setdefault("factor", 1.0)
    loaded = _paced(loaded, pace)
    print_notes(loaded.notes)
    with _stoppable() as stop:
        with Watch(loaded.name) as watch:
            hooks = Hooks(
                watch.building, watch.progress, stop.requested, stop.interruptible, print_reachable
            )
            result = run_trial(loaded, out, engine=chosen, hooks=hooks)
        print_verdicts(result)
        report_page = write_report(result.folder)
    console.print(f"report: {report_page}", soft_wrap=True)
    _exit_with([result])


def _run_campaign(campaign: Campaign, out: Path | None, engine: Engine) -> None:
    cases = campaign.cases()
    with _stoppable() as stop:
        with Watch(campaign.read_from.name) as watch:

            def done(case: Case, result: Result) -> None:
                watch.log(lambda: print_case(case, result))
                write_report(result.folder)

            hooks = Hooks(watch.building, watch.progress, stop.requested, stop.interruptible)
            watch.expect(len(cases))
            folder, finished = run_campaign(campaign, out, engine=engine, hooks=hooks, done=done)
        page = write_campaign_report(folder)
    passed = sum(result.passed for _, result in finished)
    console.print(f"{passed} of {len(cases)} cases pass")
    console.print(f"report: {page}", soft_wrap=True)
    if len(finished) < len(cases):
        raise SimulationError(f"stopped; {len(finished)} of {len(cases)} cases are on disk")
    _exit_with([result for _, result in finished])


@app.command()
def convergence(
    trial: Annotated[str, typer.Argument(help="A trial: a name, a .toml or an .ssp file.")],
    halvings: Annotated[int, typer.Option(help="How often the step is halved, at least 2.")] = 2,
    settings: _Settings = None,
    engine: _EngineName = "fmu",
    out: _Out = None,
) -> None:
    """Halve a trial's communication step: order and error of each output; status 1 if erratic."""
    chosen = _engine(engine)
    changes = dict(_setting(text) for text in settings or [])
    if _is_campaign(trial):
        raise InputError(f"convergence works with a trial; {trial} is a campaign")
    loaded = load_trial(trial, changes=changes, origin="--set")
    print_notes(loaded.notes)
    with _stoppable() as stop:
        with Watch(loaded.name) as watch:

            def done(result: Result) -> None:
                watch.log(lambda: None)
                write_report(result.folder)

            hooks = Hooks(watch.building, watch.progress, stop.requested, stop.interruptible)
            watch.expect(halvings + 1)
            folder, found = run_convergence(
                loaded, out, halvings=halvings, engine=chosen, hooks=hooks, done=done
            )
        page = write_report(folder)
    print_convergence(found)
    console.print(f"report: {page}", soft_wrap=True)
    if not found.converges:
        raise typer.Exit(_FAILED)


@app.command("list")
def list_all() -> None:
    """List trials, campaigns, rigs, vehicles, profiles, experiments and FMUs by name."""
    print_listing(
        {
            "trials": available("harness/trials"),
            "campaigns": available("harness/campaigns"),
            "rigs": available("harness/rigs"),
            "vehicles": available("vehicles"),
            "profiles": available("hil_profiles"),
            "experiments": available("harness/identification"),
        },
        {name: source.component_class() for name, source in shipped_sources().items()},
    )


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run or campaign.")],
) -> None:
    """Write the report of a run again."""
    is_campaign = (folder / "campaign.json").is_file()
    page = write_campaign_report(folder) if is_campaign else write_report(folder)
    console.print(f"report: {page}", soft_wrap=True)


@app.command()
def compare(
    run_a: Annotated[Path, typer.Argument(help="Folder of a run.")],
    run_b: Annotated[Path, typer.Argument(help="Folder of another run.")],
) -> None:
    """Compare two runs signal by signal; status 1 if their signals differ."""
    comparison = compare_runs(run_a, run_b)
    console.print(comparison.table())
    console.print(comparison.summary)
    if not comparison.identical:
        raise typer.Exit(_FAILED)


app.command("design")(design)
app.command("doctor")(doctor)
app.command("drive")(drive)
app.command("export")(export)
app.command("identify")(identify)


def _engine(name: str) -> Engine:
    if name not in ("fmu", "direct"):
        raise InputError(f"--engine: 'fmu' or 'direct' is needed, found {name!r}")
    return "direct" if name == "direct" else "fmu"


def _paced(trial: Trial, pace: dict[str, Any]) -> Trial:
    """Return the trial with what the command line says of real time."""
    if not pace:
        return trial
    if "factor" not in pace and trial.file.real_time is None:
        raise InputError("--overrun needs --real-time, or real_time in the trial")
    return trial.in_real_time(pace, "command line: real_time")


def _is_campaign(name: str) -> bool:
    if name.endswith(".toml"):
        path = Path(name)
        return path.is_file() and "trials" in _top_keys(path)
    return name in available("harness/campaigns") and name not in available("harness/trials")


def _top_keys(path: Path) -> set[str]:
    try:
        return set(tomllib.loads(path.read_text("utf-8")))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError):
        return set()  # the reader of the trial will say what is wrong


def _setting(text: str) -> tuple[str, Any]:
    """Return ``KEY=VALUE`` parsed: a number, a list, true or false as in TOML; else a text."""
    key, equals, value = text.partition("=")
    if not equals or not key:
        raise InputError(f"--set: KEY=VALUE is needed, found {text!r}")
    plain = value.strip()
    if plain.lstrip("+-") in ("nan", "inf"):  # TOML takes these words for numbers
        return key.strip(), plain
    try:
        return key.strip(), tomllib.loads(f"x = {value}")["x"]
    except tomllib.TOMLDecodeError:
        return key.strip(), plain


def _exit_with(results: list[Result]) -> None:
    if any(result.status == "failed" for result in results):
        first = next(result.error for result in results if result.status == "failed")
        raise SimulationError(str(first))
    if any(result.status == "stopped" for result in results):
        raise SimulationError("stopped; the signals recorded so far are on disk")
    if not all(result.passed for result in results):
        raise typer.Exit(_FAILED)


class _Stop:
    """Counts the signals that ask a run to stop.

    The second one and later ones raise KeyboardInterrupt, but only where a component may hang:
    what is being written then, or made of what was written, gets finished. They often come
    twice: ``timeout`` and service managers signal a process and its group, people press twice.
    """

    def __init__(self) -> None:
        self._asked = 0
        self._may_hang = False

    def ask(self, _number: int, _frame: object) -> None:
        """Handle a signal."""
        self._asked += 1
        if self._asked > 1 and self._may_hang:
            raise KeyboardInterrupt

    def requested(self) -> bool:
        """Say if there was one."""
        return self._asked > 0

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let a second signal end what is done inside."""
        self._may_hang = True
        try:
            yield
        finally:
            self._may_hang = False


@contextmanager
def _stoppable() -> Iterator[_Stop]:
    """Make Ctrl-C and a termination signal end the run after the current step.

    A second one ends it at once, if a component hangs.
    """
    stop, numbers = _Stop(), (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, stop.ask) for number in numbers}
    try:
        yield stop
    except KeyboardInterrupt:
        raise SimulationError("stopped") from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
