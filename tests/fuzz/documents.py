"""Documents such as JSON files hold, changed here and there as the bytes of a fuzzer say."""

from __future__ import annotations

import copy
from typing import Any

ODD: list[Any] = [
    None, True, 0, -1, 1, 65, 2**53, 2**63, 10**30, 0.5, -0.0, 1e308, float("nan"), float("inf"),
    "", "x", "a.b", "hull", "hull.position.x", "position", "complete", "\x1b[31m", "\u202e",
    "<script>", "../..", "rad", "1e9 s", "\0", "1" * 5000, [], {}, [[]], ["hull.position.x"],
    {"x": 1}, [1, 2, 3], [None], {"value": 1e400, "unit": "m"}, [["a", 1.0, "limit"]],
]  # fmt: skip


def changed(document: Any, data: bytes) -> Any:
    """Return a copy of ``document``; each change takes some of ``data``: a way in, then a value."""
    root = {"": copy.deepcopy(document)}
    numbers = iter(data)
    for first in numbers:
        parent: Any = root
        key: Any = ""
        step: int | None = first
        while step is not None and isinstance(parent[key], (dict, list)) and parent[key]:
            inside = parent[key]
            place = step % (len(inside) + 1)
            if place == len(inside):
                break
            parent, key = inside, list(inside)[place] if isinstance(inside, dict) else place
            step = next(numbers, None)
        what = next(numbers, 0)
        if what == 255 and parent is not root:
            del parent[key]
        else:
            parent[key] = copy.deepcopy(ODD[what % len(ODD)])
    return root[""]
