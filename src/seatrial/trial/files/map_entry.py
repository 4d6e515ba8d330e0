"""The table ``map`` of a campaign: over which keys it is drawn, and points to draw on it."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ...system.files import FileModel

MOST_VALUES = 200
"""Along an axis."""
MOST_PANELS = 8
"""Columns, or rows."""


class MapPoint(FileModel):
    """A point that is drawn on a map, such as one that somebody has published."""

    name: str
    at: list[float | str] = Field(min_length=2, max_length=2)
    """Along x and y, as in the campaign."""
    panel: dict[str, Any] = Field(default_factory=dict)
    """The panel that it is on: values of ``columns`` and ``rows``; without a key, on all."""
    holds: bool | None = None
    """What is said of it elsewhere."""


class MapEntry(FileModel):
    """A map of a campaign: two keys as axes, up to two more as columns and rows of panels."""

    x: str
    y: str
    columns: str | None = None
    rows: str | None = None
    labels: dict[str, str] = Field(default_factory=dict)
    """What a key is called on the map."""
    points: list[MapPoint] = Field(default_factory=list)

    @property
    def keys(self) -> list[str]:
        """The keys of axes and panels."""
        return [key for key in (self.x, self.y, self.columns, self.rows) if key is not None]
