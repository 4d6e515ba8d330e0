"""The end of a process whose parent was killed, even in a call that never returns."""

from __future__ import annotations

import os
import select
import signal
import threading
import time


def end_with(parent: int, after_s: float) -> None:
    """Kill this process ``after_s`` of wall time after its ``parent`` has ended. Linux only.

    Until then it may end in order: a signal says that to it (prctl, PR_SET_PDEATHSIG), but only
    Python code can heed that.
    """
    if not hasattr(os, "pidfd_open"):
        return
    try:
        ended = os.pidfd_open(parent)
    except ProcessLookupError:
        os._exit(1)

    def watch() -> None:
        select.select([ended], [], [])
        time.sleep(after_s)
        os.kill(os.getpid(), signal.SIGKILL)

    threading.Thread(target=watch, daemon=True).start()
