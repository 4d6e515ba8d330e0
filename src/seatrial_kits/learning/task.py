"""Tasks: a system, what an agent sees of it, does to it and is rewarded for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError, unknown
from seatrial.model.units import Unit, conversion, quantity, split_quantity, unit
from seatrial.system.files import find_file, read_toml, validated
from seatrial.system.rig import duration_ns
from seatrial.trial.criteria import expressions as ex
from seatrial.trial.criteria import formulas
from seatrial.trial.criteria.grammar import tree
from seatrial.trial.criteria.metrics import is_of_record
from seatrial_kits.campaigns.distributions import Law, read_distribution

from .observation import number_of
from .task_file import ActEntry, EndEntry, ObserveEntry, RewardEntry, TaskFile

FOLDER = "harness/tasks"

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Observed:
    """An element of the observation: low and high, SI, are -1 and 1."""

    value: ex.Expression
    low: float
    high: float


@dataclass(frozen=True)
class Acted:
    """An element of the action: -1 and 1 are low and high, in the unit of its port."""

    name: str
    low: float
    high: float


@dataclass(frozen=True)
class Reward:
    """A term of the reward."""

    name: str
    says: ex.Expression | formulas.Formula
    is_margin: bool
    weight: float
    low: float
    high: float


@dataclass(frozen=True)
class End:
    """What ends an episode."""

    name: str
    when: formulas.Formula
    is_success: bool
    reward: float


class Task:
    """A task's file, read; `fitted` holds it against a system."""

    def __init__(self, name: str | Path) -> None:
        path = find_file(FOLDER, str(name))
        content, self.read_from = read_toml(path)
        self.path = path
        self.file = validated(TaskFile, content, path)
        self.decision_ns = duration_ns(self.file.decision, f"{path}: decision")
        episode_ns = duration_ns(self.file.episode, f"{path}: episode")
        self.decisions, rest = divmod(episode_ns, max(self.decision_ns, 1))
        """After how many an episode is cut."""
        if rest or self.decisions < 1:
            raise InputError(
                f"{path}: episode: {self.file.episode!r} is not a whole number of decisions of "
                f"{self.file.decision!r}"
            )
        self.laws = {key: self._law(key) for key in self.file.vary}
        self.rewards = [self._reward(entry, at) for at, entry in enumerate(self.file.reward)]
        self.ends = [self._end(entry, at) for at, entry in enumerate(self.file.ends)]
        self.values = [
            self._expression(entry.value, f"observe.{at}.value")
            for at, entry in enumerate(self.file.observe)
        ]

    @property
    def rig(self) -> str:
        """Name of its rig or trial; a file's path is from the task's file on."""
        name = self.file.rig
        return str((self.path.parent / name).resolve()) if Path(name).suffix else name

    @property
    def decision(self) -> float:
        """Time from one action to the next, s."""
        return self.decision_ns / 1e9

    @property
    def signals(self) -> list[str]:
        """Names of all signals that the task reads."""
        found = [name for value in self.values for name in ex.signal_names(value)]
        for reward in self.rewards:
            says: Any = reward.says
            found += formulas.kinds(says) if reward.is_margin else ex.signal_names(says)
        found += [name for end in self.ends for name in formulas.kinds(end.when)]
        return sorted({*found})

    def require(self, name: str, known: Mapping[str, str], key: str = "") -> None:
        """Raise InputError for a signal that the system has not."""
        if name not in known:
            where = f"{self.path}: {key}" if key else str(self.path)
            raise InputError(f"{where}: {unknown('signal', name, known)}")

    def observed(self, units: Mapping[str, str]) -> list[Observed]:
        """Return the elements of the observation. Raises InputError for what does not fit."""
        return [
            self._observed(entry, value, units, f"observe.{at}")
            for at, (entry, value) in enumerate(zip(self.file.observe, self.values, strict=True))
        ]

    def acted(self, units: Mapping[str, str]) -> list[Acted]:
        """Return the elements of the action. Raises InputError for what does not fit."""
        found = []
        for at, entry in enumerate(self.file.act):
            where = f"{self.path}: act.{at}"
            self.require(entry.to, units, f"act.{at}.to")
            found.append(Acted(entry.to, *self._range(entry, units[entry.to], where)))
        return found

    def check(self, units: Mapping[str, str]) -> None:
        """Raise InputError for a reward or an end whose values do not measure what they must."""
        for at, reward in enumerate(self.rewards):
            says: Any = reward.says
            with _at(f"{self.path}: reward.{at} ({reward.name})"):
                if reward.is_margin:
                    formulas.check(says, units)
                elif found := says.exponents(units):
                    measured = ex.unit_of(says, units, found)
                    raise InputError(
                        f"a reward is a number without a unit, this one is in {measured!r}: divide "
                        f"it by what is worth 1, such as '/ 1 {measured}'"
                    )
        for at, end in enumerate(self.ends):
            with _at(f"{self.path}: ends.{at} ({end.name})"):
                formulas.check(end.when, units)

    # ------------------------------------------------------------------ entries

    def _law(self, key: str) -> Law:
        where = f"{self.path}: vary: {key}"
        law = read_distribution(self.file.vary[key], where)
        for level in law.levels:
            if (
                isinstance(level, bool)
                or (isinstance(level, str) and split_quantity(level) is None)
                or not isinstance(level, (str, int, float))
            ):
                raise InputError(
                    f"{where}: levels: quantities are needed, found {level!r}: texts are part of "
                    "the program"
                )
        return law

    def _expression(self, text: str, key: str) -> ex.Expression:
        with _at(f"{self.path}: {key}"):
            found = number_of(text)
            if is_of_record(found):
                raise InputError(f"{text!r}: it needs a whole record; an agent has the present")
            return found

    def _formula(self, text: str, key: str) -> formulas.Formula:
        with _at(f"{self.path}: {key}"):
            parsed = tree(text)
            if not isinstance(
                parsed, (*formulas.PREDICATES, formulas.Logic, formulas.Temporal, formulas.Until)
            ):
                raise InputError(f"{text!r}: 'settles' is of a whole record; a formula is needed")
            if texts := [n for n, kinds in formulas.kinds(parsed).items() if "text" in kinds]:
                raise InputError(f"{texts[0]} is a text, and copies in C have numbers alone")
            return parsed

    def _reward(self, entry: RewardEntry, at: int) -> Reward:
        key = f"reward.{at} ({entry.name})"
        limits = entry.between or ([-1.0, 1.0] if entry.margin else [-np.inf, np.inf])
        if not limits[0] < limits[1]:
            raise InputError(f"{self.path}: {key}: between: low below high, found {limits}")
        says: ex.Expression | formulas.Formula
        if entry.margin is not None:
            says = self._formula(entry.margin, key)
        else:
            says = self._expression(str(entry.value), key)
        return Reward(entry.name, says, entry.margin is not None, entry.weight, *limits)

    def _end(self, entry: EndEntry, at: int) -> End:
        from .margins import is_of_past

        key = f"ends.{at} ({entry.name})"
        when = self._formula(entry.when, key)
        if not is_of_past(when):
            raise InputError(
                f"{self.path}: {key}: {entry.when!r} looks ahead; an end is decided by what is and "
                "has been: once, historically, since"
            )
        return End(entry.name, when, entry.outcome == "success", entry.reward)

    def _observed(
        self, entry: ObserveEntry, value: ex.Expression, units: Mapping[str, str], key: str
    ) -> Observed:
        where = f"{self.path}: {key}"
        with _at(f"{where}.value"):
            measured = ex.unit_of(value, units, value.exponents(units))
        return Observed(value, *self._range(entry, measured, where, unit(measured)))

    def _range(
        self, entry: ObserveEntry | ActEntry, measured: str, where: str, scale: Unit | None = None
    ) -> tuple[float, float]:
        """Return low and high in the unit ``measured``, or SI, which bare numbers are, by scale."""
        with _at(f"{where}.range"):
            low, high = (
                quantity(written, measured) * scale.factor + scale.offset
                if scale is not None and isinstance(written, str)
                else quantity(written, measured)
                for written in entry.range
            )
            if not (np.isfinite(low) and np.isfinite(high) and low < high):
                raise InputError(f"low below high, found {entry.range}")
        return low, high


def in_port_unit(law: Law, port_unit: str, numbers: Floats) -> Floats:
    """Return numbers of a distribution in the unit of a port. Raises InputError."""
    if law.levels:
        levels = [quantity(level, port_unit) for level in law.levels]
        return np.array(levels, dtype=np.float64)[numbers.astype(np.intp)]
    if not law.unit:
        return numbers
    factor, offset = conversion(law.unit, port_unit)
    return numbers * factor + offset


class _at:  # noqa: N801  reads as a preposition
    """Says where a mistake stands."""

    def __init__(self, where: str) -> None:
        self._where = where

    def __enter__(self) -> None: ...

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, InputError):
            raise InputError(f"{self._where}: {error}") from None
