"""Reading the TOML files that a person writes: every mistake names the file and the key."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from ..errors import InputError, unknown
from ..kits import kits
from ..reading import toml_content
from ..shipped import available, provided_file, shipped_folder

Model = TypeVar("Model", bound=BaseModel)


class FileModel(BaseModel):
    """Base of the files' models: unknown keys are refused, values are not coerced."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


@dataclass(frozen=True)
class Source:
    """A file as it was read: its name for messages and manifests, its path, its hash."""

    name: str
    path: Path
    sha256: str


def find_file(kind: str, name: str, relative_to: Path | None = None) -> Path:
    """Return the TOML file that ``name`` means.

    A path (with ``.toml``) wins, relative to ``relative_to`` or the current folder. A bare name
    is looked for in ``KIND`` (such as ``harness/rigs``) beside the user's file that says it,
    then below the current folder, then among the files of the core and of kits. Raises InputError
    with near misses, and for a name that two of the latter have.
    """
    if name.endswith(".toml"):
        path = ((relative_to or Path.cwd()) / name).resolve()
        if not path.is_file():
            raise InputError(f"there is no file {path}")
        return path
    for folder in (*_beside(kind, relative_to), Path.cwd() / kind):
        path = folder / f"{name}.toml"
        if path.is_file():
            return path
    if (provided := provided_file(kind, name)) is not None:
        return provided
    what = kind.rpartition("/")[2].rstrip("s") if "/" in kind else kind.rstrip("s")
    inside, slash, _ = name.rpartition("/")
    known = [f"{inside}{slash}{each}" for each in available(f"{kind}{slash}{inside}")]
    raise InputError(
        unknown(what, name, known) + "; or give a path ending in .toml" + kits().hint()
    )


def _beside(kind: str, naming: Path | None) -> list[Path]:
    """Return the folder of ``kind`` in the harness that the naming file stands in, if a user's."""
    top, _, below = kind.partition("/")
    for parent in naming.resolve().parents if naming is not None else ():
        if parent.name == "harness" and parent != shipped_folder("harness").resolve():
            folder = parent / below if top == "harness" else parent.parent / kind
            return [folder] if folder.is_dir() else []
    return []


def read_toml(path: Path) -> tuple[dict[str, Any], Source]:
    """Return a TOML file's content and what it was read from.

    Raises InputError naming the file, and line and column if it is not TOML.
    """
    return parsed_toml(path, file_bytes(path))


def file_bytes(path: Path) -> bytes:
    """Return what a file has. Raises InputError naming it if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None


def parsed_toml(path: Path, data: bytes) -> tuple[dict[str, Any], Source]:
    """Return what ``data`` of a file say in TOML; see `read_toml`."""
    content = toml_content(data, str(path))
    return content, Source(path.stem, path, hashlib.sha256(data).hexdigest())


def validated(model: type[Model], content: Any, path: Path, *, ours: str = "") -> Model:
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
