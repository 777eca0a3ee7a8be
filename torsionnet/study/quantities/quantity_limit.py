"""What a quantity must stay below or above."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.spec import entry
from torsionnet.core.errors import Fault
from torsionnet.study.quantities.quantity_value import QuantityValue


@dataclass(frozen=True, kw_only=True)
class QuantityLimit(Declared):
    """Largest and smallest value of a quantity that is allowed.

    Of a curve over frequency or speed it is the largest of its values that must stay below, and the smallest that must
    stay above.

    Examples
    --------
    >>> import numpy as np
    >>> QuantityLimit(below=2.0).exceeded(np.array([1.0, 3.0])).tolist()
    [False, True]
    """

    kind: ClassVar[str] = "limit of a quantity"
    article: ClassVar[str] = "a limit of a quantity"
    form: ClassVar[str] = "{below: value} or {above: value}"

    below: float | None = entry(QuantityValue("largest value allowed"), None)
    above: float | None = entry(QuantityValue("smallest value allowed"), None)

    def contradictions(self) -> list[Fault]:
        if self.below is None and self.above is None:
            return [Fault("a limit of a quantity needs below: or above:", on_key=True)]
        if self.below is not None and self.above is not None and self.above >= self.below:
            return [Fault(f"nothing is above {self.above:g} and below {self.below:g}", on_key=True)]
        return []

    def exceeded(self, values: FloatArray) -> NDArray[np.bool_]:
        """Where values are outside; one that could not be calculated is not inside."""
        low = -np.inf if self.above is None else self.above
        high = np.inf if self.below is None else self.below
        return np.asarray(~((values >= low) & (values <= high)))

    def beyond(self, values: FloatArray) -> NDArray[np.bool_]:
        """Which of n variants are outside, by values (n,), or anywhere on a curve (n, n_points).

        >>> import numpy as np
        >>> QuantityLimit(below=2.0).beyond(np.array([[1.0, 3.0], [1.0, 1.5]])).tolist()
        [True, False]
        """
        outside = self.exceeded(values)
        return outside if outside.ndim == 1 else np.asarray(outside.any(axis=1))
