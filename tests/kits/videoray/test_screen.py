"""What a pilot sees, by the place of each mark; every key with its sign."""

import math
from types import SimpleNamespace

import pytest
from rich.console import Console

from seatrial_kits.videoray.driving.pilot import KEY_LASTS, TURNS, Pilot
from seatrial_kits.videoray.driving.screen import bar, horizon, picture, tape

DEG = math.pi / 180


@pytest.mark.parametrize("heading", [10, 137, 270, 352])
def test_marks_of_the_card_lie_half_a_character_a_degree_from_the_heading(heading):
    card, pointer, value = tape(heading * DEG, Pilot()).plain.split("\n")
    assert len(card) == len(pointer) == 61
    assert pointer == " " * 30 + "^" + " " * 30
    assert value.strip() == f"{heading:05.1f}°"
    for label, degrees in (("N", 0), ("E", 90), ("SW", 225), ("120", 120), ("330", 330), ("·", 15)):
        off = math.remainder(degrees - heading, 360.0)
        place = 30 + round(off / 2) - len(label) // 2
        if abs(off) < 55:
            assert card[place : place + len(label)] == label


@pytest.mark.parametrize(
    ("wanted", "place"),
    [(137, 30), (167, 45), (97, 10), (196, 60), (78, 0), (200, None), (317, None)],
)
def test_a_heading_that_is_held_is_marked_on_its_side(wanted, place):
    pilot = Pilot(hold_heading=True, heading_wanted=wanted * DEG)
    pointer = tape(137 * DEG, pilot).plain.split("\n")[1]
    mark = "◎" if place == 30 else "o"
    assert pointer.find(mark) == (-1 if place is None else place)


@pytest.mark.parametrize(
    ("phi", "theta"), [(0.0, 0.0), (0.3, 0.0), (-0.5, 0.2), (0.2, -0.3), (2.9, 0.1)]
)
def test_the_horizon_stands_as_from_inside(phi, theta):
    rows = horizon(phi, theta).plain.split("\n")
    assert [len(row) for row in rows] == [31] * 11
    for row, line in enumerate(rows):
        for column, shown in enumerate(line):
            if row == 5 and 12 <= column < 17:
                continue  # the vehicle
            # Right and up, in rows; a row is 5 degrees.
            right, up = (column - 15) / 2.0, 5 - row
            # Seen from the vehicle the vertical is turned by -phi, and its pitch shifts it down.
            sky = up * math.cos(phi) - right * math.sin(phi) + theta / DEG / 5.0
            if abs(abs(sky) - 0.5) > 1e-9:
                assert shown == ("─" if abs(sky) < 0.5 else " " if sky > 0 else "░")
    assert rows[5][12:17] == "──┼──"


@pytest.mark.parametrize(
    ("share", "left", "right"), [(0.0, 0, 0), (0.34, 0, 3), (-0.7, 7, 0), (1.0, 0, 10)]
)
def test_a_deflection_is_a_bar_to_its_side(share, left, right):
    shown = "·" * (10 - left) + "█" * left + "│" + "█" * right + "·" * (10 - right)
    assert bar(share) == f"{shown} {share:+.0%}"


def test_the_picture_has_all_values_in_80_columns():
    values = {
        "attitude": (0.1, -0.2, 1.0), "connected": True, "serial_number": "J1", "depth": 3.456,
        "water_temperature": 280.65, "humidity": 0.42, "power": 0.8, "round_trip": 0.0123,
        "missed": 4, "phase": "waiting",
    }  # fmt: skip
    pilot = Pilot(share=0.4, lights=0.6, camera_tilt=-0.3, armed=True)
    pilot.hold_depth, pilot.depth_wanted = True, 2.5
    pilot.hold_heading, pilot.heading_wanted = True, 1.2

    def shown():
        console = Console(width=80, height=24, legacy_windows=False)
        with console.capture() as capture:
            console.print(picture(SimpleNamespace(get=values.get), pilot, (0.5, -0.2, 0.1)))
        return capture.get()

    text = shown()
    for part in (
        "vehicle J1", "ARMED", "3.46 m   hold 2.50 m", "hold 69°", "+5.7°  -11.5°", "7.5 °C",
        "inside 42%", "+50%", "-20%", "+10%", "40%   power 80%", "60%   tilt -17°", "12.3 ms",
        "missed 4",
    ):  # fmt: skip
        assert part in text, part
    lines = text.rstrip("\n").split("\n")
    assert len(lines) <= 24
    assert max(map(len, lines)) <= 80
    values["connected"], pilot.armed = False, False
    text = shown()
    assert "no vehicle (waiting)" in text
    assert "disarmed" in text


@pytest.mark.parametrize(
    ("keys", "manual"),
    [
        (("w",), (1, 0, 0)), (("s",), (-1, 0, 0)), (("up",), (1, 0, 0)), (("down",), (-1, 0, 0)),
        (("d",), (0, 1, 0)), (("a",), (0, -1, 0)), (("right",), (0, 1, 0)),
        (("left",), (0, -1, 0)), (("f",), (0, 0, 1)), (("r",), (0, 0, -1)),
        (("page down",), (0, 0, 1)), (("page up",), (0, 0, -1)), (("w", "a", "f"), (1, -1, 1)),
    ],
)  # fmt: skip
def test_every_key_pushes_along_its_axis(keys, manual):
    pilot = Pilot(share=0.4)
    for key in keys:
        pilot.press(key, 2.0)
    expected = (0.4 * manual[0], 0.4 * TURNS * manual[1], 0.4 * manual[2])
    assert pilot.manual(2.0 + 0.5 * KEY_LASTS) == pytest.approx(expected)


def test_orders_change_by_their_steps_and_stay_within_their_ends():
    pilot = Pilot(depth=1.0, heading=0.5, lights=0.5)
    for key in ("z", "h", ".", ".", ",", "]", "]", "[", "l", "t", "t", "g", "+", "o"):
        pilot.press(key, 0.0)
    assert pilot.depth_wanted == pytest.approx(1.1)
    assert pilot.heading_wanted == pytest.approx(0.5 + 5 * DEG)
    assert pilot.lights == pytest.approx(0.6)
    assert pilot.camera_tilt == pytest.approx(5 * DEG)
    assert (pilot.share, pilot.manipulator) == (0.4, 1)
    for key, times in ((",", 30), ("k", 20), ("g", 40), ("-", 20), ("c", 1)):
        for _ in range(times):
            pilot.press(key, 0.0)
    ends = pilot.depth_wanted, pilot.lights, pilot.camera_tilt, pilot.share, pilot.manipulator
    assert ends == pytest.approx((0.0, 0.0, -math.pi / 2, 0.1, -1))
    for key, times in (("l", 20), ("t", 80), ("+", 20), ("x", 1)):
        for _ in range(times):
            pilot.press(key, 0.0)
    ends = pilot.lights, pilot.camera_tilt, pilot.share, pilot.manipulator
    assert ends == pytest.approx((1.0, math.pi / 2, 1.0, 0))
