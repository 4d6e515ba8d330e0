"""Reading the TOML files that a person writes: every mistake names the file and the key."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from ..errors import InputError, unknown
from ..files.reading import toml_content
from ..files.vehicle_folders import FOLDERS, PILOT, VEHICLE, Place, has, owner, place_in, stem
from ..kits import kits
from ..shipped import available, provided_folders, provided_place, shipped_folder

Model = TypeVar("Model", bound=BaseModel)
_TEMPLATES = Path(__file__).parents[1] / "templates"
"""A folder per command of `seatrial new` that takes a vehicle."""


class FileModel(BaseModel):
    """Base of the files' models: unknown keys are refused, values are not coerced."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


@dataclass(frozen=True)
class Source:
    """A file as it was read: its name for messages and manifests, its path, its hash.

    ``table`` is where in the file, joined by dots, if not the whole of it.
    """

    name: str
    path: Path
    sha256: str
    table: str = ""

    @property
    def where(self) -> str:
        """File and table, for messages."""
        return f"{self.path} [{self.table}]" if self.table else str(self.path)


def find_file(kind: str, name: str, relative_to: Path | None = None) -> Path:
    """Return the TOML file that ``name`` means, or is in; see `find_place`."""
    return find_place(kind, name, relative_to).path


def find_place(kind: str, name: str, relative_to: Path | None = None) -> Place:
    """Return where ``name`` stands: in a file of its own, or in one of a vehicle's folder.

    A path (with ``.toml``) wins, relative to ``relative_to`` or the current folder. A bare name
    is looked for in ``KIND`` (such as ``harness/rigs``) and in ``harness/vehicles`` beside the
    user's file that says it, then below the current folder, then among the files of the core and
    of kits. Raises InputError with near misses, and for a name that stands twice.
    """
    if name.endswith(".toml"):
        path = ((relative_to or Path.cwd()) / name).resolve()
        if not path.is_file():
            raise InputError(f"there is no file {path}")
        if kind != "harness/rigs" or path.name != VEHICLE:
            return Place(path)
        # A rig of anybody's may have that name, too.
        return Place(path) if has(Place(path, ("components",))) else Place(path, ("rig",))
    if (near := _near(kind, name, relative_to)) is not None:
        return near
    for root in (*_beside(relative_to), Path.cwd()):
        file, inside = root / kind / f"{name}.toml", place_in(root / FOLDERS, kind, name)
        if file.is_file() and inside is not None:
            raise InputError(f"{name!r} is there twice: {file} and {inside}; remove one")
        if file.is_file() or inside is not None:
            return inside or Place(file)
    if (provided := provided_place(kind, name)) is not None:
        return provided
    what = kind.rpartition("/")[2].rstrip("s") if "/" in kind else kind.rstrip("s")
    inner, slash, base = name.rpartition("/")
    known = [f"{inner}{slash}{each}" for each in available(f"{kind}{slash}{inner}")]
    said = unknown(what, name, known) + "; or give a path ending in .toml"
    if inner and (_TEMPLATES / inner).is_dir():
        said += f"; 'seatrial new {inner} {base} --like KIND' writes one"
    raise InputError(said + kits().hint())


def _near(kind: str, name: str, naming: Path | None) -> Place | None:
    """Return where a name stands for a file of a vehicle's folder that is in no harness."""
    folder = None if naming is None else naming.resolve()
    if folder is None or not any((folder / file).is_file() for file in (VEHICLE, PILOT)):
        return None
    is_in_harness = _beside(folder) or folder.parent in provided_folders(FOLDERS)
    return None if is_in_harness else place_in(folder.parent, kind, name)


def _beside(naming: Path | None) -> list[Path]:
    """Return the folder with the harness that the naming file stands in, if it is a user's."""
    for parent in naming.resolve().parents if naming is not None else ():
        if parent.name == "harness" and parent != shipped_folder("harness").resolve():
            return [parent.parent]
    return []


