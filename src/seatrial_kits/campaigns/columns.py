"""The columns of a campaign's table: what its cases set, what they come to."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from seatrial.errors import InputError, unknown
from seatrial.trial.files.map_entry import MOST_PANELS, MOST_VALUES
from seatrial.trial.files.trial import Trial

from .campaign import Campaign
from .case_list import FAULTS, Block
from .cases import Case
from .distributions import number_and_unit
from .ended import Ended

Kind = Literal["integer", "number", "truth", "text"]


@dataclass(frozen=True)
class Column:
    """A column: its name, its kind, the unit of its numbers, and the value of a case."""

    name: str
    kind: Kind
    value: Callable[[Case, Ended], Any]
    unit: str = ""


def columns_of(campaign: Campaign) -> list[Column]:
    """Return the columns of a campaign's table; they depend on its files alone.

    Raises InputError for a map of keys that its cases do not set to numbers, or to too many.
    """
    settings = _settings(campaign.cases().blocks)
    _check_map(campaign, settings)
    return table_columns(campaign, campaign.trials, settings)


def table_columns(
    campaign: Campaign, trials: Iterable[Trial], settings: Mapping[str, list[Any]]
) -> list[Column]:
    """Return the columns of a table of some trials whose cases set keys to some of the values."""
    columns = [
        Column("case", "integer", lambda _, ended: ended.number + 1),
        Column("trial", "text", lambda case, _: case.trial_name),
        *(_setting(key, values) for key, values in settings.items()),
        Column("seed", "integer", lambda _, ended: ended.measured.seed),
        Column("status", "text", lambda _, ended: ended.measured.status),
        Column("passed", "truth", lambda _, ended: ended.measured.passed),
        Column("error", "text", lambda _, ended: ended.measured.error),
    ]
    names = dict.fromkeys(name for trial in trials for name, _ in trial.criteria)
    columns += [column for name in names for column in _criterion(name)]
    columns += [
        Column(f"{which} {signal}", "number", _figure(place, index))
        for place, signal in enumerate(campaign.file.figures)
        for index, which in enumerate(("least", "greatest", "last"))
    ]
    return _unlike(columns)


def settings_in(names: Sequence[str]) -> list[str]:
    """Return the columns of a case's own: trial, settings, and seed once."""
    found = list(names[names.index("trial") : names.index("status")])
    return found if found[-1] == "seed" else found[:-1]  # the run's own, where seeds are set


def _check_map(campaign: Campaign, settings: Mapping[str, list[Any]]) -> None:
    entry, where = campaign.file.map, f"{campaign.read_from.path}: map"
    if entry is None:
        return
    for key in entry.keys:
        if key not in settings:
            raise InputError(f"{where}: {unknown('key that cases set', key, settings)}")
    for axis, key in (("x", entry.x), ("y", entry.y)):
        if _setting(key, settings[key]).kind not in ("integer", "number"):
            raise InputError(f"{where}.{axis}: {key} is no number, or of several units")
    bounds = {"x": MOST_VALUES, "y": MOST_VALUES, "columns": MOST_PANELS, "rows": MOST_PANELS}
    for place, most in bounds.items():
        key = getattr(entry, place)
        count = 0 if key is None else len({repr(value) for value in settings[key]})
        if count > most:
            raise InputError(
                f"{where}.{place}: {key} has {count} values, and {most} at most are drawn: a "
                "grid, or a design with levels, has few"
            )


def _settings(blocks: Iterable[Block]) -> dict[str, list[Any]]:
    """Return all values of every key that cases set."""
    values: dict[str, list[Any]] = {}
    for block in blocks:
        for key, value in block.common.items():
            values.setdefault(key, []).append(value)
        for key, several in block.grid.items():
            values.setdefault(key, []).extend(several)
        for row in block.rows:
            for key, value in row.items():
                values.setdefault(key, []).append(value)
        values.setdefault(FAULTS, []).extend(name for name in block.crossed if name is not None)
        for scale in filter(None, block.scales):
            values.setdefault(f"{scale[0]} times", []).append(scale[1])
    return {key: found for key, found in values.items() if found}


def _setting(key: str, values: list[Any]) -> Column:
    """Return the column of a setting: numbers in the unit that all have, else text."""
    kinds = {type(value) for value in values}
    if kinds == {bool}:
        return Column(key, "truth", lambda case, _: case.set.get(key))
    if kinds == {int}:
        return Column(key, "integer", lambda case, _: case.set.get(key))
    if kinds <= {int, float}:
        return Column(key, "number", lambda case, _: case.set.get(key))
    units = {number_and_unit(v)[1] if isinstance(v, str) else None for v in values}
    unit = units.pop() if len(units) == 1 else None
    if unit:
        return Column(key, "number", lambda case, _: _number(case.set, key), unit)
    return Column(key, "text", lambda case, _: _text(case.set.get(key)))


def _number(settings: Mapping[str, Any], key: str) -> float | None:
    return number_and_unit(settings[key])[0] if key in settings else None


def _text(value: Any) -> str | None:
    return value if value is None or isinstance(value, str) else json.dumps(value)


def _criterion(name: str) -> Iterator[Column]:
    def of(key: str) -> Callable[[Case, Ended], Any]:
        def value(_: Case, ended: Ended) -> Any:
            return next((v[key] for v in ended.measured.verdicts if v["name"] == name), None)

        return value

    yield Column(name, "truth", of("passed"))
    yield Column(f"robustness of {name}", "number", of("robustness"))
    yield Column(f"worst of {name}", "number", of("worst"))
    yield Column(f"unit of {name}", "text", of("unit"))


def _figure(place: int, index: int) -> Callable[[Case, Ended], float | None]:
    def value(_: Case, ended: Ended) -> float | None:
        figures = ended.measured.figures
        return figures[place][index] if place < len(figures) else None

    return value


def _unlike(columns: list[Column]) -> list[Column]:
    """Return columns whose names differ: criteria come after what has the name already."""
    seen: dict[str, int] = {}
    renamed = []
    for column in columns:
        count = seen[column.name] = seen.get(column.name, 0) + 1
        name = column.name if count == 1 else f"{column.name} ({count})"
        renamed.append(Column(name, column.kind, column.value, column.unit))
    return renamed
