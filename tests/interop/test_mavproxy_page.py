"""The session of docs/kits/mavlink/ground-stations.md is what MAVProxy really prints."""

from __future__ import annotations

from pathlib import Path

from .mavproxy_page import follow, session


def test_the_session_of_the_page(tmp_path: Path) -> None:
    with session(tmp_path) as proxy:
        follow(proxy)
        assert [line for line in proxy.complaints("Received") if "DENIED" not in line] == []
