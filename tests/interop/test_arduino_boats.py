"""Boats and ROVs of the public with an ESP32, unmodified, where SEATRIAL_ARDUINO_PROJECTS names the folder of their clones.

A clone lies there under the name of its repository: rc-boat-controller-esp32 (igoutta), vjcunderwaterbot (Kmyming);
their libraries in the folder SEATRIAL_ARDUINO_LIBRARIES: sbus (bolderflight), ESPAsyncWebServer (ESP32Async).
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.kits.arduino.bench import STEP, Bench

pytestmark = [pytest.mark.interop, pytest.mark.long]
FOLDER = Path(os.environ.get("SEATRIAL_ARDUINO_PROJECTS", ""))
LIBRARIES = os.environ.get("SEATRIAL_ARDUINO_LIBRARIES", "")

if not os.environ.get("SEATRIAL_ARDUINO_PROJECTS") or not LIBRARIES:
    pytest.skip("no folders of clones are named", allow_module_level=True)


def board(place: str, **values: object) -> Bench:
    """Return an ESP32 with a project's sketch; skip without it."""
    if not (FOLDER / place).exists():
        pytest.skip(f"there is no {FOLDER / place}")
    return Bench(FOLDER / place, mcu="esp32", libraries=LIBRARIES, **values)


def sbus(**channels: int) -> bytes:
    """Return a frame of SBUS: 0x0F, 16 channels of 11 bits from the lowest on, flags, 0x00."""
    values = [channels.get(f"c{each}", 1000) for each in range(1, 17)]
    bits = sum(value << 11 * each for each, value in enumerate(values))
    return b"\x0f" + bits.to_bytes(22, "little") + b"\x00\x00"


def test_a_boat_follows_the_frames_of_a_receiver():
    """Throttle (3) and steering (1) are mixed, half each; the switch (7) is for cruising."""
    uarts, wires = "0 115200; 2 100000", "12 servo 1; 14 servo 2"
    with board("rc-boat-controller-esp32", uarts=uarts, wires=wires) as bench:
        for channels, wanted in (
            ({}, 1500.0),
            ({"c3": 1800}, 1300.0),
            ({"c1": 1800}, 1300.0),
            ({"c3": 200}, 1700.0),
            ({"c7": 200}, 1900.0),
        ):
            for _ in range(50):
                bench.receive(2, sbus(**channels))
                bench.run(STEP)
            pulses = [pulse * 1e6 for pulse in bench.one.get("pulse")[:2]]
            assert pulses == pytest.approx([wanted, wanted], abs=0.5)


def test_a_vehicle_asks_the_hand_for_its_sticks():
    """Two boards, by HTTP: forward and turning are mixed; the sticks' middle is where they were at the start."""
    sticks = "34 voltage 1; 35 voltage 2; 32 voltage 3; 13 input 1"
    motors = "13 pwm 1; 12 pwm 2; 27 pwm 3; 26 pwm 4; 25 pwm 5; 33 pwm 6; 14 output 1"
    with (
        board("vjcunderwaterbot/Controller_Code_Full", wires=sticks, network="127.0.0.1") as hand,
        board("vjcunderwaterbot/Robot_Code_Full", wires=motors, network="127.77.0.9") as vehicle,
    ):

        def hold(depth: float, x: float, y: float, button: bool, seconds: float) -> list[float]:
            for number, value in enumerate((depth, x, y), 1):
                hand.one.set(f"voltage.v{number}", value)
            hand.one.set("level.i1", button)
            for _ in range(round(seconds / STEP)):
                hand.run(STEP)
                vehicle.run(STEP)
            return list(vehicle.one.get("duty")[:6])

        hold(3.3, 1.65, 1.65, False, 4.0)
        assert hold(3.3, 1.65, 1.65, False, 2.0) == pytest.approx([0.0] * 6, abs=0.005)
        assert hold(3.3, 3.3, 1.65, False, 2.0) == pytest.approx([1, 0, 0, 1, 0, 0], abs=0.005)
        assert hold(3.3, 0.0, 1.65, False, 2.0) == pytest.approx([0, 1, 1, 0, 0, 0], abs=0.005)
        dives = hold(1.65, 1.65, 3.3, False, 2.0)
        assert dives == pytest.approx([1, 0, 1, 0, 0.5, 0], abs=0.005)
        assert vehicle.one.get("output")[0]
        hold(3.3, 1.65, 1.65, True, 0.2)
        hold(3.3, 1.65, 1.65, False, 2.0)
        assert not vehicle.one.get("output")[0]  # the magnet holds
