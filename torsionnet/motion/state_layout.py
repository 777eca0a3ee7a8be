"""Places of the parts of the state z of a motion, and what drives a plant from outside."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.linear.assembly.rows import FloatArray


@dataclass(frozen=True)
class Layout:
    """Places of the parts of z, by their sizes.

    ``n_q`` coordinates, ``n_c`` states of controllers, ``n_w`` states of generators, ``n_u`` torques and scales.
    """

    n_q: int
    n_c: int
    n_w: int
    n_u: int

    @property
    def q(self) -> slice:
        return slice(0, self.n_q)

    @property
    def v(self) -> slice:
        return slice(self.n_q, 2 * self.n_q)

    @property
    def controllers(self) -> slice:
        return slice(2 * self.n_q, 2 * self.n_q + self.n_c)

    @property
    def w(self) -> slice:
        return slice(self.one - self.n_w, self.one)

    @property
    def one(self) -> int:
        return 2 * self.n_q + self.n_c + self.n_w

    @property
    def n_p(self) -> int:
        """Number of the states before the torques u."""
        return self.one + 1

    @property
    def u(self) -> slice:
        return slice(self.n_p, self.n_p + self.n_u)

    @property
    def slope(self) -> slice:
        return slice(self.n_p + self.n_u, self.size)

    @property
    def size(self) -> int:
        return self.n_p + 2 * self.n_u


@dataclass(frozen=True, eq=False)
class Drive:
    """Torques and scales that act on a plant from outside.

    Attributes
    ----------
    columns : (n_q, n_torques) array
        Weights of the torques on the coordinates.
    scale_of : tuple of int
        For each law the number of the entry of u that scales it, -1 for none; scales stand in u after the torques.
    n_scales : int
    F : (n_w, n_w) array
        Generators w' = F w, in 1/s.
    S : (n_u, n_w) array
        What generators add to u.
    """

    columns: FloatArray
    scale_of: tuple[int, ...]
    n_scales: int
    F: FloatArray
    S: FloatArray

    @property
    def n_u(self) -> int:
        return int(self.columns.shape[1]) + self.n_scales
