"""Parameters of vehicles, sensors of profiles: tables of what the files say."""

from __future__ import annotations

import tomllib
from functools import partial

from parts import part
from parts.markdown import shown_unit, shown_value, table
from seatrial.fmi.components.source import shipped_sources
from seatrial.model.ports import Parameter
from seatrial.shipped import available
from seatrial.system.parameters import load_vehicle
from seatrial.system.profile.kinds import keys
from seatrial.system.references.entries import Resolved

_SENSORS = ("ahrs", "anemometer", "compass", "depth", "gnss", "imu")
_OF_LINKS = ("arduino", "ardupilot", "can", "gprs", "mavlink", "nmea", "px4", "videoray")
_PACKAGES = ("seatrial.links.", *(f"seatrial_kits.{kit}." for kit in _OF_LINKS))
_VEHICLE = tuple(f"seatrial_kits.videoray.{name}." for name in ("cable", "tracking", "vessel"))
_LINKS = [
    name
    for name, source in shipped_sources().items()
    if source.module.startswith(_PACKAGES) and not source.module.startswith(_VEHICLE)
]


@part("sensor-keys")
def sensor_keys() -> str:
    """Keys of a profile's sensors, one column a kind."""
    rows: dict[tuple[str, str, str], dict[str, str]] = {}
    for kind in _SENSORS:
        for name, port in keys("sensors", kind).items():
            row = rows.setdefault((name, shown_unit(port.unit), _meaning(port)), {})
            row[kind] = _start(port)
    common_first = sorted(rows.items(), key=lambda item: len(item[1]) == 1)
    return table(
        ("key", "meaning", "unit", *_SENSORS),
        [
            (f"`{name}`", meaning, unit, *(starts.get(kind, "") for kind in _SENSORS))
            for (name, unit, meaning), starts in common_first
        ],
    )


@part("link-keys")
def link_keys() -> str:
    """Keys of a profile's links, one table a kind."""
    return "\n".join(
        f"\n## {kind}\n\n"
        + table(
            ("key", "unit", "default", "meaning"),
            [
                (f"`{name}`", shown_unit(port.unit), _start(port), _meaning(port))
                for name, port in keys("links", kind).items()
            ],
        )
        for kind in _LINKS
    )


def _start(port: Parameter) -> str:
    if port.type is str:
        return f"`{port.start[0]}`" if port.start[0] else "empty"
    starts = port.start if len(set(port.start)) > 1 else port.start[:1]
    texts = [f"{start:.4g}" for start in starts]
    return f"({', '.join(texts)})" if len(texts) > 1 else texts[0]


def _meaning(port: Parameter) -> str:
    choices = ": " + ", ".join(f"`{c}`" for c in port.choices) if port.choices else ""
    axes = f" ({', '.join(port.axes)})" if port.axes else ""
    return port.description + choices + axes


def parameters(vehicle: str) -> str:
    """Parameters that all variants share."""
    of = _entries(vehicle)
    varied = _varied(vehicle)
    return table(
        ("component", "parameter", "value", "unit", "mark", "source"),
        [
            (table, f"`{name}`", shown_value(e.value), shown_unit(e.unit), e.mark, e.source)
            for table, entries in next(iter(of.values())).items()
            for name, e in entries.items()
            if (table, name) not in varied
        ],
    )


def variants(vehicle: str) -> str:
    """Parameters in which the variants differ."""
    rows = []
    for component, name in _varied(vehicle):
        for variant, tables in _entries(vehicle).items():
            e = tables.get(component, {}).get(name)
            if e is None:  # the component's default
                continue
            value = shown_value(e.value)
            rows.append(
                (component, f"`{name}`", variant, value, shown_unit(e.unit), e.mark, e.source)
            )
    head = ("component", "parameter", "variant", "value", "unit", "mark", "source")
    return table(head, rows)


def _entries(vehicle: str) -> dict[str, dict[str, dict[str, Resolved]]]:
    """Return all entries by variant and table."""
    loaded = load_vehicle(vehicle)
    return {
        variant: {table: loaded.entries(variant or None).table(table) for table in loaded.tables}
        for variant in loaded.file.variants or ("",)
    }


def _varied(vehicle: str) -> list[tuple[str, str]]:
    """Return table and name of what variants say, and of what follows from that."""
    said = {
        (table, name): None
        for changes in load_vehicle(vehicle).file.variants.values()
        for table, entries in changes.items()
        for name in entries
    }
    first, *others = _entries(vehicle).values()
    for place, entries in first.items():
        for name, e in entries.items():
            values = [tables[place].get(name, e).value for tables in others]
            if any(value != e.value for value in values):
                said.setdefault((place, name))
    return list(said)


for _vehicle in (
    "hydrone",
    "gloria",
    "mariner",
    "kvlcc2",
    "videoray",
    "otter",
    "bluerov2",
    "remus100",
    "glider",
    "wam-v",
    "thruster-ship",
):
    part(f"{_vehicle}-parameters")(partial(parameters, _vehicle))
    part(f"{_vehicle}-variants")(partial(variants, _vehicle))
part("supply-ship-parameters")(partial(parameters, "supply-ship"))


def sensors_of(profile: str) -> str:
    """Sensors of a profile, as its file has them."""
    path = available("hil_profiles")[profile]
    sensors = tomllib.loads(path.read_text("utf-8"))["sensors"]
    rows = []
    for name, entries in sensors.items():
        for key, value in entries.items():
            if key not in ("kind", "source"):
                rows.append(
                    (name, f"`{key}`", ", ".join(value) if type(value) is list else f"{value}")
                )
    listed = "".join(f"- **{name}**: {entries['source']}\n" for name, entries in sensors.items())
    return listed + "\n" + table(("sensor", "key", "value"), rows)


for _profile in ("hydrone", "gloria", "videoray"):
    part(f"{_profile}-sensors")(partial(sensors_of, _profile))
