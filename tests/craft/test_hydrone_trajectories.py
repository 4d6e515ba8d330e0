"""The Hydrone's landings and take-offs against independently computed trajectories."""

import csv
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[1] / "reference"
CSV_PADS = ("nominal", "longitudinal", "transversal", "diagonal-fore")
VARIANTS = ("source", "consistent", "physical")
PHASES = ("landing", "takeoff")
COLUMNS = (
    *("position.x", "position.y", "position.z"),
    *("attitude.phi", "attitude.theta", "attitude.psi"),
    *("velocity.u", "velocity.v", "velocity.w"),
    *("rates.p", "rates.q", "rates.r"),
)
SINKAGE = 10 * 9.81 / (1025 * 9.81 * 0.5)  # m, of the landed HUAUV
WINDOW = {"landing": (0, 400), "takeoff": (990, 1050)}
"""First sample that figures are taken from, and that of contact or lift-off (10 ms each).

Take-offs count from just before the spool-up at 10 s; before, the craft sinks under the HUAUV
that stands on it from t = 0.
"""
SCALED = {"GMT": "GM_T", "GML": "GM_L", "m": "mass"}


def table(name):
    with (DATA / name).open() as file:
        return list(csv.DictReader(file))


def history(run):
    """Return roll, pitch (deg) and heave (m) over time."""
    return {
        "roll": np.degrees(run["attitude.phi"]),
        "pitch": np.degrees(run["attitude.theta"]),
        "heave": run["position.z"],
    }


def peak(values, first=0):
    """Return the value of largest magnitude and its index, from index ``first`` on."""
    k = first + int(np.abs(values[first:]).argmax())
    return values[k], k


@pytest.mark.slow
@pytest.mark.parametrize(
    "pad", ["diagonal-fore", *(pytest.param(p, marks=pytest.mark.interop) for p in CSV_PADS[:-1])]
)
@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize(
    "variant", ["source", "physical", pytest.param("consistent", marks=pytest.mark.interop)]
)
def test_trajectory(hydrone, variant, phase, pad):
    name = f"hydrone_{variant}_{phase}_{pad.replace('-', '_')}.csv"
    expected = np.loadtxt(DATA / name, delimiter=",", skiprows=1)
    run = hydrone.run(variant, phase, pad)
    np.testing.assert_allclose(run.t[::10], expected[:, 0], atol=1e-12)
    load = hydrone.downwash(variant, phase, pad)
    Fz = np.array([load.load_at(t) for t in expected[:, 0]])
    assert np.abs(Fz - expected[:, 1]).max() < 1e-6 * expected[:, 1].max()
    for k, column in enumerate(COLUMNS):
        published = expected[:, 2 + k]
        # A column of zeros is zero by symmetry, in every bit.
        bound = 1e-6 * np.abs(published).max()
        assert np.abs(run[column][::10] - published).max() <= bound, column


def summarised(run, phase):
    """Return the columns of hydrone_summary.csv for one run."""
    first, event = WINDOW[phase]
    result = {}
    for name, values in history(run).items():
        unit = "m" if name == "heave" else "deg"
        value, k = peak(values, first)
        result |= {f"{name}_peak_{unit}": value, f"t_{name}_peak": run.t[k]}
        result |= {f"{name}_t10": values[1000], f"{name}_t20": values[2000]}
    for name in ("x", "y"):
        values = run[f"position.{name}"]
        result |= {f"{name}_t20": values[-1]}
        result |= {f"{name}_min": values[first:].min(), f"{name}_max": values[first:].max()}
    pitch = history(run)["pitch"]
    result |= {"pitch_min": pitch[first:].min(), "pitch_max": pitch[first:].max()}
    result["psi_t20_deg"] = np.degrees(run["attitude.psi"][-1])
    result["heave_settle_5pct_s"] = settling_time(run["position.z"], phase, first, event)
    return result


def settling_time(z, phase, first, event):
    """Return how long after contact or lift-off the heave last lies outside 5 %, s."""
    target = SINKAGE if phase == "landing" else 0.0
    band = 0.05 * (SINKAGE if phase == "landing" else z[first:].max())
    outside = np.nonzero(np.abs(z[event:] - target) > band)[0]
    return outside[-1] / 100


