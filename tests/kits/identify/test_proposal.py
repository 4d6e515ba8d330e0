"""Vehicle files from main particulars: beside published figures, whole, and able to run."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.parameters import load_vehicle
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.identify.proposal.propose import propose
from seatrial_kits.identify.proposal.value import Proposal
from seatrial_kits.identify.proposal.vehicle_text import component, vehicle_text
from tests.command import seatrial

from .proposed import FIGURES, VEHICLES

PAGE = Path(__file__).parents[3] / "docs/kits/identify/estimate.md"
KINDS = {
    "torpedo": {"length": "1.6 m", "diameter": "0.19", "mass": "31.9 kg"},
    "rov": {"length": "0.46", "beam": "0.58", "height": "0.25", "mass": "20"},
    "monohull": {"length": "12 m", "beam": "3 m", "draught": "0.8", "mass": "14 t"},
    "catamaran": {"length": "2", "beam": "1.08", "hull_beam": "0.25", "mass": "55"},
    "trimaran": {
        "length": "4 m", "beam": "2.4 m", "hull_beam": "0.5 m", "side_length": "1.5 m",
        "side_beam": "20 cm", "mass": "250 kg",
    },
    "barge": {"length": "40 m", "beam": "10 m", "draught": "1.5 m", "height": "3 m"},
}  # fmt: skip
AT_SURFACE = ("monohull", "catamaran", "trimaran", "barge")


def by_name(found: Proposal):
    return {value.name: value for value in found.all_values()}


def of(figure) -> float:
    value = by_name(propose(*VEHICLES[figure.vehicle]))[figure.entry].value
    return value[figure.axis] if isinstance(value, tuple) else value


@pytest.mark.parametrize("figure", FIGURES, ids=lambda f: f"{f.vehicle}-{f.what}")
def test_estimates_are_about_what_is_published(figure):
    assert figure.low <= of(figure) / figure.published <= figure.high


def rows() -> list[str]:
    return [
        f"| {f.vehicle} | {f.what} | {f.unit} | {of(f):.3g} | {f.published:.3g} | "
        f"{of(f) / f.published:.2f} |"
        for f in FIGURES
    ]


def test_the_page_has_these_figures():
    table = [line for line in PAGE.read_text("utf-8").splitlines() if line.count("|") == 7]
    assert table[2:] == rows()


def written(kind: str, folder: Path) -> Path:
    path = folder / f"harness/vehicles/my-{kind}/vehicle.toml"
    path.parent.mkdir(parents=True)
    path.write_text(vehicle_text(propose(kind, KINDS[kind])), "utf-8")
    return path


TRIAL = """
title = "Ahead, or released"
rig = "vehicles/my-{kind}"
stop = "{stop} s"

[set]
{changes}
[record]
signals = ["hull.*"]

