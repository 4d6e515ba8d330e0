"""Instances of FMI 3.0 co-simulation FMUs: early returns, event mode, arrays."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, ClassVar

import fmpy
from fmpy import fmi3

from ..errors import SimulationError
from .arrays import ArrayCall
from .fmuinstance import FmuInstance
from .instance import Reader, Variable, Writer
from .loaded import LoadedFmu
from .messages import ACCEPTED

_MOST_RETURNS = 10_000
"""Early returns from one step."""
_MOST_UPDATES = 1_000
"""Iterations of one event."""
_LARGEST_FLOAT32 = 3.4028235677973366e38  # what rounds to a greater one is infinite


class _State:
    """The FMU's state and what of it only the importer knows."""

    def __init__(self, handle: ctypes.c_void_p, written: dict[int, list[Any]]) -> None:
        self.handle, self.written = handle, written


class Fmi3Instance(FmuInstance):
    """An instance of an FMI 3.0 FMU: one get and one set per type, in arrays allocated once.

    With event mode, what is not continuous is set in an event, as soon as anything else is
    asked of the FMU: all that changed at one communication point is one event.
    """

    _prefix: ClassVar[str] = "fmi3"
    _state_word: ClassVar[str] = "FMUState"
    _platform: ClassVar[str] = fmpy.platform_tuple
    _library: ClassVar[type[Any]] = fmi3.FMU3Slave

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._has_events = bool(fmu.description.coSimulation.hasEventMode)
        self._stepping = False
        self._waiting: list[Callable[[], None]] = []
        """Sets for the next event."""
        self._written: dict[int, list[Any]] = {}
        """Arrays as last written, by value reference, where that must be known."""
        self._event, self._end, self._early, self._more = (ctypes.c_bool() for _ in range(4))
        self._reached = ctypes.c_double()
        super().__init__(fmu, name)
        self._never_back = not self.rolls_back

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        stops = math.isfinite(stop_time)
        stop = stop_time if stops else 0.0
        self._call("EnterInitializationMode", False, 0.0, start_time, stops, stop)
        self._messages.forward()

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        if self._has_events:
            self._update()
            self._call("EnterStepMode")
        self._stepping = True
        self._messages.forward()

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s, through all events on the way."""
        self._flush()
        now, end, length = t, t + h, h
        for _ in range(_MOST_RETURNS):
            self._do_step(now, length)
            if self._event.value and self._has_events:
                self._in_event([])
            if not self._early.value or not self._reached.value < end - 2 * math.ulp(end):
                break
            now = max(now, self._reached.value)
            length = end - now
        else:
            raise SimulationError(
                f"{self.name}: fmi3DoStep(t = {t!r} s, h = {h!r} s) returned early "
                f"{_MOST_RETURNS} times and got no further than {now!r} s"
            )
        if self._messages:
            self._messages.forward()

    def get_state(self) -> Any:
        """Return a handle of the whole state."""
        self._flush()
        return _State(super().get_state(), dict(self._written))

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""
        super().set_state(state.handle)
        self._waiting = []
        self._written = dict(state.written)

    def free_state(self, state: Any) -> None:
        """Release a state's memory."""
        super().free_state(state.handle)

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._slave.instantiate(
            loggingOn=True,
            eventModeUsed=self._has_events,
            earlyReturnAllowed=True,
            logMessage=lambda _, status, category, message: self._messages.keep(status, message),
        )

    def _do_step(self, t: float, h: float) -> None:
        status = self._functions["DoStep"](
            self._c, t, h, self._never_back,
            ctypes.byref(self._event), ctypes.byref(self._end),
            ctypes.byref(self._early), ctypes.byref(self._reached),
        )  # fmt: skip
        if status not in ACCEPTED:
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._end.value:
            self._refuse_end(f"at t = {self._reached.value!r} s")

    def _in_event(self, sets: list[Callable[[], None]]) -> None:
        """Go through an event in which inputs are set."""
        self._call("EnterEventMode")
        for put in sets:
            put()
        self._update()
        self._call("EnterStepMode")

    def _update(self) -> None:
        """Iterate an event until the FMU has nothing more to update."""
        ignored, defined, at = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_double()
        for _ in range(_MOST_UPDATES):
            self._call(
                "UpdateDiscreteStates",
                ctypes.byref(self._more), ctypes.byref(self._end), ctypes.byref(ignored),
                ctypes.byref(ignored), ctypes.byref(defined), ctypes.byref(at),
            )  # fmt: skip
            if self._end.value:
                self._refuse_end("in an event")
            if not self._more.value:
                return
        raise SimulationError(
            f"{self.name}: an event is not over after {_MOST_UPDATES} calls of "
            "fmi3UpdateDiscreteStates"
        )

    def _refuse_end(self, when: str) -> None:
        raise SimulationError(
            f"{self.name}: the FMU asks to end the simulation {when}{self._messages.said()}"
        )

    def _flush(self) -> None:
        """Set what waits for an event."""
        if self._waiting:
            waiting, self._waiting = self._waiting, []
            self._in_event(waiting)

    def _kind(self, variable: Variable) -> tuple[str, bool]:
        """Return the type in names of functions, and if setting takes an event."""
        fmi_type = self.fmu.arrays[variable.reference].fmi_type
        waits = self._has_events and variable.variability != "continuous"
        return "Int64" if fmi_type == "Enumeration" else fmi_type, waits

    def _reader(self, variables: list[Variable], kind: tuple[str, bool]) -> Reader:
        call = ArrayCall(variables, kind[0], self.fmu.arrays)
        function, c, messages = f"Get{kind[0]}", self._c, self._messages
        get, arguments, values = self._functions[function], call.arguments, call.values

        def read() -> list[Any]:
            if self._waiting:
                self._flush()
            status = get(c, *arguments)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                messages.forward()
            return values()

        return read

    def _writer(self, variables: list[Variable], kind: tuple[str, bool]) -> Writer:
        fmi_type, waits = kind
        call = ArrayCall(variables, fmi_type, self.fmu.arrays)
        put, arguments, function = (
            self._functions[f"Set{fmi_type}"],
            call.arguments,
            f"Set{fmi_type}",
        )
        remembers = waits or not call.is_whole or len(call.spans) < call.size

        def put_all(values: Sequence[Any]) -> None:
            call.fill(values)
            status = put(self._c, *arguments)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if self._messages:
                self._messages.forward()

        def write(values: Sequence[Any]) -> None:
            self._refuse_unfit(fmi_type, variables, values)
            everything = values if call.is_whole else self._completed(call, kind, values)
            if waits and self._stepping:
                if self._is_known(call, everything):
                    return
                self._waiting.append(partial(put_all, everything))
            else:
                put_all(everything)
            if remembers:
                for reference, span in call.spans.items():
                    self._written[reference] = list(everything[span])

        return write

    def _refuse_unfit(
        self, fmi_type: str, variables: Sequence[Variable], values: Sequence[Any]
    ) -> None:
        """Raise SimulationError for a value that C would change to fit its type."""
        if "Int" in fmi_type:
            self._refuse_excess(variables, values)
        elif fmi_type == "String":
            self._encoded(variables, values)
        elif fmi_type == "Float32":
            for variable, value in zip(variables, values, strict=True):
                if _LARGEST_FLOAT32 < abs(value) < math.inf:
                    raise SimulationError(
                        f"{self.name}.{variable.name}: {value!r} does not fit its type, Float32"
                    )

    def _completed(
        self, call: ArrayCall, kind: tuple[str, bool], values: Sequence[Any]
    ) -> list[Any]:
        """Return values for some elements with what the others hold."""
        everything: list[Any] = [None] * call.size
        for reference, span in call.spans.items():
            array = self.fmu.arrays[reference]
            held = self._written.get(reference) or array.start
            everything[span] = held or self._reader(list(array.elements), kind)()
        for place, value in zip(call.places, values, strict=True):
            everything[place] = value
        return everything

    def _is_known(self, call: ArrayCall, values: Sequence[Any]) -> bool:
        """Say if the FMU was given just these values before."""
        return all(
            self._written.get(reference) == list(values[span])
            for reference, span in call.spans.items()
        )