@pytest.mark.interop
@pytest.mark.parametrize(
    "row",
    table("hydrone_summary.csv"),
    ids=lambda row: f"{row['variant']}-{row['phase']}-{row['scenario']}",
)
def test_summary(hydrone, row):
    run = hydrone.run(row["variant"], row["phase"], row["scenario"].replace("_", "-"))
    found = summarised(run, row["phase"])
    assert set(found) == set(row) - {"variant", "phase", "scenario"}
    for name, value in found.items():
        # The absolute bound is for motion that has died out: 1e-9 of a degree or a metre.
        assert value == pytest.approx(float(row[name]), rel=1e-6, abs=1e-9), name


@pytest.mark.interop
@pytest.mark.parametrize(
    "row",
    table("hydrone_sensitivity.csv"),
    ids=lambda row: f"{row['phase']}-{row['parameter']}-{row['factor']}",
)
def test_sensitivity(hydrone, row):
    scaled, factor = SCALED[row["parameter"]], float(row["factor"])
    run = hydrone.run("source", row["phase"], "diagonal-aft", scaled, factor)
    for name, values in history(run).items():
        unit = "m" if name == "heave" else "deg"
        found = (abs(peak(values)[0]), values[1000], values[2000])
        columns = (f"{name}_peak_{unit}", f"{name}_t10", f"{name}_t20")
        expected = [float(row[column]) for column in columns]
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)


# ---------------------------------------------------------------------- stated figures
# What the source's text and tables 7 and 8 say, with tolerances for reading them.

ANGLE, HEIGHT, NOMINAL_PITCH, PEAK_TIME = 0.5, 0.006, 0.01, 0.3  # deg, m, deg, s


@pytest.mark.interop
@pytest.mark.parametrize(
    ("pad", "roll", "pitch"),
    [
        ("nominal", 0.0, 0.0),
        ("transversal", 10.5, 0.0),
        ("longitudinal", 0.0, -3.2),
        ("diagonal-aft", -10.5, 3.2),
        ("diagonal-fore", 10.5, -3.2),
    ],
)
def test_stated_angles_after_landing(hydrone, pad, roll, pitch):
    seen = history(hydrone.run("source", "landing", pad))
    assert (seen["roll"][1000], seen["pitch"][1000]) == pytest.approx((roll, pitch), abs=ANGLE)
    assert seen["heave"][1000] == pytest.approx(0.02, abs=HEIGHT)


@pytest.mark.interop
@pytest.mark.parametrize(
    ("pad", "roll", "pitch"),
    [
        ("transversal", 14.0, 0.0),
        ("longitudinal", 0.0, -7.0),
        ("diagonal-aft", -14.0, 7.0),
        ("diagonal-fore", 14.0, -7.0),
    ],
)
def test_stated_peaks_of_take_off(hydrone, pad, roll, pitch):
    seen = history(hydrone.run("source", "takeoff", pad))
    found_roll, k = peak(seen["roll"], 990)
    assert found_roll == pytest.approx(roll, abs=ANGLE)
    assert peak(seen["pitch"], 990)[0] == pytest.approx(pitch, abs=ANGLE)
    assert peak(seen["heave"], 990)[0] == pytest.approx(0.05, abs=HEIGHT)
    if roll:
        assert k / 100 == pytest.approx(11.0, abs=PEAK_TIME)


@pytest.mark.interop
def test_stated_pitch_of_the_nominal_take_off(hydrone):
    pitch = history(hydrone.run("source", "takeoff", "nominal"))["pitch"][1000:1200]
    assert (pitch.min(), pitch.max()) == pytest.approx((-0.06, 0.04), abs=NOMINAL_PITCH)


def test_stated_downwash_compares_with_the_weight_of_the_craft(hydrone):
    downwash = hydrone.downwash("source", "takeoff")
    assert downwash.load_at(10.2) == pytest.approx(255.06, abs=0.01)
    assert downwash.load_at(10.2) / (21.987 * 9.81) == pytest.approx(1.0, abs=0.2)


@pytest.mark.interop
def test_stated_heave_does_not_depend_on_the_mass(hydrone):
    runs = [
        hydrone.run("source", "landing", "diagonal-aft", "mass", factor)
        for factor in (0.8, 1.0, 1.2)
    ]
    assert [run["position.z"][-1] for run in runs] == pytest.approx([0.0196] * 3, abs=1e-4)


