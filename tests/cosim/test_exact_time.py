"""Times of steps as FMUs see them: t + h is the next t, to the last bit, on every path."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import seatrial.sim.master
from seatrial.model.component import NS
from seatrial.sim.instants import interval
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from ..fmi.native import build_native_fmu, changed, variant

MILLISECONDS = (1, 3, 7, 10, 33, 50, 100, 333)
CARRIERS = ("compiled", "python", "isolated")


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exact")
    plain = build_native_fmu("fmi2", folder)
    variant(plain, folder / "strict.fmu", "STRICT")
    counts = variant(plain, folder / "counts.fmu", "COUNTS")
    fixed = ('canHandleVariableCommunicationStepSize="true"', "")
    changed(counts, folder / "fixed.fmu", fixed)
    variant(plain, folder / "commits.fmu", "COMMITS")
    return folder


@contextmanager
def running(path: Path, text: str, *, carrier: str, stop_ns: int | None = None) -> Iterator[Master]:
    """A master of a rig, initialised."""
    path.write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        if carrier == "python":
            patch.setattr(seatrial.sim.master, "is_compiled", lambda _system: False)
        system = assemble(load_rig(str(path)))
        try:
            master = Master(system, stop_ns=stop_ns)
            master.initialise()
            assert master.is_compiled == (carrier == "compiled")
            yield master
        finally:
            system.free()


def value(master: Master, name: str) -> Any:
    return master.signals[master.names.index(("a", name))]


def rig(fmu: str, step: str, carrier: str = "", **options: str) -> str:
    isolated = ", isolated = true" if carrier == "isolated" else ""
    top = "".join(f"{key} = {given}\n" for key, given in options.items())
    return f'{top}step = "{step}"\n[components]\na = {{ fmu = "{fmu}"{isolated} }}\n'


@pytest.mark.sampled(18)
@pytest.mark.parametrize("carrier", CARRIERS)
@pytest.mark.parametrize("milliseconds", MILLISECONDS)
def test_every_step_begins_where_the_one_before_ended(
    fmus: Path, carrier: str, milliseconds: int
) -> None:
    """An FMU that takes no other time, and none beyond the stop time: 304 stop times, 24 isolated."""
    step_ns = milliseconds * 1_000_000
    numbers = (3, 29, 100) if carrier == "isolated" else range(1, 39)
    for number in numbers:
        text = rig("strict.fmu", f"{milliseconds} ms", carrier)
        with running(fmus / "r.toml", text, carrier=carrier, stop_ns=number * step_ns) as master:
            while master.steps < number:
                master.advance(number - master.steps)
            assert master.time_ns == number * step_ns


@pytest.mark.parametrize("carrier", CARRIERS)
def test_an_fmu_for_one_length_gets_one_length(fmus: Path, carrier: str) -> None:
    """0.1 s, 0.2 s, 0.3 s are no multiples of one double."""
    changes = {}
    for fmu in ("counts.fmu", "fixed.fmu"):
        with running(fmus / "c.toml", rig(fmu, "10 ms", carrier), carrier=carrier) as master:
            while master.steps < 50:
                master.advance(50 - master.steps)
            changes[fmu] = value(master, "j")
    assert changes["counts.fmu"] > 0
    assert changes["fixed.fmu"] == 0


def test_lengths_end_at_the_next_time() -> None:
    for t_ns in (0, 1, 10_000_000, 123_456_789, 86_400 * NS, 7 * 10**16):
        for h_ns in (1, 1_000_000, 10_000_000, 33_333_333, NS):
            t, h = interval(t_ns, h_ns, constant=False)
            assert t == t_ns / NS
            assert t + h == (t_ns + h_ns) / NS
            assert interval(t_ns, h_ns, constant=True) == (t_ns / NS, h_ns / NS)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("carrier", CARRIERS)
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel", "iterated"])
def test_an_fmu_that_waits_for_the_word_moves(fmus: Path, carrier: str, algorithm: str) -> None:
    """A step that nobody goes back behind is final; with a state that somebody holds it is not."""
    if algorithm == "iterated":
        carrier = "python" if carrier == "compiled" else carrier
    text = rig("commits.fmu", "100 ms", carrier, algorithm=f'"{algorithm}"')
    with running(fmus / "w.toml", text, carrier=carrier) as master:
        moved = [value(master, "x")]

        def on(steps: int) -> None:
            goal = master.steps + steps
            while master.steps < goal:
                master.advance(goal - master.steps)
            moved.append(value(master, "x"))

        on(3)
        saved = master.save()
        on(2)
        master.restore(saved)
        master.free(saved)
        on(2)
    assert moved[1] == pytest.approx(moved[0] * 2.718281828459045**-0.3, rel=1e-12)
    assert moved[2] == moved[1]
    assert moved[3] == pytest.approx(moved[0] * 2.718281828459045**-0.5, rel=1e-12)
