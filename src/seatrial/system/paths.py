"""Names in a rig: ``component.port.axis``, where a component of an assembly has dots too."""

from __future__ import annotations

from collections.abc import Container


def split_path(components: Container[str], written: str) -> tuple[str, str]:
    """Return the component that a name begins with, and the port or scalar behind it.

    ``vehicle.hull.position.x`` is ``("vehicle.hull", "position.x")``: no component's name is
    the beginning of another's. If it begins with none, it is split at the first dot.
    """
    end = written.find(".")
    while end != -1:
        if written[:end] in components:
            return written[:end], written[end + 1 :]
        end = written.find(".", end + 1)
    name, _, port = written.partition(".")
    return name, port


def split_axis(scalar: str) -> tuple[str, str]:
    """Return the port that a scalar belongs to, and its axis: empty if it is the port itself.

    ``position.x`` is ``("position", "x")``; ``pump.flow[3]``, as others call theirs, has no axis.
    """
    port, _, axis = scalar.rpartition(".")
    return (port, axis) if port and axis.isidentifier() else (scalar, "")


def joined(path: str, name: str) -> str:
    """Return the path of ``name`` inside the assembly at ``path``; empty is the top."""
    return f"{path}.{name}" if path else name
