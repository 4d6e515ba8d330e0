"""Copies of rigs in compiled code: `Batch` and `Batches`, which a kit brings."""

from __future__ import annotations

from ..plugins import service

Batch = service("batch.Batch")
Batches = service("batch.Batches")
