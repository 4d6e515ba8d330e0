"""The cases of a campaign by number: each is made when it is asked for: there may be many."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any, overload

from seatrial.system.fault_entry import FaultEntry
from seatrial.trial.files.fault_keys import changed_faults, named_keys
from seatrial.trial.files.trial import Trial

from .cases import Case, case_name

FAULTS = "faults"
"""Key by which a case says which faults it has."""


@dataclass(frozen=True)
class Block:
    """The cases of one trial: combinations of a grid, of what was drawn, of faults, of factors.

    The last changes fastest, and of the grid its last key.
    """

    base: Trial
    """With what all cases set."""
    common: Mapping[str, Any]
    grid: Mapping[str, Sequence[Any]]
    rows: Sequence[Mapping[str, Any]]
    """Settings that a design has drawn; one without any if there is no design."""
    faults: Mapping[str, Sequence[FaultEntry]]
    crossed: Sequence[str | None]
    """Faults of which each is a case; None is the one without, or with those of its row."""
    scales: Sequence[tuple[str, float] | None]
    """Keys with the factor of each; None is the case as it is."""
    where: str
    """Where the settings are written."""
    where_scaled: str

    def __len__(self) -> int:
        combinations = math.prod(len(values) for values in self.grid.values())
        return combinations * len(self.rows) * len(self.crossed) * len(self.scales)

    def case(self, number: int) -> Case:
        """Return a case by its number in the block, from 0."""
        number, scaled = divmod(number, len(self.scales))
        number, crossed = divmod(number, len(self.crossed))
        number, row = divmod(number, len(self.rows))
        chosen: dict[str, Any] = {}
        for key in reversed(list(self.grid)):
            number, place = divmod(number, len(self.grid[key]))
            chosen = {key: self.grid[key][place], **chosen}
        chosen.update(self.rows[row])
        failing = self.crossed[crossed]
        found = chosen if failing is None else {**chosen, FAULTS: failing}
        named = found.get(FAULTS)
        of_faults = named_keys(found, self.faults)
        found = {k: v for k, v in found.items() if of_faults.get(k, named) == named}
        scale = self.scales[scaled]
        shown = found if scale is None else {**found, f"{scale[0]} times": scale[1]}

        def made() -> Trial:
            changes = {k: v for k, v in found.items() if k != FAULTS and k not in of_faults}
            trial = self.base.changed(changes, self.where)
            if named is not None:
                own = {key: value for key, value in found.items() if key in of_faults}
                trial = trial.with_faults(changed_faults(self.faults[named], own, self.where))
            return trial if scale is None else trial.scaled(*scale, self.where_scaled)

        return Case(case_name(self.base, shown), made, {**self.common, **shown}, self.base.name)


class Cases(Sequence[Case]):
    """The cases of several blocks, one block after the other."""

    def __init__(self, blocks: Iterable[Block]) -> None:
        self.blocks = [block for block in blocks if len(block)]
        self._ends = list(accumulate(len(block) for block in self.blocks))

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @overload
    def __getitem__(self, number: int) -> Case: ...

    @overload
    def __getitem__(self, number: slice) -> list[Case]: ...

    def __getitem__(self, number: int | slice) -> Case | list[Case]:
        if isinstance(number, slice):
            return [self[n] for n in range(*number.indices(len(self)))]
        if number < 0:
            number += len(self)
        if not 0 <= number < len(self):
            raise IndexError(number)
        block = bisect_right(self._ends, number)
        return self.blocks[block].case(number - (self._ends[block - 1] if block else 0))
