"""Beside the component: noise, a log of its own, programs outside that connect to it."""

from __future__ import annotations

import zlib

import numpy as np

from ..errors import InputError
from .ports import Output, Parameter


class Noise:
    """Mix-in for a component with randomness: numbers keyed by (seed, sample index).

    Never keyed by how often it was asked, so that a rerun, a half step or a rollback draws
    the same noise. Philox 4x64 with the seed and the kind of component as its key, so that
    different sensors of one seed differ, and the index as its counter.
    """

    seed = Parameter(
        1.0,
        "1",
        "seed of this instance's noise (a whole number)",
        min=0.0,
        max=2.0**53,
        role="seed",
    )

    def generator(self, index: int, stream: int = 0) -> np.random.Generator:
        """Return the generator of sample ``index``; draw all that the sample needs from it.

        Other streams of a sample are for what is drawn only sometimes.
        """
        if self.seed % 1.0:
            raise InputError(f"seed is {self.seed!r}, a whole number is needed")
        kind = zlib.crc32(type(self).__name__.encode())
        bits = np.random.Philox(key=[int(self.seed), kind], counter=[0, 0, stream, index])
        return np.random.Generator(bits)


class Logging:
    """Mix-in for a component that keeps a log of its own, in a format of its own.

    The master sets where, once there is a folder: that is after the start.
    """

    run_folder = Parameter(
        "",
        "1",
        "folder of the run, for logs of its own; empty: it keeps none",
        tunable=True,
        role="run-folder",
    )


class Reachable:
    """Mix-in for a component that programs outside connect to."""

    reached_at = Output(
        "1", "what others connect to, separated by spaces", type=str, role="address"
    )
    exceeded = Output(
        "1", "steps in which a peer brought more than one takes in", type=int, role="exceeded"
    )
    link_lost = Output(
        "1", "whether a link that was there is lost: unplugged, or its peer gone", type=bool,
        role="link-lost",
    )  # fmt: skip
    reconnections = Output("1", "times that a lost link came back", type=int, role="reconnections")
