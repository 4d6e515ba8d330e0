"""Quantities that sentences of sensors and plotters hold, by formatter: SI and rad, lat, lon deg.

Source: E. S. Raymond, "NMEA Revealed" (gpsd project); fields by pynmeagps's names. Each field is
read by itself; a sentence that says that it is not valid has no values.
"""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from typing import Any

from ..received.memory import Values
from .codec import CELSIUS, FATHOM, FOOT, KNOT, MILE

_KILOMETRES_PER_HOUR = 1.0 / 3.6
_SPEED_UNITS = {"N": KNOT, "K": _KILOMETRES_PER_HOUR, "M": 1.0, "S": 1609.344 / 3600.0}
_PER_MINUTE = math.radians(1.0) / 60.0
_RPM = math.tau / 60.0
_BAR = 1e5
_MOST_ENGINES = 99
_NO_DATES = 65532
"""Days since 1970 from which on a date is none, as on NMEA 2000."""
_LARGEST_ERROR = 1e3
"""Cross-track errors beyond so many miles are none."""

Found = tuple[float, ...] | None


def _number(m: Any, name: str, unit: float = 1.0) -> Found:
    value = getattr(m, name, None)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return (value * unit,)


def _first(*found: Found) -> Found:
    return next((each for each in found if each is not None), None)


def _angle(m: Any, name: str) -> Found:
    """Return a direction or an angle from the bow, rad; None beyond a circle."""
    found = _number(m, name)
    return None if found is None or not 0.0 <= found[0] <= 360.0 else (math.radians(found[0]),)


def _text(m: Any, name: str) -> str:
    return str(getattr(m, name, ""))


def _says(m: Any, *names: str) -> bool:
    """Return whether one of some fields says that a sentence is not valid."""
    return any(_text(m, name) in ("V", "N") for name in names)


def _sided(m: Any, name: str, side: str, negative: str) -> Found:
    """Return a magnitude in degrees with its side as an angle; without a side there is none."""
    found, where = _number(m, name, math.radians(1.0)), _text(m, side)
    if found is None or not where:
        return None
    return (-found[0],) if where == negative else found


def _place(m: Any) -> Found:
    latitude, longitude = _number(m, "lat"), _number(m, "lon")
    if latitude is None or longitude is None:
        return None
    within = abs(latitude[0]) <= 90.0 and abs(longitude[0]) <= 180.0
    return (*latitude, *longitude) if within else None


def _date(m: Any) -> Values:
    day = getattr(m, "date", None)
    if not isinstance(day, datetime.date):
        try:
            day = datetime.date(int(m.year), int(m.month), int(m.day))
        except (AttributeError, OverflowError, TypeError, ValueError):
            return {}
    days = (day - datetime.date(1970, 1, 1)).days
    return {"date": (float(days),) if 0 < days < _NO_DATES else None}


def _fix(m: Any) -> Values:
    lost = _text(m, "quality") == "0" or _says(m, "status")
    modes = _text(m, "posMode")
    lost = lost or (bool(modes) and set(modes) <= {"N"})
    if lost:
        return {"place": None, "altitude": None}
    altitude = _number(m, "alt")
    return {"place": _place(m)} | ({"altitude": altitude} if hasattr(m, "alt") else {})


def _rmc(m: Any) -> Values:
    found = _fix(m)
    found.pop("altitude", None)
    valid = found["place"] is not None
    return {
        **found,
        **_date(m),
        "speed_over_ground": _number(m, "spd", KNOT) if valid else None,
        "course": _angle(m, "cog") if valid else None,
        "variation": _sided(m, "mv", "mvEW", "W"),
    }


def _vtg(m: Any) -> Values:
    lost = _says(m, "posMode")
    speed = _first(_number(m, "sogn", KNOT), _number(m, "sogk", _KILOMETRES_PER_HOUR))
    return {
        "speed_over_ground": None if lost else speed,
        "course": None if lost else _angle(m, "cogt"),
        "magnetic_course": None if lost else _angle(m, "cogm"),
    }


