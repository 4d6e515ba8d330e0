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
from typing import Any

from .readings import Pair, Readings

Fields = dict[str, Any]

KNOT = 1852.0 / 3600.0
"""m/s."""
FOOT = 0.3048
FATHOM = 6.0 * FOOT
CELSIUS = 273.15
MILE = 1852.0
_CHANNELS = 12
"""Most satellites of GSA and GGA."""
_MOST_RMB = 9.99
"""Largest cross-track error of RMB, miles."""


def _rmc(of: Readings) -> Fields:
    return {
        "time": _time(of),
        "status": _status(of.position),
        **_place(of),
        "spd": _number(of.speed, 2, KNOT),
        "cog": bearing(of.course),
        "date": of.time.date(),
        **_variation(of, "mv", "mvEW"),
        "posMode": _mode(of.position),
        "navStatus": None,  # of version 4.1; to some readers V, "none given", is no fix
    }


def _gga(of: Readings) -> Fields:
    altitude = None if of.position is None else of.position[2]
    return {
        "time": _time(of),
        **_place(of),
        "quality": "0" if of.position is None else "1",
        "numSV": "00" if of.sky is None else f"{min(len(of.sky.satellites), _CHANNELS):02}",
        "HDOP": "" if of.sky is None else f"{of.sky.hdop:.1f}",
        "alt": _number(altitude, 2),
        "altUnit": "M",
        "sep": "",
        "sepUnit": "M",
        "diffAge": "",
        "diffStation": "",
    }


def _gll(of: Readings) -> Fields:
    return {
        **_place(of),
        "time": _time(of),
        "status": _status(of.position),
        "posMode": _mode(of.position),
    }


def _zda(of: Readings) -> Fields:
    return {
        "time": _time(of),
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
        "sogn": _number(of.speed, 2, KNOT),
        "sognUnit": "N",
        "sogk": _number(of.speed, 2, 1.0 / 3.6),
        "sogkUnit": "K",
        "posMode": _mode(of.velocity),
    }


def _hdt(of: Readings) -> Fields:
    return {"headingT": bearing(of.heading), "headingTu": "T"}


def _hdg(of: Readings) -> Fields:
    return {
        "headingM": bearing(of.magnetic(of.heading)),
        "deviation": "",
        "deviationEW": "",
        **_variation(of, "variation", "variationEW"),
    }


def _rot(of: Readings) -> Fields:
    per_minute = math.radians(1.0) / 60.0
    return {"rot": _number(of.rate_of_turn, 1, per_minute), "valid": _status(of.rate_of_turn)}


def _apparent_wind(of: Readings) -> Fields:
    return _mwv(of.apparent_wind, "R")


def _true_wind(of: Readings) -> Fields:
    return _mwv(of.true_wind, "T")


def _mwv(wind: Pair | None, reference: str) -> Fields:
    speed, angle = (None, None) if wind is None else wind
    return {
        "angle": bearing(angle),
        "reference": reference,
        "speed": _number(speed, 2, KNOT),
        "speedu": "N",
        "status": _status(wind),
    }


def _xdr(of: Readings) -> Fields:
    """Return pitch and roll as two transducers of angle, with the names that plotters know."""
    roll, pitch = (None, None) if of.roll_pitch is None else of.roll_pitch
    fields: Fields = {}
    for number, (name, angle) in enumerate((("PTCH", pitch), ("ROLL", roll)), start=1):
        fields |= {
            f"tdrtype_{number:02}": "A",
            f"data_{number:02}": _number(angle, 2, math.radians(1.0)),
            f"dataunit_{number:02}": "D",
            f"tdrid_{number:02}": name,
        }
    return fields


def _vhw(of: Readings) -> Fields:
    return {
        "hdgT": bearing(of.heading),
        "hgdTu": "T",
        "hdgM": bearing(of.magnetic(of.heading)),
        "hgdMu": "M",
        "spdN": _number(of.water_speed, 2, KNOT),
        "spdNu": "N",
        "spdK": _number(of.water_speed, 2, 1.0 / 3.6),
        "spdKu": "K",
    }


