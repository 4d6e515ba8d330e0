"""The Hydrone's equations against conservation laws, linear theory and equilibria.

Numbers come from the published parameters ([Timm2026]) by independent calculation.
"""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import root

from seatrial.errors import SimulationError
from seatrial.model.component import Parameter
from seatrial.model.units import conversion
from seatrial.physics.craft.kinematics import rotation
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.system.parameters import load_vehicle

WEIGHT = 10 * 9.81  # N, of the HUAUV
HEAVE = 1025 * 9.81 * 0.5  # N/m
W = 21.987 * 9.81  # N, of the craft
STRAY = {
    "position_start": (0.0, 0.0, 0.03),
    "attitude_start": (0.25, -0.1, 0.4),
    "velocity_start": (0.3, -0.2, 0.1),
    "rates_start": (0.2, 0.3, -0.4),
}
HORIZONTAL = ("position.x", "position.y", "attitude.psi")


class AnyStep(MarineCraft):
    """The craft without the limit on its sub-step."""

    max_step = Parameter(0.01, "s", "longest integration sub-step", min=1e-6)


def constant(downwash):
    """Return the wrench of the landed HUAUV in the body axes of a level craft, as inputs."""
    force, moment = downwash.wrench(5.0, (0.0, 0.0, 0.0))
    return {"force_2": force, "moment_2": moment}


def set_all(component, values):
    for name, value in values.items():
        component.set(name, value)


def test_parameters_are_declared_in_convertible_units_with_their_origin(hydrone):
    classes = {"marine-craft": MarineCraft, "downwash": type(hydrone.downwash("source"))}
    path = Path(__file__).parents[2] / "harness" / "vehicles" / "hydrone" / "vehicle.toml"
    file = tomllib.loads(path.read_text("utf-8"))
    for tables in (file, *file["variants"].values()):
        for table, cls in classes.items():
            for name, entry in tables[table].items():
                if isinstance(entry, str):  # follows from another one
                    assert entry.startswith("=")
                    continue
                port = cls.ports[name]
                assert entry["mark"] in ("stated", "corrected", "assumed")
                assert entry["source"]
                if port.type is float:
                    assert conversion(entry["unit"], port.unit) == (1.0, 0.0), name
                else:
                    port.check_text(entry["value"])
    assert file["default"] in file["variants"]
    assert set(hydrone.pads) == {
        "nominal",
        "longitudinal",
        "transversal",
        "diagonal-aft",
        "diagonal-fore",
    }


def test_mass_matrix_is_that_of_the_source(hydrone):
    M = hydrone.craft("source").mass_matrix()
    expected = np.diag([23.087, 39.577, 39.577, 3.80, 2.336, 5.847])
    expected[2, 4] = expected[4, 2] = 2.81
    np.testing.assert_allclose(M, expected, atol=1e-14)
    eigenvalues = [2.12517, 3.8, 5.847, 23.087, 39.577, 39.78783]
    np.testing.assert_allclose(np.linalg.eigvalsh(M), eigenvalues, atol=1e-5)


# ---------------------------------------------------------------------- conservation


def energy(craft, x):
    """Return kinetic and restoring energy of the conservative form, J."""
    n = rotation(*x[3:6])[2]
    restoring = W * (craft.GM_L * n[0] ** 2 + craft.GM_T * n[1] ** 2)
    return 0.5 * (x[6:] @ craft.mass_matrix() @ x[6:] + HEAVE * x[2] ** 2 + restoring)


def energies(craft, u=None):
    run = craft.reference(np.linspace(0, 20, 41), u, rtol=1e-12, atol=1e-13)
    return run, np.array([energy(craft, x) for x in run.x])


def test_energy_is_conserved_without_damping(hydrone):
    _run, E = energies(hydrone.undamped("consistent", **STRAY))
    assert np.abs(E / E[0] - 1).max() < 1e-9


def test_energy_of_craft_and_standing_load_is_conserved(hydrone):
    craft = hydrone.undamped("consistent", **STRAY)
    downwash = hydrone.downwash("consistent", pad="diagonal-aft")

    def load(t, x):
        force, moment = downwash.wrench(5.0, x.attitude.tolist())
        return {"force_2": force, "moment_2": moment}

    run, E = energies(craft, load)
    depth = np.array([x[2] + np.dot(rotation(*x[3:6])[2], downwash.pad) for x in run.x])
    total = E - WEIGHT * depth
    assert np.abs(total - total[0]).max() < 1e-9


def test_restoring_vector_of_the_source_does_not_conserve_energy(hydrone):
    craft = hydrone.undamped("source", **STRAY)
    _run, E = energies(craft)
    # Its own potential is W GM (1 - cos) per angle, equal to second order.
    assert np.abs(E / E[0] - 1).max() > 1e-2


