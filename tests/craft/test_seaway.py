"""Craft in waves, current and wind: references, long waves, particles of water, calm as before."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from tests.kit import classes, vehicles
from tests.sea.references import content, table

from .fleet import FLEET, craft, states

CALM = json.loads((Path(__file__).parents[1] / "reference/craft_in_calm.json").read_text())
REGULAR = {"sea_spectrum": "regular", "sea_height": 2e-3}


def amplitude(signal, t, omega):
    """Return the phasor of ``signal`` at ``omega`` over whole periods at the end."""
    period = math.tau / omega
    count = int((t[-1] - 0.7 * t[-1]) / period)
    last = t > t[-1] - count * period
    basis = np.stack([np.cos(omega * t), -np.sin(omega * t), np.ones_like(t)], 1)[last]
    c, s, _ = np.linalg.lstsq(basis, signal[last], rcond=None)[0]
    return c + 1j * s


def barge(**changes):
    """Return the barge of the reference, with the constants of its strips."""
    given = content("strip_barge_T020")
    section = {key: values[0] for key, values in given["sections"].items()}
    craft, square = MarineCraft("barge"), float(np.square(given["sections"]["x"]).sum() * 0.1)
    weight = given["mass"] * 9.81
    values = {
        "terms": "restoring damping wave-loads",
        "restoring": "surface-linear",
        "mass": given["mass"],
        "inertia": [given["I44"], given["I55"], 60.0, 0, 0, 0],
        "added_mass": [0, 2 * section["a22"], 2 * section["a33"], 0, 0, 0],
        "added_inertia": [0, square * section["a33"], 0, 0, 0, 0],
        # The reference neither surges nor yaws; here both are held by damping.
        "linear_damping_force": [2e4, 2 * section["b22"], 2 * section["b33"]],
        "linear_damping_moment": [50.0, square * section["b33"], 5e3],
        "waterplane_area": given["C33"] / (1025 * 9.81),
        "GM_T": given["C44"] / weight,
        "GM_L": given["C55"] / weight,
        "hull_length": 2.0,
        "section_beam": section["b"],
        "section_draught": section["T"],
        "section_area": section["S"],
        **REGULAR,
        **changes,
    }
    for name, value in values.items():
        craft.set(name, value)
    return craft


@pytest.mark.parametrize("vehicle", vehicles(*CALM))
def test_without_a_sea_a_craft_moves_as_it_did_before_there_was_one(vehicle):
    # The recorded thruster ship had no drag.
    variant = "published" if vehicle == "thruster-ship" else None
    hull = craft(vehicle, variant, **CALM[vehicle]["inputs"])
    last = states(hull, 2.0, 0.02)[-1]
    np.testing.assert_allclose(last, CALM[vehicle]["state"], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(hull.acceleration, CALM[vehicle]["acceleration"], rtol=1e-11)


@pytest.mark.parametrize(("omega", "direction"), [(2.4, 180), (3.6, 180), (3.6, 135), (2.4, 90)])
def test_motions_of_a_barge_are_those_computed_elsewhere(omega, direction):
    rows = table("strip_barge_T020")
    near = np.abs(rows["omega"] - omega) + np.abs(rows["direction_deg"] - direction)
    row = rows[np.argmin(near)]
    w, chi = float(row["omega"]), math.radians(row["direction_deg"])
    h = 0.01
    x = states(barge(sea_period=math.tau / w, sea_direction=chi), 40.0, h)
    t = np.arange(len(x)) * h
    for name, column in (("heave", 2), ("pitch", 4)):
        wanted = row[f"X_{name}_amp"] * np.exp(1j * math.radians(row[f"X_{name}_deg"]))
        found = amplitude(x[:, column], t, w) / 1e-3
        assert abs(found - wanted) < 1e-3 * rows[f"X_{name}_amp"].max()


@pytest.mark.parametrize(
    ("vehicle", "length", "apart"), [("hydrone", 1.276, 0.05), ("otter", 2, 0.2)]
)
def test_a_catamaran_follows_long_waves(vehicle, length, apart):
    # An Otter's linear drag ahead is that over ground, which lags its surge: with its centre of
    # gravity 0.25 m above the water it pitches 10 degrees of phase ahead of the slope.
    omega = math.sqrt(9.81 * math.tau / (40 * length))
    slope = omega**2 / 9.81 * 1e-3
    for direction, column, tolerance in ((math.pi, 4, apart), (math.pi / 2, 3, 0.05)):
        hull = craft(vehicle, **REGULAR, sea_period=math.tau / omega, sea_direction=direction)
        x = states(hull, 60.0, 0.02)
        t = np.arange(len(x)) * 0.02
        assert abs(amplitude(x[:, 2], t, omega) / 1e-3 + 1) < 0.005
        assert abs(amplitude(x[:, column], t, omega) / slope - 1j) < tolerance


def test_a_neutral_body_without_drag_is_a_particle_of_the_water():
    body = Rov("body")
    values = {"mass": 20.0, "volume": 0.02, "added_mass": [5, 9, 14, 0, 0, 0], "terms": "coriolis"}
    sea = {"sea_spectrum": "jonswap", "sea_height": 0.05, "sea_period": 3.0, "sea_depth": 6.0}
    for name, value in {**values, **sea, "sea_direction": 0.7}.items():
        body.set(name, value)
    waves = body.sea_state().waves()
    start = waves.motion(0.0, [0, 0, 2.0], stretched=True).velocity
    body.set("eta_start", [0, 0, 2.0, 0, 0, 0])
    body.set("nu_start", [*start, 0, 0, 0])
    x = states(body, 10.0, 0.01)
    largest = np.abs(x[:, 6:9]).max()
    for i in (300, 1000):
        water = waves.motion(i * 0.01, x[i, :3], stretched=True).velocity
        # The rest is of second order: the particle meets other water than stood there.
        assert np.abs(x[i, 6:9] - water).max() < 0.02 * largest
    assert np.abs(x[:, 3:6]).max() < 1e-4


TURNING = {
    "hydrone": ("velocity_start", [0, 0, 0], {"rates_start": [0, 0, 0.1]}),
    "gloria": ("nu_start", [0, 0, 0, 0.1], {"sail_area": 0, "GM_T": 1e3}),
    "mariner": ("nu_start", [7.7175, 0, 0.01], {"model": "cubic"}),
    "kvlcc2": ("nu_start", [7.97, 0, 0.002], {"propeller_order": 1.0}),
    "thruster-ship": ("nu_start", [0, 0, 0.1], {}),
    "videoray": ("nu_start", [0, 0, 0, 0, 0, 0.1], {}),
    "videoray-surface": ("nu_start", [0, 0, 0.1], {}),
}


@pytest.mark.parametrize("vehicle", vehicles(*TURNING))
def test_a_current_carries_a_turning_craft_as_if_it_stood_still(vehicle):
    name, start, changes = TURNING[vehicle]
    stream = 0.5 * np.array([math.cos(0.6), math.sin(0.6)])
    calm = states(craft(vehicle, **changes, **{name: start}), 20.0, 0.02)
    carried = [start[0] + stream[0], start[1] + stream[1], *start[2:]]
    current = {"current_speed": 0.5, "current_direction": 0.6}
    met = states(craft(vehicle, **changes, **current, **{name: carried}), 20.0, 0.02)
    t = np.arange(len(met))[:, None] * 0.02
    np.testing.assert_allclose(met[:, :2] - t * stream, calm[:, :2], atol=1e-6)


def test_a_dive_through_a_sheared_current_is_felt_by_drag_alone():
    layers = {
        "current_profile": "layers",
        "current_layers": 2,
        "current_layer_depths": [0, 10, *6 * [0]],
        "current_layer_speeds": [0, 1.0, *6 * [0]],
    }
    body = Rov("body")
    values = {
        "mass": 20.0,
        "volume": 0.02,
        "terms": "coriolis",
        "nu_start": [0, 0, 0.1, 0, 0, 0],
        "eta_start": [0, 0, 1, 0, 0, 0],
    }
    for name, value in {**values, **layers}.items():
        body.set(name, value)
    x = states(body, 20.0, 0.02)
    # No added mass and no drag: a steady parallel stream has no pressure gradient.
    assert np.abs(x[:, 6]).max() < 1e-9
    again = Rov("body")
    for name, value in {**values, **layers, "added_mass": [20.0, 20.0, 20.0, 0, 0, 0]}.items():
        again.set(name, value)
    x = states(again, 20.0, 0.02)
    # (m + A) u' = A dU/dz w
    assert x[-1, 6] == pytest.approx(0.5 * 0.1 * 0.1 * 20.0, rel=1e-6)


@pytest.mark.parametrize("h", [0.002, 0.01, 0.03])
def test_error_between_evaluations_is_that_of_a_cubic(h):
    omega = 8.0
    apart = h * math.floor(0.05 / h + 1e-9)
    hull = barge(sea_period=math.tau / omega, sea_direction=math.pi)
    states(hull, 0.5, h)
    off, largest = [], []
    for _ in range(round(1.0 / h)):
        hull.advance(hull.now, h)
        exact = hull._met(hull.now, hull._x)[9:15]
        off.append(hull._around[9:15] - exact)
        largest.append(exact)
    off, largest = np.abs(off).max(0), np.abs(largest).max(0)
    bound = 0.042 * (omega * apart) ** 4
    assert (off[[2, 4]] < (1.1 * bound + 1e-5) * largest[[2, 4]]).all()
    if apart > h:
        assert (off[[2, 4]] > 0.5 * bound * largest[[2, 4]]).all()


@pytest.mark.parametrize(
    "kind", classes("manoeuvring-ship", "mmg-ship", "thruster-ship", "surface-vessel")
)
def test_a_long_following_sea_pushes_a_hull_as_the_water_that_it_displaces(kind):
    hull, heading, omega = kind("boat"), 2.2, 0.3
    values = {"sea_period": math.tau / omega, "sea_direction": heading, "hull_length": 2.0}
    values |= {"section_beam": 0.5, "section_draught": 0.2, "section_area": 0.08, **REGULAR}
    for name, value in values.items():
        hull.set(name, value)
    _, density = hull.wave_coefficients()
    assert 990 < density < 1030
    state = np.zeros(12)
    state[hull.places.psi] = heading
    met = hull.met()
    for t in (3.0, 9.0):
        surging = -(omega**2) * 1e-3 * math.sin(omega * t)
        assert met(t, state)[9] == pytest.approx(density * 0.16 * surging, rel=0.01)


@pytest.mark.slow
def test_a_saved_state_goes_on_in_the_same_sea():
    hull = barge(sea_period=2.0)
    states(hull, 1.0, 0.02)
    saved = hull.get_state()
    for component in (hull, barge(sea_period=2.0)):
        if component is not hull:
            states(component, 0.2, 0.02)
        component.set_state(saved)
        for _ in range(50):
            component.advance(component.now, 0.02)
        if component is hull:
            wanted = component._x.copy()
    np.testing.assert_array_equal(component._x, wanted)


@pytest.mark.parametrize("vehicle", FLEET)
def test_a_craft_without_a_hull_says_what_it_needs_in_waves(vehicle):
    kind = FLEET[vehicle][1]
    hull = kind("boat")
    for name, value in {**REGULAR, "sea_period": 3.0}.items():
        hull.set(name, value)
    if vehicle == "videoray":  # a submerged craft needs none
        states(hull, 0.02, 0.02)
        return
    with pytest.raises(InputError, match=r"boat: it meets waves.*(hull_length|wave-loads)"):
        states(hull, 0.02, 0.02)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"sea_spectrum": "jonswap"}, "boat: sea: height is 0.0 m"),
        ({**REGULAR}, "boat: sea: period is 0.0 s"),
        ({"sea_spectrum": "pierson-moskowitz", "sea_height": 1, "sea_period": 4}, "leave it out"),
        ({"sea_spectrum": "tma", "sea_height": 1, "sea_period": 4}, "depth is 0"),
        ({**REGULAR, "sea_period": 3, "sea_seed": 0.5}, "boat.sea_seed is 0.5, a whole number"),
        ({"sea_spectrum": "jonswap", "sea_height": 2, "sea_period": 2}, "steepness of 0.32"),
        ({"current_profile": "power", "current_speed": 1}, "boat: current: reach is 0.0 m"),
        ({"current_profile": "layers"}, "layers: 0 are given"),
    ],
)
def test_a_sea_that_cannot_be_is_refused(changes, said):
    boat = MarineCraft("boat")
    for name, value in changes.items():
        boat.set(name, value)
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        states(boat, 0.02, 0.02)


def test_sections_of_another_waterplane_are_refused():
    with pytest.raises(InputError, match=r"sections have a waterplane of 1 m2, and .* is 1.055 m2"):
        states(barge(waterplane_area=1.055, sea_period=3.0), 0.02, 0.02)  # 5 % are allowed


def test_ships_are_pushed_by_the_wind():
    for vehicle in vehicles("hydrone", "mariner", "kvlcc2", "thruster-ship"):
        hull = craft(vehicle, wind_speed=15.0, wind_direction=math.pi / 2)
        calm = craft(vehicle)
        pushed, still = states(hull, 20.0, 0.1), states(calm, 20.0, 0.1)
        assert pushed[-1, 1] - still[-1, 1] > 0.01


@pytest.mark.parametrize(("direction", "axis", "column"), [(180, 0, "D_X"), (90, 1, "D_Y")])
def test_drift_in_a_regular_wave_is_that_of_the_table(direction, axis, column):
    rows = table("drift_barge_T020")
    given = {d: rows[rows["direction_deg"] == d][-8:] for d in (180, 90)}
    tables = {
        "drift_frequency": list(given[180]["omega"]),
        "drift_head": list(-given[180]["D_X"]),
        "drift_beam": list(given[90]["D_Y"]),
    }
    row = given[direction][5]
    sea = {"sea_direction": math.radians(direction), "sea_height": 0.02}
    sea["sea_period"] = math.tau / float(row["omega"])
    loads = [barge(**sea, **changes) for changes in ({}, tables)]
    for hull in loads:
        states(hull, 0.02, 0.02)
    plain, drifting = (hull._met(1.3, hull._x * 0)[9:15] for hull in loads)
    wanted = np.zeros(6)
    wanted[axis] = 0.01**2 * row[column]
    np.testing.assert_allclose(drifting - plain, wanted, atol=1e-9, rtol=1e-9)


def test_frequencies_of_drift_must_rise():
    with pytest.raises(InputError, match=r"drift_frequency is .* it must rise"):
        states(barge(sea_period=2.0, drift_frequency=[1, 2, 3, 3, 4, 5, 6, 7]), 0.02, 0.02)


def test_a_hull_whose_middle_is_not_the_origin_follows_long_waves_as_well():
    omega = 0.9
    sea = {"sea_period": math.tau / omega, "sea_direction": math.pi}
    aft = {"hull_middle": -0.5, "center_of_flotation": [-0.5, 0]}
    pitch = []
    for changes in ({}, aft):
        x = states(barge(**sea, **changes), 40.0, 0.02)
        pitch.append(amplitude(x[:, 4], np.arange(len(x)) * 0.02, omega) / (omega**2 / 9.81 * 1e-3))
    assert abs(pitch[0] - 1j) < 0.03
    # In phase with the slope; the CG ahead of the waterplane adds a part in phase with the heave.
    assert abs(pitch[1].imag - 1) < 0.05