def _dbt(of: Readings) -> Fields:
    return {
        "depthf": _number(of.depth, 2, FOOT),
        "depthfu": "f",
        "depthm": _number(of.depth, 2),
        "depthmu": "M",
        "depthfath": _number(of.depth, 2, FATHOM),
        "depthfathu": "F",
    }


def _dpt(of: Readings) -> Fields:
    return {
        "depth": _number(of.depth, 2),
        "offset": _number(of.transducer_offset, 2),
        "rangescale": "",
    }


def _mtw(of: Readings) -> Fields:
    kelvin = of.water_temperature
    return {"temp": _number(None if kelvin is None else kelvin - CELSIUS, 2), "tempu": "C"}


def _rsa(of: Readings) -> Fields:
    return {
        "stbdangle": _number(of.rudder, 2, math.radians(1.0)),
        "stbdstatus": _status(of.rudder),
        "portangle": "",
        "portstatus": "V",  # there is one rudder, which is the starboard one
    }


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
            "msgNum": str(number),
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
        for number, group in enumerate(groups, start=1)
    ]


def _xte(of: Readings) -> Fields:
    status = _status(of.leg)
    error = None if of.leg is None else of.leg.cross_track
    return {
        "gwarn": status,
        "LCcwarn": status,
        "ctrkerr": _number(None if error is None else abs(error), 3, MILE),
        "dirs": "" if error is None else "L" if error > 0.0 else "R",
        "disUnit": "N",
        "mode": _mode(of.leg),
    }


def _rmb(of: Readings) -> list[Fields]:
    """Return none without a leg, as plotters do: some readers take empty fields for zeros."""
    leg, places = of.leg, of.waypoints
    if leg is None or places is None:
        return []
    fields = {
        "status": "A",
        "ctrkerr": _number(min(abs(leg.cross_track) / MILE, _MOST_RMB), 2),
        "dirs": "L" if leg.cross_track > 0.0 else "R",
        "wptO": f"WP{leg.number - 1}",
        "wptD": f"WP{leg.number}",
        "lat": places[1][0],
        "lon": places[1][1],
        "range": _number(min(leg.distance / MILE, 999.9), 2),
        "bearing": bearing(leg.bearing),
        "velclos": _number(leg.closing, 2, KNOT),
        "arrstatus": "A" if leg.arrived else "V",
        "valstatus": "A",
    }
    return [fields]


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
    "XTE": _xte,
}

SENTENCES: dict[str, Callable[[Readings], list[Fields]]] = {
    **{name: _alone(made) for name, made in _ALONE.items()},
    "GSV": _gsv,
    "RMB": _rmb,
}
"""What can be sent, by formatter, and how; of wind the apparent one, R, and the true one, T."""


def bearing(direction: float | None) -> str:
    """Return a direction in degrees, 0.00 to 359.99."""
    return "" if direction is None else f"{round(math.degrees(direction), 2) % 360.0:.2f}"


def _number(value: float | None, decimals: int, unit: float = 1.0) -> str:
    # Adding 0 takes the sign off what was rounded to minus zero.
    return "" if value is None else f"{round(value / unit, decimals) + 0.0:.{decimals}f}"


def _time(of: Readings) -> str:
    return f"{of.time:%H%M%S}.{of.time.microsecond // 10_000:02}"


def _place(of: Readings) -> Fields:
    if of.position is None:
        return {"lat": "", "lon": ""}
    return {"lat": of.position[0], "lon": of.position[1]}


def _variation(of: Readings, name: str, side: str) -> Fields:
    degrees = round(math.degrees(of.variation), 1)
    return {name: f"{abs(degrees):.1f}", side: "W" if degrees < 0.0 else "E"}


def _status(reading: object) -> str:
    return "V" if reading is None else "A"


def _mode(reading: object) -> str:
    return "N" if reading is None else "A"
