"""The multirotor against trajectories of SciPy's DOP853, and against closed forms."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.environment.downwash import Downwash
from seatrial_kits.drone.multirotor import Multirotor

HERE = Path(__file__).parents[2] / "reference" / "drone"
CLOSED = json.loads((HERE / "closed-forms.json").read_text())
HOVER = CLOSED["hover speed [rad/s]"]
K_T, K_Q = CLOSED["k_T [N s2/rad2]"], CLOSED["k_Q [N m s2/rad2]"]
MASS, G, STEP = 10.0, 9.81, 0.002
WEIGHT = MASS * G
FAR = {"deck_position": [1e3, 0.0, 0.0]}
NO_DRAG = {"drag_area": [0.0, 0.0, 0.0], "rotor_drag": 0.0}
STOPPED = {"rotor_speed_start": [0.0] * 4}
PLACES, SPINS = ((1, 1), (-1, -1), (1, -1), (-1, 1)), (1, 1, -1, -1)


def drone(**values):
    component = Multirotor("drone")
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    return component


def mixed(thrust, moments):
    """Return speeds of the rotors for a thrust, N, and moments, N.m, by the hubs' arms."""
    L, M, N = moments
    squares = [
        thrust / 4 - L * 0.25 * y / 0.25 + M * 0.25 * x / 0.25 + N * s * K_T / K_Q / 4
        for (x, y), s in zip(PLACES, SPINS, strict=True)
    ]
    return [math.sqrt(square / K_T) for square in squares]


def table(name):
    return np.genfromtxt(HERE / f"{name}.csv", delimiter=",", skip_header=2)


def compared(name, component, each=lambda t: None, step=STEP):
    """Run along a reference; return the largest differences of position, m, and angles, rad."""
    apart, turned = 0.0, 0.0
    for row in table(name):
        while component.now < row[0] - 1e-9:
            each(component.now)
            component.advance(component.now, step)
        apart = max(apart, np.abs(np.array(component.get("position")) - row[1:4]).max())
        turned = max(turned, np.abs(np.array(component.get("attitude")) - row[7:10]).max())
        np.testing.assert_allclose(component.get("rotor_speed"), row[13:17], atol=1e-4)
    return apart, turned


def test_it_rises_after_a_step_of_all_rotors():
    speeds = [HOVER * math.sqrt(1.1)] * 4
    apart, turned = compared(
        "collective-step", drone(command=speeds, position_start=[0, 0, -10], **FAR, **NO_DRAG)
    )
    assert apart < 1e-4
    assert turned < 1e-4


def test_it_turns_by_the_torques_of_its_rotors():
    speeds = mixed(WEIGHT, (0.0, 0.0, 0.8))
    apart, turned = compared(
        "yaw-step", drone(command=speeds, position_start=[0, 0, -10], **FAR, **NO_DRAG)
    )
    assert apart < 1e-4
    assert turned < 1e-4


def test_it_falls_as_far_as_its_drag_lets_it():
    falling = drone(position_start=[0, 0, -10], **FAR, **STOPPED)
    apart, turned = compared("free-fall", falling)
    assert apart < 1e-4
    assert turned < 1e-4
    limit = CLOSED["terminal speed of free fall [m/s]"]
    assert falling.get("velocity")[2] == pytest.approx(limit * math.tanh(G * 4.0 / limit), rel=1e-9)


def test_it_tumbles_in_wind():
    flying = drone(
        position_start=[0, 0, -10],
        velocity_n_start=[1.0, 2.0, 0.0],
        attitude_start=[0.05, -0.1, 0.6],
        wind=[5.0, -3.0, 0.0],
        **FAR,
    )

    def each(t):
        sign = 1 if t < 0.4 - 1e-9 else -1 if t < 0.8 - 1e-9 else 0
        flying.set("command", mixed(1.05 * WEIGHT, (0.8 * sign, -0.4 * sign, 0.2 * sign)))

    apart, turned = compared("doublet-wind", flying, each)
    assert apart < 1e-4
    assert turned < 1e-4


def test_it_sinks_lands_and_stands_in_ground_effect():
    sinking = drone(
        position_start=[0.05, -0.03, -0.9],
        pad=[0, 0, 0],
        command=[0.99 * HOVER] * 4,
        rotor_speed_start=[0.99 * HOVER] * 4,
    )
    apart, turned = compared("ground-effect", sinking)
    assert apart < 1e-3
    assert turned < 2e-3


def test_it_drops_on_a_tilted_deck():
    tilted = [math.radians(6.0), 0.0, 0.0]
    falling = drone(
        position_start=[0, 0, -0.3],
        pad=[0, 0, 0],
        deck_attitude=tilted,
        deck_size=[40, 40],
        **STOPPED,
    )
    apart, turned = compared("drop-tilted", falling)
    assert apart < 1e-3
    assert turned < 2e-3


