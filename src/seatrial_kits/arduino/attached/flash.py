"""The flash of a board as a folder: files of LittleFS and SPIFFS, and values of Preferences."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from seatrial.errors import InputError

SYSTEMS = ("littlefs", "spiffs")


class Flash:
    """A copy of the folder ``begin``, and of a project's ``data`` in both file systems.

    ``littlefs/``, ``spiffs/`` and ``nvs/NAMESPACE/KEY`` are in it. Raises InputError for a folder
    that cannot be read.
    """

    def __init__(self, begin: str, data: Path | None) -> None:
        self._scratch = tempfile.TemporaryDirectory(prefix="seatrial-flash-")
        self.folder = self._scratch.name
        try:
            if data is not None and data.is_dir():
                for system in SYSTEMS:
                    shutil.copytree(data, Path(self.folder, system))
            if begin:
                shutil.copytree(Path(begin).expanduser(), self.folder, dirs_exist_ok=True)
        except OSError as error:
            self._scratch.cleanup()
            raise InputError(f"flash: {begin or data}: cannot be read: {error}") from None

    def end(self, after: str) -> None:
        """Write what is in it to the folder ``after``, '' for none, and leave nothing else.

        Raises InputError if that cannot be.
        """
        try:
            if after:
                target = Path(after).expanduser()
                for each in (*SYSTEMS, "nvs"):  # what else is there is not the flash's
                    shutil.rmtree(target / each, ignore_errors=True)
                shutil.copytree(self.folder, target, dirs_exist_ok=True)
        except OSError as error:
            raise InputError(f"flash_after: {after}: cannot be written: {error}") from None
        finally:
            self._scratch.cleanup()
