"""Orders of manoeuvres to a vessel of first order: rate and speed follow helm and thrust."""

import math
from itertools import groupby

import numpy as np
import pytest

from seatrial_kits.sea_trials.figures.course_stability import loop, spiral, stability
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.zigzag import zig_zag
from seatrial_kits.sea_trials.manoeuvre import Manoeuvre
from seatrial_kits.sea_trials.orders import EXECUTES, KINDS, POWERS

STEP, FULL_SPEED, SPEED_LAG = 0.1, 4.0, 8.0
GAIN, LAG = 0.15, 4.0
"""Rate of turn at full helm, rad/s, and its time constant, s."""
SLOPE, CUBE = -0.3, 90.0
"""Of a vessel that is not stable: helm = SLOPE r + CUBE r^3 where the rate is steady."""


class Trial:
    """A manoeuvre of a vessel that starts at rest, and what was ordered and done."""

    def __init__(self, longest=900.0, noise=0.0, stable=True, gain=GAIN, lag=LAG, **settings):
        self.stable, self.gain, self.lag = stable, gain, lag
        self.component = Manoeuvre("manoeuvre")
        for name, value in {"window": 20.0, **settings}.items():
            self.component.set(name, value)
        self.component.initialise()
        self.component.begin()
        self.rows, self.ended = [], None
        self.run(longest, np.random.default_rng(0), noise)

    def run(self, longest, random, noise):
        north = east = rate = speed = depth = pitch = 0.0
        heading = 3.1  # a turn to starboard wraps at once
        for k in range(round(longest / STEP)):
            read = self.component.get
            helm, ahead = read("helm_order"), read("speed_order")
            self.rows.append((k * STEP, north, east, heading, helm, ahead, read("phase"), speed))
            if read("done"):
                self.ended = k * STEP
                return
            north += STEP * speed * math.cos(heading)
            east += STEP * speed * math.sin(heading)
            heading += STEP * rate
            rate += STEP * self.turning(helm, heading, rate) / self.lag
            speed += STEP * (FULL_SPEED * ahead - speed) / SPEED_LAG
            if read("mode") == "guided":
                depth += STEP * 0.2 * (read("target_position")[2] - depth)
            self.component.set("heading", math.remainder(heading, math.tau)
                               + noise * random.standard_normal())  # fmt: skip
            velocity = speed * math.cos(heading), speed * math.sin(heading), 0.0
            self.component.set("velocity_n", list(velocity))
            pitch -= STEP * 0.05 * read("manual")[3]
            self.component.set("depth", depth)
            self.component.set("pitch", pitch)
            self.component.advance(k * STEP, STEP)
        self.depth = depth

    def turning(self, helm, heading, rate):
        """Return what moves the rate, rad/s: by helm, or as the pilot holds the heading."""
        if self.component.get("mode") == "stabilize":
            self.held = getattr(self, "held", heading)
            return self.gain * (0.5 * (self.held - heading) - 4.0 * rate)
        self.held = heading
        if self.stable:
            return self.gain * helm - rate
        return self.gain * (helm - SLOPE * rate - CUBE * rate**3)

    def column(self, name):
        names = ("time", "north", "east", "heading", "helm", "ahead", "phase", "speed")
        return np.array([row[names.index(name)] for row in self.rows])

    def helms(self):
        """Return the helms that were ordered, each once, after the approach."""
        helm, phase = self.column("helm"), self.column("phase")
        return [float(value) for value, _ in groupby(helm[phase > 0])]

    def turned(self):
        """Return the heading change since the order, rad."""
        heading = self.column("heading")[self.column("phase") > 0]
        return heading - heading[0]


def test_the_approach_is_steady_and_straight():
    trial = Trial(kind="turning-circle", turn=1.0)
    order = trial.component.get("order_time")
    speed = trial.column("speed")
    row = round(order / STEP)
    # 20 s in which the mean rises by 1 %: later than the 4.6 time constants to 99 %.
    assert 4.0 * SPEED_LAG < order < 90.0
    assert abs(speed[row] / speed[row - 100] - 1.0) < 0.01
    assert trial.column("helm")[row - 1] == 0.0
    assert trial.column("helm")[row] == 1.0


@pytest.mark.parametrize(("side", "sign"), [("starboard", 1.0), ("port", -1.0)])
def test_a_turning_circle_turns_to_its_side(side, sign):
    trial = Trial(kind="turning-circle", side=side, helm=math.radians(17.5))
    assert trial.helms() == [sign * 0.5]
    assert sign * trial.turned()[-1] == pytest.approx(math.radians(810.0), abs=0.02)


