"""The tether as a component: ends, state, ports, and the coupling to a vehicle."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.errors import InputError
from seatrial.fmi.dependencies.found import feedthrough_of
from seatrial.model.units import unit
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.parameters import load_vehicle
from seatrial_kits.videoray.cable.cable_shape import hanging_shape
from seatrial_kits.videoray.cable.tether import Tether
from tests.devices.running import started
from tests.kits.videoray.cables import END_FORCE, NEUTRAL, STILL, STREAM, arc_in_current, cable

ARC_END = arc_in_current(1)[:, 1].tolist()
NEUTRAL_ARC = {"tangential_drag": 0.0, "mass_per_length": NEUTRAL, "bottom_position": ARC_END}
OUTPUTS = [p.name for p in Tether.ports.values() if p.kind == "output"]


def tether(**values):
    return started(Tether, **values)


def shape(component):
    return np.array([component.get(axis) for axis in ("north", "east", "down")])


def outputs(component):
    return [component.get(name) for name in OUTPUTS]


def run(component, steps, h=0.01, inputs=lambda t: {}):
    """Advance from where it is and return the outputs at every communication point."""
    rows, start = [], component.now_ns
    for k in range(steps):
        t = start * 1e-9 + k * h
        for name, value in inputs(t).items():
            component.set(name, value)
        component.refresh()
        component.advance(t, h)
        rows.append(outputs(component))
    return rows


# ---------------------------------------------------------------------- shape and forces


@pytest.mark.parametrize("segments", [5, 10, 33, 200])
def test_it_starts_on_the_arc_in_the_current(segments):
    one = tether(segments=segments, current=[0.5, 0, 0], **NEUTRAL_ARC)
    exact = arc_in_current(10)
    np.testing.assert_allclose(shape(one)[:, [0, -1]], exact[:, [0, -1]], atol=1e-9)
    # chords of an arc; those of 5 segments are 8 m long
    apart = np.linalg.norm(shape(one) - exact, axis=0).max()
    assert apart < 15.0 / segments**2
    force, other = np.array(one.get("force")), np.array(one.get("surface_force"))
    np.testing.assert_allclose(force, -END_FORCE, atol=40.0 / segments**2)
    drag = 0.5 * 1000.0 * 8.18e-3 * 1.2 * 0.5**2 * 40.0
    assert 0.0 < np.linalg.norm(force + other) < drag
    assert one.get("greatest_tension") == pytest.approx(math.hypot(3, 10), rel=1.5 / segments)


def test_forces_are_the_pull_of_a_straight_cable_and_cancel():
    one = tether(mass_per_length=NEUTRAL, bottom_position=[0.0, 24.0, 32.04], length=40.0)
    pull = 2e4 * (math.hypot(24.0, 32.04) / 40.0 - 1.0)
    along = np.array([0.0, 24.0, 32.04]) / math.hypot(24.0, 32.04)
    for _ in range(2):  # at rest before and after some steps
        np.testing.assert_allclose(one.get("force"), -pull * along, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(one.get("surface_force"), pull * along, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(one.get("tension"), pull, rtol=1e-8)
        run(one, 10)


@pytest.mark.interop
def test_it_settles_from_still_water_to_the_arc():
    one = tether(segments=20, **NEUTRAL_ARC)
    run(one, 1)
    assert one.get("greatest_tension") == pytest.approx(0.0, abs=1e-6)
    one.set("current", [0.5, 0.0, 0.0])
    run(one, 2400, h=0.05)
    exact = arc_in_current(10)
    discrete = hanging_shape(cable(20), np.zeros(3), END_FORCE, STREAM)
    allowed = np.linalg.norm(discrete - arc_in_current(20), axis=0).max()
    assert np.linalg.norm(shape(one) - exact, axis=0).max() < 1.1 * allowed
    np.testing.assert_allclose(one.get("force"), -END_FORCE, atol=0.02)


def test_towed_through_still_water_it_is_as_in_a_current():
    settings = {"segments": 20, "tangential_drag": 0.02, "mass_per_length": 0.06}
    lying = tether(current=[0.5, 0.1, 0], bottom_position=[20, 0, 25], **settings)
    velocity = [-0.5, -0.1, 0.0]
    ends = {"top_velocity": velocity, "bottom_velocity": velocity}
    towed = tether(bottom_position=[20, 0, 25], **ends, **settings)

    def sway(t):
        return np.array([20.0, 0.5 * math.sin(t), 25.0]), np.array([0.0, 0.5 * math.cos(t), 0.0])

    def of_lying(t):
        place, speed = sway(t)
        return {"bottom_position": place, "bottom_velocity": speed}

    def of_towed(t):
        place, speed = sway(t)
        way = np.array(velocity)
        return {
            "top_position": t * way,
            "bottom_position": place + t * way,
            "bottom_velocity": speed + way,
        }

    run(lying, 400, inputs=of_lying)
    run(towed, 400, inputs=of_towed)
    carried = np.outer(velocity, np.full(11, 4.0))
    np.testing.assert_allclose(shape(towed) - carried, shape(lying), atol=1e-8)
    np.testing.assert_allclose(towed.get("force"), lying.get("force"), atol=1e-5)


def test_shear_acts_where_it_flows():
    """Current in the upper half only: the lower half of a neutral cable carries all its pull."""
    profile = {
        "profile_points": 2.0,
        "profile_depth": [20.0, 20.01, 0, 0, 0, 0, 0, 0],
        "profile_east": [0.4, 0.0, 0, 0, 0, 0, 0, 0],
    }
    one = tether(segments=100, mass_per_length=NEUTRAL, bottom_position=[0, 0, 39], **profile)
    east, down = one.get("east"), one.get("down")
    lower = [k for k in range(11) if down[k] > 21.0]
    slopes = np.diff([east[k] for k in lower]) / np.diff([down[k] for k in lower])
    np.testing.assert_allclose(slopes, slopes[0], rtol=1e-6)
    assert slopes[0] < -0.01
    assert max(east) > 1.0


# ---------------------------------------------------------------------- ends between instants


def test_an_end_with_a_velocity_alone_is_towed():
    one = tether(bottom_position=[0, 0, 30], bottom_velocity=[0.2, 0, 0])
    run(one, 500)
    assert shape(one)[:, 10] == pytest.approx([1.0, 0.0, 30.0], abs=1e-9)


def test_an_end_goes_on_between_new_positions():
    """A vehicle with a step of 50 ms feeds a tether with one of 10 ms."""
    speed = np.array([0.3, 0.0, 0.1])

    def held(t):
        known = 0.05 * math.floor(t / 0.05 + 1e-9)
        return {"bottom_position": np.array([25, 0, 20]) + known * speed, "bottom_velocity": speed}

    rows = run(tether(), 100, inputs=held)
    place = OUTPUTS.index("north")
    norths = [row[place][10] for row in rows]
    np.testing.assert_allclose(np.diff(norths), 0.003, rtol=1e-9)


def test_a_position_without_velocity_is_followed_one_step_later():
    rows = run(tether(), 50, inputs=lambda t: {"bottom_position": [25 + 0.3 * t, 0, 20]})
    norths = [row[OUTPUTS.index("north")][10] for row in rows]
    np.testing.assert_allclose(norths, 25.0 + 0.003 * np.arange(50), rtol=1e-12)


# ---------------------------------------------------------------------- as every component


SETTINGS = {"segments": 12, "bottom_position": [20.0, 0.0, 30.0], "max_step": 0.004}


def swaying(t):
    return {
        "bottom_position": [20.0 + math.sin(t), 0.0, 30.0],
        "bottom_velocity": [math.cos(t), 0.0, 0.0],
        "current": [0.3, 0.1 * math.sin(3 * t), 0.0],
    }


def test_restored_state_goes_on_identically():
    one = tether(**SETTINGS)
    run(one, 43, inputs=swaying)
    state = one.get_state()
    went_on = run(one, 60, inputs=swaying)
    one.set_state(state)
    again = run(one, 60, inputs=swaying)
    other = Tether("other")
    other.set_state(state)
    assert went_on == again == run(other, 60, inputs=swaying)


def test_state_from_before_the_first_step_can_be_restored():
    one = tether(**SETTINGS)
    state = one.get_state()
    first = run(one, 5, inputs=swaying)
    one.set_state(state)
    assert run(one, 5, inputs=swaying) == first


def test_reading_changes_nothing():
    one, unread = tether(**SETTINGS), tether(**SETTINGS)
    for k in range(20):
        for component in (one, unread):
            for name, value in swaying(0.01 * k).items():
                component.set(name, value)
        for _ in range(3):
            outputs(one)
        one.set("current", [9.0, 9.0, 9.0])  # a guess of a master's iteration
        one.get("force")
        one.set("current", swaying(0.01 * k)["current"])
        for component in (one, unread):
            component.advance(0.01 * k, 0.01)
    assert outputs(one) == outputs(unread)


def test_feedthrough_is_as_declared():
    one = tether(**SETTINGS)
    run(one, 30, inputs=swaying)
    inputs = [p.name for p in Tether.ports.values() if p.kind == "input"]
    assert set(inputs) == set(feedthrough_of(Tether)["force"])
    before = {name: one.get(name) for name in OUTPUTS}
    for name in inputs:
        old = one.get(name)
        one.set(name, [v + 0.01 for v in old])
        changed = {output for output in OUTPUTS if one.get(output) != before[output]}
        assert changed == {"force", "surface_force"}, name
        one.set(name, old)


def test_every_port_has_a_unit_and_says_what_it_is():
    for scalar in Tether.scalars:
        unit(scalar.unit)
        assert scalar.port.description


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"segments": 7.5}, "segments is 7.5, a whole number"),
        ({"segments": 4.0}, "segments is 4.0 1, allowed 5.0 to 200.0"),
        ({"max_step": 0.02}, "max_step is 0.02 s, allowed"),
        ({"profile_points": 3.0}, "depths must rise"),
        ({"axial_stiffness": 0.0}, "axial_stiffness is 0.0 N, allowed at least"),
    ],
)
def test_bad_parameters_are_named(settings, expected):
    with pytest.raises(InputError, match=expected):
        tether(**settings)


def test_parameters_of_the_shipped_file_fit():
    values = load_vehicle("tether").parameter_set("tether", None).values
    assert set(values) <= set(Tether.ports)
    assert all(entry.source for entry in values.values())


# ---------------------------------------------------------------------- coupled to a vehicle


WEIGHT = '''
from seatrial.model.component import Component, Input, Output, Parameter


class Weight(Component):
    """A mass under a constant force and that of a tether, without any drag."""

    mass = Parameter(8.44, "kg", "mass")
    pull = Parameter((0.0, 0.0, 10.0), "N", "force apart from the tether's", axes="xyz")
    place = Parameter((0.0, 0.0, 40.02), "m", "position at the start", axes="xyz")
    speed = Parameter((0.0, 0.0, 0.05), "m/s", "velocity at the start", axes="xyz")
    force = Input("N", "force of the tether", axes="xyz")
    position = Output("m", "position", axes="xyz")
    velocity = Output("m/s", "velocity", axes="xyz")

    def start(self, t):
        self._x, self._v = list(self.place), list(self.speed)

    def step(self, t, h):
        for i in range(3):
            acceleration = (self.force[i] + self.pull[i]) / self.mass
            self._x[i] += h * self._v[i] + 0.5 * h * h * acceleration
            self._v[i] += h * acceleration

    def outputs(self, t):
        self.position, self.velocity = self._x, self._v
'''


def weight_rig(folder, algorithm="jacobi", step="10 ms", **tether_values):
    values = {"tangential_drag": 0.02, "mass_per_length": NEUTRAL, **tether_values}
    written = ", ".join(f"{name} = {value}" for name, value in values.items())
    (folder / "weight.py").write_text(WEIGHT, "utf-8")
    rig = folder / "rig.toml"
    rig.write_text(
        f'''
step = "{step}"
algorithm = "{algorithm}"
[components]
weight = {{ fmu = "weight.py:Weight" }}
tether = {{ fmu = "tether", set = {{ {written} }} }}
[connections]
"weight.position" = "tether.bottom_position"
"weight.velocity" = "tether.bottom_velocity"
"tether.force" = "weight.force"
'''
    )
    return str(rig)


def recorded(rig, steps, names):
    """Run a rig in process and return the named signals, (steps + 1, names)."""
    system = assemble(load_rig(rig), "direct")
    master = Master(system)
    master.initialise()
    places = [master.names.index(tuple(name.split(".", 1))) for name in names]
    rows = [[master.signals[p] for p in places]]
    for _ in range(steps):
        master.step()
        rows.append([master.signals[p] for p in places])
    system.free()
    return np.array(rows)


def when(few: bool, usual: bool):
    """Return the marks of a case of the coupling."""
    if few or usual:
        return () if few and usual else pytest.mark.interop
    return pytest.mark.long


@pytest.mark.parametrize(
    ("segments", "algorithm"),
    [
        # At once the default alone, in CI each algorithm and each number, then all together.
        pytest.param(segments, algorithm, marks=when(segments == 20, algorithm == "jacobi"))
        for segments in (20, 50, 200)
        for algorithm in ("jacobi", "gauss-seidel", "plain-jacobi", "extrapolated", "iterated")
    ],
)
def test_coupling_is_stable_at_10_ms_with_a_stiff_tether(segments, algorithm, tmp_path):
    """The vehicle's mass at EA = 1e5 N, nothing but the tether to damp it, at 10 ms.

    With a force held from the end of the last step it grows by e^(0.7 s^-1 t), 10^6 in 20 s.
    """
    rig = weight_rig(tmp_path, algorithm, axial_stiffness=1e5, segments=segments)
    found = recorded(rig, 2000, ["weight.position.z", "tether.force.down"])
    swings = [np.ptp(found[k : k + 500, 0]) for k in (1, 500, 1000, 1500)]
    assert all(later < 0.1 * earlier for earlier, later in itertools.pairwise(swings))
    # At rest at last under 10 N: stretched by 4 mm from the unstretched 40 m.
    assert found[-1] == pytest.approx([40.004, -10.0], rel=1e-4)


def exact_weight(segments, times, stiffness):
    """Return the depth of the weight as one system with its cable, by Radau's method."""
    one = cable(segments, axial_stiffness=stiffness, tangential_drag=0.02)
    n = 3 * (segments + 1)

    def slope(t, y):
        x, v = y[:n].reshape(3, -1), y[n:].reshape(3, -1)
        s = one.forces(x, v, STILL)
        a = one.accelerations(s)
        a[:, 0] = 0.0
        a[:, -1] = (one.node_forces(s)[:, -1] + [0.0, 0.0, 10.0]) / 8.44
        return np.concatenate((y[n:], a.ravel()))

    x, v = np.zeros((3, segments + 1)), np.zeros((3, segments + 1))
    x[2] = np.linspace(0.0, 40.02, segments + 1)
    v[2] = np.linspace(0.0, 0.05, segments + 1)
    solved = solve_ivp(
        slope, (0.0, times[-1]), np.concatenate((x.ravel(), v.ravel())), "Radau",
        t_eval=times, rtol=1e-8, atol=1e-9,
    )  # fmt: skip
    return solved.y[n - 1]


