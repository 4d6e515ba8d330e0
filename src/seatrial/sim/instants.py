"""Times of calls: doubles of whole nanoseconds, for every path by which a component is stepped."""

from __future__ import annotations

from ..model.component import NS


def interval(t_ns: int, h_ns: int, *, constant: bool) -> tuple[float, float]:
    """Return begin and length of a step, s.

    The length is ``t_next - t``, so that t + h is t_next as the component will see it; a
    ``constant`` one, h_ns as a double, is for FMUs whose steps are all of one length
    (``canHandleVariableCommunicationStepSize = false``). `master.c` computes the same.
    """
    t = t_ns / NS
    return t, h_ns / NS if constant else (t_ns + h_ns) / NS - t
