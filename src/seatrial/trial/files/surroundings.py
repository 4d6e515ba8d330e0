"""Waves, current and wind of a trial: its keys ``sea``, ``current`` and ``wind``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from ...errors import InputError
from ...physics.sea.current import TIDES
from ...physics.sea.currents import LAYERS
from ...physics.sea.parameters import MeetsCurrent, MeetsWaves, MeetsWind
from ...physics.sea.seastate import SWELLS
from ...system.assembling.assumed import is_at_surface
from ...system.files import FileModel
from ...system.system import System

Quantity = float | str
Whole = Annotated[int, Field(ge=0)]

DOUGLAS = (0.0, 0.05, 0.3, 0.875, 1.875, 3.25, 5.0, 7.5, 11.5, 14.0)
"""Significant wave height, m, by degree of the sea (WMO code 3700): the middle of its range.

Of degree 9, over 14 m, its lower end.
"""


class SwellEntry(FileModel):
    """A swell beside the sea: JONSWAP, spread by cos-2s."""

    height: Quantity
    period: Quantity
    direction: Quantity = 0.0
    gamma: Quantity = 7.0
    spreading: Quantity = 0.0


class SeaEntry(FileModel):
    """The waves: the parameters of `MeetsWaves`, or a degree of the sea for the height."""

    spectrum: str | None = None
    height: Quantity | None = None
    douglas: Annotated[int, Field(ge=0, le=9)] | None = None
    period: Quantity | None = None
    direction: Quantity | None = None
    gamma: Quantity | None = None
    spreading: Quantity | None = None
    spreading_form: str | None = None
    seed: Whole | None = None
    components_per_octave: Whole | None = None
    highest: Quantity | None = None
    depth: Quantity | None = None
    amplitudes: str | None = None
    swell: list[SwellEntry] | None = Field(default=None, min_length=1, max_length=SWELLS)

    def parameters(self, where: str) -> dict[str, Any]:
        """Return the values of the parameters by name; none in a calm sea. Raises InputError."""
        written = self.model_dump(exclude_none=True, exclude={"douglas", "swell"})
        if self.swell is not None:
            written |= _swells(self.swell)
        if self.douglas is not None:
            if self.height is not None:
                raise InputError(f"{where}: douglas and height both say how high the sea is")
            written["height"] = DOUGLAS[self.douglas]
            if self.douglas == 0 and not self.swell:
                return {}
        if self.swell and not written.get("height"):
            written = {"spectrum": "none", **written}
        if "height" not in written and written.get("spectrum") != "none":
            raise InputError(f"{where}: a sea needs its height, or its degree as douglas")
        # A period that nobody gave is that of a fully developed sea.
        written.setdefault("spectrum", "pierson-moskowitz" if self.period is None else "jonswap")
        return written


def _swells(swells: list[SwellEntry]) -> dict[str, Any]:
    """Return the parameters of swells, a value for each that there can be."""
    unused = [SwellEntry(height=0.0, period=0.0)] * (SWELLS - len(swells))
    return {
        f"swell_{key}": [getattr(swell, key) for swell in (*swells, *unused)]
        for key in SwellEntry.model_fields
    }


class LayerEntry(FileModel):
    """The current at a depth, with linear shear and turning to the next."""

    depth: Quantity
    speed: Quantity
    direction: Quantity


class CurrentEntry(FileModel):
    """The current: the parameters of `MeetsCurrent`."""

    speed: Quantity | None = None
    direction: Quantity | None = None
    profile: str | None = None
    reach: Quantity | None = None
    layers: list[LayerEntry] | None = Field(default=None, min_length=2, max_length=LAYERS)
    tide: Quantity | None = None
    tide_axis: Quantity | None = None
    tide_minor: Quantity | None = None
    tide_period: Quantity | None = None
    """Or the name of a constituent: M2, S2, K1, O1."""
    tide_phase: Quantity | None = None
    variation: Quantity | None = None
    turning: Quantity | None = None
    variation_time: Quantity | None = None
    seed: Whole | None = None

    def parameters(self, where: str) -> dict[str, Any]:
        """Return the values of the parameters by name. Raises InputError."""
        written = self.model_dump(exclude_none=True, exclude={"layers"})
        if self.tide_period in TIDES:
            written["tide_period"] = TIDES[str(self.tide_period)]
        if self.layers is None:
            return written
        if self.profile not in (None, "layers"):
            raise InputError(f"{where}.profile: layers are given, and profile is {self.profile!r}")
        if self.speed is not None or self.direction is not None:
            raise InputError(f"{where}: layers have speeds and directions of their own")
        unused: list[Quantity] = [0.0] * (LAYERS - len(self.layers))
        return {
            **written,
            "profile": "layers",
            "layers": float(len(self.layers)),
            "layer_depths": [layer.depth for layer in self.layers] + unused,
            "layer_speeds": [layer.speed for layer in self.layers] + unused,
            "layer_directions": [layer.direction for layer in self.layers] + unused,
        }


class WindEntry(FileModel):
    """The wind: the parameters of `MeetsWind`."""

    speed: Quantity | None = None
    direction: Quantity | None = None
    profile: str | None = None
    spectrum: str | None = None
    gust: Quantity | None = None
    gust_start: Quantity | None = None
    gust_duration: Quantity | None = None
    seed: Whole | None = None

    def parameters(self, where: str) -> dict[str, Any]:
        """Return the values of the parameters by name."""
        return self.model_dump(exclude_none=True)


Group = Literal["sea", "current", "wind"]
GROUPS: tuple[Group, ...] = ("sea", "current", "wind")
_MET = {"sea": "waves", "current": "current", "wind": "wind"}


class Met(MeetsWaves, MeetsCurrent, MeetsWind):
    """All groups of parameters, to be checked and read as the components of a rig do."""


def set_surroundings(
    system: System, group: Group, entry: SeaEntry | CurrentEntry | WindEntry, where: str
) -> None:
    """Give the parameters of ``group`` to all components that have them.

    The seed is the run's unless it is given. A wind that nothing in the rig meets, as above a
    submerged vehicle, is a note. Raises InputError for a rig without a component that meets waves
    or current, a value that does not fit, or a sea that cannot be.
    """
    meeting = [
        name
        for name, part in system.parts.items()
        if part.instance.variables.of_role(group) and (group != "wind" or is_at_surface(part))
    ]
    if not meeting and group == "wind":
        system.notes.append(f"{where}: nothing in the rig meets it")
        return
    if not meeting:
        raise InputError(f"{where}: no component of the rig meets {_MET[group]}")
    given = entry.parameters(where)
    if not given:
        return
    given.setdefault("seed", float(system.seed))
    for name in meeting:
        for key, value in given.items():
            of_key = f"{where}.{key}"
            system.set(f"{name}.{group}_{key}", value, of_key)
    _check(system, group, meeting[0], where)
    apart = [port for port in _unreached(system, group) if port.rpartition(".")[0] not in meeting]
    if apart:
        system.notes.append(f"{where}: it does not reach {', '.join(apart)}: set or connect it")


def _unreached(system: System, group: Group) -> list[str]:
    """Return the inputs by the name of a group, of velocity, that no connection reaches."""
    found = []
    for path in (*system.unconnected_inputs(), *system.unconnected_inputs(optional=True)):
        component, _, port = path.rpartition(".")
        ports = system.parts[component].instance.variables.ports if port == group else {}
        if any(variable.unit == "m/s" for variable in ports.get(port, ())):
            found.append(path)
    return found


def _check(system: System, group: Group, name: str, where: str) -> None:
    """Raise InputError for values that contradict each other, and note what is doubtful."""
    met = Met(where)
    part = system.parts[name]
    values: Mapping[str, Any] = {
        variable: part.given[variable].value
        for variable in part.instance.variables.of_role(group)
        if variable in part.given
    }
    for variable, value in values.items():
        met.set(variable, value)
    if group == "current":
        met.current_state()
    elif group == "wind":
        met.wind_state()
    else:
        spectrum = met.sea_state().spectrum_of_it()
        outside = spectrum.outside() if spectrum is not None else None
        if outside is not None:
            system.notes.append(f"{where}: {outside}")
