"""Craft in surroundings that are known functions of time and place: waves, current, wind."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from ...errors import SimulationError
from ...model.expressions import Model, Vector, bind, compile_model, rk4_between
from ...model.plant import Plant
from ...model.ports import Input, Port

Surroundings = Callable[[float, Vector], Vector]
"""What the equations take beside their inputs, stacked, of the time, s, and the state."""

_SPACING = 0.05
"""s: shorter communication steps share two evaluations that lie no further apart than this."""


class SurroundedPlant(Plant):
    """Plant whose equations take ``surrounding_ports`` too, if `met` returns surroundings.

    These are evaluated at the ends of communication steps, no more often than every 50 ms, where
    the state is extrapolated from the step before. Between two evaluations, D apart, they are the
    cubic through these and the two before: a wave of frequency w is met within 0.042 (w D)^4 of
    its amplitude, without the delay of an input that is held.

    Without surroundings a plant runs on its equations as if there were none to be met:
    `equations` then finds no such names among the inputs. Linearisation, trim and the reference
    integration are of that plant.
    """

    surrounding_ports: ClassVar[tuple[Port, ...]] = ()
    transient = Plant.transient | {"_met", "_bound"}
    _surrounded_models: ClassVar[dict[tuple[str, ...], tuple[Model, Any]]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls._surrounded_models = {}

    def met(self) -> Surroundings | None:
        """Return the surroundings that the parameters say, or None. Raises InputError."""
        return None

    def surrounded(self) -> tuple[Model, ca.Function]:
        """Return the equations among surroundings, compiled, and their step `rk4_between`."""
        key = tuple(getattr(self, name) for name in self._texts)
        if key not in self._surrounded_models:
            model = self._compile_surrounded(dict(zip(self._texts, key, strict=True)))
            self._surrounded_models[key] = model, rk4_between(model.rhs)
        return self._surrounded_models[key]

    def start(self, t: float) -> None:
        """Start from the start values, among the surroundings there."""
        super().start(t)
        self._met = self.met()
        self._around: Vector | None = None
        if self._met is not None:
            self._around = self._meet(t, self._x)
            # The plant without surroundings says what came before: it only looks ahead.
            self._x_before = self._x - self.derivatives(self._x)
            self._spans = (1.0, 0)
            self._shares, self._evaluated = np.zeros((0, 0, 4)), np.zeros((4, len(self._around)))
            self._done = 0
            self._bind_surrounded()

    def step(self, t: float, h: float) -> None:
        """Integrate over ``h`` with inputs held, among surroundings that change."""
        if self._around is None:
            super().step(t, h)
            return
        count = max(1, math.ceil(h / self.max_step - 1e-9))
        self._look_ahead(t, h, count)
        shares, met = self._shares[self._done], self._evaluated
        # One product after the other: as C has it, to the bit.
        around = shares[:, :1] * met[0]
        for i in range(1, 4):
            around += shares[:, i : i + 1] * met[i]
        bound = self._bound
        self._x_before[:] = self._x
        self._load()
        bound.inputs[:] = self._u
        self._h[0] = h / count
        for i in range(count):
            bound.around[:] = around[2 * i : 2 * i + 3]
            bound.advance()
            self._x[:] = self._x1
        self._around = around[-1]
        self._done += 1

    def outputs(self, t: float) -> None:
        """Publish the states and what follows from them, the inputs and the surroundings."""
        if self._around is None:
            super().outputs(t)
            return
        self._publish(self._state_runs, self._x.tolist())
        if self.output_ports:
            self._load()
            self._bound.inputs[:] = self._u
            self._bound.around[0] = self._around
            self._bound.publish()
            self._publish(self._output_runs, self._y.tolist())

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        if state.get("_around") is not None:
            self._met = self.met()
            self._bind_surrounded()

    # ------------------------------------------------------------------ inside

    def _meet(self, t: float, x: Vector) -> Vector:
        """Return the surroundings. Raises SimulationError where they have no value."""
        assert self._met is not None
        with contextlib.suppress(ValueError, OverflowError):
            found = self._met(t, x)
            if np.isfinite(found).all():
                return found
        raise SimulationError(
            f"{self.name}: there is no value for what surrounds it at t = {t!r} s"
        )

    def _look_ahead(self, t: float, h: float, count: int) -> None:
        """Evaluate the surroundings ahead, if the step leaves what is evaluated.

        ``_evaluated`` has two evaluations before t, that at t and one ahead, ``_shares`` what each
         contributes, for each step between the last two: at its beginning, in the middle and
        at the end of each of ``count`` sub-steps.
        """
        if self._spans == (h, count) and self._done < len(self._shares):
            return
        slope = (self._x - self._x_before) / self._spans[0]
        self._done = 0
        if self._spans == (h, count):
            apart = len(self._shares) * h
            self._evaluated[:-1] = self._evaluated[1:]
            self._evaluated[-1] = self._meet(t + apart, self._x + apart * slope)
            return
        # The first step, or one of another length than those before.
        self._spans = (h, count)
        steps = max(1, math.floor(_SPACING / h + 1e-9))
        self._shares = _cubic(steps, count)
        apart = steps * h
        self._evaluated = np.array(
            [self._meet(t + j * apart, self._x + j * apart * slope) for j in range(-2, 2)]
        )

    def _bind_surrounded(self) -> None:
        assert self._around is not None
        model, rk4 = self.surrounded()
        inputs = len(self._u)
        u = np.zeros((3, inputs + len(self._around)))
        held, advance = bind(self.machine(rk4), [self._x, *u, self._p, self._h], self._x1)
        out, publish = bind(self.machine(model.out), [self._x, u[0], self._p], self._y)
        self._bound = _Bound(u[:, :inputs], u[:, inputs:], advance, publish, (u, held, out))

    @classmethod
    def _compile_surrounded(cls, texts: Mapping[str, str]) -> Model:
        stub = cls.__new__(cls)  # has the methods and no values
        return compile_model(
            cls.__name__,
            stub.equations,
            cls.state_ports,
            [*cls.input_ports, *cls.surrounding_ports],
            cls.parameter_ports,
            cls.output_ports,
            texts,
        )


@dataclass(frozen=True, eq=False)
class _Bound:
    """Compiled functions with the arrays that they read: inputs and surroundings, stacked."""

    inputs: Vector
    """At the beginning, in the middle and at the end of a sub-step."""
    around: Vector
    advance: Callable[[], None]
    publish: Callable[[], None]
    kept: tuple[Any, ...]
    """What the calls need and do not keep."""


def surrounding(name: str, unit: str, description: str, axes: str | tuple[str, ...]) -> Port:
    """Return a port of the surroundings: the equations find it by ``name`` among the inputs."""
    port = Input(unit, description, axes=axes)
    port.name = name
    return port


def _cubic(steps: int, count: int) -> Vector:
    """Return shares (steps, 2 count + 1, 4) of values at -2, -1, 0, 1 in those from 0 to 1.

    Lagrange's cubic, for each step at ends and middles of ``count`` parts.
    """
    begins = np.arange(steps)[:, None] / steps
    s = begins + np.arange(2 * count + 1) / (2 * count * steps)
    below, before, at, ahead = s + 2, s + 1, s, s - 1
    shares = [
        -before * at * ahead / 6,
        below * at * ahead / 2,
        -below * before * ahead / 2,
        below * before * at / 6,
    ]
    return np.stack(shares, -1)
