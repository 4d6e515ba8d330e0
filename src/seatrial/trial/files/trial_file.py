"""The content of a trial file (``harness/trials/*.toml``)."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from ...sim.clock import OverrunPolicy
from ...system.fault_entry import FaultEntry
from ...system.files import FileModel
from ..criteria.verdict import Expectation
from .limit_entry import LimitEntry
from .seabed_entry import SeabedEntry
from .surroundings import CurrentEntry, SeaEntry, WindEntry
from .utc import Utc


class RecordEntry(FileModel):
    """What is recorded: signal patterns, and how often (default: every communication step)."""

    signals: list[str] = Field(default_factory=lambda: ["*"])
    every: str | None = None


class CriterionEntry(FileModel):
    """A named condition that must hold; with ``ends`` the run ends where that is decided."""

    name: str
    check: str
    ends: bool = False
    expect: Expectation = "pass"
    """Of the trial as its file has it: whoever changes a setting expects that all hold."""
    why: str = ""
    """Why it is expected to fail: what is published, a defect that is known."""

    @model_validator(mode="after")
    def _says_why(self) -> CriterionEntry:
        if (self.expect == "fail") != bool(self.why):
            raise PydanticCustomError("why", 'expect = "fail" needs why, and only that')
        return self


_FORMER = {
    "override": '[[faults]] what = "fixed", where, value, at, for',
    "bias": '[[faults]] what = "bias", where, value, at, for',
    "release": "the key `for` of [[faults]]",
}


class EventEntry(FileModel):
    """Something that happens at a time: ports are set."""

    at: str
    set: dict[str, Any] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _refuse_former_keys(cls, written: Any) -> Any:
        """Say what has become of override, bias and release."""
        for key, what in _FORMER.items():
            if isinstance(written, dict) and key in written:
                raise PydanticCustomError(
                    "former",
                    "'{key}' is written as a fault now: {what}",
                    {"key": key, "what": what},
                )
        return written


class PlotEntry(FileModel):
    """Signals of one unit that a report draws together, over time."""

    title: str
    signals: list[str] = Field(min_length=1)


def _signal(written: str) -> str:
    if "." not in written:
        raise PydanticCustomError("signal", "A signal, component.port, is needed")
    return written


_Signal = Annotated[str, AfterValidator(_signal)]


class RealTimeEntry(FileModel):
    """How a run keeps to wall time."""

    factor: Annotated[float, Field(ge=1e-9, allow_inf_nan=False)] | _Signal = 1.0
    """Simulated seconds per second of wall time, or the signal that gives it."""
    paused: _Signal | None = None
    """Signal with the seconds of wall time that are excluded."""
    overrun: OverrunPolicy = "catch-up"


class TrialFile(FileModel):
    """The content of a trial file."""

    title: str = ""
    rig: str
    choices: dict[str, str] = Field(default_factory=dict)
    """Of the rig: the vehicle, the autopilot."""
    start: str = "0 s"
    stop: str
    variant: str | None = None
    seed: int = Field(default=1, ge=0)
    utc: Utc | None = None
    sea: SeaEntry | None = None
    current: CurrentEntry | None = None
    wind: WindEntry | None = None
    seabed: SeabedEntry | None = None
    set: dict[str, Any] = Field(default_factory=dict)
    record: RecordEntry = Field(default_factory=RecordEntry)
    real_time: RealTimeEntry | None = None
    limit: LimitEntry = Field(default_factory=LimitEntry)
    criteria: list[CriterionEntry] = Field(default_factory=list)
    plots: list[PlotEntry] = Field(default_factory=list)
    events: list[EventEntry] = Field(default_factory=list)
    faults: list[FaultEntry] = Field(default_factory=list)
    scenario: str | None = None
    """A scenario file of libcosim, whose events come after those of the same time here."""
