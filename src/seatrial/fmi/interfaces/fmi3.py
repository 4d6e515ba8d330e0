"""FMI 3.0: variables in one get and one set per type, arrays, structural parameters."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from fmpy import fmi3

from ...errors import SimulationError
from ..files.arrays import ArrayCall
from ..instance import Reader, Value, Variable, Writer
from ..messages import ACCEPTED
from .eventful import MOST_UPDATES, EventfulInstance
from .loaded import LoadedFmu
from .modelexchange import ModelInstance

_LARGEST_FLOAT32 = 3.4028235677973366e38  # what rounds to a greater one is infinite


class Fmi3Access(EventfulInstance):
    """What both interfaces of FMI 3.0 have in common, in arrays allocated once."""

    _prefix: ClassVar[str] = "fmi3"
    _state_word: ClassVar[str] = "FMUState"

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._written: dict[int, list[Any]] = {}
        """Arrays as last written, by value reference, where not all elements are written."""
        super().__init__(fmu, name)
        if fmu.options.structure:
            try:
                self._configure(fmu.options.structure)
            except BaseException:
                self.free()
                raise

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values by variable name, before `initialise`.

        Structural parameters have their values since the instance was made.
        """
        structure = self.fmu.options.structure
        super().set_start({name: v for name, v in values.items() if name not in structure})

    # ------------------------------------------------------------------ inside

    def _configure(self, structure: Mapping[str, int]) -> None:
        """Set structural parameters: sizes of arrays follow."""
        self._call("EnterConfigurationMode")
        self.writer(list(structure))(list(structure.values()))
        self._call("ExitConfigurationMode")

    def _enter_initialisation(self, tolerance: float | None, start: float, stop: float) -> None:
        """Enter initialisation, of which an infinite ``stop`` is none."""
        stops = math.isfinite(stop)
        self._call(
            "EnterInitializationMode", tolerance is not None, tolerance or 0.0,
            start, stops, stop if stops else 0.0,
        )  # fmt: skip
        self._messages.forward()

    def _update_discrete_states(self) -> tuple[bool, float | None]:
        """Iterate an event until the FMU has nothing more to update.

        Returns whether it asks to end the simulation, and when its next event is.
        """
        more, ends, defined, ignored = (ctypes.c_bool() for _ in range(4))
        at = ctypes.c_double()
        for _ in range(MOST_UPDATES):
            self._activate()
            self._call(
                "UpdateDiscreteStates",
                ctypes.byref(more), ctypes.byref(ends), ctypes.byref(ignored),
                ctypes.byref(ignored), ctypes.byref(defined), ctypes.byref(at),
            )  # fmt: skip
            if not ends.value:
                self._schedule()
            if ends.value or not (more.value or self._is_due()):
                return ends.value, at.value if defined.value else None
        raise self._endless("UpdateDiscreteStates")

    def _activate(self) -> None:
        """Activate the clocks that tick now, before discrete states are updated."""

    def _schedule(self) -> None:
        """Take in when clocks tick next, after discrete states were updated."""

    def _is_due(self) -> bool:
        """Say if a clock has to be activated now."""
        return False

    def _memory(self) -> Any:
        return super()._memory(), dict(self._written)

    def _recall(self, memory: Any) -> None:
        given, written = memory
        super()._recall(given)
        self._written = dict(written)

    def _type(self, variable: Variable) -> Any:
        """Return the type in names of functions."""
        fmi_type = self.fmu.arrays[variable.reference].fmi_type
        return "Int64" if fmi_type == "Enumeration" else fmi_type

    def _getter(self, variables: list[Variable], kind: Any) -> Reader:
        call = ArrayCall(variables, kind, self.fmu.arrays)
        function, c, messages = f"Get{kind}", self._c, self._messages
        get, arguments, values = self._functions[function], call.arguments, call.values

        def read() -> list[Any]:
            status = get(c, *arguments)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                messages.forward()
            return values()

        return read

    def _setter(self, variables: list[Variable], kind: Any) -> Writer:
        call = ArrayCall(variables, kind, self.fmu.arrays)
        function, c, messages = f"Set{kind}", self._c, self._messages
        put, arguments = self._functions[function], call.arguments
        is_part = not call.is_whole or len(call.spans) < call.size

        def write(values: Sequence[Any]) -> None:
            self._refuse_unfit(variables, kind, values)
            everything = values if call.is_whole else self._completed(call, kind, values)
            call.fill(everything)
            status = put(c, *arguments)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                messages.forward()
            if is_part:
                for reference, span in call.spans.items():
                    self._written[reference] = list(everything[span])

        return write

    def _refuse_unfit(
        self, variables: Sequence[Variable], kind: Any, values: Sequence[Any]
    ) -> None:
        """Raise SimulationError for a value that C would change to fit its type."""
        if "Int" in kind:
            self._refuse_excess(variables, values)
        elif kind == "String":
            self._encoded(variables, values)
        elif kind == "Float32":
            for variable, value in zip(variables, values, strict=True):
                if _LARGEST_FLOAT32 < abs(value) < math.inf:
                    raise SimulationError(
                        f"{self.name}.{variable.name}: {value!r} does not fit its type, Float32"
                    )

    def _completed(self, call: ArrayCall, kind: Any, values: Sequence[Any]) -> list[Any]:
        """Return values for some elements with what the others hold."""
        everything: list[Any] = [None] * call.size
        for reference, span in call.spans.items():
            array = self.fmu.arrays[reference]
            held = self._written.get(reference) or array.start
            everything[span] = held or self._getter(list(array.elements), kind)()
        for place, value in zip(call.places, values, strict=True):
            everything[place] = value
        return everything


class Fmi3Model(ModelInstance, Fmi3Access):
    """An instance of an FMI 3.0 FMU in model exchange, with a solver."""

    _library: ClassVar[type[Any]] = fmi3.FMU3Model
    _derivatives_word: ClassVar[str] = "GetContinuousStateDerivatives"

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self._enter_initialisation(self._tolerance, start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        self._messages.forward()
        self._update()
        self._begin_integration()

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._slave.instantiate(
            loggingOn=True,
            logMessage=lambda _, status, category, message: self._messages.keep(status, message),
        )

    def _sizes(self) -> tuple[int, int]:
        states, indicators = ctypes.c_size_t(), ctypes.c_size_t()
        self._call("GetNumberOfContinuousStates", ctypes.byref(states))
        self._call("GetNumberOfEventIndicators", ctypes.byref(indicators))
        return states.value, indicators.value

    def _enter_events(self) -> None:
        self._call("EnterEventMode")

    def _enter_continuous_time(self) -> None:
        self._call("EnterContinuousTimeMode")

    def _update(self) -> None:
        ends, at = self._update_discrete_states()
        if ends:
            self._end()
        self._next_event = at

    def _wants_event(self) -> bool:
        wants, ends = ctypes.c_bool(), ctypes.c_bool()
        self._call(
            "CompletedIntegratorStep", bool(self.never_back),
            ctypes.byref(wants), ctypes.byref(ends),
        )  # fmt: skip
        if ends.value:
            self._end()
        return wants.value