def test_it_slides_where_the_deck_is_steeper_than_its_friction():
    row = table("slide")[0]
    tilted = [math.radians(14.0), 0.0, 0.0]
    sliding = drone(
        position_start=list(row[1:4]),
        attitude_start=tilted,
        pad=[0, 0, 0],
        deck_attitude=tilted,
        deck_size=[40, 40],
        friction=0.18,
        **STOPPED,
    )
    speeds = {}

    def each(t):
        speeds[t] = np.linalg.norm(sliding.get("velocity_n"))

    apart, turned = compared("slide", sliding, each)
    assert apart < 1e-3
    assert turned < 2e-3
    # Regularised friction is whole from 0.15 s on.
    (first, slow), *_, (last, fast) = [(t, v) for t, v in speeds.items() if t > 0.15]
    down = G * (math.sin(tilted[0]) - 0.18 * math.cos(tilted[0]))
    assert (fast - slow) / (last - first) == pytest.approx(down, rel=0.005)


@pytest.mark.parametrize(
    ("degrees", "friction", "slides", "tips"),
    [
        pytest.param(25.0, 0.6, False, False, id="below the angle of friction"),
        pytest.param(36.0, 0.6, True, False, id="above the angle of friction"),
        pytest.param(34.0, 2.0, False, False, id="below the angle of the feet"),
        pytest.param(42.0, 2.0, False, True, id="above the angle of the feet"),
    ],
)
def test_it_slides_and_tips_where_statics_says(degrees, friction, slides, tips):
    # atan(0.6) = 31 deg; weight over the outer feet: atan(0.2 / 0.25) = 38.7 deg.
    a = math.radians(degrees)
    place = np.array([0.0, math.sin(a), -math.cos(a)]) * 0.25
    standing = drone(
        position_start=place.tolist(),
        attitude_start=[a, 0.0, 0.0],
        pad=[0, 0, 0],
        deck_attitude=[a, 0.0, 0.0],
        deck_size=[40, 40],
        friction=friction,
        **STOPPED,
    )
    for _ in range(500):
        standing.advance(standing.now, STEP)
    assert (abs(standing.get("attitude")[0] - a) > math.radians(15.0)) == tips
    if not tips:
        assert (abs(standing.get("slip")[1]) > 0.05) == slides


def test_it_lands_on_a_deck_that_heaves_and_rolls():
    speeds = [0.97 * HOVER] * 4
    landing = drone(
        position_start=[0.1, 0.05, -1.1],
        pad=[0.1, 0.05, -0.2],
        deck_size=[40, 40],
        command=speeds,
        rotor_speed_start=speeds,
    )

    def each(t):
        # The middle of the step: the deck is held over it.
        at = t + STEP / 2
        roll, rate = 0.1 * math.sin(2 * at + 0.7), 0.2 * math.cos(2 * at + 0.7)
        down = -0.3 * math.cos(2 * at)
        landing.set("deck_position", [0.0, 0.0, -0.15 * math.sin(2 * at)])
        landing.set("deck_velocity", [0.0, down * math.sin(roll), down * math.cos(roll)])
        landing.set("deck_attitude", [roll, 0.0, 0.0])
        landing.set("deck_rates", [rate, 0.0, 0.0])
        if t > 1.6 - 1e-9:
            landing.set("command", [0.0] * 4)

    apart, turned = compared("landing-heaving-deck", landing, each)
    assert apart < 1e-3
    assert turned < 2e-3


def test_closed_forms_of_hover():
    hovering = drone(position_start=[0, 0, -10], command=[HOVER] * 4, **FAR)
    assert hovering.get("thrust") == pytest.approx(WEIGHT, rel=1e-9)
    assert hovering.get("acceleration") == pytest.approx([0, 0, 0], abs=1e-8)
    shaft = CLOSED["hover shaft power of four [W]"]
    assert hovering.get("power") == pytest.approx(shaft / 0.8, rel=1e-9)
    assert sum(hovering.get("torque")) == pytest.approx(0.0, abs=1e-12)
    turning = CLOSED["hover torque of a rotor [N m]"]
    assert hovering.get("torque") == pytest.approx([turning, turning, -turning, -turning])


@pytest.mark.parametrize("height", ["0.1", "0.15", "0.3", "0.6", "2.0"])
def test_ground_effect_over_the_deck(height):
    gains = CLOSED["ground effect, hub height [m] -> T/T_out (Cheeseman and Bennett)"]
    # Hubs are 0.05 m above the CG.
    near = drone(
        position_start=[0, 0, -0.2 - float(height) + 0.05],
        command=[HOVER] * 4,
        feet=[0.2, 0.2, 0.0],
        deck_size=[4, 4],
    )
    assert near.get("thrust") / WEIGHT == pytest.approx(gains[height], rel=1e-12)


def test_a_rotor_beyond_the_edge_has_no_ground_effect():
    half = 1.276 / 2
    edge = drone(position_start=[half, 0.0, -0.45], command=[HOVER] * 4)
    gain = CLOSED["ground effect, hub height [m] -> T/T_out (Cheeseman and Bennett)"]["0.3"]
    assert edge.get("thrust") == pytest.approx(WEIGHT * (1 + gain) / 2, rel=1e-9)
    slopes = edge.derivatives(edge._start_state())
    pitch = slopes[edge.compiled().x_names.index("rates.q")]
    assert pitch == pytest.approx(-0.25 * (gain - 1) * WEIGHT / 2 / 0.25, rel=1e-9)


