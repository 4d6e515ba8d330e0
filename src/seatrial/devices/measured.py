"""Outputs of sensors: what is measured, with the errors of its data sheet, and what follows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from ..model.component import Output, Parameter

Validity = Literal["", "whole", "axes"]


class Derived(Output):
    """An output that a sensor computes from a measurement, and publishes with it.

    ``validity`` declares a further output ``NAME_valid``, for values that a measurement may
    lack: "whole", one for all axes, "axes", one for each. A lacking value is shown as 0.
    """

    def __init__(
        self, unit: str, description: str, *, validity: Validity = "", **options: Any
    ) -> None:
        super().__init__(unit, description, **options)
        self.validity = validity

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        if self.validity:
            axes = self.axes if self.validity == "axes" else None
            output = Output("1", f"whether {name} is valid", type=bool, axes=axes)
            output.__set_name__(owner, f"{name}_valid")
            setattr(owner, f"{name}_valid", output)


class Measured(Derived):
    """An output that is measured, and the errors its data sheet gives, per axis.

    Declares four parameters, each zero for an ideal sensor: ``NAME_noise``, standard deviation
    of a sample's white noise; ``NAME_bias``, constant; ``NAME_instability``, standard deviation
    of a slowly varying bias; ``NAME_resolution``, the quantisation step. ``span`` has the least and
    the greatest value that a broken instrument shows, alike for all axes or per axis.

    With ``bandwidth``, Hz, there is ``NAME_bandwidth``, for which the noise is stated: that of a
    density N is N sqrt(bandwidth). With ``limit`` there is ``NAME_range``, the largest reading.
    """

    ERRORS = ("noise", "bias", "instability", "resolution")

    def __init__(
        self,
        unit: str,
        description: str,
        *,
        span: tuple[Any, Any],
        noise: Any = 0.0,
        bias: Any = 0.0,
        instability: Any = 0.0,
        resolution: Any = 0.0,
        bandwidth: float | None = None,
        limit: float | None = None,
        axes: Sequence[str] | None = None,
        frame: str = "",
        validity: Validity = "",
    ) -> None:
        super().__init__(unit, description, validity=validity, axes=axes, frame=frame)
        self.bandwidth, self.largest = bandwidth, limit
        self.low: list[float] = self._spread(span[0])
        self.high: list[float] = self._spread(span[1])
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
            self._declare(owner, f"{name}_{error}", parameter)
        if self.bandwidth is not None:
            text = f"{name}: bandwidth that the noise is stated for, 0: it is that of a sample"
            self._declare(
                owner, f"{name}_bandwidth", Parameter(self.bandwidth, "Hz", text, min=0.0)
            )
        if self.largest is not None:
            text = f"{name}: largest reading of an axis, of either sign, 0 for no limit"
            self._declare(owner, f"{name}_range", Parameter(self.largest, self.unit, text, min=0.0))

    @staticmethod
    def _declare(owner: type, name: str, parameter: Parameter) -> None:
        parameter.__set_name__(owner, name)
        setattr(owner, name, parameter)
