"""The surface vessel against closed forms, conservation laws and a limit of stability."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.vessel.surface_vessel import SurfaceVessel
from tests.kits.videoray.vessel_loop import build, profile

FREE = {"damping": 0.0, "eta_start": (0.0, 0.0, 0.3), "nu_start": (0.5, 0.2, 0.4)}


def motion(variant, t, **values):
    return build(SurfaceVessel, variant, **values).reference(t, rtol=1e-12, atol=1e-14)


def test_free_motion_conserves_energy_and_momentum():
    mass = np.array(profile("physical")["mass"])
    run = motion("physical", np.linspace(0, 50, 51), **FREE)
    _x, _y, psi, u, v, r = run.x.T
    north = mass[0] * u * np.cos(psi) - mass[1] * v * np.sin(psi)
    east = mass[0] * u * np.sin(psi) + mass[1] * v * np.cos(psi)
    energy = mass[0] * u**2 + mass[1] * v**2 + mass[2] * r**2
    about = mass[2] * r + run["eta.x"] * east - run["eta.y"] * north
    for conserved in (north, east, energy, about):
        assert np.abs(conserved - conserved[0]).max() < 1e-9 * np.abs(energy[0])
    assert np.ptp(u) > 0.1  # it does tumble


def test_the_sources_yaw_coupling_creates_energy():
    mass = np.array(profile("physical")["mass"])
    run = motion("physical", np.linspace(0, 20, 201), **FREE, yaw_coupling_sign=-1)
    energy = (run.x[:, 3:] ** 2) @ mass
    assert np.ptp(energy) > 0.1 * energy[0]


def test_surge_alone_follows_its_closed_form():
    mass, damping, thrust, t = 8.44, 0.95, 46.7, np.linspace(0, 30, 31)
    craft = build(SurfaceVessel, "physical", command=[0.1, 0.1])
    u = craft.reference(t)["nu.u"]
    np.testing.assert_allclose(
        u, 2 * 0.1 * thrust / damping * -np.expm1(-damping / mass * t), rtol=1e-9
    )


def test_thruster_1_ahead_turns_to_starboard():
    slope = build(SurfaceVessel, "physical", command=[1.0, 0.0]).derivatives(np.zeros(6))
    np.testing.assert_allclose(slope[3:], [46.7 / 8.44, 0, 0.1 * 46.7 / 0.133], rtol=1e-14)


def test_loads_act_on_all_three_axes():
    loads = {"force_1": [3.0, 3.0], "force_4": [0.0, 1.0], "moment_2": 5.0}
    slope = build(SurfaceVessel, "physical", **loads).derivatives(np.zeros(6))
    np.testing.assert_allclose(slope[3:], [3 / 8.44, 4 / 12.55, 5 / 0.133], rtol=1e-14)


def test_straight_motion_is_unstable_above_the_munk_limit():
    """Stable if and only if d22 d33 > m11 (m22 - m11) U^2 (Routh, 2 x 2)."""
    (m11, m22, _), (_, d22, d33) = (profile("physical")[k] for k in ("mass", "damping"))
    limit = np.sqrt(d22 * d33 / (m11 * (m22 - m11)))
    assert limit == pytest.approx(0.062, abs=5e-4)
    craft = build(SurfaceVessel, "physical")
    for share, sign in ((0.999, -1), (1.001, 1)):
        A = craft.linearise(np.array([0, 0, 0, share * limit, 0, 0])).A
        poles = np.linalg.eigvals(A[np.ix_([4, 5], [4, 5])])
        assert sign * poles.real.max() > 0


def test_linearisation_is_the_jacobian_of_section_5():
    (m11, m22, m33), (d11, d22, d33) = (profile("table75")[k] for k in ("mass", "damping"))
    U, V, R = 0.3, -0.2, 0.5
    for s in (1, -1):
        craft = build(SurfaceVessel, "table75", yaw_coupling_sign=s)
        c = s * (m11 - m22)
        expected = [
            [-d11 / m11, m22 * R / m11, m22 * V / m11],
            [-m11 * R / m22, -d22 / m22, -m11 * U / m22],
            [c * V / m33, c * U / m33, -d33 / m33],
        ]
        A = craft.linearise(np.array([0, 0, 0, U, V, R])).A
        np.testing.assert_allclose(A[3:, 3:], expected, rtol=1e-14, atol=1e-17)


def test_a_sign_between_the_two_is_refused():
    craft = build(SurfaceVessel, "physical", yaw_coupling_sign=0.5)
    with pytest.raises(InputError, match=r"yaw_coupling_sign is 0\.5, allowed -1\.0 or 1\.0"):
        craft.initialise()


def test_the_fit_has_the_ratios_that_table_81_gives():
    values = profile("table81_fit")
    m11, m22, m33 = values["mass"]
    assert m11 / values["damping"][1] == pytest.approx(43.3077, abs=1e-3)
    assert m22 / m11 == pytest.approx(0.73332, abs=6e-5)
    assert m33 / m11 == pytest.approx(17.615, abs=9e-3)
    assert values["yaw_coupling_sign"] == -1
