"""Mistakes that would go on without a word: delays, forgotten connections, a lost compiled master."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.sim.compiled import choice
from seatrial.system.assembling.assembly import assemble
from seatrial.system.assembling.fitted_parts import forgotten
from seatrial.system.flattening import load_rig
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.preparation import prepare
from seatrial.trial.running.run import Hooks, run_trial

PARTS = '''
import math
from seatrial.model.component import Component, Input, Output, Terms
from seatrial.model.plant import Plant, State
from helping import inverse


class Ramp(Component):
    y = Output("1", "time")

    def outputs(self, t):
        self.y = t


class Gain(Component):
    u = Input("1", "in")
    y = Output("1", "out")

    def outputs(self, t):
        self.y = 2.0 * self.u


class Crossed(Component):
    """Its two ways do not touch: joined crosswise with another they are no loop."""

    a = Input("1", "in")
    b = Input("1", "in")
    y = Output("1", "of a")
    z = Output("1", "of b")

    def outputs(self, t):
        self.y, self.z = self.a + 1.0, 3.0 * self.b


class Dark(Component):
    """Nobody can tell from the text what it reads."""

    u = Input("1", "in")
    y = Output("1", "out")

    def outputs(self, t):
        self.y = 2.0 * self.values[self.ports[chr(117)].offset]


class Breaks(Component):
    y = Output("1", "out")

    def outputs(self, t):
        self.y = t if t < 0.15 else inverse(0.0)


class Body(Component):
    force = Terms(2, "N", "forces")
    moment = Input("N.m", "moment")
    command = Input("1", "order", role="command")
    other = Input("1", "something")
    y = Output("1", "out")

    def outputs(self, t):
        self.y = self.force + self.moment + self.command + self.other


class Hull(Plant):
    """100 u' = force - 30 u."""

    force = Input("N", "force")
    x = State("m", "place", start=1.0)
    v = State("m/s", "speed")

    def equations(self, x, u, p):
        return {"x": x.v, "v": (u.force - 30.0 * x.v) / 100.0}, {}


class Appendage(Plant):
    """On a spring and a damper of the hull; its feed-through is in its equations."""

    x_hull = Input("m", "place of the hull")
    x = State("m", "place")
    v = State("m/s", "speed")
    force = Output("N", "force on the hull")

    def equations(self, x, u, p):
        f = 400.0 * (x.x - u.x_hull) + 12.0 * x.v
        return {"x": x.v, "v": -f / 8.0}, {"force": f}
