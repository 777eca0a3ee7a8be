"""Share of random draws with the confidence interval of Clopper and Pearson."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.base.errors import UsageError


@dataclass(frozen=True)
class Share:
    """Share of draws between 0 and 1 with its confidence interval, and the number of draws counted."""

    value: float
    low: float
    high: float
    count: int

    @property
    def percent(self) -> str:
        """Text of the share in percent with its interval, with as many digits as the interval's width allows.

        >>> counted_share(31, 1000).percent
        '3.1 % (2.1 to 4.4 %)'
        """
        width = max(self.high - self.value, self.value - self.low) * 100
        decimals = next((digits for digits in range(9) if 2 * 10.0**-digits <= width), 9)
        value, low, high = (f"{100 * number:.{decimals}f}" for number in (self.value, self.low, self.high))
        return f"{value} % ({low} to {high} %)"


def counted_share(hits: float, count: int, confidence: float = 0.95) -> Share:
    """Share from 0 to 1 of independent draws that are hits, with the confidence interval of Clopper and Pearson.

    The interval contains the true share at least as often as ``confidence`` says, also where nothing was hit. Draws of
    a Latin hypercube or a Sobol sequence spread more evenly, which makes it wider than needed.

    Parameters
    ----------
    hits : float
        Sum over the draws of 1 for a hit and 0 otherwise; a mean over several conditions of a draw lies
        between, and varies less than a count of the same mean, so that the interval is on the safe side.
    count : int
        Number of draws.
    confidence : float

    Examples
    --------
    >>> none = counted_share(0, 100)
    >>> round(none.high, 5) == round(1 - 0.025 ** (1 / 100), 5)
    True
    """
    from scipy.special import betaincinv

    if not 0 <= hits <= count or count < 1:
        raise UsageError(f"a share needs hits between 0 and the number of draws, got {hits} of {count}")
    tail = (1 - confidence) / 2
    low = float(betaincinv(hits, count - hits + 1, tail)) if hits else 0.0
    high = float(betaincinv(hits + 1, count - hits, 1 - tail)) if hits < count else 1.0
    return Share(hits / count, low, high, count)
