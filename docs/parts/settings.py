"""Parameters of vehicles, sensors of profiles: tables of what the files say."""

from __future__ import annotations

import tomllib
from functools import partial

from parts import part
from parts.markdown import shown_unit, shown_value, table
from seatrial.cosim.parameters import Entry, load_vehicle
from seatrial.cosim.profile import SENSORS
from seatrial.ports import Parameter
from seatrial.shipped import shipped_folder


@part("sensor-keys")
def sensor_keys() -> str:
    """Keys of a profile's sensors: the parameters of their components."""
    rows: dict[tuple[str, str, str], dict[str, str]] = {}
    for kind, component in SENSORS.items():
        for name, port in component.ports.items():
            if isinstance(port, Parameter) and name != "seed":
                starts = port.start if len(set(port.start)) > 1 else port.start[:1]
                texts = [f"{start:.4g}" for start in starts]
                axes = f" ({', '.join(port.axes)})" if port.axes else ""
                row = rows.setdefault((name, shown_unit(port.unit), port.description + axes), {})
                row[kind] = f"({', '.join(texts)})" if len(texts) > 1 else texts[0]
    common_first = sorted(rows.items(), key=lambda item: len(item[1]) == 1)
    return table(
        ("key", "meaning", "unit", *SENSORS),
        [
            (f"`{name}`", meaning, unit, *(starts.get(kind, "") for kind in SENSORS))
            for (name, unit, meaning), starts in common_first
        ],
    )


def parameters(vehicle: str) -> str:
    """Parameters that all variants share."""
    file = load_vehicle(vehicle).file
    varied = {(t, n) for c in file.variants.values() for t, entries in c.items() for n in entries}
    return table(
        ("component", "parameter", "value", "unit", "mark", "source"),
        [
            (table, f"`{name}`", shown_value(e.value), shown_unit(e.unit), e.mark, e.source)
            for table, entries in file.components.items()
            for name, e in entries.items()
            if (table, name) not in varied
        ],
    )


def variants(vehicle: str) -> str:
    """Parameters in which the variants differ."""
    file = load_vehicle(vehicle).file
    places = dict.fromkeys(
        (table, name)
        for changes in file.variants.values()
        for table, entries in changes.items()
        for name in entries
    )
    rows = []
    for component, name in places:
        for variant, changes in file.variants.items():
            shared: dict[str, Entry] = file.components[component]
            e = changes.get(component, {}).get(name, shared.get(name))
            assert e is not None
            value = shown_value(e.value)
            rows.append(
                (component, f"`{name}`", variant, value, shown_unit(e.unit), e.mark, e.source)
            )
    head = ("component", "parameter", "variant", "value", "unit", "mark", "source")
    return table(head, rows)


for _vehicle in ("hydrone", "gloria", "mariner"):
    part(f"{_vehicle}-parameters")(partial(parameters, _vehicle))
    part(f"{_vehicle}-variants")(partial(variants, _vehicle))
for _vehicle in ("thruster-ship", "videoray"):
    part(f"{_vehicle}-parameters")(partial(parameters, _vehicle))


def sensors_of(profile: str) -> str:
    """Sensors of a profile, as its file has them."""
    path = shipped_folder("hil_profiles") / f"{profile}.toml"
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