def _hdg(m: Any) -> Values:
    shown, variation = _angle(m, "headingM"), _sided(m, "variation", "variationEW", "W")
    deviation = _sided(m, "deviation", "deviationEW", "W") or (0.0,)
    if shown is not None:
        shown = (shown[0] + deviation[0], *(variation or ()))
    return {"magnetic_heading": shown, "variation": variation}


def _rsa(m: Any) -> Values:
    """Return the rudder, or of two the starboard one."""
    valid = _text(m, "stbdstatus") != "V"
    return {"rudder": _number(m, "stbdangle", math.radians(1.0)) if valid else None}


def _vhw(m: Any) -> Values:
    return {
        "heading": _angle(m, "hdgT"),
        "magnetic_heading": _angle(m, "hdgM"),
        "water_speed": _first(_number(m, "spdN", KNOT), _number(m, "spdK", _KILOMETRES_PER_HOUR)),
    }


def _vbw(m: Any) -> Values:
    valid = _text(m, "waterspdstatus") != "V"
    return {"water_speed": _number(m, "longwaterspd", KNOT) if valid else None}


def _dbt(m: Any) -> Values:
    feet, fathoms = _number(m, "depthf", FOOT), _number(m, "depthfath", FATHOM)
    return {"depth": _first(_number(m, "depthm"), feet, fathoms)}


def _mwv(m: Any) -> Values:
    """Wind from the bow: R apparent, T over ground."""
    lost, unit = _says(m, "status"), _SPEED_UNITS.get(_text(m, "speedu"))
    speed = None if lost or unit is None else _number(m, "speed", unit)
    angle = None if lost else _angle(m, "angle")
    if _text(m, "reference") == "T":
        return {"ground_wind_speed": speed, "ground_wind_angle": angle}
    blows_to = None if angle is None else (math.remainder(angle[0] - math.pi, math.tau),)
    return {"wind_speed": speed, "wind_angle": blows_to}


def _mwd(m: Any) -> Values:
    return {
        "ground_wind_speed": _first(_number(m, "speedM"), _number(m, "speedN", KNOT)),
        "wind_direction": _angle(m, "dirT"),
        "magnetic_wind_direction": _angle(m, "dirM"),
    }


_TRANSDUCERS: dict[str, tuple[str, str, Callable[[float], float]]] = {
    "PTCH": ("pitch", "D", math.radians),
    "PITCH": ("pitch", "D", math.radians),
    "TRIM": ("pitch", "D", math.radians),
    "ROLL": ("roll", "D", math.radians),
    "HEEL": ("roll", "D", math.radians),
    "YAW": ("yaw", "D", math.radians),
    "ENV_WATER_T": ("water_temperature", "C", lambda celsius: celsius + CELSIUS),
    "WATERTEMP": ("water_temperature", "C", lambda celsius: celsius + CELSIUS),
    "ENV_OUTAIR_T": ("air_temperature", "C", lambda celsius: celsius + CELSIUS),
    "TEMPAIR": ("air_temperature", "C", lambda celsius: celsius + CELSIUS),
    "AIRTEMP": ("air_temperature", "C", lambda celsius: celsius + CELSIUS),
    "ENV_ATMOS_P": ("air_pressure", "B", lambda bar: bar * _BAR),
    "BAROMETER": ("air_pressure", "B", lambda bar: bar * _BAR),
    "BARO": ("air_pressure", "B", lambda bar: bar * _BAR),
    "ENV_OUTSIDE_H": ("humidity", "P", lambda percent: percent / 100.0),
}
"""Quantity, unit and conversion of the transducers of XDR, by the names that makers give them."""


