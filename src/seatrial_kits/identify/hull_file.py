"""Hull files: the dimensions that damping is estimated from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from seatrial.errors import InputError
from seatrial.model.units import quantity
from seatrial.system.files import FileModel, Source, find_file, read_toml, validated

from .damping import Derivative, HullForm, damping

_SEA_WATER = {"density": "1025 kg/m3", "viscosity": "1.19e-6 m2/s"}
"""At 15 degrees."""

Quantity = float | str
Sections = Quantity | list[Quantity]


class HullFile(FileModel):
    """A hull's file. Areas that are not given are those of boxes with its beam and draught."""

    title: str = ""
    length: Quantity
    draught: Sections
    """One value, or values evenly spaced from stern to bow."""
    beam: Sections
    middle: Quantity = 0.0
    hulls: int = Field(default=1, ge=1)
    hulls_across: int | None = Field(default=None, ge=1)
    wetted_area: Quantity | None = None
    frontal_area: Quantity | None = None
    form_factor: float = Field(default=0.15, ge=0.0)
    drag_ahead: float = Field(default=0.45, ge=0.0)
    drag_across: float = Field(default=1.2, ge=0.0)
    drag_down: float = Field(default=1.2, ge=0.0)
    speed: Quantity
    density: Quantity = _SEA_WATER["density"]
    viscosity: Quantity = _SEA_WATER["viscosity"]


@dataclass(frozen=True)
class Estimate:
    """Derivatives of a hull, and the file that its dimensions are from."""

    read_from: Source
    title: str
    hull: HullForm
    derivatives: list[Derivative]

    def of(self, symbol: str) -> float:
        """Return the value of a derivative by its symbol."""
        return next(each.value for each in self.derivatives if each.symbol == symbol)

    def vehicle_lines(self) -> list[str]:
        """Return the lines of a vehicle file that say the same, for `marine-craft` or `rov`."""
        of = self.of
        rows: dict[str, tuple[str, Sequence[float]]] = {
            "linear_damping_force": ("N.s/m", (-of("X_u"), 0.0, 0.0)),
            "quadratic_damping_force": ("N.s2/m2", (-of("X_u|u|"), -of("Y_v|v|"), -of("Z_w|w|"))),
            "quadratic_damping_moment": ("N.m.s2/rad2", (0.0, -of("M_q|q|"), -of("N_r|r|"))),
            "quadratic_coupled_damping_force": ("N.s2/rad2", (of("Y_r|r|"), of("Z_q|q|"))),
            "quadratic_coupled_damping_moment": ("N.s2/m", (of("N_v|v|"), of("M_w|w|"))),
        }
        return [
            f"{name} = {{ value = [{', '.join(f'{value + 0.0:.4g}' for value in values)}], "
            f'unit = "{unit}", source = "seatrial estimate {self.read_from.name}", '
            'mark = "assumed" }'
            for name, (unit, values) in rows.items()
        ]


def estimate_damping(name: str) -> Estimate:
    """Read the hull ``name``, below ``harness/hulls`` or a path, and return its derivatives.

    Raises InputError for a file that says what cannot be.
    """
    path = find_file("harness/hulls", name)
    content, read_from = read_toml(path)
    file = validated(HullFile, content, path)

    def si(key: str, written: Quantity, unit: str, *, positive: bool = True) -> float:
        try:
            value = quantity(written, unit)
        except InputError as error:
            raise InputError(f"{path}: {key}: {error}") from None
        if positive and value <= 0.0:
            raise InputError(f"{path}: {key}: above 0 is needed, found {written!r}")
        return value

    def sections(key: str, written: Sections) -> tuple[float, ...]:
        values = written if isinstance(written, list) else [written, written]
        if len(values) < 2:
            raise InputError(f"{path}: {key}: one value, or two and more from stern to bow")
        found = tuple(si(key, each, "m", positive=False) for each in values)
        if min(found) < 0.0 or not max(found) > 0.0:
            raise InputError(f"{path}: {key}: 0 m and more are needed, found {written!r}")
        return found

    length = si("length", file.length, "m")
    draught, beam = sections("draught", file.draught), sections("beam", file.beam)
    x = np.linspace(0.0, length, 1001)
    deep, wide = (
        np.interp(x, np.linspace(0.0, length, len(values)), values) for values in (draught, beam)
    )
    wetted = file.hulls * float(np.trapezoid(wide + 2.0 * deep, x))
    frontal = file.hulls * float((wide * deep).max())
    if file.wetted_area is not None:
        wetted = si("wetted_area", file.wetted_area, "m2")
    if file.frontal_area is not None:
        frontal = si("frontal_area", file.frontal_area, "m2")
    hull = HullForm(
        length=length,
        draught=draught,
        beam=beam,
        wetted_area=wetted,
        frontal_area=frontal,
        middle=si("middle", file.middle, "m", positive=False),
        hulls=file.hulls,
        hulls_across=file.hulls if file.hulls_across is None else file.hulls_across,
        form_factor=file.form_factor,
        drag_ahead=file.drag_ahead,
        drag_across=file.drag_across,
        drag_down=file.drag_down,
    )
    speed, density = si("speed", file.speed, "m/s"), si("density", file.density, "kg/m3")
    try:
        found = damping(hull, speed, density, si("viscosity", file.viscosity, "m2/s"))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return Estimate(read_from, file.title, hull, found)
