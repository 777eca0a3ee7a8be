"""Names and parameters that will go: what to use instead, and with which version they go.

A deprecated name works for two minor versions and warns; :data:`PENDING` lists what has been marked, and a test fails
once a name is overdue.
"""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")
MINOR_VERSIONS_KEPT = 2
"""Least number of minor versions between a deprecation and the end, as docs/stability.md promises."""


class TorsionnetDeprecationWarning(FutureWarning):
    """Warning about a name or parameter that a later version will not have; the text says which, and what to use.

    A FutureWarning, as Python hides a DeprecationWarning from those who run programs that others wrote.
    """


@dataclass(frozen=True)
class Deprecation:
    """Deprecated name or parameter, with the version since which it warns and the version that will not have it.

    >>> Deprecation("Drivetrain.frf", "1.1", "1.3", "use frequency_response").sentence
    'Drivetrain.frf goes with version 1.3 (deprecated since 1.1): use frequency_response'
    """

    name: str
    since: str
    gone: str
    instead: str

    def __post_init__(self) -> None:
        (major, since), (end, gone) = version_number(self.since), version_number(self.gone)
        if (end, gone) < (major, since + MINOR_VERSIONS_KEPT):
            raise ValueError(
                f"{self.name}: deprecated in {self.since}, it stays until {major}.{since + MINOR_VERSIONS_KEPT}"
            )

    @property
    def sentence(self) -> str:
        """Text of the warning."""
        return f"{self.name} goes with version {self.gone} (deprecated since {self.since}): {self.instead}"

    def overdue(self, version: str) -> bool:
        """Whether a version of the package should no longer have the name."""
        return version_number(version) >= version_number(self.gone)

    def warn(self, stacklevel: int = 2) -> None:
        """Warn of the deprecation at the place of the caller, ``stacklevel`` frames up."""
        warnings.warn(self.sentence, TorsionnetDeprecationWarning, stacklevel=stacklevel + 1)


PENDING: list[Deprecation] = []
"""Deprecations of this version, each written here or by :func:`deprecated`; none so far."""


def deprecated(*, since: str, gone: str, instead: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator of a function or method that still works, warns, and goes with a later version.

    Parameters
    ----------
    since, gone : str
        Versions, ``"1.2"``; the second at least two minor versions later.
    instead : str
        What to write instead.

    Examples
    --------
    >>> from unittest.mock import patch
    >>> with patch(f"{__name__}.PENDING", []), warnings.catch_warnings(record=True) as seen:
    ...     warnings.simplefilter("always")
    ...     double = deprecated(since="1.1", gone="1.3", instead="multiply by 2")(lambda x: 2 * x)
    ...     double(4), str(seen[0].message).partition(" (")[2]
    (8, 'deprecated since 1.1): multiply by 2')
    """

    def marked(function: Callable[P, R]) -> Callable[P, R]:
        told = Deprecation(function.__qualname__, since, gone, instead)
        PENDING.append(told)

        @functools.wraps(function)
        def warning(*args: P.args, **kwargs: P.kwargs) -> R:
            told.warn()
            return function(*args, **kwargs)

        return warning

    return marked


def version_number(text: str) -> tuple[int, int]:
    """Major and minor number of a version.

    >>> version_number("1.10.2")
    (1, 10)
    """
    major, minor = text.split(".")[:2]
    return int(major), int(minor)
