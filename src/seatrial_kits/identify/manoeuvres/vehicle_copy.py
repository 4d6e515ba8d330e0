"""Copy of a vehicle's files with identified numbers as a variant of its own."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from itertools import count
from pathlib import Path

from seatrial.files.vehicle_folders import FOLDERS, PILOT, owner
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.system.parameters import VehicleFile, load_vehicle
from seatrial.system.references.entries import Entry

from ..studies.vehicle_file import VARIANT, table_lines
from .study import ManoeuvreStudy, Row


def write_copy(study: ManoeuvreStudy, folder: Path) -> Path:
    """Write the vehicle with its identified parameters below a folder; return its file.

    A vehicle of a folder becomes ``harness/vehicles/NAME-identified``, its pilot too; another one
    ``NAME-identified.toml``. The text stays, comments too; a variant is added, which is the one
    that was identified with the new numbers in it, and is the default of file, rig and pilot.
    """
    source = study.craft.source[0]
    file = load_vehicle(str(source)).file
    variant = next(name for name in _names() if name not in file.variants)
    name = f"{owner(source) or source.stem}-{variant}"
    if not owner(source):
        path = folder / f"{name}.toml"
    else:
        shutil.copytree(source.parent, folder / FOLDERS / name)
        path = folder / FOLDERS / name / source.name
        pilot = path.with_name(PILOT)
        if pilot.exists():
            write_whole(pilot, _chosen(pilot.read_text("utf-8"), study.craft.variant, variant))
    text = _chosen(source.read_text("utf-8"), study.craft.variant, variant)
    added = "\n".join(_variant_lines(study, file, variant))
    write_whole(path, f"{_with_default(text, variant).rstrip()}\n{added}\n")
    return path


def _names() -> Iterator[str]:
    yield VARIANT
    yield from (f"{VARIANT}-{number}" for number in count(2))


def _chosen(text: str, old: str | None, new: str) -> str:
    """Return a file whose rigs take another variant."""
    if old is None:
        return text
    return re.sub(rf'^(variant\s*=\s*)"{re.escape(old)}"', rf'\g<1>"{new}"', text, flags=re.M)


def _with_default(text: str, variant: str) -> str:
    top, *tables = re.split(r"^(?=\[)", text, maxsplit=1, flags=re.M)
    line = f'default = "{variant}"'
    changed, found = re.subn(r"^default\s*=.*$", line, top, flags=re.M)
    if not found:
        changed = re.sub(r"^(?=[A-Za-z])", f"{line}\n", top, count=1, flags=re.M)
    return "".join((changed, *tables))


def _variant_lines(study: ManoeuvreStudy, file: VehicleFile, variant: str) -> Iterator[str]:
    base, table = study.craft.variant, study.craft.source[1]
    logs = ", ".join(dict.fromkeys(shown.run.name for shown in study.shown if shown.is_fitted))
    yield ""
    yield f"# {variant}: {base or 'the numbers above'}, with parameters identified from {logs}"
    changes = dict(file.variants.get(base, {})) if base else {}
    own = {row.name: _entry(row, logs) for row in study.parameters}
    changes[table] = {**changes.get(table, {}), **own}
    for name, entries in changes.items():
        yield from table_lines(("variants", variant, name), entries)


def _entry(row: Row, logs: str) -> Entry:
    low, high = row.interval
    source = f"identified from {logs}: 95 % interval {number(low, 4)} to {number(high, 4)}"
    if row.partner:
        source += f"; hardly separable from {row.partner}"
    return Entry(value=row.value, unit=row.unit, source=source, mark="identified")