def test_a_zig_zag_has_the_executes_of_its_definition():
    angle = math.radians(20.0)
    trial = Trial(kind="zig-zag", helm=angle, heading_change=angle)
    share = 20.0 / 35.0
    assert trial.helms() == pytest.approx([share * (-1) ** n for n in range(EXECUTES)])
    rec = Record(*(trial.column(name) for name in ("time", "north", "east", "heading", "helm")))
    found = zig_zag(rec, angle)
    orders = trial.column("time")[np.flatnonzero(np.diff(trial.column("helm"))) + 1]
    for number in range(1, EXECUTES):
        reversal = orders[number] - orders[0]
        assert 0.0 <= reversal - found[f"reversal_{number}_time"] < 2.0 * STEP
        assert found[f"overshoot_{number}"] > 0.0


def test_noise_of_the_compass_does_not_end_the_approach_for_ever():
    trial = Trial(kind="initial-turning", noise=math.radians(0.5))
    assert trial.ended is not None


def test_a_pull_out_ends_with_helm_amidships_and_no_rate():
    trial = Trial(kind="pull-out", turn=3.0)
    assert trial.helms() == [1.0, 0.0]
    heading = trial.column("heading")
    assert abs(heading[-1] - heading[-11]) < math.radians(0.05)


def test_a_spiral_goes_from_side_to_side_and_back():
    trial = Trial(kind="spiral", steps=2.0, longest=2000.0)
    assert trial.helms() == [1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0]
    assert trial.ended is not None


@pytest.mark.slow
def test_a_slow_vessel_that_is_stable_has_no_loop():
    # Its rates are below 1.2 deg/s and decay within a minute: windows of 20 s see little of that.
    trial = Trial(kind="spiral", steps=1.0, longest=6000.0, gain=0.02, lag=40.0)
    assert trial.ended is not None
    rec = Record(*(trial.column(name) for name in ("time", "north", "east", "heading", "helm")))
    begun = int(np.flatnonzero(trial.column("phase"))[0])
    helm, rate = spiral(Record(**{n: v[begun:] for n, v in rec.columns().items()}), None)
    assert rate[1::2] == pytest.approx([0.0, 0.0], abs=0.01 * 0.02)
    assert loop(helm, rate).width == 0.0


@pytest.mark.slow
def test_noise_of_the_compass_is_no_branch_of_a_reverse_spiral():
    trial = Trial(kind="reverse-spiral", noise=math.radians(1.0), longest=3000.0)
    assert trial.ended is not None
    rec = Record(*(trial.column(name) for name in ("time", "north", "east", "heading", "helm")))
    begun = rec.time[np.flatnonzero(np.diff(trial.column("phase"))) + 1]
    helm, rate = (each[1:] for each in spiral(rec, None, begun.tolist()))
    assert helm == pytest.approx(rate / GAIN, abs=0.03)


@pytest.mark.slow
def test_a_reverse_spiral_finds_the_branch_that_is_not_stable():
    trial = Trial(kind="reverse-spiral", stable=False, longest=2000.0)
    assert trial.ended is not None
    rec = Record(*(trial.column(name) for name in ("time", "north", "east", "heading", "helm")))
    begun = rec.time[np.flatnonzero(np.diff(trial.column("phase"))) + 1]
    helm, rate = spiral(rec, None, begun.tolist())
    steps = slice(1, None)  # after the approach
    assert len(rate[steps]) == 10
    assert helm[steps] == pytest.approx(SLOPE * rate[steps] + CUBE * rate[steps] ** 3, abs=0.01)
    largest = rate[1]
    assert rate[steps] / largest == pytest.approx(np.arange(5, -5, -1) / 5.0, abs=0.02)
    found = stability(helm[steps], rate[steps])
    assert found.slope == pytest.approx(SLOPE, abs=0.1)
    # Helm at the extrema of SLOPE r + CUBE r^3, on both sides.
    width = -4.0 / 3.0 * SLOPE * math.sqrt(-SLOPE / (3.0 * CUBE))
    assert found.width == pytest.approx(width, rel=0.3)


def test_an_order_ends_though_nothing_becomes_steady():
    trial = Trial(kind="bollard-pull", window=2.0, noise=0.5)
    order = trial.component.get("order_time")
    assert trial.ended - order == pytest.approx(40.0, abs=0.3)


