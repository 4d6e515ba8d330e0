"""The log of a campaign under way: a line per case that has ended, in whatever order."""

from __future__ import annotations

from pathlib import Path

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole

from .ended import Ended
from .resuming import Note, cut_aside, is_whole

ENDED_LOG = "ended.jsonl"


class EndedLog:
    """Appends lines; a campaign that was killed has all but the one that was being written.

    Use it as a context manager.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / ENDED_LOG
        self._cut()
        self._file = self.path.open("a", encoding="utf-8", newline="\n")

    def __enter__(self) -> EndedLog:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def add(self, ended: Ended) -> None:
        """Append a case; it is with the system when this returns."""
        self._file.write(ended.line() + "\n")
        self._file.flush()

    def _cut(self) -> None:
        """Take back a last line that was not written whole."""
        data = self.path.read_bytes() if self.path.is_file() else b""
        whole = data.rfind(b"\n") + 1
        if whole < len(data):
            with self.path.open("r+b") as file:
                file.truncate(whole)


def ended_cases(folder: Path, count: int, note: Note) -> dict[int, Ended]:
    """Return the cases in a folder's log, by number; none without a log.

    A line that cannot be read is as if its case had not ended, and so is a case whose folder has
    no manifest that can be read; the log as it was is set aside, which is noted. Raises InputError
    for a case that is none of ``count``.
    """
    path = folder / ENDED_LOG
    if not path.is_file():
        return {}
    found: dict[int, Ended] = {}
    cut = []
    lines = path.read_text("utf-8", errors="replace").splitlines(keepends=True)
    for place, line in enumerate(lines, 1):
        if not line.endswith("\n"):
            break
        try:
            ended = Ended.of_line(line)
        except (ValueError, KeyError, TypeError):
            cut.append(place)
            continue
        if not 0 <= ended.number < count:
            raise InputError(f"{path}, line {place}: there is no case {ended.number + 1}")
        if not ended.folder or is_whole(folder / ended.folder, note):
            found[ended.number] = ended
    if cut:
        cut_aside(path, f"{path}, line {cut[0]}: this is no case that has ended", note)
        write_whole(path, "".join(ended.line() + "\n" for ended in found.values()), synced=True)
    return found
