import math

import pytest

from seatrial.errors import InputError
from seatrial.physics.foils import sail_naca0015
from seatrial_kits.sailing.control.sail_control import SailControl
from tests.devices.running import started

DEG = math.radians(1.0)
BOAT = {
    "heeling_arm": 1.18,
    "righting_moment": 53.3664,
    "sail_area": 0.9,
    "sail_entry": "verbatim",
    "high_alpha": "table",
}
ALLOWED = 53.3664 * math.sin(15 * DEG) * math.cos(15 * DEG)


def control(heading, speed=5.0, **values):
    """Return the controller of a boat at rest in 5 m/s of wind that blows north."""
    angle = math.remainder(-heading * DEG, math.tau)
    inputs = {"heading": heading * DEG, "wind": [5.0, 0.0], "apparent_wind": [speed, angle]}
    return started(SailControl, **BOAT, **inputs, **values)


@pytest.mark.parametrize(
    ("heading", "side"), [(0, -1), (1, 1), (90, 1), (179, 1), (180, -1), (181, -1), (359, -1)]
)
def test_side_of_the_sail(heading, side):
    assert math.copysign(1.0, control(heading).get("sail")) == side


@pytest.mark.parametrize("heading", [20, 55, 90, 110, 150])
@pytest.mark.parametrize("limit", ["off", "on"])
def test_port_and_starboard_are_alike(heading, limit):
    one, other = (control(h, roll_limit=limit, heel=0.0) for h in (heading, -heading))
    assert one.get("sail") == -other.get("sail") > 0.0
    assert one.get("flap") == other.get("flap")
    assert one.get("heeling_moment") == pytest.approx(-other.get("heeling_moment"), rel=1e-12)


@pytest.mark.parametrize("heading", [101, 120, 150, 179])
def test_upwind_the_sail_stays_where_the_source_has_it(heading):
    assert control(heading).get("sail") == 40 * DEG
    assert control(heading).get("flap") == 0.0


def turned(headings, **values):
    """Return the side of the sail (1 port) at headings, one instant after the other."""
    trimmer, sides = control(headings[0], **values), []
    for k, heading in enumerate(headings):
        trimmer.set("heading", heading * DEG)
        sides.append(round(math.copysign(1.0, trimmer.get("sail"))))
        trimmer.advance(0.02 * k, 0.02)
    return sides


def test_hysteresis_keeps_the_side_near_dead_downwind():
    headings = [10, 3, -3, -4.9, -5.1, -4, 4, 5.1]
    assert turned(headings) == [1, 1, -1, -1, -1, -1, 1, 1]
    assert turned(headings, hysteresis=5 * DEG) == [1, 1, 1, 1, -1, -1, -1, 1]


@pytest.mark.parametrize("speed", [3.0, 5.0, 8.0])
@pytest.mark.parametrize("heading", [80, 90, 100, 120])
def test_predicted_heeling_moment_keeps_to_the_design_heel(heading, speed):
    trimmer = control(heading, speed, roll_limit="on")
    assert abs(trimmer.get("heeling_moment")) <= ALLOWED * (1 + 1e-12)
    free = control(heading, speed)
    if abs(free.get("heeling_moment")) <= ALLOWED:
        assert trimmer.get("sail") == free.get("sail")


def test_moment_is_that_of_the_side_force_at_the_arm():
    """Apparent wind athwart: the side force is the drag alone, 2.21."""
    trimmer = control(90)
    alpha = math.pi / 2 - trimmer.get("sail")
    _, drag = sail_naca0015().coefficients(alpha, trimmer.get("flap"))
    expected = -0.5 * 1.225 * 0.9 * 25.0 * 1.18 * drag
    assert trimmer.get("heeling_moment") == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("heel", "share"), [(-10, 1.0), (-15, 1.0), (-25, 0.5), (-33, 0.1), (20, 1.0)]
)
def test_heel_beyond_the_design_heel_takes_moment_away(heel, share):
    """On the starboard tack leeward is port: heel is negative."""
    trimmer = control(100, 8.0, roll_limit="on", heel=heel * DEG)
    assert -trimmer.get("heeling_moment") == pytest.approx(share * ALLOWED, rel=1e-6)


def test_at_the_spill_heel_the_sail_feathers():
    trimmer = control(100, 8.0, roll_limit="on", heel=-35 * DEG)
    alpha = math.remainder(-100 * DEG - trimmer.get("sail") + math.pi, math.tau)
    assert alpha == pytest.approx(0.0, abs=1e-12)


def test_roll_rate_is_foreseen():
    still = control(100, 8.0, roll_limit="on", heel=-25 * DEG)
    rolling = control(100, 8.0, roll_limit="on", heel=-20 * DEG, roll_rate=-10 * DEG, lead=0.5)
    assert rolling.get("sail") == pytest.approx(still.get("sail"), abs=1e-12)


def test_upwind_the_sail_is_eased_only_if_it_must():
    light, strong = (control(120, speed, roll_limit="on") for speed in (3.0, 9.0))
    assert light.get("sail") == 40 * DEG
    assert strong.get("sail") > 41 * DEG
    assert abs(strong.get("heeling_moment")) <= ALLOWED * (1 + 1e-12)


def test_without_wind_nothing_heels():
    trimmer = started(SailControl, **BOAT, roll_limit="on", heading=1.0)
    assert trimmer.get("heeling_moment") == 0.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"upwind_sail": 1.6}, r"upwind_sail \(1.6 rad\) must not exceed sail_limit"),
        ({"spill_heel": 0.2}, r"design_heel \(0.26.* rad\) must be less than spill_heel"),
    ],
)
def test_refuses_what_cannot_be(values, message):
    with pytest.raises(InputError, match=message):
        started(SailControl, **values)


# ---------------------------------------------------------------------- by hand


def sheeted(angle, sheet=0.0, wind=(0.0, 0.0), **changes):
    """Return the sail's angle, deg, in an apparent wind that blows to ``angle``, deg."""
    found = started(
        SailControl,
        trimming=False,
        sheet=sheet,
        apparent_wind=[5.0, math.radians(angle)],
        wind=list(wind),
        **changes,
    )
    assert found.get("flap") == 0.0
    return math.degrees(found.get("sail"))


@pytest.mark.parametrize(("angle", "sail"), [(180, 0), (-150, 30), (150, -30), (-100, 80)])
def test_an_eased_sail_streams_with_its_trailing_edge_downwind(angle, sail):
    # Wind from starboard, which blows to port: the boom lies to port.
    assert sheeted(angle, wind=[0.0, -5.0 if sail > 0 else 5.0]) == pytest.approx(sail)


def test_an_eased_sail_gives_no_lift():
    found = started(SailControl, trimming=False, apparent_wind=[5.0, math.radians(-120)])
    assert found.get("heeling_moment") == pytest.approx(0.0, abs=2.0)


@pytest.mark.parametrize(("sheet", "sail"), [(0.0, 80), (0.5, 45), (0.9, 9), (1.0, 0), (2.0, 0)])
def test_the_sheet_hauls_the_boom_in(sheet, sail):
    assert sheeted(-100, sheet, wind=[0.0, -5.0]) == pytest.approx(sail, abs=1e-9)


@pytest.mark.parametrize("heading", [10, -10])
def test_wind_from_astern_presses_the_boom_out_to_its_limit(heading):
    found = sheeted(-heading, wind=[5.0, 0.0], heading=math.radians(heading))
    assert abs(found) == pytest.approx(90.0)
