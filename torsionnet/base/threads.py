"""Context that limits linear algebra of small matrices to a single thread.

BLAS divides a product of some hundred numbers among threads that must all be running before it can begin: alone on a
machine that gains nothing, on a busy one the calculation waits for its own threads, many times over.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def one_thread() -> Iterator[None]:
    """Context manager or decorator that limits BLAS and LAPACK to one thread."""
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> Any:
    """Controller of the threads of the loaded BLAS libraries; finding them takes milliseconds."""
    import scipy.linalg  # noqa: F401  (numpy and scipy each bring a library, which must be loaded to be found)
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
