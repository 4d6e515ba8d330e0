"""Motion of a vessel from a log: quantities on one time axis, positions in metres."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from seatrial.errors import InputError, listed
from seatrial.trial.logs.channels import Array, Log
from seatrial.trial.logs.quantities import Column, Series, chosen
from seatrial_kits.logs.paired.common_time import WHOLE, Together, Window, together

_LOCAL, _GEODETIC = ("north", "east"), ("latitude", "longitude")


def motion(
    log: Log, columns: Mapping[str, Column], further: Iterable[str], window: Window = WHOLE
) -> Together:
    """Return heading, north and east, and those of the ``further`` quantities that the log has.

    All are at the instants of the heading. Latitude and longitude become metres north and east of
    the first row, WGS 84; they are used where ``columns`` names them, or the log has no north and
    east. Where both are exactly 0 the receiver had no fix: such entries are left out.

    Raises InputError for a log without heading or position, and as `chosen` and `together` do.
    """
    found = chosen(log, columns, ("heading", *_LOCAL, *_GEODETIC, *further))
    geodetic_first = not columns.keys().isdisjoint(_GEODETIC)
    places = (_GEODETIC, _LOCAL) if geodetic_first else (_LOCAL, _GEODETIC)
    place = next((each for each in places if all(part in found for part in each)), None)
    if "heading" not in found or place is None:
        lacking = "heading" if place else "position: north and east, or latitude and longitude"
        raise InputError(
            f"{log.path}: no {log.noun} serves as {lacking}; --columns WHAT=NAME names one of "
            f"{listed(list(log.channels))}"
        )
    notes: tuple[str, ...] = ()
    if place == _GEODETIC:
        fixes, notes = _fixes(found["latitude"], found["longitude"])
        found |= fixes
    kept = {what: found[what] for what in ("heading", *place, *further) if what in found}
    result = together(kept, "heading", place, window)
    values = dict(result.values)
    if place == _GEODETIC:
        values |= _local(values.pop("latitude"), values.pop("longitude"))
    return replace(result, values=values, notes=(*notes, *result.notes))


def _fixes(latitude: Series, longitude: Series) -> tuple[dict[str, Series], tuple[str, ...]]:
    """Return the entries of a receiver with a fix, and a note of those without."""
    both = {"latitude": latitude, "longitude": longitude}
    if not np.array_equal(latitude.time, longitude.time):
        return both, ()
    fix = (latitude.values != 0.0) | (longitude.values != 0.0)
    if fix.all():
        return both, ()
    if not fix.any():
        raise InputError(
            f"{latitude.log.path}: no fix: latitude ({latitude.channel.name}) and longitude are 0 "
            "in all entries"
        )
    count = int(np.count_nonzero(~fix))
    return {what: each.at(fix) for what, each in both.items()}, (
        f"positions of 0, 0 are left out, {count} of them: the receiver had no fix",
    )


def _local(latitude: Array, longitude: Array) -> dict[str, Array]:
    """Return north and east of the first row, m."""
    from pymap3d import geodetic2ned

    north, east, _ = geodetic2ned(
        latitude, longitude, 0.0, latitude[0], longitude[0], 0.0, deg=False
    )
    return {"north": north, "east": east}
