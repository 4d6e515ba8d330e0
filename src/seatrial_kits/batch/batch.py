"""Copies of a rig in compiled code, with arrays of a row per copy."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from seatrial.api.assembling import assembled
from seatrial.api.signal import Signal, described
from seatrial.errors import InputError, SimulationError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from seatrial.trial.files.trial import Trial
    from seatrial_kits.native.surroundings import Met

    from .splitting import Split

    Floats = NDArray[np.float64]

MOST_THREADS = 64


class BatchState:
    """The states of all copies at one moment; `Batch.save` makes one."""

    def __init__(self, batch: Batch, states: Any, steps: NDArray[np.int64]) -> None:
        self.batch, self.states, self.steps = batch, states, steps
        self.met = {name: list(met) for name, met in batch._met.items()}
        """What surrounds each plant that can meet weather, in each copy."""


class Batch:
    """``count`` copies of a rig or a trial, all in compiled code, that the caller steps together.

    ``rig``, ``set``, ``variant``, ``step`` and ``choices`` are those of `seatrial.Simulation`; a
    value of ``set`` may also be an array with a row for each copy. ``seed`` is the first copy's
    (None: the trial's, or 1), the next has the next one, or a sequence with a seed for each.
    ``threads`` share the copies. Of a trial's faults a copy has those of
    devices, and outputs that are fixed or stuck.

    Copy i has the bytes of a `Simulation` with ``engine="native"``, its seed and its settings, on
    any number of threads. A copy that fails keeps its values and its message (`failures`) and is
    passed over until it is started anew; the others go on.

    Raises InputError for bad input, for a rig that cannot start with it, for one with components
    that have no C, naming them, and without a compiler.
    """

    def __init__(
        self,
        rig: str | Path | Trial,
        count: int,
        *,
        set: Mapping[str, Any] | None = None,
        seed: int | Sequence[int] | None = None,
        variant: str | None = None,
        step: float | str | None = None,
        choices: Mapping[str, str] | None = None,
        threads: int = 1,
    ) -> None:
        import numpy as np

        from .course import Course
        from .program import program_of
        from .settings import Settings, first_of, give_built_in, is_weather, take_weather

        if count < 1:
            raise InputError(f"Batch: the count is {count}, at least 1 is needed")
        if not 1 <= threads <= MOST_THREADS:
            raise InputError(f"Batch: threads is {threads}, allowed 1 to {MOST_THREADS}")
        self.count, self.threads = count, threads
        given = dict(set or {})
        weather_keys = {
            key: first_of(value, count) for key, value in given.items() if is_weather(key)
        }
        made = assembled(
            rig, weather_keys, variant=variant, engine="native", step=step, choices=choices
        )
        self.made, self.system = made, made.system
        try:
            self.seeds = self._seeds(made.system.seed if seed is None else seed)
            """Of each copy."""
            rest = {k: v for k, v in given.items() if np.ndim(v) or not is_weather(k)}
            of_copies = give_built_in(made, rest)
            weather = take_weather(self.system)
            program = program_of(self.system)
            self._settings = Settings(made, program.references, count, weather)
            self._settings.change(of_copies, "set")
            self._course = Course(made, program.step_ns)
        except BaseException:
            self.system.discard()
            raise
        self._nodes = list(self.system.parts)
        self.step_size = program.step_ns / 1e9
        """Communication step, s."""
        self._library = program.library
        self._batch = self._library.batch_new(count)
        if not self._batch:
            self.system.discard()
            raise InputError(f"Batch: there is no memory for {count} copies")
        self._free = weakref.finalize(self, _freed, self._library, self._batch, self.system)
        self._met: dict[str, list[Met | None]] = {}
        """What surrounds each plant that can meet weather, in each copy; C calls it."""
        self._start(np.ones(count, dtype=bool))

    # ------------------------------------------------------------------ time

    @property
    def time(self) -> Floats:
        """Simulated time of each copy, s, shape (count,)."""
        import numpy as np

        return np.asarray(self._times()[0] * self.step_size, dtype=np.float64)

    def step(self, count: int = 1, mask: ArrayLike | None = None) -> None:
        """Let the copies of ``mask`` (count,), or all, take ``count`` communication steps.

        Copies that have failed take none. Raises InputError.
        """
        self._refuse_closed()
        chosen = self._mask(mask)
        if count < 0:
            raise InputError(f"step: the count is {count}, it cannot be negative")
        before, failed = self._times()
        while count and (chosen & ~failed).any():
            ahead = self._course.ahead(before[chosen & ~failed], count)
            self._advance(ahead, chosen)
            count -= ahead
            before, failed = self._acted(before)

    def record(self, count: int, *names: str, mask: ArrayLike | None = None) -> Floats:
        """Take ``count`` communication steps, and return values after each, as `get` names them.

        Shape (copies, count, elements); NaN from the step on in which a copy fails, and of copies
        outside the ``mask`` (count,), which take none. Raises InputError.
        """
        import numpy as np

        self._refuse_closed()
        references, chosen = self._settings.read(names), self._mask(mask)
        blocks, (before, failed) = [np.empty((self.count, 0, len(references)))], self._times()
        while count > 0:
            going = chosen & ~failed
            ahead = self._course.ahead(before[going], count) if going.any() else count
            rows = np.full((self.count, ahead, len(references)), np.nan)
            self._advance(ahead, chosen, references, rows)
            count -= ahead
            before, failed = self._acted(before)
            if self._course:  # the last row has what events of its time have made of it
                last = np.empty((self.count, len(references)))
                self._library.batch_get(self._batch, _at(references), len(references), _at(last))
                rows[chosen & ~failed, -1] = last[chosen & ~failed]
            blocks.append(rows)
        return np.concatenate(blocks, axis=1)

    @property
    def failures(self) -> dict[int, str]:
        """By number of each copy that cannot go on: why."""
        import numpy as np

        failed = np.flatnonzero(self._times()[1])
        message = self._library.batch_message
        return {int(i): message(self._batch, int(i)).decode() for i in failed}

    # ------------------------------------------------------------------ values

    @property
    def signals(self) -> dict[str, Signal]:
        """All outputs by name, in the order of the rig."""
        return described(self.system, "output")

    @property
    def inputs(self) -> dict[str, Signal]:
        """All inputs by name."""
        return described(self.system, "input")

    @property
    def parameters(self) -> dict[str, Signal]:
        """All parameters by name."""
        return described(self.system, "parameter")

    def get(self, *names: str) -> Floats:
        """Return present values: outputs, inputs that nothing feeds, parameters, in their units.

        Shape (count,) of one scalar; (count, n) of a port with n elements, or of several names,
        side by side. Numbers alone: true is 1.0; NaN is what a failed copy has no more. Raises
        InputError.
        """
        import numpy as np

        self._refuse_closed()
        references = self._settings.read(names)
        values = np.full((self.count, len(references)), np.nan)
        self._library.batch_get(self._batch, _at(references), len(references), _at(values))
        is_scalar = len(names) == 1 and self._settings.is_scalar(names[0])
        return values[:, 0] if is_scalar else values

    def set(self, name: str, value: ArrayLike | str, mask: ArrayLike | None = None) -> None:
        """Set an input that nothing feeds, or a tunable parameter, from now on.

        ``value`` is one for all copies, as `Simulation.set` takes it, or an array with a row for
        each; ``mask`` (count,) says of which copies. An input of text, as that of a device's fault,
        has one text. Raises InputError.
        """
        self._refuse_closed()
        chosen, text = self._mask(mask), self._settings.text(name)
        if text is not None:
            if not isinstance(value, str):
                raise InputError(f"set: {name} is a text, found {value!r}")
            self._library.batch_set_text(self._batch, _at(chosen), text, value.encode())
            return
        references, values = self._settings.running(name, value)
        self._library.batch_set(
            self._batch, _at(chosen), _at(references), len(references), _at(values)
        )

    def override(self, name: str, value: ArrayLike | str, mask: ArrayLike | None = None) -> None:
        """Replace an output for all its readers, from now on, until `release` or a start.

        ``value`` and ``mask`` as for `set`. Raises InputError.
        """
        self._refuse_closed()
        chosen = self._mask(mask)
        references, values = self._settings.overriding(name, value)
        self._library.batch_override(
            self._batch, _at(chosen), _at(references), len(references), _at(values)
        )

    def release(self, name: str, mask: ArrayLike | None = None) -> None:
        """End an override: the output has its own value again. Raises InputError."""
        self._refuse_closed()
        chosen = self._mask(mask)
        references, _ = self._settings.overriding(name, None)
        self._library.batch_override(
            self._batch, _at(chosen), _at(references), len(references), None
        )

    def settings(self, copy: int) -> dict[str, Any]:
        """Return what a copy has started with beside the rig's or trial's own: its settings.

        ``run_trial(trial, set=batch.settings(3))`` runs it alone, into a folder with its record;
        ``Simulation`` takes the seed apart. Raises InputError for a number that no copy has.
        """
        if not 0 <= copy < self.count:
            raise InputError(f"settings: copy is {copy}, allowed 0 to {self.count - 1}")
        return {"seed": int(self.seeds[copy]), **self._settings.of(copy)}

    def is_built_in(self, name: str) -> bool:
        """Say if a value is part of the program, so that `reset` refuses it. Raises InputError."""
        from .settings import is_built_in

        return any(is_built_in(self.made, each) for each in self.made.named(name))

    # ------------------------------------------------------------------ life

    def reset(
        self,
        mask: ArrayLike | None = None,
        *,
        set: Mapping[str, Any] | None = None,
        seed: int | Sequence[int] | None = None,
    ) -> None:
        """Start copies anew, at time 0, those of ``mask`` (count,) or all.

        ``set`` changes parameters and start values from now on, fixed ones too: one value for all
        copies, or an array with a row for each. ``seed`` replaces the seeds of these copies.
        Raises InputError, naming what is built into the program: texts and structure.
        """
        import numpy as np

        self._refuse_closed()
        chosen = self._mask(mask)
        seeds = self.seeds if seed is None else self._seeds(seed)
        before = self.seeds, self._settings.change(set or {}, "reset", chosen)
        try:
            self.seeds = np.where(chosen, seeds, self.seeds)
            self._start(chosen)
        except InputError:
            self.seeds = before[0]
            self._settings.undo(before[1])
            raise

    def save(self) -> BatchState:
        """Return the states of all copies. Raises SimulationError without memory for them."""
        self._refuse_closed()
        states = (ctypes.c_void_p * self.count)()
        if not self._library.batch_save(self._batch, states):
            raise SimulationError(f"save: there is no memory for {self.count} states")
        saved = BatchState(self, states, self._times()[0])
        weakref.finalize(saved, self._release, states).atexit = False
        return saved

    def restore(
        self,
        state: BatchState,
        mask: ArrayLike | None = None,
        *,
        source: ArrayLike | None = None,
        seed: int | Sequence[int] | None = None,
    ) -> None:
        """Let the copies of ``mask`` (count,), or all, go on from a state that this batch saved.

        ``source`` (count,) says from which copy's state each goes on, if not from its own.
        Parameters and weather come with a state, until the copy starts anew. ``seed``, as of
        `Batch`, lets the noise of components from there on be another: copies of one state go ways
        of their own. Raises InputError.
        """
        import numpy as np

        from .per_copy import sources_of

        self._refuse_closed()
        if state.batch is not self:
            raise InputError("restore: this is the state of another batch")
        chosen, numbers = self._mask(mask), sources_of(source, self.count)
        for name, met in state.met.items():
            self._surround(name, chosen, [met[copy] for copy in numbers.tolist()])
        origin = np.where(chosen, numbers, -1).astype(np.int64)
        self._library.batch_restore(self._batch, state.states, _at(origin), _at(state.steps))
        if seed is not None:
            references, seeds = self._settings.noise(self._seeds(seed))
            count = len(references)
            self._library.batch_reseed(self._batch, _at(chosen), _at(references), count, _at(seeds))

    def split(self, name: str, levels: Sequence[float], until: float, *, seed: int = 1) -> Split:
        """Return how likely ``name`` rises to the last of rising ``levels`` before ``until``, s.

        Copies go on from now; at each level, those that reach it are split, so that all go on from
        there with noise of their own: fixed-effort splitting (Garvels 2000, The splitting method in
        rare event simulation), unbiased for any levels. What is random is the noise of components;
        weather stays. ``seed`` draws which states are split, and the seeds from there on.

        Raises InputError for bad input, SimulationError for a copy that cannot go on.
        """
        from .splitting import split

        return split(self, name, levels, until, seed)

    def close(self) -> None:
        """Release the copies; more than once does nothing."""
        self._free()

    def __enter__(self) -> Batch:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __len__(self) -> int:
        return self.count

    def __repr__(self) -> str:
        closed = "" if self._free.alive else ", closed"
        return f"<Batch of {self.count} x {self.system.rig.read_from.name}{closed}>"

    # ------------------------------------------------------------------ inside

    def _advance(
        self,
        count: int,
        chosen: NDArray[np.bool_],
        references: NDArray[np.uint32] | None = None,
        rows: Floats | None = None,
    ) -> None:
        wanted = 0 if references is None else len(references)
        places = [None if array is None else _at(array) for array in (references, rows)]
        threads = min(self.threads, self.count)
        where = self._batch, _at(chosen)
        self._library.batch_step(*where, count, threads, places[0], wanted, places[1])

    def _acted(self, before: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Let events of the copies' times happen; return the steps of each, and which failed."""
        steps, failed = self._times()
        if self._course:
            self._course.act(self, steps, steps > before)
            failed = self._times()[1]
        return steps, failed

    def _start(self, chosen: NDArray[np.bool_]) -> None:
        references, values = self._settings.rows(self.seeds)
        for name, met in self._settings.surroundings(chosen).items():
            self._surround(name, chosen, met)
        self._library.batch_start(
            self._batch, _at(chosen), _at(references), len(references), _at(values)
        )
        for number, why in self.failures.items():
            if chosen[number]:
                raise InputError(
                    f"{self.system.rig.read_from.path}: copy {number} cannot start: {why}"
                )
        self._course.act(self, self._times()[0], chosen)

    def _surround(self, name: str, chosen: NDArray[np.bool_], met: Sequence[Met | None]) -> None:
        """Let a plant meet what surrounds it, in each chosen copy."""
        from seatrial_kits.native.surroundings import NOTHING

        of_all = self._met.setdefault(name, [None] * self.count)
        node = self._nodes.index(name)
        for copy in chosen.nonzero()[0].tolist():
            if of_all[copy] is not met[copy]:
                of_all[copy] = met[copy]
                found = met[copy] or NOTHING
                self._library.batch_surround(self._batch, copy, node, found.function, found.of)

    def _seeds(self, seed: int | Sequence[int]) -> NDArray[np.int64]:
        from .per_copy import seeds_of

        return seeds_of(seed, self.count)

    def _mask(self, mask: ArrayLike | None) -> NDArray[np.bool_]:
        from .per_copy import mask_of

        return mask_of(mask, self.count)

    def _times(self) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        import numpy as np

        self._refuse_closed()
        steps, failed = np.empty(self.count, dtype=np.int64), np.empty(self.count, dtype=bool)
        self._library.batch_times(self._batch, _at(steps), _at(failed))
        return steps, failed

    def _release(self, states: Any) -> None:
        if self._free.alive:
            self._library.batch_free_states(self._batch, states)

    def _refuse_closed(self) -> None:
        if not self._free.alive:
            raise InputError("this batch is closed")


def _at(array: NDArray[Any]) -> int:
    """Return where an array without gaps has its numbers."""
    return int(array.ctypes.data)


def _freed(library: ctypes.CDLL, batch: int, system: Any) -> None:
    library.batch_free(batch)
    system.free()