@pytest.mark.slow
def test_a_speed_trial_runs_there_and_back_with_each_power():
    trial = Trial(kind="speed-trial", longest=3000.0)
    assert trial.ended is not None
    phase, ahead, turned = trial.column("phase"), trial.column("ahead"), trial.turned()
    ends = np.flatnonzero(np.diff(phase[phase > 0], append=99) > 0)[::2]
    assert turned[ends] == pytest.approx(np.pi * np.arange(8), abs=0.05)
    assert ahead[phase > 0][ends].tolist() == np.repeat(POWERS, 2).tolist()
    speeds = trial.column("speed")[phase > 0][ends]
    assert speeds == pytest.approx(FULL_SPEED * np.repeat(POWERS, 2), rel=0.02)


@pytest.mark.parametrize("unfixed", [0, 3])
def test_a_craft_under_way_is_stopped_before_it_accelerates(unfixed):
    component = Manoeuvre("manoeuvre")
    component.set("kind", "acceleration")
    component.initialise()
    component.begin()
    ordered = []
    for k, speed in enumerate((*[0.0] * unfixed, 2.0, 0.5, 0.0, 0.1)):
        component.set("velocity_n", [speed, 0.0, 0.0])
        component.advance(k * STEP, STEP)
        ordered.append(component.get("speed_order"))
    assert ordered[unfixed:] == [-0.5, -0.5, 0.0, 0.0]


def test_under_water_the_approach_dives_and_the_helm_is_ordered_at_depth():
    component = Manoeuvre("manoeuvre")
    for name, value in {"approach_mode": "depth-hold", "depth_start": 5.0, "window": 1.0}.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    component.set("depth", 4.5)
    component.advance(0.0, STEP)
    component.advance(STEP, STEP)
    assert component.get("mode") == "depth-hold"
    assert component.get("manual")[3] == pytest.approx(0.5)
    for k in range(2, 30):
        component.advance(k * STEP, STEP)
    assert component.get("phase") == 1
    assert component.get("mode") == "manual-depth"
    assert component.get("manual") == [1.0, 0.0, 1.0, 0.0]


def test_a_vertical_zig_zag_orders_the_dive_and_no_helm():
    trial = Trial(kind="vertical-zig-zag", helm=math.radians(17.5))
    assert set(trial.column("helm")) == {0.0}
    assert trial.component.get("manual")[3] == 0.5
    assert trial.component.get("mode") == "manual"


def test_a_crash_stop_ends_at_rest_and_coasting_at_a_fifth_of_the_speed():
    crash, coasting = Trial(kind="crash-stop"), Trial(kind="stopping")
    assert crash.column("ahead")[-1] == -1.0
    assert crash.column("speed")[-1] == pytest.approx(0.0, abs=0.12)
    order = round(coasting.component.get("order_time") / STEP)
    share = coasting.column("speed")[-1] / coasting.column("speed")[order]
    assert share == pytest.approx(0.2, abs=0.01)


def test_an_acceleration_begins_at_rest_and_ends_at_full_speed():
    trial = Trial(kind="acceleration")
    order = round(trial.component.get("order_time") / STEP)
    assert not trial.column("speed")[: order + 1].any()
    assert trial.column("speed")[-1] == pytest.approx(FULL_SPEED, rel=0.02)


def test_a_williamson_turn_ends_beyond_the_reciprocal_heading():
    trial = Trial(kind="williamson", heading_change=math.radians(70.0))
    assert trial.helms() == [1.0, -1.0]
    assert trial.turned().max() > math.radians(70.0)
    assert trial.turned()[-1] == pytest.approx(-math.radians(190.0), abs=0.03)


def test_a_turn_on_the_spot_has_no_speed():
    trial = Trial(kind="turn-on-the-spot")
    assert not trial.column("speed").any()
    assert trial.turned()[-1] >= math.radians(809.0)


def test_a_depth_step_is_guided_to_its_depth():
    trial = Trial(kind="depth-step", depth_start=2.0, depth_change=5.0)
    assert trial.component.get("mode") == "guided"
    assert list(trial.component.get("target_position")) == [0.0, 0.0, 7.0]
    assert trial.ended is not None


@pytest.mark.parametrize("kind", [k for k in KINDS if "spiral" not in k and k != "speed-trial"])
def test_every_other_manoeuvre_comes_to_its_end(kind):
    assert Trial(kind=kind, turn=2.0, steps=1.0, depth_change=1.0).ended is not None


def test_a_manoeuvre_goes_on_from_a_saved_state():
    trial = Trial(kind="zig-zag", longest=70.0)
    again = Manoeuvre("again")
    again.set_state(trial.component.get_state())
    assert again.get("phase") == trial.component.get("phase") > 0
    for component in (trial.component, again):
        component.set("heading", 1.0)
        component.advance(70.0, STEP)
    assert again.get("helm_order") == trial.component.get("helm_order")
