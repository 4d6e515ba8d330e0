"""Native FMUs in the user's cache, for rigs that run on this machine."""

from __future__ import annotations

import hashlib
import sys
import zipfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import seatrial.fmi
from seatrial.errors import InputError
from seatrial.fmi.building.bundle_name import bundle_name
from seatrial.fmi.cache import cache_folder, write_named
from seatrial.fmi.compiler import FLAGS, HERE, library_here, require_compiler
from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.forwarding.sources import SEAL

from .carriers import checked, refuse
from .export import build_native_fmu
from .selfcheck import DifferenceError
from .tables import is_built_in
from .translation.constants import fingerprint


def native_fmu(
    source: ComponentSource, values: Mapping[str, Any] | None = None, *, surrounded: bool = False
) -> Path:
    """Return the native FMU of ``source`` for this machine, built if it is not there yet.

    ``values`` (by scalar, SI) are parameters as a rig gives them. Texts and what is
    ``structural`` are built in, and waves, current and wind, if it is no plant that is
    ``surrounded`` by them; other numbers are to be set before the run as ever: one FMU serves all
    of them. The machine's own C compiler builds it (``cc``), else Zig's.

    Raises InputError, with the reason, for a component that has no C, values that it cannot
    start with or that cannot be built in, and without a compiler.
    """
    refuse(source)
    require_compiler()
    cls = source.component_class()
    given = values or {}
    scalars = cls.scalar_by_name
    own = {
        name: value
        for name, value in given.items()
        if name in scalars and is_built_in(cls, scalars[name].port, surrounded=surrounded)
    }
    text = f"{_tool_tag()} {fingerprint(cls)} {sorted(own.items())!r} {surrounded}"
    tag = hashlib.sha256(text.encode()).hexdigest()[:12]
    path = cache_folder("native") / f"{bundle_name(source)}-{tag}.fmu"
    refused = path.with_suffix(".refused")
    if refused.is_file():
        raise InputError(refused.read_text(encoding="utf-8"))
    if not zipfile.is_zipfile(path):
        component = cls(source.name)
        for name, value in given.items():
            component.set(name, value)
        checked(component, source.origin)
        try:
            build_native_fmu(
                source, path, (HERE,), own, library_here, given=given, surrounded=surrounded
            )
        except DifferenceError as error:
            write_named(refused, str(error).encode())
            raise
    return path


@cache
def _tool_tag() -> str:
    """Return a tag of what besides the component decides an FMU's bytes."""
    digest = hashlib.sha256(repr((FLAGS, HERE, sys.version_info[:2])).encode())
    folder, fmi = Path(__file__).parent, Path(str(seatrial.fmi.__file__)).parent
    described = [fmi / "description.py", SEAL, *fmi.glob("dependencies/*.py")]
    for file in sorted([*described, *folder.rglob("*.py"), *folder.rglob("*.[ch]")]):
        digest.update(file.read_bytes())
    return digest.hexdigest()