def read_toml(path: Path) -> tuple[dict[str, Any], Source]:
    """Return a TOML file's content and what it was read from.

    Raises InputError naming the file, and line and column if it is not TOML.
    """
    return parsed_toml(path, file_bytes(path))


def read_place(place: Place) -> tuple[dict[str, Any], Source]:
    """Return the content of a rig's file, or of the table of a vehicle's, and its source.

    Raises InputError as `read_toml` does, and for a table that is not there or none.
    """
    file, read_from = read_toml(place.path)
    content = place.content(file)
    if not isinstance(content, dict):
        raise InputError(f"{place}: a table is needed, found {content!r}")
    if owner(place.path) and not place.table:
        content = {key: value for key, value in content.items() if key != "rigs"}
    return content, replace(read_from, name=stem(place), table=".".join(place.table))


def file_bytes(path: Path) -> bytes:
    """Return what a file has. Raises InputError naming it if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None


def parsed_toml(path: Path, data: bytes) -> tuple[dict[str, Any], Source]:
    """Return what ``data`` of a file say in TOML; see `read_toml`."""
    content = toml_content(data, str(path))
    return content, Source(stem(Place(path)), path, hashlib.sha256(data).hexdigest())


def validated(model: type[Model], content: Any, path: Path | str, *, ours: str = "") -> Model:
    """Return ``content`` as ``model``; raise InputError naming each key that does not fit.

    ``ours`` is a key at the top of ``content`` that the file does not have.
    """
    try:
        return model.model_validate(content)
    except ValidationError as error:
        lines = _explained(model, error.errors(), content, ours)
        raise InputError("\n".join(f"{path}: {line}" for line in lines)) from None


def _explained(
    model: type[BaseModel], problems: Sequence[Any], content: Any, ours: str
) -> list[str]:
    """Return a line for each place; what several forms of a value would need is joined there."""
    said: dict[str, list[str]] = {}
    found: dict[str, Any] = {}
    for problem in problems:
        keys = _keys(problem, content)
        shown = keys[1:] if keys[:1] == [ours] else keys
        place = ".".join(f'"{k}"' if "." in k else k for k in shown) or "(top level)"
        if problem["type"] == "extra_forbidden":
            message = unknown("key", keys[-1], _known_keys(model, keys[:-1]))
        elif problem["type"] == "missing":
            message = "this key is missing"
        else:
            message, found[place] = problem["msg"], problem["input"]
        messages = said.setdefault(place, [])
        if message not in messages:
            messages.append(message)
    return [
        f"{place}: {'; or: '.join(messages)}"
        + (f", found {found[place]!r}" if place in found else "")
        for place, messages in said.items()
    ]


def _keys(problem: Any, content: Any) -> list[str]:
    """Return where a problem is in the file: pydantic names the forms of a value on the way."""
    keys, current, last = [], content, len(problem["loc"]) - 1
    for i, key in enumerate(problem["loc"]):
        inside = isinstance(current, dict) and key in current
        if inside or (isinstance(current, list) and isinstance(key, int)):
            current = current[key]
            keys.append(str(key))
        elif i == last and problem["type"] == "missing":
            keys.append(str(key))
    return keys


def _known_keys(model: type[BaseModel], keys: list[str]) -> list[str]:
    """Return the keys allowed at ``keys`` inside ``model``, as far as they can be followed."""
    current: Any = model
    for key in keys:
        field = getattr(current, "model_fields", {}).get(key)
        annotation = field.annotation if field is not None else current
        candidates = [a for a in _flattened(annotation) if _is_model(a)]
        if candidates:
            current = candidates[0]
    fields = getattr(current, "model_fields", {})
    return [field.alias or name for name, field in fields.items()]


def _flattened(annotation: Any) -> list[Any]:
    arguments = getattr(annotation, "__args__", ())
    return [annotation, *(a for argument in arguments for a in _flattened(argument))]


def _is_model(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)
