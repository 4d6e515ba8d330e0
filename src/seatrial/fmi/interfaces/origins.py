"""A user's own files in the messages of FMUs that carry copies of them."""

from __future__ import annotations

import re
from pathlib import Path

from ...kits import OURS
from .loaded import LoadedFmu

_COPY = re.compile(r'(?<=File ")([^"\n]*[/\\]resources[/\\]bundle_[0-9a-f]+)[/\\]([^"\n]+)(?=")')
_TOP = Path(__file__).parents[3]


def with_origins(text: str, fmu: LoadedFmu) -> str:
    """Return a traceback with the files that the FMU's code was copied from, where they are known.

    Copies have the same lines. What an FMU file of somebody else carries stays as it is.
    """

    def original(found: re.Match[str]) -> str:
        place = Path(found[2])
        own = fmu.origin / place if fmu.origin is not None else place
        ours = _TOP / place if place.parts[0] in OURS else own
        shown = ours if ours.is_file() else own
        return str(shown) if fmu.origin is not None and shown.is_file() else found[0]

    return _COPY.sub(original, text)
