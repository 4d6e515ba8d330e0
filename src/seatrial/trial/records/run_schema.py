"""Models of the JSON files in run and campaign folders."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    Strict,
    StringConstraints,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from ...errors import InputError
from ...files.reading import json_content
from ...model.ports import VIEWS
from ...system.shape import Drawn, carried
from ..files.map_entry import MapEntry

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=2**63)]
Scalar = bool | int | float | str | None
_MOST_BINS = 64
"""Of durations in ns, by powers of two."""
_MOST_SHOWN = 5


class _Entry(BaseModel):
    """Base of the models: what they do not name may be there too."""

    model_config = ConfigDict(strict=True)


class _File(_Entry):
    name: str
    file: str
    sha256: str
    title: str | None = None


class _Parameter(_Entry):
    value: Scalar
    unit: str
    origin: str | None = Field(default=None, alias="from")
    source: str | None = None
    mark: str | None = None


class _Outline(_Entry):
    length: Number
    beam: Number


class _Moved(_Entry):
    """What moves a part: the signal, of which gain times the value plus offset is the port's."""

    signal: str
    gain: Number = 1.0
    offset: Number = 0.0


class _Turn(_Moved):
    about: list[Number] = Field(min_length=3, max_length=3)
    factor: Number = 1.0


class _Stretch(_Moved):
    full: Number = Field(gt=0.0)


class _Slide(_Moved):
    along: list[Number] = Field(min_length=3, max_length=3)


class _ShapePart(Drawn):
    """A part of a shape, with signals in the place of ports."""

    turn: _Turn | None = None
    stretch: _Stretch | None = None
    slide: _Slide | None = None
    sha256: str | None = Field(default=None, pattern="^[0-9a-f]{64}$")


def _views(views: dict[str, dict[str, str]]) -> dict[str, dict[str, str]]:
    for kind, ports in views.items():
        lacking = [port for port in VIEWS.get(kind, ()) if port not in ports]
        if lacking:
            raise ValueError(f"the view {kind!r} lacks {', '.join(lacking)}")
    return views


_DRAWN = {
    "deck": (("place", (".z",)), ("size", (".x", ".y"))),
    "field-of-view": (("height", ("",)), ("angle", ("",)), ("reach", ("",))),
    "landing-point": (("place", (".x", ".y")),),
    "target": (("place", (".x", ".y", ".z")), ("radius", ("",))),
}
"""Parameters that views are drawn by, and their axes."""


class _Component(_Entry):
    fmu: str
    sha256: str | None
    step: Number
    parameters: dict[str, _Parameter]
    views: Annotated[dict[str, dict[str, str]], AfterValidator(_views)] = Field(
        default_factory=dict
    )
    outline: _Outline | None = None
    shape: Annotated[list[_ShapePart], AfterValidator(carried)] = Field(
        default_factory=list, max_length=200
    )
    home: Annotated[tuple[Number, Number, Number], Strict(False)] | None = None

    @model_validator(mode="after")
    def _has_what_is_viewed(self) -> _Component:
        for parameter in self._viewed():
            if not isinstance(self._value(parameter), (int, float)):
                raise ValueError(f"a view needs the parameter {parameter!r}, a number")
        return self

    def _value(self, parameter: str) -> Scalar:
        return self.parameters[parameter].value if parameter in self.parameters else None

    def _viewed(self) -> Iterator[str]:
        for kind, wanted in _DRAWN.items():
            if ports := self.views.get(kind):
                yield from (f"{ports[port]}{axis}" for port, axes in wanted for axis in axes)
        if ports := self.views.get("waypoints"):
            count = self._value(ports["count"])
            if not isinstance(count, (int, float)) or not float(count).is_integer():
                raise ValueError(f"a view needs the parameter {ports['count']!r}, a whole number")
            for number in range(1, int(count) + 1):
                yield from (f"{ports['place']}_{number}.{axis}" for axis in ("north", "east"))


class _Signal(_Entry):
    unit: str
    type: Literal["Real", "Integer", "Boolean", "String", "Binary"] | None = None
    description: str


class _Plot(_Entry):
    title: str
    signals: list[str] = Field(min_length=1)


class _Criterion(_Entry):
    name: str
    check: str
    paths: dict[str, str] = Field(default_factory=dict)


_Pair = Annotated[tuple[bool | int, bool | int], Strict(False)]
_Connection = (
    Annotated[tuple[str, str], Strict(False)]
    | Annotated[tuple[str, str, Number, Number], Strict(False)]
    | Annotated[tuple[str, str, Number, Number, list[_Pair]], Strict(False)]
)
"""From, to; factor and offset; mapping, pairs of values. JSON has lists only."""


class _Identity(_Entry):
    program: dict[str, str]
    files: dict[str, dict[str, str]]


class _Imported(_Entry):
    """What a record that was imported from a log, or into which one played, has of the log."""

    format: str
    serves: dict[str, str] = Field(default_factory=dict)
    """Signals by the quantities that they are."""
    orders: dict[str, str] = Field(default_factory=dict)
    """Signals of the log by the inputs that they fed."""
    notes: list[str] = Field(default_factory=list)


class Manifest(_Entry):
    """``manifest.json``."""

    format: Literal[1]
    trial: _File
    rig: _File
    components: dict[str, _Component]
    connections: list[_Connection]
    signals: dict[str, _Signal]
    criteria: list[_Criterion]
    status: (
        Literal["running", "complete", "ended", "stopped", "failed"]
        | Annotated[str, StringConstraints(pattern="^ended by .")]
    )
    error: str | None = None
    step: Number | None = None
    versions: dict[str, Any] = Field(default_factory=dict)
    identity: _Identity | None = None
    plots: list[_Plot] = Field(default_factory=list)
    events: list[Any] = Field(default_factory=list)
    faults: list[Any] = Field(default_factory=list)
    log: _Imported | None = None