def test_no_ground_effect_through_or_under_the_deck():
    for below in (
        {"position_start": [0, 0, 0.1]},
        {"position_start": [0, 0, -0.5], "deck_attitude": [3.0, 0, 0]},
    ):
        assert drone(command=[HOVER] * 4, **below).get("thrust") == pytest.approx(WEIGHT, rel=1e-9)


@pytest.mark.parametrize("height", ["0", "0.5", "1", "2"])
def test_wake_on_the_deck(height):
    loads = CLOSED["wake on the deck at hover, height of feet [m] -> N"]
    # Without ground effect: hubs high above.
    over = drone(
        position_start=[0, 0, -0.45 - float(height)], command=[HOVER] * 4, hub=[0.25, 0.25, -1e4]
    )
    assert over.get("load") == pytest.approx(loads[height], rel=1e-6)
    assert over.get("force") == pytest.approx([0, 0, loads[height]], rel=1e-6)


@pytest.mark.parametrize(
    ("height", "share"), [(0.2, 0.014), (0.3, 0.006), (0.45, 0.006), (0.6, 0.006)]
)
def test_its_ground_effect_is_near_that_of_the_published_load(height, share):
    near = drone(
        position_start=[0, 0, -0.2 - height + 0.05],
        command=[HOVER] * 4,
        feet=[0.2, 0.2, 0.0],
        deck_size=[4, 4],
    )
    gain = near.get("thrust") / WEIGHT
    assert gain == pytest.approx(Downwash("wake").ground_effect(height), rel=share)


@pytest.mark.parametrize("wind", ["3", "8", "15"])
def test_it_leans_into_the_wind(wind):
    theta, speed = CLOSED[
        "hover in steady wind: wind from ahead [m/s] -> [theta, deg (bow down negative); "
        "rotor speed, rad/s]"
    ][wind]
    held = drone(
        position_start=[0, 0, -10],
        attitude_start=[0, math.radians(theta), 0],
        rotor_speed_start=[speed] * 4,
        command=[speed] * 4,
        wind=[-float(wind), 0, 0],
        **FAR,
    )
    assert held.get("acceleration") == pytest.approx([0, 0, 0], abs=1e-6)


def test_a_climbing_rotor_loses_what_its_inflow_says():
    values = {"position_start": [0, 0, -10], "command": [HOVER] * 4, **FAR}
    climbing = drone(velocity_n_start=[0, 0, -2.0], inflow=1e-3, **values)
    assert climbing.get("thrust") == pytest.approx(WEIGHT - 4 * 1e-3 * HOVER * 2.0, rel=1e-9)


def test_a_further_force_acts_along_its_body_axes():
    pushed = drone(
        position_start=[0, 0, -10],
        attitude_start=[0.0, 0.0, math.pi / 2],
        command=[HOVER] * 4,
        push=[3.0, -2.0, 1.0],
        **FAR,
    )
    assert pushed.get("acceleration") == pytest.approx([0.3, -0.2, 0.1], abs=1e-8)
    pushed.advance(0.0, STEP)
    # Bow to the east; drag takes less than a thousandth of it.
    assert pushed.get("velocity_n") == pytest.approx([0.2 * STEP, 0.3 * STEP, 0.1 * STEP], rel=1e-3)


def test_rotors_follow_their_supply_and_commands_within_limits():
    full = CLOSED["largest speed [rad/s]"]
    for voltage, command, wanted in ((22.2, 9e3, full), (11.1, 9e3, full / 2), (25.0, -5.0, 0.0)):
        spun = drone(
            position_start=[0, 0, -10], supply_voltage=voltage, command=[command] * 4, **FAR
        )
        for _ in range(500):
            spun.advance(spun.now, STEP)
        assert spun.get("rotor_speed") == pytest.approx([wanted] * 4, abs=1e-4)


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_a_command_that_is_no_number_is_refused_by_its_name(wrong):
    with pytest.raises(InputError, match="command"):
        drone(position_start=[0, 0, -10], command=[HOVER, wrong, HOVER, HOVER], **FAR)


@pytest.mark.parametrize(("name", "wrong"), [("mass", 0.0), ("inertia", [0.25, 0.0, 0.4])])
def test_a_body_without_mass_is_refused(name, wrong):
    with pytest.raises(InputError, match=name):
        drone(**{name: wrong})


def test_it_turns_over_without_a_singular_attitude():
    tumbling = drone(position_start=[0, 0, -100], rates_start=[0.0, 3.0, 0.0], **FAR, **STOPPED)
    for _ in range(1000):
        tumbling.advance(tumbling.now, STEP)
    # It turns about its own y alone: the angle is that of a rotation at a constant rate.
    assert tumbling.get("attitude")[1] == pytest.approx(math.asin(math.sin(6.0)), abs=1e-6)
    assert math.hypot(*tumbling.get("turn")) == pytest.approx(1.0, abs=1e-9)
