"""Waiting on a machine that does much else: what works comes sooner, so that only a failure takes this long."""

import time

PATIENCE = 240.0
"""Seconds after which something counts as missing."""


def wait_for(condition, says=lambda: "", pause=0.02):
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"waited in vain\n{says()}"
        time.sleep(pause)
