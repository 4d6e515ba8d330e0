"""Rally points: places to return to, other than home."""

from __future__ import annotations

import math

from seatrial.links.geodesy import Ned

from ..missions.plan import Plan
from ..service import Service
from ..transport import Transport
from ..vehicle import Vehicle


class RallyService(Service):
    """Chooses where the vehicle returns to: the nearest of home and the rally points.

    The nearest when the mode return begins is kept until it ends; home is followed if it moves.
    Depths are left out of distances; altitudes to break off, and directions to land, are not
    obeyed.
    """

    def __init__(self, vehicle: Vehicle, transport: Transport, plan: Plan) -> None:
        super().__init__(vehicle, transport)
        self._plan = plan
        self._known: tuple[object, object] | None = None
        self._points: list[Ned] = []
        self._chosen: Ned | None = None

    @property
    def refuge(self) -> Ned:
        """Position the vehicle returns to, in {n}."""
        return self.vehicle.home_n if self._chosen is None else self._chosen

    def tick(self, now: float) -> None:
        """Choose, unless the vehicle is on its way."""
        if self.vehicle.mode.name == "return":
            return
        if self._known != (self._plan.items, self.vehicle.home_n):
            self._known = (self._plan.items, self.vehicle.home_n)
            places = [item.place(self.vehicle) for item in self._plan.items]
            self._points = [place for place in places if place is not None]
        nearest = min((self.vehicle.home_n, *self._points), key=self._distance)
        self._chosen = None if nearest == self.vehicle.home_n else nearest

    def _distance(self, place: Ned) -> float:
        return math.dist(place[:2], self.vehicle.estimates.position_n[:2])
