"""NMEA 0183: ports of the component, and the sentences that it sends."""

from __future__ import annotations

import datetime
import math
from functools import partial

from parts import part
from parts.can import ports
from parts.markdown import table
from seatrial_kits.nmea.leg import leg_status
from seatrial_kits.nmea.nmea0183.codec import encode
from seatrial_kits.nmea.nmea0183.component import Nmea0183
from seatrial_kits.nmea.nmea0183.readings import Readings
from seatrial_kits.nmea.nmea0183.sentences import SENTENCES
from seatrial_kits.nmea.satellites import sky

_TIME = datetime.datetime(2018, 9, 1, 12, 0, 0, tzinfo=datetime.UTC)
_KNOWN = Readings(
    time=_TIME,
    variation=math.radians(-23.0),
    transducer_offset=0.4,
    position=(-22.862, -43.223, 0.5),
    velocity=(1.0, 0.5),
    heading=math.radians(30.0),
    rate_of_turn=math.radians(2.0),
    roll_pitch=(math.radians(-12.0), math.radians(1.5)),
    apparent_wind=(6.0, math.radians(45.0)),
    true_wind=(5.0, math.radians(60.0)),
    water_speed=1.1,
    depth=12.3,
    water_temperature=295.15,
    rudder=math.radians(5.0),
    sky=sky(_TIME.timestamp(), -22.862, -43.223),
    leg=leg_status(3, (0.0, 0.0), (926.0, 0.0), 20.0, (0.0, 92.6), (1.0, 0.5)),
    waypoints=((-22.862, -43.224), (-22.854, -43.224)),
    water_distance=1389.0,
    engine_speeds=(120.0,),
)
_TALKERS = {"HDT": "HE", "HDG": "HC", "ROT": "TI", "MWV-R": "WI", "MWV-T": "WI", "XDR": "II"} | {
    "VHW": "VW",
    "DBT": "SD",
    "DPT": "SD",
    "MTW": "YX",
    "RSA": "AG",
    "XTE": "AG",
    "RMB": "AG",
    "APB": "AG",
    "BWC": "AG",
    "BOD": "AG",
    "HDM": "HC",
    "MWD": "WI",
    "GNS": "GN",
    "VLW": "VW",
    "RPM": "ER",
    "VDR": "II",
}

part("nmea0183-ports")(partial(ports, Nmea0183))


@part("nmea0183-sentences")
def sentences() -> str:
    """Each sentence with readings, and without."""
    rows = []
    for name, fields in SENTENCES.items():
        talker = _TALKERS.get(name, "GP")
        shown = (
            encode(talker, name[:3], made[0]).decode("ascii").strip() if made else "not sent"
            for made in (fields(_KNOWN), fields(Readings(_TIME)))
        )
        rows.append((f"`{talker}{name}`", *(f"`{text}`" for text in shown)))
    return table(("sentence", "valid", "not valid"), rows)
