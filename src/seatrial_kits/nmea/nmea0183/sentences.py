"""Sentences made of the readings; fields by pynmeagps's names.

Source: E. S. Raymond, "NMEA Revealed" (gpsd project), which has the fields, units and status
marks of NMEA 0183 up to 4.x from many public sources; the standard itself is not public.

A reading that is not valid leaves its fields empty, and has status V where there is one (A if it
is valid), mode N instead of A, or fix quality 0 instead of 1. Angles have two decimals, knots
two, variation one; lat and lon are in 1e-5 minutes (2 cm). No sentence is longer than 82
characters.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from .codec import (
    CELSIUS,
    FATHOM,
    FOOT,
    KNOT,
    MILE,
    Fields,
    bearing,
    mode,
    number,
    place,
    status,
    time,
    variation,
)
from .readings import Pair, Readings
from .sentences_route import ROUTE, ROUTE_LEG

_CHANNELS = 12
"""Most satellites of GSA and GGA."""


def _rmc(of: Readings) -> Fields:
    return {
        "time": time(of),
        "status": status(of.position),
        **place(of),
        "spd": number(of.speed, 2, KNOT),
        "cog": bearing(of.course),
        "date": of.time.date(),
        **variation(of, "mv", "mvEW"),
        "posMode": mode(of.position),
        "navStatus": None,  # of version 4.1; to some readers V, "none given", is no fix
    }


def _gga(of: Readings) -> Fields:
    altitude = None if of.position is None else of.position[2]
    return {
        "time": time(of),
        **place(of),
        "quality": "0" if of.position is None else "1",
        "numSV": "00" if of.sky is None else f"{min(len(of.sky.satellites), _CHANNELS):02}",
        "HDOP": "" if of.sky is None else f"{of.sky.hdop:.1f}",
        "alt": number(altitude, 2),
        "altUnit": "M",
        "sep": "",
        "sepUnit": "M",
        "diffAge": "",
        "diffStation": "",
    }


def _gll(of: Readings) -> Fields:
    return {
        **place(of),
        "time": time(of),
        "status": status(of.position),
        "posMode": mode(of.position),
    }


def _zda(of: Readings) -> Fields:
    return {
        "time": time(of),
        "day": f"{of.time.day:02}",
        "month": f"{of.time.month:02}",
        "year": f"{of.time.year:04}",
        "ltzh": "00",  # the zone of local time: UTC
        "ltzn": "00",
    }


def _vtg(of: Readings) -> Fields:
    return {
        "cogt": bearing(of.course),
        "cogtUnit": "T",
        "cogm": bearing(of.magnetic(of.course)),
        "cogmUnit": "M",
        "sogn": number(of.speed, 2, KNOT),
        "sognUnit": "N",
        "sogk": number(of.speed, 2, 1.0 / 3.6),
        "sogkUnit": "K",
        "posMode": mode(of.velocity),
    }


def _hdt(of: Readings) -> Fields:
    return {"headingT": bearing(of.heading), "headingTu": "T"}


def _hdg(of: Readings) -> Fields:
    return {
        "headingM": bearing(of.magnetic(of.heading)),
        "deviation": "",
        "deviationEW": "",
        **variation(of, "variation", "variationEW"),
    }


def _rot(of: Readings) -> Fields:
    per_minute = math.radians(1.0) / 60.0
    return {"rot": number(of.rate_of_turn, 1, per_minute), "valid": status(of.rate_of_turn)}


def _apparent_wind(of: Readings) -> Fields:
    return _mwv(of.apparent_wind, "R")


def _true_wind(of: Readings) -> Fields:
    return _mwv(of.true_wind, "T")


def _mwv(wind: Pair | None, reference: str) -> Fields:
    speed, angle = (None, None) if wind is None else wind
    return {
        "angle": bearing(angle),
        "reference": reference,
        "speed": number(speed, 2, KNOT),
        "speedu": "N",
        "status": status(wind),
    }


def _xdr(of: Readings) -> Fields:
    """Return pitch and roll as two transducers of angle, with the names that plotters know."""
    roll, pitch = (None, None) if of.roll_pitch is None else of.roll_pitch
    fields: Fields = {}
    for count, (name, angle) in enumerate((("PTCH", pitch), ("ROLL", roll)), start=1):
        fields |= {
            f"tdrtype_{count:02}": "A",
            f"data_{count:02}": number(angle, 2, math.radians(1.0)),
            f"dataunit_{count:02}": "D",
            f"tdrid_{count:02}": name,
        }
    return fields


def _vhw(of: Readings) -> Fields:
    return {
        "hdgT": bearing(of.heading),
        "hgdTu": "T",
        "hdgM": bearing(of.magnetic(of.heading)),
        "hgdMu": "M",
        "spdN": number(of.water_speed, 2, KNOT),
        "spdNu": "N",
        "spdK": number(of.water_speed, 2, 1.0 / 3.6),
        "spdKu": "K",
    }


def _dbt(of: Readings) -> Fields:
    return {
        "depthf": number(of.depth, 2, FOOT),
        "depthfu": "f",
        "depthm": number(of.depth, 2),
        "depthmu": "M",
        "depthfath": number(of.depth, 2, FATHOM),
        "depthfathu": "F",
    }


def _dpt(of: Readings) -> Fields:
    return {
        "depth": number(of.depth, 2),
        "offset": number(of.transducer_offset, 2),
        "rangescale": "",
    }


def _mtw(of: Readings) -> Fields:
    kelvin = of.water_temperature
    return {"temp": number(None if kelvin is None else kelvin - CELSIUS, 2), "tempu": "C"}


def _rsa(of: Readings) -> Fields:
    return {
        "stbdangle": number(of.rudder, 2, math.radians(1.0)),
        "stbdstatus": status(of.rudder),
        "portangle": "",
        "portstatus": "V",  # there is one rudder, which is the starboard one
    }


def _hdm(of: Readings) -> Fields:
    return {"headingM": bearing(of.magnetic(of.heading)), "headingMag": "M"}


def _mwd(of: Readings) -> Fields:
    """Return the wind over ground, by where it comes from, clockwise from north."""
    speed, angle = (None, None) if of.true_wind is None else of.true_wind
    direction = None if angle is None or of.heading is None else angle + of.heading
    return {
        "dirT": bearing(direction),
        "dirTu": "T",
        "dirM": bearing(of.magnetic(direction)),
        "dirMu": "M",
        "speedN": number(speed, 2, KNOT),
        "speedNu": "N",
        "speedM": number(speed, 2),
        "speedMu": "M",
    }


def _gns(of: Readings) -> Fields:
    altitude = None if of.position is None else of.position[2]
    return {
        "time": time(of),
        **place(of),
        "posMode": mode(of.position),
        "numSV": "00" if of.sky is None else f"{len(of.sky.satellites):02}",
        "HDOP": "" if of.sky is None else f"{of.sky.hdop:.1f}",
        "alt": number(altitude, 2),
        "sep": "",
        "diffAge": "",
        "diffStation": "",
        "navStatus": None,  # of version 4.1
    }


def _vlw(of: Readings) -> Fields:
    """Return the distance through the water: total and trip are both that of the run."""
    run = number(of.water_distance, 3, MILE)
    return {
        "twd": run,
        "twdUnit": "N",
        "wd": run,
        "wdUnit": "N",
        **dict.fromkeys(("tgd", "tgdUnit", "gd", "gdUnit")),  # of version 3.0, over ground
    }


def _vdr(of: Readings) -> list[Fields]:
    """Return set and drift, over ground less through the water along the bow; none without them."""
    if of.current is None:
        return []
    direction, speed = of.current
    fields = {
        "dirT": bearing(direction),
        "dirTu": "T",
        "dirM": bearing(of.magnetic(direction)),
        "dirMu": "M",
        "spd": number(speed, 2, KNOT),
        "spdu": "N",
    }
    return [fields]


def _rpm(of: Readings) -> list[Fields]:
    """Return a sentence for each engine; none without one."""
    return [
        {
            "source": "E",
            "engineshaftnum": str(count),
            "rpm": number(speed, 1, math.tau / 60.0),
            "pitch": "",
            "status": "A",
        }
        for count, speed in enumerate(of.engine_speeds, start=1)
        if speed is not None
    ]


def _gsa(of: Readings) -> Fields:
    used = [] if of.sky is None else of.sky.satellites[:_CHANNELS]
    numbers = [f"{each.prn:02}" for each in used] + [""] * (_CHANNELS - len(used))
    sky = of.sky
    return {
        "opMode": "A",
        "navMode": "1" if sky is None else "3",
        **{f"svid_{k:02}": number for k, number in enumerate(numbers, start=1)},
        "PDOP": "" if sky is None else f"{sky.pdop:.1f}",
        "HDOP": "" if sky is None else f"{sky.hdop:.1f}",
        "VDOP": "" if sky is None else f"{sky.vdop:.1f}",
        "systemId": None,  # of version 4.1
    }


def _gsv(of: Readings) -> list[Fields]:
    """Return as many sentences as it takes, four satellites each."""
    found = () if of.sky is None else of.sky.satellites
    groups = [found[k : k + 4] for k in range(0, len(found), 4)] or [()]
    return [
        {
            "numMsg": str(len(groups)),
            "msgNum": str(count),
            "numSV": f"{len(found):02}",
            **{
                f"{name}_{k:02}": text
                for k, each in enumerate(group, start=1)
                for name, text in (
                    ("svid", f"{each.prn:02}"),
                    ("elv", f"{round(math.degrees(each.elevation)):02}"),
                    ("az", f"{round(math.degrees(each.azimuth)) % 360:03}"),
                    ("cno", f"{round(each.signal):02}"),
                )
            },
            "signalID": None,  # of version 4.1
        }
        for count, group in enumerate(groups, start=1)
    ]


def _alone(made: Callable[[Readings], Fields]) -> Callable[[Readings], list[Fields]]:
    return lambda of: [made(of)]


_ALONE: dict[str, Callable[[Readings], Fields]] = {
    "RMC": _rmc,
    "GGA": _gga,
    "GLL": _gll,
    "ZDA": _zda,
    "VTG": _vtg,
    "HDT": _hdt,
    "HDG": _hdg,
    "ROT": _rot,
    "MWV-R": _apparent_wind,
    "MWV-T": _true_wind,
    "XDR": _xdr,
    "VHW": _vhw,
    "DBT": _dbt,
    "DPT": _dpt,
    "MTW": _mtw,
    "RSA": _rsa,
    "GSA": _gsa,
    "GNS": _gns,
    "HDM": _hdm,
    "MWD": _mwd,
    "VLW": _vlw,
    **ROUTE,
}

SENTENCES: dict[str, Callable[[Readings], list[Fields]]] = {
    **{name: _alone(made) for name, made in _ALONE.items()},
    "GSV": _gsv,
    "RPM": _rpm,
    "VDR": _vdr,
    **ROUTE_LEG,
}
"""What can be sent, by formatter, and how; of wind the apparent one, R, and the true one, T."""
