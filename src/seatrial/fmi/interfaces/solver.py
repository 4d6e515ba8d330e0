"""CVode, of SUNDIALS as FMPy brings it: integrates one FMU, step by step, to the next event."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from fmpy import sundials
from fmpy.sundials.libraries import sundials_cvode

_ONE_STEP = 2
_ROOT_RETURN = sundials.CV_ROOT_RETURN
_RECOVERABLE, _LOST = 1, -1
"""What a callback returns to have a smaller step tried, and to have the solver give up."""

_set_stop_time = sundials_cvode.CVodeSetStopTime
_set_stop_time.argtypes = [ctypes.c_void_p, ctypes.c_double]
_set_stop_time.restype = ctypes.c_int


class Equations(Protocol):
    """What is integrated; the arrays are C arrays of doubles.

    Derivatives and indicators return whether they could be computed: if not, a smaller step may
    do. Other failures are raised.
    """

    def set_time(self, t: float) -> None:
        """Set the time, s."""

    def get_states(self, x: Any, count: int) -> None:
        """Get the states."""

    def set_states(self, x: Any, count: int) -> bool:
        """Set the states."""

    def derivatives(self, dx: Any, count: int) -> bool:
        """Get the derivatives of the states."""

    def indicators(self, z: Any, count: int) -> bool:
        """Get the event indicators."""

    def nominals(self, x: Any, count: int) -> None:
        """Get the nominal values of the states."""


class _NoInput:
    """FMPy's solver applies inputs; ours are held while it integrates."""

    def apply(self, t: float) -> None:
        """Do nothing."""


class Solver(sundials.CVodeSolver):  # type: ignore[misc]
    """CVode by backward differences, with the event indicators as root functions.

    Absolute tolerances are the relative one times the nominal values. What the equations raise
    ends a step and is raised by it.
    """

    def __init__(
        self, equations: Equations, sizes: tuple[int, int], t: float, tolerance: float
    ) -> None:
        self._equations = equations
        self._raised: BaseException | None = None
        states, indicators = sizes
        super().__init__(
            nx=states,
            nz=indicators,
            get_x=equations.get_states,
            set_x=equations.set_states,
            get_dx=equations.derivatives,
            get_z=equations.indicators,
            get_nominals=self._nominals,
            set_time=equations.set_time,
            input=_NoInput(),
            startTime=t,
            relativeTolerance=tolerance,
        )

    def restart(self, t: float) -> None:
        """Forget the past: states, inputs or equations have jumped at ``t``."""
        super().reset(t)
        sundials.CVodeSVtolerances(self.cvode_mem, self.reltol, self.abstol)  # it keeps a copy

    def advance(self, until: float) -> tuple[float, bool]:
        """Take one step, at most to ``until``; return its end, and if an indicator crossed zero.

        The equations stand at the end then. Raises what they raised, RuntimeError if the solver
        cannot go on.
        """
        reached = ctypes.c_double()
        _set_stop_time(self.cvode_mem, until)
        self.error_info = None
        flag = sundials.CVode(self.cvode_mem, until, self.x, ctypes.byref(reached), _ONE_STEP)
        if self._raised is not None:
            raised, self._raised = self._raised, None
            raise raised
        if flag < 0:
            _, function, _, message = self.error_info or (0, "CVode", "", "no message")
            raise RuntimeError(f"{function} ended with {flag}: {message}")
        self._equations.set_time(reached.value)
        if not self.discrete:
            self._equations.set_states(self.px, self.nx)
        return reached.value, flag == _ROOT_RETURN

    # ------------------------------------------------------------------ callbacks of CVode

    def f(self, t: float, y: Any, ydot: Any, _user_data: Any) -> int:
        """Right-hand side."""
        dx = sundials.NV_DATA_S(ydot)
        if self.discrete:
            dx[0] = 0.0
            return 0
        return self._guarded(t, y, lambda: self._equations.derivatives(dx, self.nx))

    def g(self, t: float, y: Any, gout: Any, _user_data: Any) -> int:
        """Root functions."""
        return self._guarded(t, y, lambda: self._equations.indicators(gout, self.nz))

    def _guarded(self, t: float, y: Any, compute: Callable[[], bool]) -> int:
        """Let the equations compute at ``t`` and ``y``; an exception cannot cross C."""
        try:
            self._equations.set_time(t)
            at_y = self.discrete or self._equations.set_states(sundials.NV_DATA_S(y), self.nx)
            return 0 if at_y and compute() else _RECOVERABLE
        except BaseException as error:
            self._raised = error
            return _LOST

    def _nominals(self, x: Any, count: int) -> None:
        self._equations.nominals(x, count)
        values = np.ctypeslib.as_array(x, (count,))
        values[:] = np.abs(values)
        values[~(values > 0.0) | ~np.isfinite(values)] = 1.0
