"""Settings of copies as rows of values by reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.api.assembling import Assembled
from seatrial.api.written import as_written
from seatrial.errors import InputError, unknown
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.fmi.instance import Variable
from seatrial.model.plant import Plant
from seatrial.physics.craft.surrounded import SurroundedPlant
from seatrial.system.assembling.component_parameters import derived_seeds, seed_of
from seatrial.system.part import Part
from seatrial.system.references.values import check_limits, from_written, port_names, port_scalars
from seatrial.system.system import System
from seatrial_kits.native.surroundings import (
    Met,
    is_surrounded,
    met_with,
    plant_of,
    surroundings_of,
)
from seatrial_kits.native.tables import WEATHER_ROLES
from seatrial_kits.native.tables import is_built_in as built_in_port

Floats = NDArray[np.float64]
_MOST_SEAS = 256
"""That are kept for copies to come, whatever the number of copies: some hundred kB each."""


@dataclass(frozen=True)
class Each:
    """What is written for each copy, as a trial's file has it."""

    written: Sequence[Any]


class Settings:
    """Values that copies of a system start with, by ``component.port``, a row for each copy.

    They begin as the rig gives them; what is set at a start stays for the starts that follow.
    """

    def __init__(
        self,
        made: Assembled,
        references: Mapping[str, int],
        count: int,
        weather: Mapping[str, Mapping[str, str]],
    ) -> None:
        self._made, self._references, self._count = made, references, count
        self._system = system = made.system
        self._weather = weather
        self._sources = {part.name: _source(system, part) for part in system.parts.values()}
        self._rows: dict[str, Floats] = {}
        """What was set, by scalar, each (count,)."""
        self._met: dict[tuple[Any, ...], Met | None] = {}
        self._calm: dict[str, SurroundedPlant] = {}
        """Plants that had nothing around them: most settings change nothing in that."""
        self._seeded: tuple[NDArray[np.int64], dict[str, Floats]] = (np.empty(0, np.int64), {})
        self._known: dict[tuple[str, ...], NDArray[np.uint32]] = {}

    # ------------------------------------------------------------------ names

    def is_scalar(self, name: str) -> bool:
        """Say if a name is that of one scalar."""
        return name in self._references

    def read(self, names: Sequence[str]) -> NDArray[np.uint32]:
        """Return the references of outputs, open inputs and parameters. Raises InputError."""
        known = self._known.get(tuple(names))
        if known is None:
            found = [name for given in names for name, _ in self._scalars(given, "get")]
            known = np.array([self._references[name] for name in found], dtype=np.uint32)
            self._known[tuple(names)] = known
        return known

    def _scalars(self, name: str, call: str) -> list[tuple[str, Variable]]:
        part, port = self._system.located(name, call)[0]
        variables = part.instance.variables
        scalars = port_scalars(variables, port)
        if not scalars:
            raise InputError(f"{part.name}: {unknown('port', port, port_names(variables))}")
        named = [(f"{part.name}.{scalar.name}", scalar) for scalar in scalars]
        for whole, scalar in named:
            if scalar.type in (str, bytes):
                raise InputError(f"{call}: {whole} is a text, and a batch has numbers alone")
            if whole not in self._references:
                feeder = self._system.feeders(part.name).get(scalar.name, "another component")
                raise InputError(f"{call}: {whole} is fed by {feeder}, and nothing else sets it")
        return named

    def text(self, name: str) -> int | None:
        """Return the reference of an input of text that nothing feeds, None of another port."""
        part, port = self._system.located(name, "set")[0]
        scalar = part.instance.variables.get(port)
        if scalar is None or scalar.type is not str or scalar.causality != "input":
            return None
        return self._references.get(f"{part.name}.{port}")

    # ------------------------------------------------------------------ values

    def given(self, name: str, value: Any, call: str) -> dict[str, Floats]:
        """Return what a caller gives of a port, by scalar, each (count,). Raises InputError."""
        scalars = self._scalars(name, call)
        part = self._system.parts[scalars[0][0].removesuffix(f".{scalars[0][1].name}")]
        for whole, scalar in scalars:
            if scalar.causality == "output" and call != "override":
                raise InputError(f"{call}: {whole} is an output; it can be overridden")
        if isinstance(value, Each):
            known, origin = {repr(each): each for each in value.written}, f"{call}: {name}"
            read = {key: self._read(part, scalars, w, origin) for key, w in known.items()}
            stacked = np.array([read[repr(each)] for each in value.written])
            return {whole: stacked[:, i] for i, (whole, _) in enumerate(scalars)}
        rows: NDArray[Any] = np.array(0.0 if isinstance(value, str) else value)
        if rows.dtype.kind in "fiub" and rows.ndim and rows.shape[0] == self._count:
            wanted = (self._count,) if len(scalars) == 1 else (self._count, len(scalars))
            if rows.shape == wanted:
                return self._checked(scalars, rows.reshape(self._count, -1), f"{call}: {name}")
        if rows.ndim > 1 or (rows.ndim == 1 and rows.shape != (len(scalars),)):
            raise InputError(
                f"{call}: {name} has shape {rows.shape}; one value for all copies has "
                f"{len(scalars)} element{'s' * (len(scalars) != 1)}, a row for each copy "
                f"({self._count}, {len(scalars)})"
            )
        numbers = self._read(part, scalars, value, f"{call}: {name}")
        pairs = zip(scalars, numbers, strict=True)
        return {whole: np.full(self._count, number) for (whole, _), number in pairs}

    def _read(
        self, part: Part, scalars: Sequence[tuple[str, Variable]], value: Any, origin: str
    ) -> list[float]:
        """Return the numbers of what is written of a port."""
        presets = part.presets.get(self._port_of(part, scalars), {})
        found = from_written(as_written(value), [s for _, s in scalars], presets, origin)
        return [float(found[scalar.name].value) for _, scalar in scalars]

    def _port_of(self, part: Part, scalars: Sequence[tuple[str, Variable]]) -> str:
        return part.instance.variables.port_of(scalars[0][1].name)

    def _checked(
        self, scalars: Sequence[tuple[str, Variable]], rows: NDArray[Any], origin: str
    ) -> dict[str, Floats]:
        numbers = rows.astype(float)
        for column, (whole, scalar) in enumerate(scalars):
            for copy in np.flatnonzero(~np.isfinite(numbers[:, column])):
                raise InputError(f"{origin}: copy {copy} gets {numbers[copy, column]} for {whole}")
            _require_type(scalar, numbers[:, column], origin)
            for furthest in {int(numbers[:, column].argmin()), int(numbers[:, column].argmax())}:
                number = float(numbers[furthest, column])
                check_limits(scalar, number, f"{origin}: copy {furthest}")
        return {whole: numbers[:, i].copy() for i, (whole, _) in enumerate(scalars)}

    def running(self, name: str, value: Any) -> tuple[NDArray[np.uint32], Floats]:
        """Return references and rows of what is set in a run. Raises InputError."""
        given = self.given(name, value, "set")
        for whole, scalar in self._scalars(name, "set"):
            if scalar.causality == "parameter" and scalar.variability != "tunable":
                raise InputError(f"set: {whole} is fixed once a copy has started; reset sets it")
        return self._stacked(given)

    def overriding(self, name: str, value: Any) -> tuple[NDArray[np.uint32], Floats]:
        """Return references and rows of outputs that are overridden; of None references alone.

        Raises InputError.
        """
        for whole, scalar in self._scalars(name, "override"):
            if scalar.causality != "output":
                raise InputError(f"override: {whole} is no output; set it, or reset with it")
        if value is None:
            return self.read([name]), np.empty((self._count, 0))
        return self._stacked(self.given(name, value, "override"))

    # ------------------------------------------------------------------ starts

    def change(
        self, settings: Mapping[str, Any], call: str, mask: NDArray[np.bool_] | None = None
    ) -> dict[str, Floats]:
        """Take over what copies, those of ``mask``, start with from now on; return what was before.

        Raises InputError, and changes nothing then.
        """
        changed: dict[str, Floats] = {}
        named = {name: value for key, value in settings.items() for name in self._made.named(key)}
        for name, value in named.items():
            given = self.given(name, value, call)
            for whole, scalar in self._scalars(name, call):
                if _is_built_in(self._system, whole, scalar):
                    raise InputError(
                        f"{call}: {whole} is built into the program; give it to Batch's set"
                    )
            changed |= given
        before, self._rows = self._rows, dict(self._rows)
        for whole, rows in changed.items():
            own = before.get(whole, np.full(self._count, self._as_given(whole)))
            self._rows[whole] = rows if mask is None else np.where(mask, rows, own)
        return before

    def undo(self, before: dict[str, Floats]) -> None:
        """Go back to what `change` returned."""
        self._rows = before

    def of(self, copy: int) -> dict[str, float]:
        """Return what was set for the starts of a copy, by scalar."""
        return {whole: float(rows[copy]) for whole, rows in self._rows.items()}

    def _as_given(self, whole: str) -> float:
        """Return what the rig gives a scalar."""
        part, name = self._system.located(whole, "set")[0]
        given = part.given.get(name)
        value = part.instance.variables[name].start if given is None else given.value
        return float(value)  # type: ignore[arg-type]

    def rows(self, seeds: NDArray[np.int64]) -> tuple[NDArray[np.uint32], Floats]:
        """Return references and rows of values that copies with these seeds start with."""
        known, rows = self._seeded
        other = np.ones(len(seeds), dtype=bool) if not len(known) else seeds != known
        if other.any():
            for name, values in self._of_seeds(seeds[other]).items():
                rows.setdefault(name, np.empty(self._count))[other] = values
            self._seeded = seeds.copy(), rows
        return self._stacked(rows | self._rows)

    def surroundings(self, mask: NDArray[np.bool_]) -> dict[str, list[Met | None]]:
        """Return what surrounds each plant that can meet weather, in each copy of the mask.

        `rows` has said the seeds of the copies.

        Raises InputError for a sea, a current or a wind that cannot be.
        """
        found: dict[str, list[Met | None]] = {}
        for name, source in self._sources.items():
            if source is None:
                continue
            part = self._system.parts[name]
            values: dict[str, Any] = {own: given.value for own, given in part.given.items()}
            values |= self._weather[name]
            changed = {
                whole.removeprefix(f"{name}."): rows
                for whole, rows in (self._seeded[1] | self._rows).items()
                if whole.startswith(f"{name}.")
                and whole.removeprefix(f"{name}.") in part.instance.variables
                and _is_met(source, part.instance.variables[whole.removeprefix(f"{name}.")])
            }
            found[name] = [
                self._meets(name, source, values, {k: float(v[i]) for k, v in changed.items()})
                if mask[i]
                else None
                for i in range(self._count)
            ]
        return found

    def _meets(
        self, name: str, source: ComponentSource, values: dict[str, Any], own: dict[str, float]
    ) -> Met | None:
        """Return what surrounds a plant with its values, and those of a copy."""
        key = name, *own.items()
        if key not in self._met:
            if len(self._met) > max(_MOST_SEAS, 4 * self._count):
                self._met.clear()  # those in use are kept by the copies
            calm = self._calm.get(name)
            if calm is None or met_with(calm, own) is not None:
                self._met[key] = surroundings_of(source, {**values, **own})
            else:
                self._met[key] = None
            if calm is None and self._met[key] is None:
                self._calm[name] = plant_of(source)
                met_with(self._calm[name], {**values, **own})
        return self._met[key]

    def noise(self, seeds: NDArray[np.int64]) -> tuple[NDArray[np.uint32], Floats]:
        """Return references and rows of the seeds of components: of their noise, not of weather."""
        own = self._of_seeds(seeds)
        return self._stacked(
            {n: rows for n, rows in own.items() if n not in self._made.weather_seeds}
        )

    def _of_seeds(self, seeds: NDArray[np.int64]) -> dict[str, Floats]:
        """Return the seeds of components, as `give_parameters` derives them from a system's."""
        of_weather = seeds.astype(np.float64)
        found: dict[str, Floats] = dict.fromkeys(self._made.weather_seeds, of_weather)
        for part in self._system.parts.values():
            for name, owner in derived_seeds(part).items():
                own = [seed_of(owner, seed) for seed in seeds.tolist()]
                found[f"{part.name}.{name}"] = np.array(own)
        return found

    def _stacked(self, given: Mapping[str, Floats]) -> tuple[NDArray[np.uint32], Floats]:
        references = np.array([self._references[name] for name in given], dtype=np.uint32)
        rows = np.empty((self._count, len(given)))
        for column, values in enumerate(given.values()):
            rows[:, column] = values
        return references, rows