[[criteria]]
name = "by the closed form"
check = "{check}"
"""
AHEAD = {
    "torpedo": [1],
    "rov": [0.02, 0.02, -0.02, -0.02],  # more, and it pitches
    "monohull": [1],
    "catamaran": [1, 1],
    "trimaran": [1],
}
"""Orders that push ahead."""
STOP = 4.0


def straight_ahead(kind: str) -> str:
    """Return that it gathers speed as u = U tanh(t X U / (m + A)), within 2 %."""
    found = by_name(propose(kind, KINDS[kind]))
    drag = found["quadratic_damping_force"].value[0]
    mass = found["mass"].value + found["added_mass"].value[0]
    axis = [found.get(f"propulsor_axis_{k}") for k in (1, 2, 3, 4)]
    thrust = sum(
        order * found[f"propulsor_thrust_{k}"].value[0] * (along.value[0] if along else 1.0)
        for k, (order, along) in enumerate(zip(AHEAD[kind], axis, strict=False), 1)
    )
    top = math.sqrt(thrust / drag)
    expected = top * math.tanh(STOP * drag * top / mass)
    return f"finally abs(hull.velocity.u - {expected} m/s) < {0.02 * expected} m/s"


def released(kind: str) -> str:
    """Return that 5 degrees of roll decay as of a damped oscillator, within 0.05 degrees."""
    found = by_name(propose(kind, KINDS[kind]))
    inertia = found["inertia"].value[0] + found["added_inertia"].value[0]
    natural = math.sqrt(found["mass"].value * 9.81 * found["GM_T"].value / inertia)
    ratio = found["linear_damping_moment"].value[0] / (2.0 * inertia * natural)
    damped = natural * math.sqrt(1.0 - ratio**2)
    turned = math.cos(damped * STOP) + ratio * natural / damped * math.sin(damped * STOP)
    expected = 5.0 * math.exp(-ratio * natural * STOP) * turned
    return f"finally abs(hull.attitude.phi - {expected} deg) < 0.05 deg"


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_file_runs(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(kind, tmp_path)
    if kind in AHEAD:
        changes = f'"hull.propulsor_order" = {AHEAD[kind] + [0] * (8 - len(AHEAD[kind]))}'
        check = straight_ahead(kind)
    else:
        changes = '"hull.attitude_start" = ["5 deg", "0 deg", "0 deg"]'
        check = released(kind)
    text = TRIAL.format(kind=kind, changes=changes, check=check, stop=STOP)
    Path("trial.toml").write_text(text, "utf-8")
    result = run_trial(load_trial("trial.toml"), tmp_path / "run", engine="direct")
    assert result.passed, result.verdicts


@pytest.mark.parametrize("kind", KINDS)
def test_every_entry_is_assumed_or_given_and_has_a_source(kind, tmp_path):
    proposal = propose(kind, KINDS[kind])
    vehicle = load_vehicle(str(written(kind, tmp_path)))
    entries = vehicle.parameter_set("hull", None).values
    own = {name: e for name, e in entries.items() if name not in ("propulsors", "foils")}
    assert {value.name for value in proposal.all_values()} <= {n.partition(".")[0] for n in own}
    assert component(proposal) == ("marine-craft" if kind == "barge" else "fitted-craft")
    for value in proposal.all_values():
        assert value.source
        assert (value.mark == "stated") == value.source.startswith("given: --")


@pytest.mark.parametrize("kind", AT_SURFACE)
def test_sections_and_windage_follow_from_the_drawing(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(kind, tmp_path)
    system = assemble(load_rig(f"vehicles/my-{kind}"), engine="direct")
    try:
        given = dict(system.parts["hull"].given)
    finally:
        system.free()
    assert given["windage_lateral"].value > given["windage_frontal"].value > 0.0
    assert total(given, "area") == pytest.approx(given["mass"].value / 1025.0, rel=1e-6)
    assert total(given, "beam") == pytest.approx(given["waterplane_area"].value, rel=1e-6)


def total(given, what: str) -> float:
    """Return the integral of the sections' beams or areas over all hulls."""
    found = 0.0
    for hull, section in (("hull", "section"), ("side", "side")):
        if f"{section}_{what}.s0" in given:
            values = [given[f"{section}_{what}.s{k}"].value for k in range(11)]
            pair = 2 if given[f"{hull}_spacing"].value else 1
            found += pair * float(np.trapezoid(values, dx=given[f"{hull}_length"].value / 10))
    return found


# ----------------------------------------------------------- the command


def command(*words: str, cwd: Path):
    return seatrial("estimate", *words, cwd=cwd)


TORPEDO = ("--kind", "torpedo", "--length", "1.6 m", "--diameter", "0.19", "--mass", "31.9")


def test_the_file_is_printed_with_formula_and_trial(tmp_path):
    done = command(*TORPEDO, cwd=tmp_path)
    assert done.returncode == 0
    for said in ("measured by", "towing test", "bollard pull", "turning circle", "[hull]"):
        assert said in done.stdout
    assert not list(tmp_path.iterdir())


