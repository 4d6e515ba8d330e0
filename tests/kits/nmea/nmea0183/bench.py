"""An NMEA 0183 component that a test feeds and steps, and pynmea2 as its reader."""

import math
import re
from collections.abc import Sequence

import pynmea2

from seatrial.links.text import decode, encode
from seatrial_kits.nmea.nmea0183.component import Nmea0183

DEG = math.pi / 180.0
KNOT = 1852.0 / 3600.0
LINE = re.compile(rb"\$[^\r\n*]*\*[0-9A-F]{2}\r\n")

VALID = {
    "position_n": [100.0, -50.0, -1.5],
    "velocity_n": [1.0, -0.5, 0.1],
    "heading": 350.0 * DEG,
    "rate_of_turn": 3.0 * DEG,
    "roll_pitch": [5.0 * DEG, -2.0 * DEG],
    "wind_speed": 6.0,
    "wind_angle": -135.0 * DEG,  # it comes from 45 degrees to starboard
    "true_wind": [-4.0, -3.0],
    "water_speed": 1.25,
    "depth": 12.34,
    "water_temperature": 295.65,
    "rudder": -7.5 * DEG,
    "engine_speed": [1e30, 100.0, 1e30, 1e30],
    "leg": 2,
    "leg_from": [0.0, -150.0, 0.0],
    "leg_to": [1000.0, -150.0, 0.0],
    "leg_radius": 50.0,
    **{
        f"{name}_valid": True
        for name in (
            "position",
            "heading",
            "imu",
            "wind",
            "true_wind",
            "water_speed",
            "depth",
            "water_temperature",
            "rudder",
        )
    },
}
"""All readings."""

ALL = "; ".join(
    f"{name} 1"
    for name in (
        "GPRMC",
        "GPGGA",
        "GPGLL",
        "GPZDA",
        "GPVTG",
        "HEHDT",
        "HCHDG",
        "TIROT",
        "WIMWV-R",
        "WIMWV-T",
        "IIXDR",
        "VWVHW",
        "SDDBT",
        "SDDPT",
        "YXMTW",
        "AGRSA",
        "GPGSA",
        "GPGSV",
        "AGXTE",
        "AGRMB",
        "AGAPB",
        "AGBWC",
        "AGBOD",
        "HCHDM",
        "WIMWD",
        "GNGNS",
        "VWVLW",
        "ERRPM",
        "IIVDR",
    )
)


class Bench:
    """One component at the start of its run, without links unless they are given."""

    def __init__(self, **values: object) -> None:
        self.one = Nmea0183("nmea")
        for name, value in {"links": "", "sentences": ALL, **values}.items():
            self.one.set(name, value)
        self.one.initialise()
        self.one.begin()
        self.now = 0
        self.number = 0
        self.sent: list[tuple[int, bytes]] = []
        self._seen = 0

    def __enter__(self) -> "Bench":
        return self

    def __exit__(self, *_: object) -> None:
        self.one.close()

    def set(self, **values: object) -> None:
        for name, value in values.items():
            self.one.set(name, value)

    def receive(self, *data: bytes) -> None:
        """Let bytes arrive by the port; they are read in the next step."""
        self.number += 1
        self.one.set("rx", encode(self.number, [(self.now, each) for each in data]))

    def run(self, seconds: float, step_ns: int = 50_000_000) -> list[bytes]:
        """Run on; return what was sent on the port meanwhile."""
        before = len(self.sent)
        for _ in range(round(seconds * 1e9) // step_ns):
            self.one.advance(self.now / 1e9, step_ns / 1e9)
            self.now += step_ns
            number, chunks = decode(self.one.get("tx"))
            if number != self._seen:
                self._seen = number
                self.sent += chunks
        return [data for _, data in self.sent[before:]]


def read(sentences: Sequence[bytes]) -> dict[str, pynmea2.NMEASentence]:
    """Return what pynmea2 makes of sentences, by talker and formatter; MWV with its reference."""
    found = {}
    for each in sentences:
        assert LINE.fullmatch(each), each
        assert len(each) <= 82
        sentence = pynmea2.parse(each.decode("ascii").strip(), check=True)
        name = sentence.talker + sentence.sentence_type
        if sentence.sentence_type == "MWV":
            name += f"-{sentence.reference}"
        found[name] = sentence
    return found
