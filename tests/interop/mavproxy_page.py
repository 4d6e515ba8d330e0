"""The session of docs/kits/mavlink/ground-stations.md, typed into a MAVProxy at a running trial."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .mavproxy import MavProxy, mavproxy
from .running import HOST, free_port, running, wait_for

PAGE = Path(__file__).parents[2] / "docs/kits/mavlink/ground-stations.md"
FACTOR = 5.0
MISSION_S = 240.0
"""Wall time for what a boat needs half a minute of simulated time for."""


def shown(name: str) -> str:
    """Return a block of the page by the comment before it."""
    pattern = rf"^<!-- session: {re.escape(name)} -->\n```text\n(.*?)^```$"
    found = re.search(pattern, PAGE.read_text("utf-8"), re.S | re.M)
    assert found is not None, name
    return found[1]


def steps() -> list[tuple[str, str, list[str]]]:
    """Return prompt and line that is typed, and what MAVProxy must say then, in this order."""
    found: list[tuple[str, str, list[str]]] = []
    for line in shown("typed").splitlines():
        prompt, _, typed = line.partition("> ")
        if typed and prompt.isupper():
            found.append((prompt, typed, []))
        else:
            found[-1][2].append(line)
    return found


@contextmanager
def session(folder: Path) -> Iterator[MavProxy]:
    """Yield a MAVProxy that knows the vehicle of a running trial, and has the page's files."""
    port, home = free_port(), folder / "home"
    given = {"autopilot__mavlink__links": f"udpout:{HOST}:{port}"}
    with (
        running("hydrone-mission", folder, factor=FACTOR, **given) as trial,
        mavproxy(home, f"udpin:{HOST}:{port}") as proxy,
    ):
        (home / "square.txt").write_text(shown("square.txt"), "utf-8")
        wait_for(lambda: trial.is_running, "the trial's first step")
        proxy.expect(r"Received \d+ parameters")
        # It may ask for all of them once more, and shows none meanwhile.
        proxy.insist("param show FS_ACTION", r"FS_ACTION +\d", each_s=5.0)
        yield proxy


def follow(proxy: MavProxy) -> list[tuple[str, str, str]]:
    """Type what the page shows, and see that MAVProxy says what it shows.

    Return each prompt, line, and all that was printed before the next.
    """
    begun = []
    for prompt, typed, transcript in steps():
        begun.append((prompt, typed, proxy.transcript.rfind("\n") + 1))
        patterns = [rf"(^|> ){re.escape(line)}" for line in transcript] or [""]
        proxy.ask(typed, patterns[0], MISSION_S)
        for pattern in patterns[1:]:
            proxy.expect(pattern, MISSION_S)
    ends = [*(at for _, _, at in begun[1:]), len(proxy.transcript)]
    return [
        (p, typed, proxy.transcript[at:end])
        for (p, typed, at), end in zip(begun, ends, strict=True)
    ]