def test_programs_get_the_entries_and_the_file(tmp_path):
    result = json.loads(command(*TORPEDO, "--json", cwd=tmp_path).stdout)["result"]
    mass = next(entry for entry in result["entries"] if entry["name"] == "mass")
    assert (mass["value"], mass["unit"], mass["mark"]) == (31.9, "kg", "stated")
    assert result["file"] == vehicle_text(propose("torpedo", KINDS["torpedo"]))


def test_what_is_given_is_kept(tmp_path):
    command(*TORPEDO, "--density", "1000 kg/m3", "-o", "a.toml", cwd=tmp_path)
    values = load_vehicle(str(tmp_path / "a.toml")).parameter_set("hull", None).values
    assert (values["mass"].value, values["mass"].mark) == (31.9, "stated")
    assert values["density"].value == 1000.0
    assert values["crossflow_length"].value == 1.6


def test_a_file_that_exists_is_not_replaced(tmp_path):
    (tmp_path / "a.toml").write_text("mine")
    done = command(*TORPEDO, "-o", "a.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert "a.toml: exists already" in done.stderr
    assert (tmp_path / "a.toml").read_text() == "mine"


def test_outside_the_range_of_a_formula_there_is_a_note():
    blunt = propose("torpedo", {"length": "0.6", "diameter": "0.2"})
    assert any("length / diameter is 3, outside the range 6.7 to 10" in n for n in blunt.notes)
    assert not propose("torpedo", KINDS["torpedo"]).notes


REFUSED = [
    ({"kind": "submarine"}, "--kind: unknown kind 'submarine'"),
    ({"kind": "rov", "length": "1"}, "--beam, --height, --mass missing"),
    ({"kind": "rov", "diameter": "1"}, "--diameter: of a rov the particulars are"),
    ({"kind": "torpedo", "length": "1 kg", "diameter": "1"}, "--length: .*'kg'"),
    ({"kind": "torpedo", "length": "nan", "diameter": "1"}, "--length"),
    ({"kind": "torpedo", "length": "1", "diameter": "-2"}, "--diameter: above 0 .*'-2'"),
    ({"kind": "torpedo", "length": "1", "diameter": "2"}, "--length 1 m is below --diameter 2 m"),
    ({"kind": "monohull", "length": "9", "beam": "3"}, "--mass or --draught is needed"),
    (
        {"kind": "monohull", "length": "5", "beam": "1", "mass": "3000", "draught": "0.2"},
        "block coefficient of 2.93; up to 1",
    ),
    ({"kind": "monohull", "length": "5", "beam": "0.3", "mass": "300"}, "does not float upright"),
    (
        {"kind": "barge", "length": "9", "beam": "3", "draught": "1", "height": "0.5"},
        "--height 0.5 m is below the draught 1 m",
    ),
    (
        {"kind": "catamaran", "length": "5", "beam": "1", "hull_beam": "0.6", "mass": "300"},
        "--hull-beam 0.6 m",
    ),
    (
        {"kind": "rov", "length": "1", "beam": "1", "height": "1", "mass": "9", "top_area": "3"},
        "--top-area 3 m2: up to 1 m2",
    ),
]


@pytest.mark.parametrize(("words", "message"), REFUSED)
def test_mistakes_are_refused_with_what_is_allowed(words, message):
    written = dict(words)
    with pytest.raises(InputError, match=message):
        propose(written.pop("kind"), written)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "a hull's file or --kind is needed; kinds are torpedo"),
        (("hydrone", "--kind", "rov"), "one of them is needed"),
        (("hydrone", "--mass", "3"), "--mass: particulars are for --kind"),
        (("hydrone", "-o", "x.toml"), "--out x.toml: for --kind"),
    ],
)
def test_the_command_takes_a_hull_or_a_kind(words, message, tmp_path):
    done = command(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