@pytest.mark.interop
def test_coupling_converges_to_one_system_with_first_order(tmp_path):
    times = 0.02 * np.arange(1, 76)
    exact = exact_weight(10, times, 2e4)
    errors = []
    for h_ms in (10, 5, 2.5):
        every = round(20 / h_ms)
        rig = weight_rig(tmp_path, step=f"{h_ms} ms", segments=10)
        found = recorded(rig, 75 * every, ["weight.position.z"])[every::every, 0]
        errors.append(np.abs(found - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 1.0, atol=0.25)
    # Implicit in time: it takes omega h / 4, here 2 %, from the swing of the weight on its tether.
    assert errors[0] < 0.1 * np.ptp(exact)


def test_half_as_long_steps_inside_change_little(tmp_path):
    names = ["weight.position.z"]
    once = recorded(weight_rig(tmp_path, segments=10), 100, names)
    twice = recorded(weight_rig(tmp_path, segments=10, max_step=0.005), 100, names)
    assert 0.0 < np.abs(once - twice).max() < 0.05 * np.ptp(once)


# ---------------------------------------------------------------------- the sea of a trial


def test_the_current_of_a_trial_is_one_that_is_connected():
    ends = {"bottom_position": [10.0, 3.0, 30.0], "bottom_velocity": [0.1, 0.0, 0.0]}
    speed, direction = 0.5, 0.6
    north, east = speed * math.cos(direction), speed * math.sin(direction)
    connected = tether(current=[north, east, 0.0], **ends)
    of_the_trial = tether(current_speed=speed, current_direction=direction, **ends)
    for here, there in zip(run(of_the_trial, 50), run(connected, 50), strict=True):
        np.testing.assert_allclose(np.hstack(here), np.hstack(there), rtol=1e-12, atol=1e-12)


@pytest.mark.interop
def test_the_layers_of_a_trials_current_are_the_profile_of_the_cable():
    ends = {"bottom_position": [4.0, 0.0, 38.0]}
    profile = tether(
        profile_points=2,
        profile_depth=[5.0, 25.0, *[0.0] * 6],
        profile_north=[0.6, 0.2, *[0.0] * 6],
        **ends,
    )
    layers = tether(
        current_profile="layers",
        current_layers=2,
        current_layer_depths=[5.0, 25.0, *[0.0] * 6],
        current_layer_speeds=[0.6, 0.2, *[0.0] * 6],
        **ends,
    )
    # The start looks for a shape in the water of a straight cable; then it settles.
    for one in (profile, layers):
        run(one, 3000)
    np.testing.assert_allclose(shape(layers), shape(profile), atol=2e-4)  # of a bow of 6.7 m
    np.testing.assert_allclose(layers.get("force"), profile.get("force"), rtol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("direction", [0.0, 2.0])
def test_waves_drag_a_taut_cable(direction):
    height, period, top, bottom, segments = 0.1, 6.0, 2.0, 12.0, 40
    one = tether(
        length=9.8,
        segments=segments,
        mass_per_length=NEUTRAL,
        top_position=[0.0, 0.0, top],
        bottom_position=[0.0, 0.0, bottom],
        sea_spectrum="regular",
        sea_height=height,
        sea_period=period,
        sea_direction=direction,
    )
    rows = run(one, 600)
    at = OUTPUTS.index("force"), OUTPUTS.index("surface_force")
    pulled = np.array([np.add(row[at[0]], row[at[1]]) for row in rows])
    # Airy in deep water, at x = 0; the cable follows at once, and hardly moves.
    omega = math.tau / period
    z = top + (np.arange(segments) + 0.5) * (bottom - top) / segments
    u = 0.5 * height * omega * np.exp(-(omega**2) / 9.81 * z)
    drag = np.sum(0.5 * 1000.0 * 8.18e-3 * 1.2 * u**2) * (bottom - top) / segments
    t = 0.01 * np.arange(600)
    expected = drag * np.cos(omega * t) * np.abs(np.cos(omega * t))
    along = pulled[:, 0] * math.cos(direction) + pulled[:, 1] * math.sin(direction)
    across = pulled[:, 1] * math.cos(direction) - pulled[:, 0] * math.sin(direction)
    # 2.5 %: the stretched theory at the surface's place (k a = 0.6 %) and the cable's own motion.
    np.testing.assert_allclose(along[100:], expected[100:], atol=0.025 * drag)
    np.testing.assert_allclose(across, 0.0, atol=1e-9 * drag)
