"""Workers of a Dask cluster: the same evaluators, in the processes that Dask has started."""

from __future__ import annotations

import hashlib
import ipaddress
import re
import tempfile
import threading
from collections import defaultdict
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from importlib import import_module
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from seatrial.errors import InputError
from seatrial.links.hardware import check_host, resolved

from .asked import Asked, asked_of
from .campaign import Campaign
from .ended import Ended
from .evaluator import Evaluator, Plan, still
from .shipment import pack_folder, packed, unpacked
from .workers import Task

_WAIT_S = 30
"""For the scheduler, and for the first worker."""
_LATE_S = 5
"""What Dask may take longer than it was asked to."""
_TASK_S = 2.0
"""Wall time of a task of short cases: a scheduler does some thousand tasks a second."""
_MOST_CASES = 1000
_ADDRESS = re.compile(
    r"(?:(?P<scheme>tcp|tls)://)?(?P<host>\[[^\]]+\]|[^:/\[\]]+):(?P<port>\d{1,5})"
)
Question = tuple[str, Mapping[int, Mapping[str, Any]]]
"""A question's name, and what its cases set, by their numbers."""
_PER_THREAD = 4
"""Tasks that wait for each thread of a worker."""


def check_address(address: str) -> None:
    """Raise InputError for what is no scheduler's address, or one of another host unless allowed.

    A scheduler and its workers send pickles: whoever is there runs code as the user here.
    """
    match = _ADDRESS.fullmatch(address)
    if match is None:
        raise InputError(
            f"--cluster: HOST:PORT, tcp://HOST:PORT or tls://HOST:PORT is needed, found {address!r}"
        )
    host = match["host"].strip("[]")
    try:
        check_host("--cluster", str(ipaddress.ip_address(host)))
    except ValueError:
        check_host("--cluster", resolved("--cluster", host))


def _connected(client: Any, address: str) -> Any:
    """Return a client of a scheduler. Raises what Dask does, OSError for a peer that is none.

    Dask waits without end for a greeting that does not come, of a web server say: in a thread
    that may be left behind.
    """
    found: list[Any] = []

    def connect() -> None:
        try:
            found.append(client(address, timeout=_WAIT_S, set_as_default=False))
        except BaseException as error:
            found.append(error)

    thread = threading.Thread(target=connect, daemon=True)
    thread.start()
    thread.join(_WAIT_S + _LATE_S)
    if not found:
        raise OSError("who answers there does not speak Dask's protocol")
    if isinstance(found[0], BaseException):
        raise found[0]
    return found[0]


class Cluster:
    """Runs tasks on the workers of the scheduler at ``address`` (`check_address`).

    With ``tls://`` Dask's own settings name authority, certificate and key.

    The campaign goes to each worker once, by its hash. Dask gives what a lost worker had to others;
    what it has lost with several of them comes back as an error (`lost`). Raises InputError if
    Dask is not installed, or there is no scheduler or worker.
    """

    def __init__(
        self, address: str, campaign: Campaign, plan: Plan, asked: Asked | None = None
    ) -> None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise InputError(
                "--cluster needs Dask: python -m pip install 'seatrial[cluster]'"
            ) from None
        if plan.recorded:
            raise InputError(
                "--cluster: a case of this campaign keeps to wall time, or programs outside "
                "connect to it; it runs on this machine"
            )
        self._killed = distributed.KilledWorker
        try:
            self._client: Any = _connected(distributed.Client, address)
        except TypeError as error:  # tls:// without a certificate
            raise InputError(
                f"--cluster: {address} needs authority, certificate and key, Dask's settings "
                f"distributed.comm.tls: {error}"
            ) from None
        except (OSError, ValueError, MemoryError) as error:  # of a length that nobody has
            raise InputError(f"--cluster: there is no scheduler at {address}: {error}") from None
        try:
            self._client.wait_for_workers(1, timeout=_WAIT_S)
        except TimeoutError:
            self._client.close()
            raise InputError(f"--cluster: the scheduler at {address} has no worker") from None
        data = packed(campaign)
        key = f"seatrial-{hashlib.sha256(data).hexdigest()}"
        self._data = self._client.submit(_itself, data, key=key)
        self._plan, self._asked = plan, asked
        self._executor = self._client.get_executor(pure=False)

    @property
    def places(self) -> int:
        """How many tasks are worth having under way; workers come and go."""
        threads = sum(self._client.nthreads().values())
        return _PER_THREAD * max(1, int(threads))

    def size(self, wall: float) -> int:
        """Return how many cases make a task of `_TASK_S`."""
        return min(max(1, int(_TASK_S / max(wall, 1e-6))), _MOST_CASES)

    def submit(self, task: Task, below: Path) -> Future[list[Ended | None]]:
        """Begin a task; the folders come packed, with what they are of."""
        future: Future[list[Ended | None]] = self._executor.submit(
            run_task, self._data, self._plan, list(task), self._question(task)
        )
        return future

    def _question(self, task: Task) -> Question | None:
        asked = self._asked
        return None if asked is None else (asked.question, {n: asked.rows[n] for n in task})

    def lost(self, error: BaseException) -> bool:
        """Say if an error of a task is that several workers in turn died of it."""
        return isinstance(error, self._killed)

    def close(self) -> None:
        """Cancel what has not begun."""
        self._executor.shutdown(wait=False)
        self._client.cancel([self._data])
        self._client.close()


def run_task(
    data: bytes, plan: Plan, task: Sequence[int], question: Question | None = None
) -> list[Ended]:
    """Run the cases of a task in a worker, and return what they leave, with the folders kept.

    They are those of the campaign, or what a question of it asks for.
    """
    with still():
        campaign, top = unpacked(data)
    name = "" if question is None else question[0]
    evaluators = _evaluators[hashlib.sha256(data).hexdigest(), plan, name]
    try:
        evaluator = evaluators.get_nowait()
    except Empty:
        cases = campaign.cases() if question is None else asked_of(campaign, name)
        evaluator = Evaluator(cases, plan, home=top)
    if question is not None:
        evaluator.expect(question[1])
    evaluator.foresee(task)
    try:
        with tempfile.TemporaryDirectory(prefix="seatrial-cases-") as below:
            return [_ended(evaluator, number, Path(below)) for number in task]
    finally:
        evaluators.put(evaluator)


def _ended(evaluator: Evaluator, number: int, below: Path) -> Ended:
    ended = evaluator.ended(number, below)
    assert ended is not None  # nobody stops it
    if ended.folder:
        ended.files = pack_folder(below / ended.folder)
    return ended


def _itself(data: bytes) -> bytes:
    return data


_evaluators: dict[tuple[str, Plan, str], SimpleQueue[Evaluator]] = defaultdict(SimpleQueue)
"""Of this process, by campaign, plan and question: those that are idle."""
