"""Station keeping: decisions one by one, then holding the Hydrone in a closed loop."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.control.station_keeping import HEADING_ONLY, HOLD, IDLE, RETURN, StationKeeping
from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError

from ..devices.running import started

REFERENCE = Path(__file__).parents[1] / "reference" / "t200_16v.csv"
NEUTRAL = 1.5e-3
DEG = math.radians(1.0)


def pilot(**values):
    """Return an autopilot that is armed, on its station and heading by default."""
    return started(StationKeeping, **{"enabled": True, **values})


def decided(**values):
    """Return (mode, surge force, yaw moment) at the first instant."""
    keeper = pilot(**values)
    return keeper.get("mode"), keeper.get("surge_force"), keeper.get("yaw_moment")


# ------------------------------------------------------------------ allocation


def table_thrust(pulse):
    """Return the thrust (N) of the published T200 table at a pulse (s)."""
    with REFERENCE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    us = [float(row["pwm_us"]) for row in rows]
    newton = [float(row["force_kgf"]) * 9.80665 for row in rows]
    return np.interp(pulse * 1e6, us, newton)


def test_pulses_give_the_force_and_moment_by_the_published_table():
    # Largest error 1.52 N in a thruster, 3 % of full thrust.
    keeper = pilot(surge_limit=100.0, moment_limit=100.0, surge_damping=0.0)
    worst = 0.0
    for thrust in np.linspace(-39.9, 51.4, 200):
        keeper._command(2 * thrust, 0.0)
        got = table_thrust(np.array([keeper.pulse_port, keeper.pulse_starboard]))
        worst = max(worst, abs(got[0] - thrust))
        assert got[0] == got[1]
    assert worst < 1.53
    assert worst < 0.03 * 51.4


def test_turning_splits_the_thrust():
    keeper = pilot()
    keeper._command(10.0, 4.0)
    port, starboard = table_thrust(np.array([keeper.pulse_port, keeper.pulse_starboard]))
    assert port == pytest.approx(10.0, abs=1.5)
    assert starboard == pytest.approx(0.0, abs=1e-12)


def test_no_thrust_is_exactly_neutral():
    keeper = pilot(position_n=[0, 0, 0])
    assert (keeper.get("pulse_port"), keeper.get("pulse_starboard")) == (NEUTRAL, NEUTRAL)


def test_pulses_stay_within_their_range_whatever_is_asked():
    values = {"surge_limit": 1e6, "moment_limit": 1e6, "surge_gain": 1e4, "yaw_gain": 1e4}
    for north in (-5, 5):
        for heading in (-3, -1, 0, 1, 3):
            keeper = pilot(position_n=[north, 0, 0], heading=heading, **values)
            for pulse in (keeper.get("pulse_port"), keeper.get("pulse_starboard")):
                assert 1.1e-3 <= pulse <= 1.9e-3


def test_moment_comes_first_when_the_thrusters_cannot_do_both():
    limits = {"surge_limit": 1e6, "moment_limit": 1e6}
    _, surge, moment = decided(
        position_n=[-0.9, 0, 0], heading=-3, surge_gain=1e4, yaw_gain=1e4, **limits
    )
    assert moment == pytest.approx(2 * 0.4 * 39.9)
    # Astern (the station is behind): what is left of the starboard thruster, pushing astern.
    assert surge == pytest.approx(0.0, abs=1e-9)


# ------------------------------------------------------------------ decisions


def test_holds_within_the_radius_and_returns_outside():
    assert decided(position_n=[0.99, 0, 0])[0] == HOLD
    assert decided(position_n=[1.01, 0, 0])[0] == RETURN
    assert decided(position_n=[0.8, 0.8, 5])[0] == RETURN


def test_returns_until_captured():
    keeper = pilot(position_n=[2.0, 0, 0])
    modes = []
    for k, north in enumerate([2.0, 0.9, 0.31, 0.29, 0.5, 0.99, 1.01]):
        keeper.set("position_n", [north, 0, 0])
        modes.append(keeper.get("mode"))
        keeper.advance(0.05 * k, 0.05)
    assert modes == [RETURN, RETURN, RETURN, HOLD, HOLD, HOLD, RETURN]


@pytest.mark.parametrize("heading", [-100, -30, 0, 30, 100, 390])
def test_hold_turns_the_short_way(heading):
    _, _, moment = decided(heading=heading * DEG, station_heading=10 * DEG)
    error = math.remainder((10 - heading) * DEG, math.tau)
    assert math.copysign(1, moment) == math.copysign(1, error)


@pytest.mark.parametrize(("heading", "sign"), [(0, 1), (180, -1)])
def test_hold_corrects_along_the_bow(heading, sign):
    _, surge, _ = decided(position_n=[-0.5, 0, 0], heading=heading * DEG)
    assert surge == pytest.approx(sign * 8.0 * 0.5)


def test_hold_leaves_an_error_abeam():
    _, surge, moment = decided(position_n=[0, 0.9, 0])
    assert (surge, moment) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("heading", "surge_sign", "turn_sign"), [(30, 1, -1), (-30, 1, 1), (150, -1, 1), (-150, -1, -1)]
)
def test_return_goes_bow_or_stern_first(heading, surge_sign, turn_sign):
    # The station is 5 m to the north.
    _, surge, moment = decided(position_n=[-5, 0, 0], heading=heading * DEG)
    assert surge * surge_sign > 0
    assert moment * turn_sign > 0


def test_return_does_not_drive_while_pointing_away():
    _, surge, _ = decided(position_n=[-5, 0, 0], heading=90 * DEG)
    assert surge == pytest.approx(0.0, abs=1e-9)


def test_return_keeps_its_end_while_it_turns():
    # Entered stern first; swung across the beam it stays stern first.
    keeper = pilot(position_n=[-5, 0, 0], heading=100 * DEG)
    keeper.advance(0.0, 0.05)
    keeper.set("heading", 80 * DEG)
    assert keeper.get("yaw_moment") > 0.0


def test_damping_acts_against_motion():
    _, surge, _ = decided(velocity_n=[0.2, 0, 0])
    assert surge == pytest.approx(-25.0 * 0.2)
    _, _, moment = decided(yaw_rate=0.1)
    assert moment == pytest.approx(-12.0 * 0.1)


# ------------------------------------------------------------------ safety


def test_starts_disarmed_and_neutral():
    keeper = started(StationKeeping, position_n=[5, 5, 0], heading=2.0)
    for k in range(40):
        assert keeper.get("mode") == IDLE
        assert (keeper.get("pulse_port"), keeper.get("pulse_starboard")) == (NEUTRAL, NEUTRAL)
        keeper.advance(0.05 * k, 0.05)


def test_disarming_is_neutral_at_the_next_instant_and_forgets():
    keeper = pilot(position_n=[-0.5, 0, 0])
    for k in range(100):
        keeper.advance(0.05 * k, 0.05)
    assert keeper.get("surge_force") > 8.0 * 0.5 + 1.0  # the integral has grown
    keeper.set("enabled", False)
    assert (keeper.get("pulse_port"), keeper.get("pulse_starboard")) == (NEUTRAL, NEUTRAL)
    keeper.advance(5.0, 0.05)
    keeper.set("enabled", True)
    assert keeper.get("surge_force") == pytest.approx(8.0 * 0.5)


@pytest.mark.parametrize(
    ("lost", "mode"), [("heading_valid", IDLE), ("position_valid", HEADING_ONLY)]
)
def test_lost_input_is_tolerated_for_the_timeout(lost, mode):
    keeper = pilot(position_n=[-0.5, 0, 0], heading=0.2, timeout=0.5)
    modes = []
    for k in range(40):
        keeper.set(lost, k < 10)
        modes.append(keeper.get("mode"))
        keeper.advance(0.05 * k, 0.05)
    # Last valid at 0.45 s; 0.5 s later it is lost.
    assert modes == [HOLD] * 20 + [mode] * 20
    assert keeper.get("surge_force") == 0.0


@pytest.mark.parametrize(
    ("lost", "mode"), [("heading_valid", IDLE), ("position_valid", HEADING_ONLY)]
)
def test_nothing_is_believed_before_it_is_valid(lost, mode):
    keeper = pilot(position_n=[-0.5, 0, 0], heading=0.2, **{lost: False})
    assert keeper.get("mode") == mode
    assert keeper.get("surge_force") == 0.0
    keeper.advance(0.0, 0.05)
    keeper.set(lost, True)
    assert keeper.get("mode") == HOLD


def test_integral_does_not_wind_up_against_a_limit():
    keeper = pilot(position_n=[-0.9, 0, 0], surge_limit=3.0)
    for k in range(2000):
        keeper.advance(0.05 * k, 0.05)
    # 100 s against the limit; the demand turns as soon as the error does.
    keeper.set("position_n", [0.5, 0, 0])
    assert keeper.get("surge_force") < 0.0


def test_integral_keeps_its_direction_when_the_craft_turns():
    h, period, steps = 2.0, 0.1, 20
    bow = complex(math.cos(h), math.sin(h))
    gains = {"surge_gain": 5.0, "surge_integral": 3.0, "surge_damping": 25.0, "surge_limit": 1e3}
    keeper = pilot(**gains, heading=h, station=[0.4 * bow.real, 0.4 * bow.imag], period=period)
    for k in range(steps):
        keeper.advance(k * period, period)
    learnt = 3.0 * 0.4 * period * steps * bow
    turned, velocity = 0.3, complex(0.2, -0.1)
    values = {"heading": turned, "station": [0, 0], "velocity_n": [velocity.real, velocity.imag, 0]}
    for name, value in values.items():
        keeper.set(name, value)
    along = ((learnt - 25.0 * velocity) * np.exp(-1j * turned)).real
    assert keeper.get("surge_force") == pytest.approx(along)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"capture_radius": 1.0}, "capture_radius .* must be less than"),
        ({"pulse_neutral": 1.0e-3}, "must rise"),
    ],
)
def test_refuses_what_cannot_be(values, message):
    with pytest.raises(InputError, match=message):
        pilot(**values)


def test_neutral_pulse_stops_the_thruster():
    thruster = started(Thruster, pulse=pilot().get("pulse_port"))
    thruster.advance(0.0, 1.0)
    assert thruster.get("thrust") == 0.0