_Limit = Annotated[tuple[str, Number, str], Strict(False)]
"""Signal, value and kind; JSON has lists only."""


class _Verdict(_Entry):
    name: str
    check: str
    passed: bool
    detail: str
    worst: Number | None
    unit: str
    time: Number | None
    limits: list[_Limit]
    robustness: Number | None = None
    margin: str = ""
    expected: Literal["pass", "fail"] = "pass"
    why: str = ""


class _Durations(_Entry):
    steps: Count
    mean_s: Number
    p50_at_most_s: Number
    p99_at_most_s: Number
    longest_s: Number
    longest_at_s: Number | None
    bins: list[Count] = Field(max_length=_MOST_BINS)

    @model_validator(mode="after")
    def _has_longest(self) -> _Durations:
        if self.steps and self.longest_at_s is None:
            raise ValueError("steps without a longest_at_s")
        return self


class _Pacing(_Entry):
    overruns: _Durations
    slack: _Durations
    wake_ups: _Durations


class _LostLinks(_Entry):
    first_at: Number
    lost_s: Number
    reconnections: Count


class _Timing(_Entry):
    step_times: dict[str, _Durations] = Field(default_factory=dict)
    pacing: _Pacing | None = None
    lost_links: dict[str, _LostLinks] = Field(default_factory=dict)


class _CaseVerdict(_Entry):
    name: str
    check: str
    passed: bool
    detail: str
    worst: Number | None = None
    unit: str | None = None
    robustness: Number | None = None
    margin: str = ""
    expected: Literal["pass", "fail"] = "pass"
    why: str = ""


def _inside(folder: str) -> str:
    if folder in ("", ".", "..") or "/" in folder or "\\" in folder or "\0" in folder:
        raise ValueError("the name of a folder in the campaign's is needed")
    return folder


class _Case(_Entry):
    name: str
    folder: Annotated[str, AfterValidator(_inside)]
    trial: str = ""
    set: dict[str, Any]
    status: str
    passed: bool
    verdicts: list[_CaseVerdict]


class _Accepted(_Entry):
    name: str
    check: str
    verdict: Literal["pass", "fail", "undecided"]
    detail: str


class _Campaign(_Entry):
    name: str
    file: str | None = None
    engine: str | None = None
    title: str = ""
    cases: list[_Case]
    table: str | None = None
    count: Count | None = None
    page: str | None = None
    left_out: dict[str, str] = Field(default_factory=dict)
    map: MapEntry | None = None
    identity: _Identity | None = None
    criteria: list[_Accepted] = Field(default_factory=list)


class _Closed(BaseModel):
    """Base of the models that name all there may be."""

    model_config = ConfigDict(strict=True, extra="forbid")


class _Accuracy(_Closed):
    signal: str
    unit: str
    behaviour: Literal["converges", "exact", "not converging"]
    range: Number
    differences: list[Number] = Field(min_length=2)
    orders: list[Number]
    errors: list[Number]

    @model_validator(mode="after")
    def _has_errors(self) -> _Accuracy:
        if self.behaviour == "converges" and (len(self.errors) < 2 or not self.orders):
            raise ValueError("converges needs orders and errors")
        return self


class _Discrete(_Closed):
    signal: str
    differs_at: list[Number | None]

    @model_validator(mode="after")
    def _differs(self) -> _Discrete:
        if all(at is None for at in self.differs_at):
            raise ValueError("a time is needed in differs_at")
        return self


class _Convergence(_Closed):
    trial: str
    steps: list[Number] = Field(min_length=3)
    folders: list[str]
    outputs: list[_Accuracy]
    discrete: list[_Discrete]
    components: list[str]

    @model_validator(mode="after")
    def _falling(self) -> _Convergence:
        if self.steps[-1] <= 0.0 or any(a <= b for a, b in pairwise(self.steps)):
            raise ValueError("steps above 0, each smaller than the one before, are needed")
        return self


MANIFEST = TypeAdapter(Manifest)
VERDICTS = TypeAdapter(list[_Verdict])
TIMING = TypeAdapter(_Timing)
CAMPAIGN = TypeAdapter(_Campaign)
CONVERGENCE = TypeAdapter(_Convergence)


def checked_json(path: Path, schema: TypeAdapter[Any]) -> Any:
    """Return what a JSON file holds, as it is there, once it fits ``schema``.

    Raises InputError naming the file, each place that does not fit and what was found there.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    content = json_content(data, str(path))
    try:
        schema.validate_python(content)
    except ValidationError as error:
        raise InputError("\n".join(_explained(path, error))) from None
    return content


def _explained(path: Path, error: ValidationError) -> list[str]:
    problems = error.errors(include_url=False)
    lines = []
    for problem in problems[:_MOST_SHOWN]:
        place = ".".join(map(str, problem["loc"])) or "(top level)"
        said = f"{problem['msg']}, found {_shortened(problem['input'])}"
        if problem["type"] == "missing":
            said = "this key is missing"
        elif problem["type"] == "value_error" and isinstance(problem["input"], (dict, list)):
            said = problem["msg"].removeprefix("Value error, ")
        lines.append(f"{path}: {place}: {said}")
    if len(problems) > _MOST_SHOWN:
        lines.append(f"{path}: and {len(problems) - _MOST_SHOWN} more")
    return lines


def _shortened(value: Any) -> str:
    if isinstance(value, (dict, list)):
        return "a table" if isinstance(value, dict) else "a list"
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
