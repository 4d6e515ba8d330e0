"""The seabed of a component: one group of parameters, the same in all that need it."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from seatrial.errors import InputError
from seatrial.files.whole_file import stamp
from seatrial.model.component import Component, Parameter

from .grid import read_grid
from .obstacles import read_obstacles
from .plane import Plane
from .scene import Scene


class OverSeabed(Component):
    """Mix-in: a seabed and obstacles by parameters.

    The seabed is a plane, or the grid of a file; everything that moves over it takes the same
    parameters, so that there is one seabed and no connection.
    """

    seabed_depth = Parameter(0.0, "m", "depth of the seabed at the origin, 0 for none", min=0.0)
    seabed_slope = Parameter(
        0.0, "rad", "angle of the seabed with the horizontal", min=0.0, max=1.5
    )
    seabed_direction = Parameter(0.0, "rad", "where the seabed falls away to, clockwise from north")
    seabed_file = Parameter(
        "", "1", "grid of depths (.asc, .csv) in the place of a plane", role="file"
    )
    obstacles = Parameter(
        "",
        "1",
        "sphere, cylinder, capsule or box and its numbers, m and deg, {n}; with ;",
        check=read_obstacles,
    )

    def start(self, t: float) -> None:
        """Raise InputError for a seabed that cannot be, before anything looks at it."""
        self.scene()
        super().start(t)

    def scene(self) -> Scene:
        """Return seabed and obstacles. Raises InputError for what contradicts itself."""
        try:
            return _scene(
                self.seabed_depth,
                self.seabed_slope,
                self.seabed_direction,
                self.seabed_file,
                stamp(Path(self.seabed_file)) if self.seabed_file else (0, 0),
                self.obstacles,
            )
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None


@lru_cache(64)
def _scene(
    depth: float, slope: float, direction: float, file: str, stamp: tuple[int, int], shapes: str
) -> Scene:
    if file:
        if depth or slope:
            raise InputError(
                f"seabed_file is {file!r}: the file has the depths, and seabed_depth and "
                "seabed_slope must be 0"
            )
        return Scene(read_grid(Path(file)), read_obstacles(shapes))
    if not depth:
        if slope:
            raise InputError("seabed_slope needs a seabed_depth above 0 m")
        return Scene(None, read_obstacles(shapes))
    return Scene(Plane(depth, slope, direction), read_obstacles(shapes))
