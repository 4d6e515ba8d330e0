"""Rigs inside rigs: flattening, choices, what is shown, terminals and sums."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import System
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

USERS = '''
"""A body on which forces add up, what pushes it, who reads it."""
from seatrial.model.component import Component, Input, Output, Parameter, Terms, terminal


class Push(Component):
    """A constant force and moment."""

    force_value = Parameter(1.0, "N", "force")
    force = Output("N", "force", axes="xy")
    moment = Output("N.m", "moment")
    terminals = {"wrench": terminal("force", "moment")}

    def outputs(self, t):
        self.force = [self.force_value, 2.0 * self.force_value]
        self.moment = 0.1 * self.force_value


class Body(Component):
    """Publishes what acts on it."""

    force = Terms(3, "N", "force on it", axes="xy")
    moment = Terms(3, "N.m", "moment on it")
    total = Output("N", "sum of the forces", axes="xy")
    turning = Output("N.m", "sum of the moments")
    terminals = {
        "wrench": terminal("force", "moment", rule="plug"),
        "motion": terminal("total", turn="turning"),
    }
    feedthrough = {"total": ("force",), "turning": ("moment",)}

    def outputs(self, t):
        self.total, self.turning = self.force, self.moment


class Reader(Component):
    """Repeats what it reads."""

    total = Input("N", "what it reads", axes="xy")
    east = Input("N.m", "one scalar of it", optional=True)
    gain = Parameter(1.0, "1", "gain", tunable=True)
    y = Output("N", "gain times the first element")
    terminals = {"sensors": terminal("total"), "one": terminal(turn="east")}
    feedthrough = {"y": ("total",)}

    def outputs(self, t):
        self.y = self.gain * self.total[0]
'''
INNER = """
step = "10 ms"
[choices]
kind = "one"
[components]
body = { fmu = "../users.py:Body" }
push = { rig = "push-{kind}", set = { "push.force_value" = 4 } }
[connections]
"push.wrench" = "body.wrench"
[shows]
motion = ["body.motion", { push = "push.wrench.force" }]
load   = "body.wrench"
set    = "body.force_3"
"""
PUSHES = {
    "one": '[components]\npush = { fmu = "../users.py:Push", set = { force_value = 3 } }\n'
    '[shows]\nwrench = "push.wrench"\n',
    "two": '[components]\npush = { fmu = "../users.py:Push", set = { force_value = 30 } }\n'
    '[shows]\nwrench = { force = "push.force", moment = "push.moment" }\n',
}
TOP = """
step = "10 ms"
[components]
a      = { rig = "inner/body" }
b      = { rig = "inner/body", choices = { kind = "two" }, set = { "push.push.force_value" = 50 } }
more   = { fmu = "users.py:Push" }
reader = { fmu = "users.py:Reader" }
[connections]
"more.wrench" = ["a.load", "b.load"]
"a.motion"    = "reader.sensors"
"""


@pytest.fixture
def yard(tmp_path: Path, monkeypatch) -> Callable[[str], Path]:
    """Return a function that writes the top rig beside the files of the others."""
    monkeypatch.chdir(tmp_path)
    rigs = tmp_path / "harness" / "rigs"
    (rigs / "inner").mkdir(parents=True)
    (rigs / "users.py").write_text(USERS)
    (rigs / "inner" / "body.toml").write_text(INNER.replace('rig = "push-', 'rig = "inner/push-'))
    for name, text in PUSHES.items():
        (rigs / "inner" / f"push-{name}.toml").write_text(text)

    def write(text: str = TOP) -> Path:
        path = rigs / "top.toml"
        path.write_text(text)
        return path

    return write


def built(path: Path, **choices: str) -> System:
    return assemble(load_rig(str(path), None, choices), "direct")


def values(system: System, *names: str) -> list[float]:
    master = Master(system)
    master.initialise()
    places = {".".join(name): place for place, name in enumerate(master.names)}
    return [master.signals[places[name]] for name in names]


def refused(path: Path, **choices: str) -> str:
    with pytest.raises(InputError) as error:
        built(path, **choices)
    return str(error.value)


def test_components_have_paths_and_sums_add_their_terms_in_order(yard) -> None:
    system = built(yard())
    assert list(system.parts) == [
        "a.body", "a.push.push", "b.body", "b.push.push", "more", "reader"
    ]  # fmt: skip
    fed = {".".join(c.target): ".".join(c.source) for c in system.connections}
    # The inner rig's connections come first: its load is the first term.
    assert fed["a.body.force_1.x"] == "a.push.push.force.x"
    assert fed["a.body.force_2.y"] == "more.force.y"
    assert fed["a.body.moment_2"] == "more.moment"
    assert "a.body.force_3.x" not in fed
    assert values(system, "a.body.total.x", "a.body.turning", "b.body.total.y", "reader.y") == [
        4.0 + 1.0,
        0.1 * 4.0 + 0.1,
        2.0 * 50.0 + 2.0,
        5.0,
    ]


def test_the_outer_rig_sets_after_the_inner(yard) -> None:
    # 3 in the innermost file, 4 by the rig around it; for b, 30, 4 and 50.
    given = {name: part.given for name, part in built(yard()).parts.items() if "push" in name}
    assert given["a.push.push"]["force_value"].value == 4.0
    assert given["b.push.push"]["force_value"].value == 50.0
    assert "components.b.set" in given["b.push.push"]["force_value"].origin


def test_a_choice_of_the_top_goes_down(yard) -> None:
    path = yard(TOP + '[choices]\nkind = "one"\n')
    system = built(path, kind="two")
    assert system.rig.components["a.push.push"].scope.read_from.path.stem == "push-two"
    assert refused(path, knd="two").endswith(
        "unknown choice 'knd'; did you mean 'kind'? (known: kind)"
    )
    assert "unknown rig 'inner/push-three'" in refused(path, kind="three")


def test_a_choice_may_stand_on_another_one(yard) -> None:
    path = yard(TOP + '[choices]\nbase = "tw"\nkind = "{base}o"\n')
    system = built(path)
    assert system.rig.components["a.push.push"].scope.read_from.path.stem == "push-two"
    system = built(path, base="", kind="one")
    assert system.rig.components["a.push.push"].scope.read_from.path.stem == "push-one"


def test_an_empty_name_of_parameters_is_none(yard) -> None:
    more = 'more   = { fmu = "users.py:Push", parameters = "{of}" }'
    path = yard(TOP.replace('more   = { fmu = "users.py:Push" }', more) + '[choices]\nof = ""\n')
    assert values(built(path), "more.force.x") == [1.0]
    assert "nobody" in refused(path, of="nobody")


def test_what_an_inner_rig_is_chosen_must_be_used(yard) -> None:
    path = yard(TOP.replace('choices = { kind = "two" }', 'choices = { kin = "two" }'))
    assert "components.b.choices: unknown choice 'kin'; did you mean 'kind'" in refused(path)


def test_a_choice_without_a_value_is_named(yard) -> None:
    path = yard(TOP.replace('"inner/body" }', '"inner/{which}" }'))
    assert "components.a.rig: the choice 'which' has no value" in refused(path)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('"a.motion"    = "reader.sensors"', '"a.body.total" = "reader.total"',
         "a does not show 'body'"),
        ('"a.load", "b.load"', '"a.load", "b.lod"', "b does not show 'lod': unknown name 'lod'"),
        ('"a.motion"    = "reader.sensors"', '"a.motion" = "reader.total"',
         "reader.total is a port and a.motion a terminal"),
        ('"a.motion"    = "reader.sensors"', '"a.motion" = "b.motion"',
         "nothing joins: a.motion gives total, turn, push; b.motion gives total, turn, push"),
        ('"a.motion"    = "reader.sensors"', '"a.motion.totl" = "reader.total"',
         "unknown member 'totl'; did you mean 'total'"),
        ('"a.load", "b.load"', '"a.load", "a.load", "a.load"',
         "all 3 terms of a.body.force are fed, by a.push.push.force.x, more.force.x, more.force.x"),
        ('"a.motion"    = "reader.sensors"', '"a.motion" = "reader.sensors"\n"b.motion" = "reader.sensors"',
         "reader.total.x is already fed by a.body.total.x"),
        ('rig = "inner/body" }', 'rig = "top" }', "a rig contains itself: top -> top"),
        ('rig = "inner/body" }', 'rig = "inner/body", fmu = "users.py:Body" }',
         "components.a: either fmu, rig or sum is needed"),
        ('rig = "inner/body" }', 'rig = "inner/body", isolated = true }',
         "components.a.isolated: has no effect beside rig"),
        ('reader = { fmu = "users.py:Reader" }', 'reader = { fmu = "users.py:Reader", home = ["1 deg", "1 deg", "0 m"] }',
         "components.reader.home: has no effect beside fmu"),
        ('"push.push.force_value" = 50', '"push.psh.force_value" = 50',
         "components.b.set: unknown component 'psh'; did you mean 'push'"),
    ],
)  # fmt: skip
def test_mistakes_name_the_file_and_what_is_there(yard, before, after, said) -> None:
    assert before in TOP
    message = refused(yard(TOP.replace(before, after, 1)))
    assert said in message
    assert "top.toml" in message


def test_a_plug_that_is_not_met_is_refused(yard) -> None:
    path = yard(TOP.replace('"more.wrench" =', '"reader.one" ='))
    assert "nothing joins: reader.one takes turn" in refused(path)
    rigs = path.parent / "inner"
    (rigs / "push-one.toml").write_text(
        PUSHES["one"].replace('"push.wrench"', '{ force = "push.force" }')
    )
    assert "nothing gives body.wrench its moment (a.body.moment)" in refused(yard())


def test_an_optional_connection_is_made_if_both_sides_show_it(yard) -> None:
    path = yard(TOP + '"more.wrench?" = "a.lamp"\n"b.motion" = "reader.one?"\n')
    system = built(path)
    assert system.open == ['"more.wrench?" = "a.lamp": there is no a.lamp']
    assert ("b.body.turning", "reader.east") in {(j.source, j.target) for j in system.joints}


def test_an_inner_rig_runs_alone_with_its_own_step(yard) -> None:
    yard()
    system = built(Path("harness/rigs/inner/body.toml").resolve())
    assert list(system.parts) == ["body", "push.push"]
    assert system.rig.step_ns == 10_000_000
    with pytest.raises(InputError, match="step: this key is missing, and no rig inside has one"):
        Master(built(Path("harness/rigs/inner/push-one.toml").resolve()))


TRIAL = """
rig  = "top"
stop = "50 ms"
[set]
"b.push.push.force_value" = 7
"reader.gain"             = 2
[record]
signals = ["a.motion.*", "b.motion.total.x", "*.push.*", "reader.y"]
[[faults]]
what  = "fixed"
where = "a.motion.total.x"
value = 100
at    = "20 ms"
[[faults]]
what  = "fixed"
where = "reader.total"
value = [1, 1]
at    = "20 ms"
[[criteria]]
name  = "the shown name is that of the output"
check = "eventually[0 s, 50 ms] a.motion.total.x > 99 N"
[[criteria]]
name  = "so is the path"
check = "always b.body.total.x < 9 N"
[[plots]]
title   = "forces"
signals = ["a.motion.total.x", "b.body.total.x"]
"""


def test_trials_write_paths_or_what_is_shown_and_record_paths(yard, tmp_path: Path) -> None:
    yard()
    (tmp_path / "trial.toml").write_text(TRIAL.replace('"b.body.total.x"]', '"a.body.total.y"]'))
    result = run_trial(load_trial(str(tmp_path / "trial.toml")), tmp_path / "run", engine="direct")
    assert result.passed, result.verdicts
    header, *rows = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert header.split(",") == [
        "time", "a.body.total.x", "a.body.total.y", "a.body.turning", "a.push.push.force.x",
        "a.push.push.force.y", "a.push.push.moment", "b.body.total.x", "b.push.push.force.x",
        "b.push.push.force.y", "b.push.push.moment", "reader.y",
    ]  # fmt: skip
    first, last = (
        dict(zip(header.split(","), map(float, r.split(",")), strict=True))
        for r in (rows[0], rows[-1])
    )
    assert (first["a.body.total.x"], first["b.body.total.x"], first["reader.y"]) == (5.0, 8.0, 10.0)
    assert (last["a.body.total.x"], last["reader.y"]) == (100.0, 2.0)


def test_names_that_nothing_shows_are_refused_in_trials(yard, tmp_path: Path) -> None:
    yard()
    path = tmp_path / "trial.toml"
    path.write_text(TRIAL.replace("always b.body.total.x", "always b.lod.total.x"))
    with pytest.raises(InputError, match=r"b does not show 'lod'|unknown"):
        run_trial(load_trial(str(path)), tmp_path / "run", engine="direct")
    path.write_text(TRIAL.replace('"b.push.push.force_value"', '"b.motion"'))
    with pytest.raises(
        InputError, match=r"b\.motion is a terminal; its members are b\.motion\.total"
    ):
        run_trial(load_trial(str(path)), tmp_path / "run", engine="direct")
    assert not (tmp_path / "run").exists()


def test_frames_must_be_the_same(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(
        'step = "10 ms"\n[components]\nhull = { fmu = "marine-craft", parameters = "hydrone" }\n'
        'other = { fmu = "marine-craft", parameters = "hydrone" }\n[connections]\n'
        '"hull.velocity" = "other.current"\n'
    )
    message = refused(tmp_path / "rig.toml")
    assert "velocity.u is in {b}, body axes; current.north in {n}, north-east-down" in message
    assert "attachment_velocity in {n}" in message


def test_a_sum_without_sources_is_zero_and_a_constant_may_be_a_term(yard) -> None:
    system = built(yard())
    system.set("a.set.x", "0.5 N", "test")
    total = values(system, "a.body.total.x")[0]
    assert math.isclose(total, 5.5, rel_tol=0.0, abs_tol=0.0)
