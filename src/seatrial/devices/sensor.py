"""Base of sensors: sample rate, errors of a data sheet, delay, dropout, failures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

from ..errors import InputError, unknown
from ..model.component import NS, Noise, Output, Parameter
from ..model.faults.operators import Bias, Deviation, Drift, Moment, Operator, Scale
from ..model.faults.text import Written
from ..model.sampled import Sampled
from .delays import last_due
from .fault import SHARE_WRONG, SLOWER, Fallible
from .measured import Derived as Derived
from .measured import Measured as Measured

Value = float | None
"""A value of a measurement, None where there was nothing to measure."""

ALWAYS_THERE = dict.fromkeys(("valid", "count"), ("fault",))
"""Feed-through of a sensor that always has something to measure: only a failure loses it."""


class Sensor(Noise, Fallible, Sampled):
    """Base of the sensors: every ``period`` a measurement, published ``delay`` later.

    Whoever writes one declares `Measured` outputs and overrides `measure`, and for `Derived`
    outputs `derive`. Measurement k, of the true values x at t_k = t_0 + k period, is

        y_k = quantised(x + bias + b_k + noise w_k),
        b_k = a b_(k-1) + instability sqrt(1 - a^2) v_k,   a = exp(-period / correlation_time)

    with w, v standard normal and b_0 = instability v_0 (a first-order Gauss-Markov process,
    stationary from the start); quantised to the nearest multiple of the resolution, and held
    within the range of an output that has one. Noise stated for a bandwidth B is

        noise = NAME_noise / sqrt(2 period B)

    of each sample: white noise of one density, whatever the period. The measurement
    appears on the outputs at t_k + delay, or at the first communication point after that, and
    stays until the next; with no delay it appears at t_k itself. Times are counted in whole
    nanoseconds, so that what is published does not depend on the communication step.

    With probability ``dropout`` a measurement is lost: outputs keep the one before. It is lost
    too where there is nothing to measure; where a part of it lacks, the rest is published.
    ``count`` is the number of measurements published so far: new data has a new one; ``valid``
    is false before the first and while the last one due was lost.

    ``fault`` makes it fail, measurement by measurement:

    ============ ===================================================================
    off          it is lost
    stuck        the last one that arrived is published again, as a valid one
    garbage      random values, uniform over the output's `Measured.span`
    wrong        a tenth of the span too much
    slow         none is due, but for every tenth: outputs stay as they are
    delayed      it is published 10 periods later than otherwise
    intermittent it is lost with probability 1/2
    ============ ===================================================================

    A fault of one measured output, such as ``bias of=heading value=0.1 at=12``, acts on y before
    it is quantised, with the equation that it has on a signal (`seatrial.model.faults.operators`).

    Lost, garbage and wrong ones take the same way as all others: what was measured before the
    failure still arrives. Before there is a measurement, stuck is as off. What is overtaken by
    a newer one, when a delay ends, is never published.

    All random numbers of measurement k come from `Noise.generator` (k). Two sensors with the
    same ``seed`` draw the same numbers: give each its own.
    """

    measured: ClassVar[tuple[Measured, ...]] = ()
    published: ClassVar[tuple[Derived, ...]] = ()
    """The measured outputs, then those that are computed from them."""
    empty_is_lost: ClassVar[bool] = True
    """Whether a measurement that has nothing in it is a lost one."""

    delay = Parameter(0.0, "s", "time from measurement to output", min=0.0)
    dropout = Parameter(0.0, "1", "probability that a measurement is lost", min=0.0, max=1.0)
    correlation_time = Parameter(300.0, "s", "correlation time of the varying bias", min=1e-6)

    valid = Output("1", "whether the last measurement due arrived", type=bool)
    count = Output("1", "number of measurements published so far", type=int)

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.measured = tuple(p for p in cls.ports.values() if isinstance(p, Measured))
        derived = [p for p in cls.ports.values() if isinstance(p, Derived)]
        cls.published = (*cls.measured, *(p for p in derived if not isinstance(p, Measured)))

    def measure(self) -> Sequence[Value]:
        """Return the true values of the measured outputs, one after the other, from the inputs.

        None stands for what cannot be measured now.
        """
        raise TypeError(f"{type(self).__name__} does not define what it measures")

    def finish(self, values: list[float]) -> list[float]:
        """Return the values with errors as the sensor reports them (an angle wrapped)."""
        return values

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the values of the `Derived` outputs from those that were measured."""
        return ()

    def travel_ns(self) -> int:
        """Return the time that a measurement now takes before its ``delay`` begins, ns."""
        return 0

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start with nothing published."""
        self._delay_ns = round(self.delay * NS)
        noise, self._bias, self._instability, self._resolution = (
            [v for port in self.measured for v in self._error(port, error)]
            for error in Measured.ERRORS
        )
        shares = [v for port in self.measured for v in [self._share(port)] * port.size]
        self._noise = [share * v for share, v in zip(shares, noise, strict=True)]
        self._range = [v for port in self.measured for v in [self._most(port)] * port.size]
        self._low = [v for port in self.measured for v in port.low]
        self._high = [v for port in self.measured for v in port.high]
        self._kept = math.exp(-self.period / self.correlation_time)
        self._count, self._arrived = 0, False
        self._last: list[Value] = [None] * sum(port.size for port in self.published)
        self._shown: list[Any] = [self._last, 0, False]
        self._queue: list[list[Any]] = []
        self._draw(0)
        self._walk = [s * v for s, v in zip(self._instability, self._drift, strict=True)]

    def update(self, t: float, k: int) -> None:
        """Queue the measurement if it is delayed, and draw the next one's random numbers."""
        now_ns, late_ns = round(t * NS), self._late_ns()
        self._last, self._count, self._arrived = self._measurement(k)
        measured = [self._last, self._count, self._arrived]
        if late_ns:
            # The last one due stays: it may not have been published yet.
            while len(self._queue) > 1 and self._queue[1][0] <= now_ns:
                self._queue.pop(0)
            while self._queue and self._queue[-1][0] >= now_ns + late_ns:
                self._queue.pop()
            self._queue.append([now_ns + late_ns, *measured])
        else:
            self._queue, self._shown = [], measured
        self._draw(k + 1)
        grown = math.sqrt(1.0 - self._kept**2)
        self._walk = [
            self._kept * b + s * grown * v
            for b, s, v in zip(self._walk, self._instability, self._drift, strict=True)
        ]

    def hold(self, t: float) -> None:
        """Publish the measurement of this instant, or the last that fell due."""
        now_ns = round(t * NS)
        if self._instant_ns() == now_ns and not self._late_ns():
            self._publish(*self._measurement(self._next))
            return
        due = last_due(self._queue, now_ns)
        self._publish(*(self._shown if due is None else due[1:]))

    # ------------------------------------------------------------------ inside

    def _error(self, port: Measured, error: str) -> list[float]:
        value = getattr(self, f"{port.name}_{error}")
        return [value] if port.axes is None else value

    def _share(self, port: Measured) -> float:
        """Return the noise of a sample, of that which is stated."""
        if port.bandwidth is None:
            return 1.0
        return share_of_sample(self.period, getattr(self, f"{port.name}_bandwidth"))

    def _most(self, port: Measured) -> float:
        """Return the largest reading of an axis, 0 where there is no limit."""
        return 0.0 if port.largest is None else float(getattr(self, f"{port.name}_range"))

    def _draw(self, k: int) -> None:
        """Draw the random numbers of measurement ``k``."""
        n = len(self._bias)
        if self.dropout or any(self._noise) or any(self._instability):
            generator = self.generator(k)
            self._lost = bool(generator.random() < self.dropout)
            normal = generator.standard_normal(2 * n).tolist()
        else:
            self._lost, normal = False, [0.0] * (2 * n)
        self._white, self._drift = normal[:n], normal[n:]

    def _late_ns(self) -> int:
        """Return the time from a measurement now to its output, ns."""
        late_ns: int = self._delay_ns + self.travel_ns()
        return late_ns + (SLOWER * self._period_ns if self.fault == "delayed" else 0)

    def _measurement(self, k: int) -> tuple[list[Value], int, bool]:
        """Return the values, the count and whether it arrives, of measurement ``k`` now."""
        written = self.written_fault()
        fault = written.what
        if fault == "slow" and k % SLOWER:
            return self._last, self._count, self._arrived
        if self._lost or self._fails(fault, k):
            return self._last, self._count, False
        if fault == "stuck":
            return self._last, self._count + 1, True
        found = self._garbage(k) if fault == "garbage" else self._noisy()
        if written.of:
            found = self._disturbed(found, written, k)
        if self.empty_is_lost and all(y is None for y in found):
            return self._last, self._count, False
        values = [0.0 if y is None else y for y in found]
        if fault == "wrong":
            ends = zip(values, self._low, self._high, strict=True)
            values = [y + SHARE_WRONG * (high - low) for y, low, high in ends]
        steps = zip(values, self._resolution, strict=True)
        read = [(step * round(y / step) if step else y) for y, step in steps]
        finished = self.finish([_held(y, most) for y, most in zip(read, self._range, strict=True)])
        measured = [None if x is None else y for x, y in zip(found, finished, strict=True)]
        return [*measured, *self.derive(measured)], self._count + 1, True

    def _fails(self, fault: str, k: int) -> bool:
        """Return whether a failure loses measurement ``k``."""
        if fault == "intermittent":
            return bool(self.generator(k, 1).random() < 0.5)
        return fault == "off" or (fault == "stuck" and not self._count)

    def _garbage(self, k: int) -> Sequence[Value]:
        drawn: list[float] = self.generator(k, 1).uniform(self._low, self._high).tolist()
        return drawn

    def _noisy(self) -> Sequence[Value]:
        return [
            None if x is None else x + bias + walk + noise * white
            for x, bias, walk, noise, white in zip(
                self.measure(), self._bias, self._walk, self._noise, self._white, strict=True
            )
        ]

    def _disturbed(self, found: Sequence[Value], fault: Written, k: int) -> Sequence[Value]:
        """Return the measurement ``k`` with a fault of one output."""
        known = [port.name for port in self.measured]
        if fault.of not in known:
            raise InputError(f"{self.name}.fault: {unknown('measured output', fault.of, known)}")
        at_ns = self._start_ns + k * self._period_ns
        begun_ns = min(at_ns, round(fault.at * NS))
        moment = Moment(at_ns, begun_ns, round(fault.grows_over * NS))
        values, first = list(found), 0
        for port in self.measured:
            if port.name == fault.of:
                normal = self.generator(k, 2).standard_normal(port.size).tolist()
                own = range(first, first + port.size)
                values = [
                    x
                    if x is None or i not in own
                    else _faulty(fault, i - first, normal[i - first], x, moment)
                    for i, x in enumerate(values)
                ]
            first += port.size
        return values

    def _publish(self, values: list[Value], count: int, valid: bool) -> None:
        place = 0
        for port in self.published:
            found = values[place : place + port.size]
            shown = [0.0 if y is None else y for y in found]
            setattr(self, port.name, shown[0] if port.axes is None else shown)
            if port.validity:
                there: Any = [valid and y is not None for y in found]
                whole = port.validity == "whole"
                setattr(self, f"{port.name}_valid", all(there) if whole else there)
            place += port.size
        self.count, self.valid = count, valid


