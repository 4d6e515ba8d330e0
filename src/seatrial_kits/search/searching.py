"""Libraries of questions: ``seatrial[search]`` brings them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from seatrial.errors import InputError


def needed(module: str) -> Any:
    """Return a module. Raises InputError if it is not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        raise InputError(
            f"this question needs {error.name}: python -m pip install 'seatrial[search]'"
        ) from None


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep linear algebra to one thread: sums have one order, whatever the machine has."""
    with needed("threadpoolctl").threadpool_limits(1):
        yield
