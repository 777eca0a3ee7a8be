"""Whether a scheduler answers at an address, asked before a client of dask is made that would wait and retry."""

from __future__ import annotations

import asyncio
from typing import Any

from torsionnet.core.errors import UsageError


def must_answer(address: str, patience: float) -> None:
    """Refuse an address where no scheduler answers within ``patience`` seconds."""
    from distributed.utils import LoopRunner

    runner = LoopRunner(asynchronous=False)
    runner.start()
    try:
        found = runner.run_sync(_identity, address, patience)
    except (OSError, TimeoutError) as error:
        raise UsageError(
            f"no scheduler answers at {address} within {patience:g} s; see that it runs (dask scheduler), that address "
            f"and port are those it prints, and that no firewall is between ({_first_line(error)})"
        ) from None
    except ValueError as error:
        raise UsageError(
            f"{address} is no address of a scheduler, as tcp://host:8786 is ({_first_line(error)})"
        ) from None
    except (TypeError, ImportError, MemoryError, AttributeError) as error:
        raise UsageError(
            f"what answers at {address} is no scheduler of dask, or one of another version ({_first_line(error)})"
        ) from None
    finally:
        runner.stop()
    if found.get("type") != "Scheduler":
        what = str(found.get("type", "something else")).lower()
        raise UsageError(f"{address} is the address of a {what}; give that of the scheduler")


async def _identity(address: str, patience: float) -> dict[str, Any]:
    from distributed.core import rpc
    from distributed.security import Security

    async with rpc(address, timeout=patience, connection_args=Security().get_connection_args("client")) as scheduler:
        return dict(await asyncio.wait_for(scheduler.identity(), patience + 1))


def _first_line(error: BaseException) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)
