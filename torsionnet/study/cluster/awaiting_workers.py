"""Waiting for workers of a cluster that has none yet, with words."""

from __future__ import annotations

import time
from collections.abc import Callable

LOOK_EVERY, SAID_FIRST = 2.0, 10.0
"""Seconds after which it is asked again, and from one word to the next: twice as long each time."""

Told = Callable[[str], None]


def await_workers(
    threads: Callable[[], int],
    told: Told,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> int:
    """Threads of all workers, as soon as there are some.

    Parameters
    ----------
    threads : callable
        Those there are now.
    told : callable
        Is told at once that there are none yet, and again from time to time for how long.
    clock, sleep : callable
        In seconds.

    Examples
    --------
    >>> there = iter([0, 0, 8])
    >>> await_workers(lambda: next(there), print, clock=lambda: 0.0, sleep=lambda _: None)
    the scheduler has no workers yet; waiting for some to join (dask worker ADDRESS)
    8
    """
    began, said, every = clock(), False, SAID_FIRST
    while not (found := threads()):
        waited = clock() - began
        if not said:
            told("the scheduler has no workers yet; waiting for some to join (dask worker ADDRESS)")
            said = True
        elif waited >= every:
            told(f"no workers yet for {waited:.0f} s")
            every *= 2
        sleep(LOOK_EVERY)
    return found