def _require_type(scalar: Variable, numbers: Floats, origin: str) -> None:
    """Raise InputError for a number that is no value of the scalar's type."""
    allowed = {bool: "0 or 1", int: "a whole number"}.get(scalar.type)
    if allowed is None:
        return
    fits = (numbers == 0.0) | (numbers == 1.0) if scalar.type is bool else numbers % 1.0 == 0.0
    for copy in np.flatnonzero(~fits):
        raise InputError(
            f"{origin}: copy {copy} gets {float(numbers[copy])!r} for {scalar.name}, {allowed} is "
            "needed"
        )


def is_weather(key: str) -> bool:
    """Say if a key is one of a trial's sea, current or wind."""
    return key.partition(".")[0] in WEATHER_ROLES


def first_of(value: Any, count: int) -> Any:
    """Return a setting of the first copy, where a value has a row for each."""
    rows = np.asarray(value)
    return value if rows.dtype.kind not in "fiub" or rows.shape[:1] != (count,) else rows[0]


def give_built_in(made: Assembled, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Give a system what is built into its program, and return what its copies can each have.

    Raises InputError for what does not fit.
    """
    rest: dict[str, Any] = {}
    for key, value in settings.items():
        for name in made.named(key):
            if is_built_in(made, name):
                made.system.set(name, as_written(value), "set")
            else:
                rest[name] = value
    return rest


def is_built_in(made: Assembled, name: str) -> bool:
    """Say if a port's value is part of the program. Raises InputError for a name that is none."""
    part, port = made.system.located(name, "set")[0]
    scalars = port_scalars(part.instance.variables, port)
    return bool(scalars) and _is_built_in(made.system, f"{part.name}.{scalars[0].name}", scalars[0])


def take_weather(system: System) -> dict[str, dict[str, str]]:
    """Take the texts of waves, current and wind from plants that meet them; return them by plant.

    Their programs know nothing of them: `Settings` evaluates the weather, of each copy its own.
    """
    taken: dict[str, dict[str, str]] = {}
    for part in system.parts.values():
        if _source(system, part) is None:
            continue
        variables = part.instance.variables
        names = [n for n in part.given if variables[n].type is str]
        names = [n for n in names if variables[n].role in WEATHER_ROLES]
        taken[part.name] = {n: str(part.given.pop(n).value) for n in names}
    return taken


def _is_built_in(system: System, whole: str, scalar: Variable) -> bool:
    part = system.parts[whole.removesuffix(f".{scalar.name}")]
    source = None if part.is_sum else find_source(part.fmu, _folder(system, part))
    if not isinstance(source, ComponentSource):
        return False
    cls = source.component_class()
    return built_in_port(
        cls, cls.scalar_by_name[scalar.name].port, surrounded=is_surrounded(source)
    )


def _is_met(source: ComponentSource, scalar: Variable) -> bool:
    """Say if what surrounds a plant can depend on a value: not on inputs, nor where it starts."""
    cls = source.component_class()
    assert issubclass(cls, Plant)
    starts = {f"{state.name}_start" for state in cls.state_ports}
    return scalar.causality == "parameter" and scalar.name.partition(".")[0] not in starts


def _folder(system: System, part: Part) -> Path:
    return system.rig.components[part.name].scope.folder


def _source(system: System, part: Part) -> ComponentSource | None:
    """Return the source of a plant that can meet weather, None of any other component."""
    if part.is_sum:
        return None
    source = find_source(part.fmu, _folder(system, part))
    if isinstance(source, ComponentSource) and is_surrounded(source):
        return source
    return None