@pytest.mark.interop
@pytest.mark.parametrize(
    ("phase", "pad", "roll_passes", "pitch_passes"),
    [
        ("landing", "nominal", True, True),
        ("takeoff", "nominal", True, True),
        ("landing", "longitudinal", True, True),
        ("takeoff", "longitudinal", True, False),
        ("landing", "transversal", False, True),
        ("takeoff", "transversal", False, True),
        ("landing", "diagonal-aft", False, True),
        ("takeoff", "diagonal-aft", False, False),
        ("landing", "diagonal-fore", False, True),
        ("takeoff", "diagonal-fore", False, False),
    ],
)
def test_verdicts_on_the_limits_of_the_source(hydrone, phase, pad, roll_passes, pitch_passes):
    run = hydrone.run("source", phase, pad)
    seen = history(run)
    assert (np.abs(seen["roll"]).max() < 10.0) == roll_passes
    assert (np.abs(seen["pitch"]).max() < 5.0) == pitch_passes
    first, event = WINDOW[phase]
    assert settling_time(run["position.z"], phase, first, event) < 5.0


# ---------------------------------------------------------------------- the other variants


@pytest.mark.interop
@pytest.mark.parametrize(
    ("phase", "pad", "roll", "pitch"),
    [
        ("takeoff", "transversal", 12.91, None),
        ("takeoff", "longitudinal", None, -3.50),
        ("takeoff", "diagonal-fore", 13.00, -3.54),
        ("takeoff", "diagonal-aft", -13.00, 3.54),
    ],
)
def test_physical_peaks(hydrone, phase, pad, roll, pitch):
    seen = history(hydrone.run("physical", phase, pad))
    if roll is not None:
        assert peak(seen["roll"], 990)[0] == pytest.approx(roll, abs=0.005)
    if pitch is not None:
        assert peak(seen["pitch"], 990)[0] == pytest.approx(pitch, abs=0.005)


@pytest.mark.interop
def test_physical_landing(hydrone):
    roll = history(hydrone.run("physical", "landing", "transversal"))["roll"]
    pitch = history(hydrone.run("physical", "landing", "longitudinal"))["pitch"]
    assert (roll[1000], roll[2000]) == pytest.approx((12.03, 12.86), abs=0.005)
    assert pitch[2000] == pytest.approx(-3.25, abs=0.005)


# ---------------------------------------------------------------------- co-simulation


def coupled_peaks(hydrone, variant, H, delay):
    """Return the take-off's largest roll and pitch (deg) with the load held for H (s).

    Small sub-steps leave the coupling as the only error; ``delay``: one step late.
    """
    craft = hydrone.craft(variant, max_step=0.002)
    downwash = hydrone.downwash(variant, "takeoff", "diagonal-aft")
    craft.initialise()
    craft.begin()
    held = downwash.wrench(0.0, craft.attitude)
    angles = []
    for k in range(round(14.0 / H)):
        now = downwash.wrench(round(k * H, 9), craft.attitude)
        craft.force_2, craft.moment_2 = held if delay else now
        held = now
        craft.advance(k * H, H)
        angles.append(craft.attitude[:2])
    return np.degrees(np.abs(angles).max(axis=0))


def exact_peaks(hydrone, variant, H):
    run = hydrone.run(variant, "takeoff", "diagonal-aft")
    angles = np.array([run["attitude.phi"], run["attitude.theta"]])
    return np.degrees(np.abs(angles[:, :: round(100 * H)]).max(axis=1))


@pytest.mark.interop
@pytest.mark.parametrize(
    ("H", "delay", "roll", "pitch"),
    [
        (0.01, False, 0.016, 1e-5),
        (0.01, True, 0.037, 0.009),
        (0.02, True, 0.073, 0.018),
        (0.05, True, 0.181, 0.042),
    ],
)
def test_error_of_coupling_by_held_loads(hydrone, H, delay, roll, pitch):
    error = np.abs(coupled_peaks(hydrone, "source", H, delay) - exact_peaks(hydrone, "source", H))
    assert error[0] < roll
    assert error[1] < pitch


@pytest.mark.interop
def test_error_of_coupling_is_of_first_order(hydrone):
    errors = [
        coupled_peaks(hydrone, "consistent", H, False)[0] - exact_peaks(hydrone, "consistent", H)[0]
        for H in (0.01, 0.02, 0.05)
    ]
    assert errors[0] == pytest.approx(0.016, abs=1e-3)
    assert errors[1] / errors[0] == pytest.approx(2.0, abs=0.1)
    assert errors[2] / errors[0] == pytest.approx(5.0, abs=0.25)
