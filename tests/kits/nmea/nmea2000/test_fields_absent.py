"""Messages without some of their fields: the fields are those of canboat's tables, not a list here.

A field that is not available takes from a reader what depends on it, and nothing else.
"""

import random
from functools import cache

import pytest
from nmea2000.backend import DATABASE
from nmea2000.native_units import NATIVE_UNITS

from seatrial_kits.nmea.nmea2000.catalogue import READABLE
from seatrial_kits.nmea.nmea2000.codec import Decoder, Encoder, Message
from seatrial_kits.nmea.nmea2000.quantities import READERS
from seatrial_kits.nmea.nmea2000.traffic import AIS_PGNS, report

PADDING = ("RESERVED", "SPARE")
CHOICES = {  # lookups that say what the other fields are: each of their numbers
    "headingReference": (0, 1),
    "reference": (0, 1, 2, 3, 4),
    "cogReference": (0, 1),
    "courseBearingReference": (0, 1),
    "temperatureSource": (0, 1),
    "source": (0, 1),
    "humiditySource": (0, 1),
    "navigationTerminated": (0,),
}
TEXTS = ("STRING_FIX", "STRING_LAU", "STRING_LZ")
EITHER = {"arrived": {"perpendicularCrossed", "arrivalCircleEntered"}}
"""Quantities that one of several fields is enough for."""
KEPT = ("communicationState",)
"""Fields that the package that encodes cannot leave out without shifting what follows."""
PGNS = sorted({*READERS, *AIS_PGNS})


@cache
def fields_of(pgn):
    """Return the fields of a PGN that carry something, by canboat's table."""
    variant = DATABASE.pgn_variants(pgn)[0]
    return [f for f in variant.fields if f.field_type not in PADDING and f.id != "sid"]


def any_value(pgn, field, rng):
    """Return a value that a field holds and that is available."""
    if field.id in CHOICES:
        return rng.choice(CHOICES[field.id])
    if field.id in ("latitude", "destinationLatitude"):
        return rng.uniform(-80.0, 80.0)
    if field.field_type in TEXTS:
        return "SEATRIAL"
    if field.field_type == "BINARY":
        return bytes(field.bit_length // 8 + 1)
    if field.field_type in ("LOOKUP", "BITLOOKUP", "INDIRECT_LOOKUP"):
        return 1
    unit = NATIVE_UNITS.get((DATABASE.pgn_variants(pgn)[0].id, field.id))
    resolution = (unit[1] if unit else field.resolution) or 1.0
    top = 2 ** (field.bit_length - 2) - 3
    if field.unit == "rad":
        top = min(top, 3.0 / resolution)
    if field.field_type == "DATE":
        return rng.randrange(10_000, 20_000)
    return rng.randrange(1, max(2, min(int(top), 10**6))) * resolution


def received(pgn, values):
    """Return the quantities, or the report, of a message with these values, over the bus."""
    decoder, found = Decoder({}), None
    for frame in Encoder({}).encode(Message(pgn, dict(values), 7)):
        found = decoder.decode(frame)
    if pgn in AIS_PGNS:
        return report(pgn, found.fields) or {}
    read = READERS[pgn](found.fields)
    return {name: value for name, value in read.items() if value is not None}


def dependent(pgn, values):
    """Return the fields without which a quantity is not as with all of them, by quantity."""
    whole = received(pgn, values)
    found = {name: set() for name in whole}
    for name in found:
        found[name] |= EITHER.get(name, set())
    for field in values:
        if field in KEPT:
            continue
        rest = {name: value for name, value in values.items() if name != field}
        without = received(pgn, rest)
        for name, value in whole.items():
            if without.get(name) != value:
                found[name].add(field)
    return whole, found


@pytest.mark.parametrize("pgn", PGNS)
def test_any_group_of_fields_may_be_absent(pgn):
    rng = random.Random(pgn)
    for _ in range(4):
        values = {f.id: any_value(pgn, f, rng) for f in fields_of(pgn)}
        whole, needed = dependent(pgn, values)
        for _ in range(12):
            absent = {name for name in values if rng.random() < rng.random()} - {*KEPT}
            found = received(pgn, {k: v for k, v in values.items() if k not in absent})
            for name, value in whole.items():
                if not needed[name] & absent:
                    assert found.get(name) == value, (name, absent)
        assert received(pgn, {}) == {}


@pytest.mark.parametrize("pgn", PGNS)
def test_the_fields_that_the_tables_name_are_read_and_no_others(pgn):
    """Of each field that the catalogue has as received there is a message where it matters."""
    rng, read = random.Random(pgn), set()
    for _ in range(25):
        values = {f.id: any_value(pgn, f, rng) for f in fields_of(pgn)}
        if rng.random() < 0.5:
            values.pop("bearingOriginToDestinationWaypoint", None)
        _, needed = dependent(pgn, values)
        read |= set().union(*needed.values())
    named = {field.name for field in READABLE[pgn].fields if field.received}
    meant = {"instance", "source", "userId", *CHOICES}
    optional = {"perpendicularCrossed", "arrivalCircleEntered", "navigationTerminated", "method"}
    optional |= {"directionOrder"}
    assert named - optional <= read | meant, named - read
    assert read <= named | meant | optional
