"""What all sensors share: sample rate, errors of a data sheet, delay, dropout."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

from ..component import NS, Noise, Output, Parameter
from ..sampled import Sampled


class Measured(Output):
    """An output that is measured, and the errors its data sheet gives, per axis.

    Declares four parameters, each zero for an ideal sensor: ``NAME_noise``, standard deviation
    of a sample's white noise; ``NAME_bias``, constant; ``NAME_instability``, standard deviation
    of a slowly varying bias; ``NAME_resolution``, the quantisation step.
    """

    ERRORS = ("noise", "bias", "instability", "resolution")

    def __init__(
        self,
        unit: str,
        description: str,
        *,
        noise: Any = 0.0,
        bias: Any = 0.0,
        instability: Any = 0.0,
        resolution: Any = 0.0,
        axes: Sequence[str] | None = None,
    ) -> None:
        super().__init__(unit, description, axes=axes)
        self._errors = dict(zip(self.ERRORS, (noise, bias, instability, resolution), strict=True))

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        meaning = {
            "noise": "white noise, standard deviation of a sample",
            "bias": "constant bias",
            "instability": "slowly varying bias, standard deviation",
            "resolution": "quantisation step, 0 for none",
        }
        for error, start in self._errors.items():
            least = None if error == "bias" else 0.0
            text = f"{name}: {meaning[error]}"
            parameter = Parameter(start, self.unit, text, axes=self.axes, min=least)
            parameter.__set_name__(owner, f"{name}_{error}")
            setattr(owner, f"{name}_{error}", parameter)


class Sensor(Noise, Sampled):
    """Base of the sensors: every ``period`` a measurement, published ``delay`` later.

    Whoever writes one declares `Measured` outputs and overrides `measure`. Measurement k, of
    the true values x at t_k = t_0 + k period, is

        y_k = quantised(x + bias + b_k + noise w_k),
        b_k = a b_(k-1) + instability sqrt(1 - a^2) v_k,   a = exp(-period / correlation_time)

    with w, v standard normal and b_0 = instability v_0 (a first-order Gauss-Markov process,
    stationary from the start); quantised to the nearest multiple of the resolution. It
    appears on the outputs at t_k + delay, or at the first communication point after that, and
    stays until the next; with no delay it appears at t_k itself. Times are counted in whole
    nanoseconds, so that what is published does not depend on the communication step.

    With probability ``dropout`` a measurement is lost: outputs keep the one before.
    ``count`` is the number of measurements published so far and tells old from new; ``valid``
    is false before the first and while the last one due was lost.

    All random numbers of measurement k come from `Noise.generator` (k). Two sensors with the
    same ``seed`` draw the same numbers: give each its own.
    """

    measured: ClassVar[tuple[Measured, ...]] = ()

    delay = Parameter(0.0, "s", "time from measurement to output", min=0.0)
    dropout = Parameter(0.0, "1", "probability that a measurement is lost", min=0.0, max=1.0)
    correlation_time = Parameter(300.0, "s", "correlation time of the varying bias", min=1e-6)

    valid = Output("1", "whether the last measurement due arrived", type=bool)
    count = Output("1", "number of measurements published so far", type=int)

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.measured = tuple(p for p in cls.ports.values() if isinstance(p, Measured))

    def measure(self) -> list[float]:
        """Return the true values of the measured outputs, one after the other, from the inputs."""
        raise TypeError(f"{type(self).__name__} does not say what it measures")

    def finish(self, values: list[float]) -> list[float]:
        """Return the values with errors as the sensor reports them (an angle wrapped)."""
        return values

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start with nothing published."""
        self._delay_ns = round(self.delay * NS)
        self._noise, self._bias, self._instability, self._resolution = (
            [v for port in self.measured for v in self._error(port, error)]
            for error in Measured.ERRORS
        )
        self._kept = math.exp(-self.period / self.correlation_time)
        self._count = 0
        self._last = [0.0] * len(self._bias)
        self._queue: list[list[Any]] = []
        self._draw(0)
        self._walk = [s * v for s, v in zip(self._instability, self._drift, strict=True)]
        self._publish(self._last, 0, False)

    def sample(self, t: float, k: int) -> None:
        """Publish the measurement, if nothing delays it."""
        if self._delay_ns == 0:
            self._publish(*self._measurement())

    def update(self, t: float, k: int) -> None:
        """Queue the measurement if it is delayed, and draw the next one's random numbers."""
        now_ns = round(t * NS)
        values, self._count, arrived = self._measurement()
        self._last = values
        if self._delay_ns:
            # The last one due stays: it may not have been published yet.
            while len(self._queue) > 1 and self._queue[1][0] <= now_ns:
                self._queue.pop(0)
            self._queue.append([now_ns + self._delay_ns, values, self._count, arrived])
        self._draw(k + 1)
        grown = math.sqrt(1.0 - self._kept**2)
        self._walk = [
            self._kept * b + s * grown * v
            for b, s, v in zip(self._walk, self._instability, self._drift, strict=True)
        ]

    def hold(self, t: float) -> None:
        """Publish the last measurement that fell due."""
        now_ns = round(t * NS)
        due = [entry for entry in self._queue if entry[0] <= now_ns]
        if due:
            self._publish(*due[-1][1:])

    # ------------------------------------------------------------------ inside

    def _error(self, port: Measured, error: str) -> list[float]:
        value = getattr(self, f"{port.name}_{error}")
        return [value] if port.axes is None else value

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

    def _measurement(self) -> tuple[list[float], int, bool]:
        """Return the values, the count and whether it arrives, of the measurement now."""
        if self._lost:
            return self._last, self._count, False
        noisy = [
            x + bias + walk + noise * white
            for x, bias, walk, noise, white in zip(
                self.measure(), self._bias, self._walk, self._noise, self._white, strict=True
            )
        ]
        steps = zip(noisy, self._resolution, strict=True)
        return self.finish([_quantised(y, step) for y, step in steps]), self._count + 1, True

    def _publish(self, values: list[float], count: int, valid: bool) -> None:
        place = 0
        for port in self.measured:
            self.values[port.offset : port.offset + port.size] = values[place : place + port.size]
            place += port.size
        self.count, self.valid = count, valid


def _quantised(value: float, step: float) -> float:
    return step * round(value / step) if step else value


def full_circle(angle: float) -> float:
    """Return ``angle``, rad, in [0, 2 pi), as a compass card counts."""
    wrapped = angle % math.tau
    # Python's % gives tau itself for a tiny negative angle.
    return wrapped if wrapped < math.tau else 0.0


def half_circle(angle: float) -> float:
    """Return ``angle``, rad, in (-pi, pi]."""
    return math.pi - (math.pi - angle) % math.tau
