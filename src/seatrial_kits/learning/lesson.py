"""Lessons: rows for a network from run folders, and how much it leaves of what it learned."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import unit
from seatrial.system.files import read_toml, validated
from seatrial.system.rig import duration_ns
from seatrial.trial.criteria import expressions as ex
from seatrial.trial.criteria.grammar import tree
from seatrial.trial.criteria.metrics import TIME
from seatrial.trial.criteria.predicates import Comparison, Record
from seatrial.trial.records.run_folder import Run

from .fit import answers, fitted
from .lesson_file import Elements, LessonFile
from .network import MOST, Array
from .observation import number_of, pointed
from .policy_file import at, meaning


@dataclass(frozen=True)
class Rows:
    """What the network takes, (rows, observations), and is to give, (rows, actions)."""

    name: str
    taken: Array
    given: Array
    low: Array
    """Lowest values that the network takes, of rows that are no means; highest: ``high``."""
    high: Array


@dataclass(frozen=True)
class Remainder:
    """What a network leaves of one output in one run, root mean squares over rows and axes."""

    run: str
    output: str
    unit: str
    before: float
    after: float
    outside: float
    """Share of the rows outside of the ranges of training."""

    @property
    def share(self) -> float:
        """What is left, of what there was."""
        return self.after / self.before if self.before else float("inf")


class Lesson:
    """A lesson's file, read. Raises InputError naming the file and the key."""

    def __init__(self, path: Path) -> None:
        content, _ = read_toml(path)
        self.path, self.file = path, validated(LessonFile, content, path)
        self.meaning = meaning(path.parent / self.file.policy)
        self._inputs = self._expressions("inputs", self.file.inputs, self.meaning.inputs)
        self._outputs = self._expressions("outputs", self.file.outputs, self.meaning.outputs)
        self._where = [self._condition(n, text) for n, text in enumerate(self.file.where)]
        self._every = 0
        if self.file.every is not None:
            self._every = duration_ns(self.file.every, f"{path}: every")
        if not 1 <= min(self.file.hidden) <= max(self.file.hidden) <= MOST**0.5:
            raise InputError(f"{path}: hidden: layers of 1 to {int(MOST**0.5)} neurons are needed")

    def rows(self, run: Run) -> Rows:
        """Return what a run has for the network. Raises InputError naming the run."""
        with at(f"{run.folder}"):
            values = self._record(run)
            inputs = {
                pointed(name): self._evaluated("inputs", name, node, values, run.units)
                for name, node in self._inputs.items()
            }
            observed = [
                np.broadcast_to(n.evaluate(inputs), len(run.time)) for n in self.meaning.observed
            ]
            wanted = []
            for name in self.meaning.acted:
                found = self._evaluated("outputs", name, self._outputs[name], values, run.units)
                measure = unit(self.meaning.outputs[name])
                wanted.append((found - measure.offset) / measure.factor)
            kept = np.ones(len(run.time), dtype=bool)
            for number, condition in enumerate(self._where):
                with at(f"{self.path}: where.{number}"):
                    condition.check(run.units)
                kept &= condition.margins(Record(run.time, values))[0] >= 0.0
            both = np.column_stack([*observed, *wanted])
            means = self._averaged(run.time, both, kept)
            if not len(means):
                raise InputError("no row is left: the lesson's where holds nowhere")
            if not np.isfinite(both[kept]).all():
                raise InputError("a value that the lesson takes or gives is not finite")
            taken, given = np.split(means, [len(observed)], axis=1)
            seen = both[kept, : len(observed)]
        return Rows(str(run.folder), taken, given, seen.min(axis=0), seen.max(axis=0))

    def learned(self, runs: Sequence[Rows]) -> dict[str, Any]:
        """Return the arrays of a network that learned all runs; see `fit.fitted`."""
        arrays = fitted(
            np.concatenate([each.taken for each in runs]),
            np.concatenate([each.given for each in runs]),
            self.file.hidden,
            decay=self.file.decay,
            iterations=self.file.iterations,
            seed=self.file.seed,
        )
        return arrays | {
            "input_low": np.min([each.low for each in runs], axis=0),
            "input_high": np.max([each.high for each in runs], axis=0),
        }

    def remainders(self, arrays: Mapping[str, Any], rows: Rows) -> Iterator[Remainder]:
        """Yield what a network leaves of each output in a run."""
        error = rows.given - answers(arrays, rows.taken)
        low, high = arrays["input_low"], arrays["input_high"]
        outside = float(np.mean(np.any((rows.taken < low) | (rows.taken > high), axis=1)))
        ports = [name.partition(".")[0] for name in self.meaning.acted]
        for port in dict.fromkeys(ports):
            axes = [place for place, each in enumerate(ports) if each == port]
            measure = self.meaning.outputs[self.meaning.acted[axes[0]]]
            before, after = (float(np.sqrt(np.mean(e[:, axes] ** 2))) for e in (rows.given, error))
            yield Remainder(rows.name, port, measure, before, after, outside)

    def _expressions(
        self, key: str, written: Elements, units: Mapping[str, str]
    ) -> dict[str, ex.Expression]:
        found: dict[str, ex.Expression] = {}
        for port, entry in written.items():
            elements = entry if isinstance(entry, dict) else {"": entry}
            for axis, text in elements.items():
                name = f"{port}.{axis}" if axis else port
                if name not in units:
                    raise InputError(f"{self.path}: {key}: {unknown('element', name, units)}")
                with at(f"{self.path}: {key}.{name}"):
                    found[name] = number_of(text)
        if left := [name for name in units if name not in found]:
            raise InputError(f"{self.path}: {key}: {left[0]!r} of {self.file.policy} is not there")
        return found

    def _condition(self, number: int, text: str) -> Comparison:
        with at(f"{self.path}: where.{number}"):
            parsed = tree(text)
            if not isinstance(parsed, Comparison):
                raise InputError(f"{text!r}: a comparison is needed, such as 'a.b < 1 m'")
            return parsed

    def _record(self, run: Run) -> dict[str, Array]:
        """Return the columns of numbers that the lesson needs, SI, and the time."""
        nodes = [*self._inputs.values(), *self._outputs.values()]
        names = {name for node in nodes for name in ex.signal_names(node)}
        names |= {name for condition in self._where for name in condition.kinds}
        values = dict[str, Array]()
        for name in sorted(names):
            if name not in run.signals:
                raise InputError(unknown("signal", name, run.signals))
            if isinstance(run.signals[name], list):
                raise InputError(f"{name} holds text, not numbers")
            measure = unit(run.units[name])
            values[name] = run.signals[name] * measure.factor + measure.offset
        return {**values, TIME: run.time}

    def _evaluated(
        self,
        key: str,
        name: str,
        node: ex.Expression,
        values: Mapping[str, Array],
        units: Mapping[str, str],
    ) -> Array:
        """Return an expression's values, SI. Raises InputError if it measures something else."""
        wanted = getattr(self.meaning, key)[name]
        with at(f"{self.path}: {key}.{name}"):
            exponents = node.exponents(units)
            if exponents != unit(wanted).exponents:
                own = ex.unit_of(node, units, exponents)
                raise InputError(f"{ex.written(node)} is in {own}, {wanted} is needed")
        found: Array = np.empty(len(values[TIME]))
        with np.errstate(all="ignore"):  # what is not finite is refused with all else
            found[:] = node.evaluate(values)
        return found

    def _averaged(self, time: Array, rows: Array, kept: Any) -> Array:
        """Return the kept rows; of those within ``every`` the mean, if all are kept."""
        if not self._every or not len(time):
            chosen: Array = rows[kept]
            return chosen
        bins = np.round((time - time[0]) * 1e9).astype(np.int64) // self._every
        places, index = np.unique(bins, return_inverse=True)
        count = np.bincount(index)
        whole = np.bincount(index, weights=kept) == count
        sums = np.zeros((len(places), rows.shape[1]))
        np.add.at(sums, index, np.where(kept[:, None], rows, 0.0))
        found: Array = sums[whole] / count[whole, None]
        return found
