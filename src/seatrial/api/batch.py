"""Copies of a rig in compiled code: `Batch`, which a kit brings."""

from __future__ import annotations

from ..plugins import service

Batch = service("batch.Batch")
