"""Scenario files of libcosim as events of a trial; what libcosim makes of them is in interop."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from seatrial import run_trial
from seatrial.errors import InputError
from seatrial.model.units import quantity
from seatrial.system.assembling.assembly import assemble
from seatrial.trial.files.scenario import read_scenario
from seatrial.trial.files.trial import load_trial
from tests.kits.interchange.osp_files import write_osp

JSON = {
    "description": "a test",
    "defaults": {"model": "slave uno", "variable": "x", "action": "override"},
    "events": [
        {"time": 0.55, "action": "bias", "value": 0.5},
        {"time": 0.2, "value": -1.0},
        {"time": 0.4, "action": "reset"},
        {"time": 0.1, "variable": "gain", "value": 3},
    ],
    "end": 1,
}
YAML = """---
description: a test
defaults: {model: slave uno, variable: x, action: override}
events:
  - time: 55e-2
    action: bias
    value: .5
  - {time: 0.2, value: -1.0}
  - {time: 4e-1, action: reset}
  - {time: 0.1, variable: gain, value: 3}
end: 1
"""


@pytest.fixture(scope="module")
def system_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_osp(tmp_path_factory.mktemp("osp"))


def events(system_file: Path, scenario: Path, **changes: str) -> tuple[list[Any], list[str]]:
    """Return (time, action, key, value, how long) of what a scenario does, and the notes."""
    trial = load_trial(str(system_file), changes={"scenario": str(scenario), **changes})
    system = assemble(trial.rig)
    try:
        found = trial.scheduled(system)
        acted = [(e.at_ns / 1e9, "set", e.key, e.written, None) for e in found.events()]
        acted += [
            (quantity(f.at, "s"), f.what, f.where, f.value, f.for_) for f in found.file.faults
        ]
        return sorted(acted, key=lambda one: one[0]), system.notes
    finally:
        system.free()


def test_json_and_yaml_say_the_same(system_file: Path, write) -> None:
    # Outputs change when the step ends that begins with the event; at the end all is reset.
    expected = [
        (0.1, "set", "slave_uno.gain", 3.0, None),
        (0.3, "fixed", "slave_uno.x", -1.0, "0.2 s"),
        (0.7, "bias", "slave_uno.x", 0.5, "0.4 s"),
        (1.0, "set", "slave_uno.gain", 2.0, None),
    ]
    for name, text in (("s.json", json.dumps(JSON)), ("s.yaml", YAML)):
        assert events(system_file, write(name, text)) == (expected, [])


def test_without_an_end_all_is_reset_a_step_after_the_last_event(system_file: Path, write) -> None:
    text = (
        '{"events": [{"time": 1, "model": "two", "variable": "u", "action": "bias", "value": 1}]}'
    )
    found, _ = events(system_file, write("s.json", text))
    assert found == [(1.0, "bias", "two.u", 1.0, "0.1 s")]


def test_events_after_the_last_step_are_noted(system_file: Path, write) -> None:
    found, notes = events(system_file, write("s.json", json.dumps(JSON)), stop="0.5 s")
    assert found[-1] == (0.3, "fixed", "slave_uno.x", -1.0, "0.2 s")
    assert notes == ["s.json: 1 of 4 events come after the last step begins"]


def test_a_trial_names_its_scenario(system_file: Path, write, tmp_path: Path) -> None:
    write("folder/s.json", json.dumps(JSON))
    rig = write("rig.toml", f'step = "100 ms"\n[components.uno]\nfmu = "{system_file.parent / "fmi2.fmu"}"\n')  # fmt: skip
    trial = write("folder/t.toml", f'rig = "{rig}"\nstop = "1 s"\nscenario = "s.json"\n')
    with pytest.raises(InputError, match=r"s.json: events.3.model: unknown model 'slave uno'"):
        run_trial(str(trial), engine="fmu", out=tmp_path / "run")
    write("folder/s.json", json.dumps(JSON).replace("slave uno", "uno"))
    run_trial(str(trial), engine="fmu", out=tmp_path / "run")
    with (tmp_path / "run" / "signals.csv").open() as lines:
        x = [float(row["uno.x"]) for row in csv.DictReader(lines)]
    assert x[3:5] == [-1.0, -1.0]
    assert x[7] == pytest.approx(x[6] * 2.718281828459045**-0.1 + 0.5, abs=1e-12)
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text("utf-8"))
    assert manifest["scenario"]["file"] == "s.json"


ONE = {"time": 0.1, "model": "two", "variable": "u", "action": "override", "value": 1}
MISTAKES = [
    ({"time": "soon"}, "events.0.time: a finite number is needed, found 'soon'"),
    ({"time": None}, "events.0.time: "),
    ({"action": "bais"}, "events.0.action: unknown action 'bais'; did you mean 'bias'"),
    ({"variable": "v"}, "events.0.variable: two: unknown variable 'v'"),
    ({"model": "too"}, "events.0.model: unknown model 'too'; did you mean 'two'"),
    ({"model": ""}, "events.0.model: this key is missing, and defaults.model too"),
    ({"value": None}, "events.0.value: this key is missing"),
    ({"value": "fast"}, "events.0.value: a finite number is needed, found 'fast'"),
    ({"variable": "i", "value": 1.5}, "events.0.value: a whole number is needed, found 1.5"),
    ({"variable": "b", "value": 1}, "events.0.value: true or false is needed, found 1"),
    ({"variable": "s", "value": 1}, "events.0.value: a text is needed, found 1"),
    ({"variable": "s", "value": "a", "action": "bias"}, "nothing can be added to the text s"),
    ({"variable": "k"}, "events.0: two.k is fixed and cannot change during a run"),
    ({"vaule": 1}, "events.0.vaule: unknown key 'vaule'; did you mean 'value'"),
]


@pytest.mark.parametrize(("change", "message"), MISTAKES)
def test_a_mistake_is_named(change: dict[str, Any], message: str, system_file: Path, write) -> None:
    path = write("s.json", json.dumps({"events": [{**ONE, **change}]}))
    with pytest.raises(InputError, match=message):
        events(system_file, path)


def test_two_events_at_once_on_one_variable_are_refused(system_file: Path, write) -> None:
    path = write("s.json", json.dumps({"events": [ONE, {**ONE, "time": 0.04}]}))
    with pytest.raises(InputError, match=r"events.1: acts on two.u at once with .*events.0"):
        events(system_file, path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("events: [{time: 1", "s.yaml: not YAML: "),
        ("a: &x [1]\nevents: *x", "s.yaml: line 2: aliases are not read"),
        ("end: 1\nend: 2", "s.yaml: line 2: a second key 'end'"),
        ("#" * (2**19 + 1), "s.yaml: 524289 bytes, at most 524288 are read"),
        ("[" * 100 + "]" * 100, "more than 64 deep"),
        ("[" * 1000, "more than 64 deep"),
        ("- 1", "s.yaml: .*dictionary"),
        ("end: \x00", "not YAML"),
    ],
)
def test_what_is_no_scenario_is_refused(text: str, message: str, write) -> None:
    with pytest.raises(InputError, match=message):
        read_scenario(write("s.yaml", text))


def test_a_scenario_that_is_not_there(system_file: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.json: No such file"):
        load_trial(str(system_file), changes={"scenario": str(tmp_path / "no.json")})
