"""Windage of a craft: areas with coefficients, or a merchant ship's coefficients."""

from __future__ import annotations

from ...errors import InputError
from ...model.component import Component, Parameter
from ..sea.wind_loads import (
    BLENDERMANN,
    Areas,
    Blendermann,
    Isherwood,
    Ship,
    Silhouette,
)

WindLoad = Areas | Ship
"""Its `loads` are X, Y, K, N, N and N.m about the body origin."""


class Windage(Component):
    """Mix-in: the outline of a craft above water, and what the wind's load is computed by."""

    windage_model = Parameter(
        "areas",
        "1",
        "loads by areas and coefficients, or as of a merchant ship",
        choices=("areas", "isherwood", "blendermann"),
    )
    windage_frontal = Parameter(0.0, "m2", "area seen from ahead; 0: no windage given", min=0.0)
    windage_lateral = Parameter(0.0, "m2", "area seen from abeam", min=0.0)
    windage_ahead = Parameter(0.0, "m", "centroid of the lateral area ahead of the body origin")
    windage_height = Parameter(0.0, "m", "that centroid above the body origin", min=0.0)
    windage_along = Parameter(0.7, "1", "drag coefficient ahead (areas)", min=0.0)
    windage_across = Parameter(0.85, "1", "drag coefficient abeam (areas)", min=0.0)
    windage_type = Parameter(
        "cargo_loaded", "1", "type of ship (blendermann)", choices=tuple(BLENDERMANN)
    )
    windage_length = Parameter(0.0, "m", "length over all (isherwood, blendermann)", min=0.0)
    windage_beam = Parameter(0.0, "m", "beam (isherwood)", min=0.0)
    windage_perimeter = Parameter(
        0.0, "m", "perimeter of the lateral area without the water line (isherwood)", min=0.0
    )
    windage_masts = Parameter(0.0, "1", "groups of masts (isherwood)", min=0.0)
    windage_superstructure = Parameter(
        0.0, "m2", "lateral area of the superstructure (isherwood)", min=0.0
    )

    def wind_load(self) -> WindLoad:
        """Return the load of the air on the craft. Raises InputError for an outline not given.

        Ships' coefficients are about midships at the water line, where the body origin is taken
        to be.
        """
        if not (self.windage_frontal > 0.0 and self.windage_lateral > 0.0):
            raise InputError(
                f"{self.name}: it meets wind, and what it shows to the wind is not given: "
                "windage_frontal and windage_lateral"
            )
        if self.windage_model == "areas":
            return Areas(
                self.windage_frontal,
                self.windage_lateral,
                self.windage_ahead,
                self.windage_height,
                self.windage_along,
                self.windage_across,
            )
        try:
            return self._of_a_ship()
        except InputError as error:
            raise InputError(f"{self.name}: windage: {error}") from None

    def _of_a_ship(self) -> WindLoad:
        shape = Silhouette(self.windage_length, self.windage_frontal, self.windage_lateral)
        form: Isherwood | Blendermann
        if self.windage_model == "blendermann":
            form = Blendermann(shape, self.windage_type, self.windage_ahead, self.windage_height)
        else:
            for name in ("windage_beam", "windage_perimeter"):
                if not getattr(self, name) > 0.0:
                    raise InputError(f"{name} is 0, more is needed by isherwood")
            form = Isherwood(
                shape,
                self.windage_beam,
                self.windage_perimeter,
                0.5 * self.windage_length - self.windage_ahead,
                int(self.windage_masts),
                self.windage_superstructure,
            )
        return Ship(shape, form)