def _xdr(m: Any) -> Values:
    found: Values = {}
    for key, value in vars(m).items():
        number = key.removeprefix("data_")
        name = str(getattr(m, f"tdrid_{number}", "")).upper()
        if key.startswith("data_") and name in _TRANSDUCERS:
            quantity, unit, converted = _TRANSDUCERS[name]
            right = getattr(m, f"dataunit_{number}", "") == unit
            known = isinstance(value, (int, float)) and right
            found[quantity] = (converted(float(value)),) if known else None
    return found


def _rpm(m: Any) -> Values:
    """Speed of an engine or its shaft: 0 and 1 are the first one."""
    number = _number(m, "engineshaftnum")
    if number is None or not 0 <= number[0] <= _MOST_ENGINES:
        return {}
    speed = None if _text(m, "status") == "V" else _number(m, "rpm", _RPM)
    return {f"engine_speed {max(int(number[0]) - 1, 0)}": speed}


def _vdr(m: Any) -> Values:
    return {
        "current_speed": _number(m, "spd", KNOT),
        "current_direction": _angle(m, "dirT"),
        "magnetic_current_direction": _angle(m, "dirM"),
    }


def _plain(m: Any, place: int, unit: float = 1.0) -> Found:
    """Return a field of a sentence that pynmeagps has no names for, by its place, from 1."""
    try:
        value = float(getattr(m, f"field_{place:02}", ""))
    except ValueError:
        return None
    return (value * unit,) if math.isfinite(value) else None


def _vwr(m: Any) -> Values:
    """Apparent wind of older instruments: the angle to either side of the bow."""
    angle, side = _plain(m, 1, math.radians(1.0)), _text(m, "field_02")
    comes_from = None
    if angle is not None and side in ("L", "R"):
        comes_from = angle[0] if side == "R" else -angle[0]
    blows_to = None if comes_from is None else math.remainder(comes_from - math.pi, math.tau)
    return {
        "wind_speed": _first(_plain(m, 5), _plain(m, 3, KNOT), _plain(m, 7, _KILOMETRES_PER_HOUR)),
        "wind_angle": None if blows_to is None else (blows_to,),
    }


def _mda(m: Any) -> Values:
    """Weather stations' composite: pressure, temperatures, humidity and the wind over ground."""
    air, water, humidity = _plain(m, 5), _plain(m, 7), _plain(m, 9, 0.01)
    return {
        "air_pressure": _plain(m, 3, _BAR),
        "air_temperature": None if air is None else (air[0] + CELSIUS,),
        "water_temperature": None if water is None else (water[0] + CELSIUS,),
        "humidity": humidity,
        "wind_direction": _plain(m, 13, math.radians(1.0)),
        "magnetic_wind_direction": _plain(m, 15, math.radians(1.0)),
        "ground_wind_speed": _first(_plain(m, 19), _plain(m, 17, KNOT)),
    }


def _cross_track(m: Any, unit: str, *marks: str) -> Found:
    """Return the error, m: a vessel to be steered left is to starboard of the leg."""
    scale = 1000.0 if _text(m, unit) == "K" else MILE
    error, side = _number(m, "ctrkerr", scale), _text(m, "dirs")
    if error is None or side not in ("L", "R") or any(_text(m, mark) == "V" for mark in marks):
        return None
    if _text(m, "mode") == "N" or abs(error[0]) > _LARGEST_ERROR * MILE:
        return None
    return error if side == "L" else (-error[0],)


def _referred(m: Any, name: str, angle: str, unit: str) -> Values:
    """Return a direction whose unit, T or M, says what it is counted from."""
    names = {"T": name, "M": f"magnetic_{name}"}
    key = names.get(_text(m, unit))
    return {} if key is None else {key: _angle(m, angle)}


def _apb(m: Any) -> Values:
    arrived = "A" in (_text(m, "aalmcirc"), _text(m, "aalmperp"))
    return {
        "cross_track": _cross_track(m, "ctrkUnit", "LCgwarn", "LCcwarn"),
        "arrived": (float(arrived),),
        **_referred(m, "leg_direction", "bearO2D", "bearO2Du"),
        **_referred(m, "waypoint_bearing", "bearD", "bearDu"),
    }


