"""Bag of all that the link writes, as a recorder beside it would have it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .messages.definitions import type_store


class Bag:
    """A ROS 2 bag, MCAP inside, in the folder ``path``; times are those of the stamps, ns."""

    def __init__(self, path: Path) -> None:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        self._writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._writer.open()
        self._connections: dict[str, Any] = {}

    def write(self, topic: str, kind: str, data: bytes, now_ns: int) -> None:
        """Write a message of the kind, as bytes (`packing`)."""
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=type_store()
            )
        self._writer.write(self._connections[topic], now_ns, data)

    def close(self) -> None:
        """Finish the bag: without that it cannot be read."""
        self._writer.close()