def test_restoring_moment_has_no_component_about_the_vertical(hydrone):
    craft = hydrone.undamped("consistent")
    x = np.array([0, 0, 0, 0.3, -0.2, 1.0, 0, 0, 0, 0, 0, 0])
    moment = (craft.mass_matrix() @ craft.derivatives(x)[6:])[3:]
    assert abs(np.dot(rotation(*x[3:6])[2], moment)) < 1e-13
    assert np.linalg.norm(moment) > 50.0


@pytest.mark.parametrize(("variant", "conserves"), [("consistent", True), ("source", False)])
def test_momentum_is_conserved_only_with_the_coupling_in_coriolis(hydrone, variant, conserves):
    craft = hydrone.undamped(variant, GM_T=0.0, GM_L=0.0, waterplane_area=0.0, **STRAY)
    M = craft.mass_matrix()
    run = craft.reference(np.linspace(0, 20, 41), rtol=1e-13, atol=1e-14)
    linear, angular = [], []
    for x in run.x:
        R, h = np.array(rotation(*x[3:6])), M @ x[6:]
        linear.append(R @ h[:3])
        angular.append(R @ h[3:] + np.cross(x[:3], R @ h[:3]))
    scale = np.linalg.norm(linear[0])
    for momentum in (np.array(linear), np.array(angular)):
        drift = np.abs(momentum - momentum[0]).max() / scale
        assert drift < 2e-12 if conserves else drift > 0.05


# ---------------------------------------------------------------------- linear theory


def test_undamped_periods(hydrone):
    A = hydrone.undamped("source").linearise(np.zeros(12)).A
    omega = np.sort(np.abs(np.linalg.eigvals(A).imag))[-6::2]
    np.testing.assert_allclose(omega, [5.850384, 10.849584, 16.991713], atol=1e-6)
    np.testing.assert_allclose(2 * np.pi / omega, [1.073978, 0.579118, 0.369779], atol=1e-6)


def test_undamped_periods_without_coupling_of_heave_and_pitch(hydrone):
    craft = hydrone.undamped("source", added_coupling=0.0)
    omega = np.sort(np.abs(np.linalg.eigvals(craft.linearise(np.zeros(12)).A).imag))[-6::2]
    np.testing.assert_allclose(omega, [5.850384, 11.270937, 15.642422], atol=1e-6)


@pytest.mark.parametrize("variant", ["source", "consistent"])
def test_damped_eigenvalues_at_rest(hydrone, variant):
    values = np.linalg.eigvals(hydrone.craft(variant).linearise(np.zeros(12)).A)
    expected = [-96.342053, -78.511419, -32.027761, -3.725052, -2.956825, -0.435949]
    np.testing.assert_allclose(np.sort(values.real), expected + [0.0] * 6, atol=1e-6)
    np.testing.assert_allclose(values.imag, 0.0, atol=1e-12)


# deviation from the linear solution at 2 s, relative: heave, roll, pitch
NONLINEARITY = {
    1.0: (3.8e-3, -5.1e-2, -1.07e-3),
    0.1: (3.7e-5, -5.7e-3, -9.65e-5),
    0.01: (None, -5.8e-4, -9.5e-6),
}


@pytest.mark.parametrize("factor", NONLINEARITY)
def test_small_loads_approach_the_linear_solution(hydrone, factor):
    craft = hydrone.craft("source")
    downwash = hydrone.downwash("source", pad="diagonal-fore", mass=10 * factor)
    load = constant(downwash)
    set_all(craft, load)
    model = craft.linearise(np.zeros(12))
    slope = sum(
        model.B[:, model.u_names.index(f"{name}.{axis}")] * value
        for name, vector in load.items()
        for axis, value in zip("xyz", vector, strict=True)
    )
    system = np.block([[model.A, slope[:, None]], [np.zeros((1, 13))]])
    linear = expm(2.0 * system)[:12, 12]
    reached = craft.reference([0.0, 2.0]).x[-1]
    expected = NONLINEARITY[factor]
    deviation = reached[2:5] / linear[2:5] - 1
    for value, published in zip(deviation, expected, strict=True):
        if published is not None:
            assert value == pytest.approx(published, rel=0.02)
        else:
            assert abs(value) < 1e-6


# ---------------------------------------------------------------------- equilibria


@pytest.mark.parametrize(
    ("pad", "roll", "pitch"),
    [("transversal", 10.868940, 0.0), ("longitudinal", 0.0, -3.138475)],
)
def test_source_equilibrium_of_a_standing_load(hydrone, pad, roll, pitch):
    craft = hydrone.craft("source")
    set_all(craft, constant(hydrone.downwash("source", pad=pad)))
    x = craft.trim(np.zeros(12), hold=HORIZONTAL)
    assert x[2] == pytest.approx(WEIGHT / HEAVE, rel=1e-9)
    assert np.degrees(x[3:5]) == pytest.approx((roll, pitch), abs=1e-6)
    assert np.abs(x[5:]).max() < 1e-9