'''
HELPING = "def inverse(x):\n    return 1.0 / x\n"


def written(
    folder: Path, components: dict[str, str], connections: str, algorithm: str = ""
) -> Path:
    (folder / "parts.py").write_text(PARTS, "utf-8")
    (folder / "helping.py").write_text(HELPING, "utf-8")
    lines = [f'algorithm = "{algorithm}"'] if algorithm else []
    lines += ['step = "100 ms"', "[components]"]
    lines += [f'{name} = {{ fmu = "parts.py:{cls}" }}' for name, cls in components.items()]
    (folder / "rig.toml").write_text("\n".join([*lines, "[connections]", connections]), "utf-8")
    (folder / "trial.toml").write_text('rig = "rig.toml"\nstop = "500 ms"\n', "utf-8")
    return folder / "trial.toml"


ENGINES = ("direct", "fmu", pytest.param("native", marks=pytest.mark.interop))


def run(trial: Path, engine: Any) -> Any:
    return run_trial(load_trial(str(trial)), trial.with_name(f"run-{engine}"), engine=engine)


def column(result: Any, name: str) -> list[float]:
    with Path(result.folder, "signals.csv").open(encoding="utf-8") as file:
        return [float(row[name]) for row in csv.DictReader(file)]


@pytest.mark.parametrize("engine", ENGINES)
def test_what_nobody_declared_delays_nothing(tmp_path: Path, engine: Any) -> None:
    trial = written(
        tmp_path, {"one": "Gain", "two": "Gain", "dark": "Dark", "ramp": "Ramp"},
        '"ramp.y" = "one.u"\n"one.y" = "two.u"\n"two.y" = "dark.u"',
    )  # fmt: skip
    result = run(trial, engine)
    assert column(result, "dark.y") == [8.0 * y for y in column(result, "ramp.y")]


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_outputs_that_do_not_depend_make_no_loop(tmp_path: Path, engine: Any) -> None:
    trial = written(
        tmp_path, {"one": "Crossed", "two": "Crossed"}, '"one.y" = "two.b"\n"two.z" = "one.b"'
    )
    system = prepare(load_trial(str(trial)), engine, Hooks()).system
    assert dict(system.parts["one"].instance.feedthrough) == {"y": ["a"], "z": ["b"]}
    system.free()
    result = run(trial, engine)
    assert set(column(result, "two.z")) == {3.0}


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_a_plant_needs_no_declaration(tmp_path: Path, engine: Any) -> None:
    trial = written(
        tmp_path, {"hull": "Hull", "appendage": "Appendage"},
        '"hull.x" = "appendage.x_hull"\n"appendage.force" = "hull.force"', "gauss-seidel",
    )  # fmt: skip
    assert run(trial, engine).status == "complete"


def test_what_is_unknown_is_said_once(tmp_path: Path) -> None:
    trial = written(tmp_path, {"a": "Dark", "b": "Dark", "ramp": "Ramp"}, '"ramp.y" = "a.u"')
    notes = [note for note in run(trial, "direct").notes if "depend" in note]
    assert len(notes) == 1
    assert notes[0].startswith("a, b: every output is taken to depend on every input")
    assert "parts.py, line" in notes[0]


def test_forgotten_forces_and_commands_have_lines_of_their_own(tmp_path: Path) -> None:
    written(tmp_path, {"body": "Body", "ramp": "Ramp"}, "")
    system = assemble(load_rig(str(tmp_path / "rig.toml")), "direct")
    assert list(forgotten(system).values()) == [
        "nothing feeds the moment body.moment: it stays at 0.0 N.m",
        "nothing feeds the command body.command: it stays at 0.0",
        "nothing feeds the force body.force: none of its terms is connected",
    ]
    notes = run(tmp_path / "trial.toml", "direct").notes
    assert "inputs that nothing feeds keep their start values: body.other" in notes
    assert "nothing feeds the moment body.moment: it stays at 0.0 N.m" in notes


def test_a_pattern_that_matches_nothing_is_answered_with_near_names(tmp_path: Path) -> None:
    trial = written(tmp_path, {"ramp": "Ramp"}, "")
    text = trial.read_text("utf-8")
    trial.write_text(text + '[record]\nsignals = ["rmap.*"]\n', "utf-8")
    with pytest.raises(InputError, match=r"no signal matches 'rmap.\*'; did you mean 'ramp.y'\?"):
        run(trial, "direct")


@pytest.mark.parametrize("isolated", ["false", "true"])
def test_an_error_in_an_fmu_names_the_users_own_files(tmp_path: Path, isolated: str) -> None:
    trial = written(tmp_path, {"broken": "Breaks"}, "")
    rig = tmp_path / "rig.toml"
    text = rig.read_text("utf-8")
    rig.write_text(text.replace('Breaks" }', f'Breaks", isolated = {isolated} }}'), "utf-8")
    result = run(trial, "fmu")
    assert result.status == "failed"
    line = 1 + PARTS.splitlines().index("        self.y = t if t < 0.15 else inverse(0.0)")
    assert f'File "{tmp_path}/parts.py", line {line}, in outputs' in result.error
    assert f'File "{tmp_path}/helping.py", line 2, in inverse' in result.error
    assert "bundle_" not in result.error


def test_an_algorithm_that_loses_the_compiled_master_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, {"ramp": "Ramp"}, "", "iterated")
    system = assemble(load_rig(str(tmp_path / "rig.toml")), "direct")
    assert choice.lost_by_algorithm(system) == ""  # there was none to lose
    monkeypatch.setattr(system.parts["ramp"].instance, "is_native", True, raising=False)
    monkeypatch.setattr("seatrial.sim.compiled.library.library", lambda: object())
    assert choice.lost_by_algorithm(system).startswith(
        "the master's steps are taken in Python, not in C: the algorithm 'iterated' is none of"
    )
