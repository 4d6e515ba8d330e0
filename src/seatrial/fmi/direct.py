"""A component run in process, without FMI: for sweeps, tests and identification."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any

from ..errors import DiscardError, InputError, SimulationError
from ..model.component import Component
from ..model.plant import Plant
from ..model.ports import Input, Parameter, ScalarPort
from .compiled_functions import compiled_function
from .dependencies.found import Through, feedthrough_of
from .instance import ByType, Reader, Value, Variable, Variables, Writer


class DirectInstance(ByType):
    """A component as the master sees it; the same calls in the same order as for its FMU.

    ``compiles``: the equations of a plant become machine code, where there is a compiler.
    ``through`` is what its outputs depend on, where somebody knows; it is found out otherwise.
    """

    def __init__(
        self, component: Component, *, compiles: bool = True, through: Through | None = None
    ) -> None:
        self.component = component
        self.name = component.name
        self.variables = Variables({s.name: _variable(component, s) for s in component.scalars})
        self._through = through
        self.rolls_back, self.at_once = component.rolls_back, False
        self.any_step = not component.fixed_step
        self.restarts = True
        self.ended_at: float | None = None
        self.terminals, self.views = component.terminals, component.views
        if compiles and isinstance(component, Plant):
            component.machine = compiled_function
        self._publishes = any(port.kind == "output" for port in component.ports.values())
        self._stepped = False
        """The outputs of the last step have not been computed yet."""

    @cached_property
    def feedthrough(self) -> dict[str, list[str]]:
        """The inputs that act on each output at the same instant."""
        through = feedthrough_of(type(self.component)) if self._through is None else self._through
        ports = self.component.ports
        return {
            scalar: [name for port in inputs for name in ports[port].scalar_names]
            for output, inputs in through.items()
            if inputs
            for scalar in ports[output].scalar_names
        }

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""
        for name, value in values.items():
            self._call("set", partial(self.component.set, name, value))

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._call("setup", lambda: self.component.setup(start_time))
        self._call("initialise", self.component.initialise)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("begin", self.component.begin)

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s; the outputs follow when they are read.

        Most depend on inputs that are written before. An error of either is a discarded step, as
        in the FMU.
        """
        try:
            self.component.advance(t, h, publish=not self._publishes)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # SystemExit too, as in the FMU
            raise DiscardError(str(self._error("step", error))) from error
        self._stepped = self._publishes

    def get_state(self) -> Any:
        """Return a copy of the whole state."""
        return self._call("get_state", self.component.get_state)

    def set_state(self, state: Any) -> None:
        """Restore a state."""
        self._call("set_state", lambda: self.component.set_state(state))

    def free_state(self, state: Any) -> None:
        """Release a state: nothing to do in process."""

    def reset(self) -> None:
        """Return to before `set_start`."""
        self._call("close", self.component.close)
        self._call("reset", self.component.begin_anew)

    def terminate(self) -> None:
        """End the run."""
        self._call("close", self.component.close)

    def free(self) -> None:
        """Release everything."""
        self._call("close", self.component.close)

    def _reader(self, variables: list[Variable], kind: Any) -> Reader:
        own = self.component.reader([v.reference for v in variables], kind)

        def read() -> list[Any]:
            try:
                values = own()
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # SystemExit too, as in the FMU
                if self._stepped:
                    raise DiscardError(str(self._error("step", error))) from error
                raise self._error("read", error) from error
            self._stepped = False
            return values

        return read

    def _writer(self, variables: list[Variable], kind: Any) -> Writer:
        own = self.component.writer([v.reference for v in variables], kind)

        def write(values: Sequence[Any]) -> None:
            try:
                own(values)
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                raise self._error("write", error) from error

        return write

    def _call(self, what: str, call: Callable[[], Any]) -> Any:
        try:
            return call()
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # SystemExit too, as in the FMU
            raise self._error(what, error) from error

    def _error(self, what: str, error: BaseException) -> SimulationError:
        if isinstance(error, (InputError, SimulationError)):
            return SimulationError(str(error))
        text = "".join(traceback.format_exception(error)).strip()
        return SimulationError(
            f"{self.name}: {what} at t = {self.component.now!r} s raised\n{text}"
        )


def _variable(component: Component, scalar: ScalarPort) -> Variable:
    port = scalar.port
    tunable = isinstance(port, Parameter) and port.tunable
    continuous = port.type is float and not component.discrete
    varying = "continuous" if continuous else "discrete"
    return Variable(
        name=scalar.name,
        causality=port.kind,
        variability=("tunable" if tunable else "fixed") if port.kind == "parameter" else varying,
        type=port.type,
        reference=scalar.reference,
        unit=scalar.unit if port.type is float else "",
        start=None if port.kind == "output" else component.values[scalar.reference],
        minimum=port.limit("min", scalar.index),
        maximum=port.limit("max", scalar.index),
        nominal=port.limit("nominal", scalar.index),
        description=port.description,
        optional=isinstance(port, Input) and port.optional,
        role=port.role,
        frame=port.frame,
        term_of=port.term_of if isinstance(port, Input) else "",
    )