@pytest.mark.parametrize(
    ("pad", "angle", "degrees"),
    [("transversal", "phi", 10.868940), ("longitudinal", "theta", -3.138475)],
)
def test_source_simulation_reaches_the_equilibrium(hydrone, pad, angle, degrees):
    downwash = hydrone.downwash("source", pad=pad)
    run = hydrone.follow(hydrone.craft("source"), downwash, [0.0, 60.0])
    assert np.degrees(run[f"attitude.{angle}"][-1]) == pytest.approx(degrees, abs=1e-6)
    # Residual sway or surge of the heeled craft keeps a share in the sinkage for minutes.
    assert run["position.z"][-1] == pytest.approx(0.019567, rel=1e-3)


@pytest.mark.parametrize(
    ("pad", "roll", "pitch"),
    [("transversal", 12.890336, 0.0), ("longitudinal", 0.0, -3.250338)],
)
def test_vertical_weight_heels_more(hydrone, pad, roll, pitch):
    craft = hydrone.craft("consistent")
    downwash = hydrone.downwash("consistent", pad=pad)

    def slope(state):  # at rest; the load turns in body axes as the craft heels
        force, moment = downwash.wrench(5.0, (state[1], state[2], 0.0))
        set_all(craft, {"force_2": force, "moment_2": moment})
        return craft.derivatives(np.array([0.0, 0.0, *state, *[0.0] * 7]))

    found = root(slope, [0.0, 0.0, 0.0], method="lm", options={"xtol": 1e-14, "ftol": 1e-14})
    assert np.abs(slope(found.x)).max() < 1e-9
    assert found.x[0] == pytest.approx(WEIGHT / HEAVE, rel=1e-9)
    assert np.degrees(found.x[1:]) == pytest.approx((roll, pitch), abs=1e-6)


# ---------------------------------------------------------------------- fixed steps


def stepped(craft, inputs, h, duration):
    set_all(craft, inputs)
    craft.initialise()
    craft.begin()
    for k in range(round(duration / h)):
        craft.advance(k * h, h)
    return np.array([v for p in craft.state_ports for v in craft.get(p.name)])


@pytest.mark.parametrize("variant", ["source", "physical"])
def test_port_and_starboard_mirror_each_other_to_the_bit(hydrone, variant):
    ends = []
    for side in (1, -1):
        downwash = hydrone.downwash(variant, "takeoff", "diagonal-fore")
        downwash.set("pad.y", side * 0.25)
        downwash.initialise()
        craft = hydrone.craft(variant)
        craft.initialise()
        craft.begin()
        for k in range(1200):
            force, moment = downwash.wrench(k / 100, craft.attitude)
            set_all(craft, {"force_2": force, "moment_2": moment})
            craft.advance(k / 100, 0.01)
        ends.append([v for p in craft.state_ports for v in craft.get(p.name)])
    mirror = [1, -1, 1, -1, 1, -1]
    np.testing.assert_array_equal(ends[1], np.array(mirror * 2) * ends[0])
    assert abs(ends[0][3]) > 0.1


def coarse(hydrone, h):
    craft = AnyStep("craft")
    entries = load_vehicle("hydrone").parameter_set("marine-craft", "source").values
    set_all(craft, {name: entry.value for name, entry in entries.items()})
    craft.set("max_step", h)
    return craft


def test_fixed_step_has_order_four(hydrone):
    load = constant(hydrone.downwash("source", pad="diagonal-aft"))
    craft = hydrone.craft("source")
    set_all(craft, load)
    exact = craft.reference([0.0, 2.0], rtol=1e-13, atol=1e-15).x[-1]
    errors = []
    for h in (0.01, 0.005, 0.0025, 0.00125):
        reached = stepped(hydrone.craft("source", max_step=h), load, h, 2.0)
        errors.append(np.abs(reached - exact).max())
    np.testing.assert_allclose(errors, [7e-7, 3.3e-8, 1.8e-9, 1.05e-10], rtol=0.1)
    orders = np.log2(np.array(errors[1:-1]) / errors[2:])
    np.testing.assert_allclose(orders, [4.2, 4.1], atol=0.1)


def test_why_sub_steps_are_limited(hydrone):
    load = constant(hydrone.downwash("source", pad="diagonal-aft"))
    with pytest.raises(SimulationError, match="nan"):
        stepped(coarse(hydrone, 0.022), load, 0.022, 2.0)
    fore = constant(hydrone.downwash("source", pad="diagonal-fore"))
    with pytest.raises(SimulationError, match="nan"):
        stepped(coarse(hydrone, 0.02), fore, 0.02, 2.0)