def _rmb(m: Any) -> Values:
    names = ("cross_track", "waypoint_place", "waypoint_bearing", "waypoint_distance",
             "closing_speed", "arrived")  # fmt: skip
    if _text(m, "status") != "A" or _text(m, "valstatus") == "N":
        return dict.fromkeys(names)
    return {
        "cross_track": _cross_track(m, ""),
        "waypoint_place": _place(m),
        "waypoint_bearing": _angle(m, "bearing"),
        "waypoint_distance": _number(m, "range", MILE),
        "closing_speed": _number(m, "velclos", KNOT),
        "arrived": (float(_text(m, "arrstatus") == "A"),),
    }


def _bwc(m: Any) -> Values:
    lost = _text(m, "mode") == "N"
    return {
        "waypoint_place": None if lost else _place(m),
        "waypoint_bearing": None if lost else _angle(m, "bearT"),
        "magnetic_waypoint_bearing": None if lost else _angle(m, "bearM"),
        "waypoint_distance": None if lost else _number(m, "dist", MILE),
    }


def _hsc(m: Any) -> Values:
    if _text(m, "status") == "R":  # a heading that is reported, not ordered
        return {}
    true, magnetic = _angle(m, "cmdheadingT"), _angle(m, "cmdheadingM")
    if true is not None:
        return {"heading_to_steer": (true[0], 0.0)}
    return {"heading_to_steer": None if magnetic is None else (magnetic[0], 1.0)}


READERS: dict[str, Callable[[Any], Values]] = {
    "APB": _apb,
    "BOD": lambda m: {
        "leg_direction": _angle(m, "bearT"),
        "magnetic_leg_direction": _angle(m, "bearM"),
    },
    "BWC": _bwc,
    "BWR": _bwc,
    "DBT": _dbt,
    "DPT": lambda m: {"depth": _number(m, "depth"), "depth_offset": _number(m, "offset")},
    "GGA": _fix,
    "GLL": _fix,
    "GNS": _fix,
    "HDG": _hdg,
    "HDM": lambda m: {"magnetic_heading": _angle(m, "headingM")},
    "HDT": lambda m: {"heading": _angle(m, "headingT")},
    "HSC": _hsc,
    "MDA": _mda,
    "MTW": lambda m: {
        "water_temperature": None if (t := _number(m, "temp")) is None else (t[0] + CELSIUS,)
    },
    "MWD": _mwd,
    "MWV": _mwv,
    "RMB": _rmb,
    "RMC": _rmc,
    "ROT": lambda m: {
        "rate_of_turn": None if _says(m, "valid") else _number(m, "rot", _PER_MINUTE)
    },
    "RPM": _rpm,
    "RSA": _rsa,
    "THS": lambda m: {"heading": None if _says(m, "mi") else _angle(m, "headt")},
    "VBW": _vbw,
    "VDR": _vdr,
    "VHW": _vhw,
    "VTG": _vtg,
    "VWR": _vwr,
    "XDR": _xdr,
    "XTE": lambda m: {"cross_track": _cross_track(m, "disUnit", "gwarn", "LCcwarn")},
    "ZDA": _date,
}
"""By formatter."""

LATE: dict[str, tuple[str, ...]] = {"HDG": ("variation",), "VHW": ("heading", "magnetic_heading")}
"""Quantities that a sentence repeats of others, by formatter: used where nothing else has them."""


def quantities_of(message: Any) -> Values:
    """Return the quantities of a sentence of `READERS`; numbers beyond a double's are none."""
    read = READERS[message.msgID](message)
    return {
        name: values if values is not None and all(map(math.isfinite, values)) else None
        for name, values in read.items()
    }
