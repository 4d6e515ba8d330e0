"""FMUs that proxy-fmu runs in a process of its own, ``proxyfmu://localhost?file=PATH``."""

from __future__ import annotations

from urllib.parse import SplitResult, parse_qs


def proxied_file(uri: SplitResult) -> str | None:
    """Return the path in the URI of an FMU on this machine; None for any other URI.

    A port names a server that somebody started, which runs FMUs of its own.
    """
    if uri.scheme != "proxyfmu" or uri.netloc not in ("localhost", "127.0.0.1"):
        return None
    query = parse_qs(uri.query)
    files = query.pop("file", [])
    return files[0] if len(files) == 1 and not query and not uri.fragment else None