def _faulty(fault: Written, axis: int, normal: float, x: float, moment: Moment) -> float:
    """Return what becomes of one measured value; ``normal`` is standard normal."""

    def setting(key: str) -> float:
        values = fault.settings[key]
        return values[axis if len(values) > 1 else 0]

    match fault.what:
        case "bias":
            operator: Operator = Bias(setting("value"))
        case "noise":
            operator = Bias(setting("value") * normal)
        case "drift":
            operator = Drift(setting("rate"))
        case "scale":
            operator = Scale(setting("factor"))
        case _:
            operator = Deviation(tuple(fault.settings["coefficients"]))
    value: float = operator.value(None, x, moment)
    return value


def share_of_sample(period: float, bandwidth: float) -> float:
    """Return the noise of a sample over that stated for a bandwidth, Hz; ``period`` in s.

    White noise of a density N is N sqrt(bandwidth) as stated, and N sqrt(1 / (2 period)) in
    samples; 1 without a bandwidth.
    """
    return 1.0 / math.sqrt(2.0 * period * bandwidth) if bandwidth else 1.0


def _held(value: float, most: float) -> float:
    return min(max(value, -most), most) if most else value


def full_circle(angle: float) -> float:
    """Return ``angle``, rad, in [0, 2 pi), as on a compass card."""
    wrapped = angle % math.tau
    # Python's % gives tau itself for a tiny negative angle.
    return wrapped if wrapped < math.tau else 0.0


def half_circle(angle: float) -> float:
    """Return ``angle``, rad, in (-pi, pi]."""
    return math.pi - (math.pi - angle) % math.tau


def require_unit(owner: str, name: str, vector: Sequence[float]) -> None:
    """Raise InputError for a vector whose length is not 1 within 1e-6."""
    length = math.hypot(*vector)
    if abs(length - 1.0) > 1e-6:
        raise InputError(
            f"{owner}.{name} is {tuple(vector)}, of length {length:.6g}: give a unit vector"
        )
