import csv
import math
from pathlib import Path

import pytest

from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError

from .running import run, started

REFERENCE = Path(__file__).parents[1] / "reference" / "t200_16v.csv"
ROWS = [
    {key: float(text) for key, text in row.items()}
    for row in csv.DictReader(REFERENCE.open(encoding="utf-8"))
]
G = 9.80665  # N per kgf


def settled(pulse, **values):
    """Return thrust and current after twenty time constants."""
    thruster = started(Thruster, time_constant=0.1, pulse=pulse, **values)
    thruster.advance(0.0, 4.0)
    return thruster.get("thrust"), thruster.get("current")


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['pwm_us']:g}us")
def test_settles_at_the_published_table(row):
    thrust, current = settled(row["pwm_us"] / 1e6)
    assert thrust == pytest.approx(row["force_kgf"] * G, abs=1e-9)
    assert current == pytest.approx(row["current_A"], abs=1e-9)


@pytest.mark.parametrize("row", ROWS[::20], ids=lambda row: f"{row['pwm_us']:g}us")
def test_draws_the_published_power(row):
    thruster = started(Thruster, time_constant=0.1, pulse=row["pwm_us"] / 1e6)
    thruster.advance(0.0, 4.0)
    assert thruster.get("power") == pytest.approx(row["power_W"], abs=0.01)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['pwm_us']:g}us")
def test_turns_as_fast_as_published(row):
    thruster = started(Thruster, time_constant=0.1, pulse=row["pwm_us"] / 1e6)
    thruster.advance(0.0, 4.0)
    ahead = math.copysign(1.0, row["force_kgf"])
    assert thruster.get("speed") == pytest.approx(ahead * row["rpm"] * math.pi / 30, abs=1e-9)


def test_turns_slower_on_less_voltage_as_its_thrust_says():
    full, low = (started(Thruster, pulse=1.9e-3, supply_voltage=volts) for volts in (16.0, 12.0))
    for thruster in (full, low):
        thruster.advance(0.0, 10.0)
    thrusts, speeds = ([each.get(name) for each in (low, full)] for name in ("thrust", "speed"))
    assert (speeds[0] / speeds[1]) ** 2 == pytest.approx(thrusts[0] / thrusts[1], rel=1e-12)


def test_is_linear_between_the_rows():
    low, high = ROWS[-2], ROWS[-1]
    thrust, current = settled((low["pwm_us"] + high["pwm_us"]) / 2e6)
    assert thrust == pytest.approx((low["force_kgf"] + high["force_kgf"]) / 2 * G, abs=1e-9)
    assert current == pytest.approx((low["current_A"] + high["current_A"]) / 2, abs=1e-9)


def test_thrust_never_falls_as_the_pulse_grows():
    thrusts = [settled(us / 1e6)[0] for us in range(1000, 2000, 3)]
    assert thrusts == sorted(thrusts)


@pytest.mark.parametrize("us", [1472, 1480, 1500, 1520, 1528])
def test_dead_band(us):
    assert settled(us / 1e6) == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.0, abs=1e-12))


@pytest.mark.parametrize("us", [0, -1500, 799, 2201, 20000])
def test_no_signal_is_no_thrust(us):
    assert settled(us / 1e6) == (0.0, 0.0)


@pytest.mark.parametrize(("us", "row"), [(1000, 0), (1099, 0), (1901, -1), (2000, -1)])
def test_pulses_beyond_the_range_are_full_power(us, row):
    assert settled(us / 1e6)[0] == pytest.approx(ROWS[row]["force_kgf"] * G)


def test_losing_the_signal_spins_down():
    thruster = started(Thruster, pulse=1.9e-3)
    thruster.advance(0.0, 3.0)
    full = thruster.get("thrust")
    thruster.set("pulse", 0.0)
    thruster.advance(3.0, 0.15)
    assert thruster.get("thrust") == pytest.approx(full * math.exp(-1.0), rel=1e-8)


@pytest.mark.parametrize("step_ms", [1, 5, 10, 50, 300])
def test_lag_is_exact_for_any_step(step_ms):
    thruster = started(Thruster, pulse=1.9e-3, time_constant=0.15)
    rows = run(thruster, ["thrust", "current"], 600, step_ms)
    for index, (thrust, current) in enumerate(rows):
        risen = -math.expm1(-index * step_ms / 150)
        assert thrust == pytest.approx(ROWS[-1]["force_kgf"] * G * risen, rel=1e-12)
        assert current == pytest.approx(ROWS[-1]["current_A"] * risen, rel=1e-12)


def test_reversed_motor_mirrors_the_pulse():
    thrust, current = settled(1.7e-3, reversed=1.0)
    assert (thrust, current) == pytest.approx(settled(1.3e-3), rel=1e-12)
    assert thrust < 0.0


def test_calibration_stretches_the_table():
    calibration = {"pulse_min": 1.0e-3, "pulse_neutral": 1.5e-3, "pulse_max": 2.0e-3}
    assert settled(2.0e-3, **calibration)[0] == pytest.approx(ROWS[-1]["force_kgf"] * G)
    assert settled(1.75e-3, **calibration)[0] == pytest.approx(settled(1.7e-3)[0])
    assert settled(1.25e-3, **calibration)[0] == pytest.approx(settled(1.3e-3)[0])


# Manufacturer's full-throttle thrust ahead and astern, kgf (T200 product page).
@pytest.mark.parametrize(
    ("voltage", "ahead", "astern"), [(12.0, 3.71, 2.92), (16.0, 5.25, 4.1), (20.0, 6.7, 5.05)]
)
def test_supply_voltage_against_published_full_thrust(voltage, ahead, astern):
    assert settled(1.9e-3, supply_voltage=voltage)[0] == pytest.approx(ahead * G, rel=0.02)
    assert settled(1.1e-3, supply_voltage=voltage)[0] == pytest.approx(-astern * G, rel=0.05)


@pytest.mark.parametrize("voltage", [0.0, -5.0])
def test_no_supply_is_no_thrust(voltage):
    assert settled(1.9e-3, supply_voltage=voltage) == (0.0, 0.0)


def test_refuses_a_calibration_that_does_not_rise():
    with pytest.raises(InputError, match="must rise"):
        started(Thruster, pulse_neutral=1.95e-3)
