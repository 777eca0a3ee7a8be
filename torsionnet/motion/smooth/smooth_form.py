"""Equations of motion in one contact state over as few states as there are, with smooth laws as torques u."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.smooth_laws import SmoothLaw
from torsionnet.motion.state_layout import Layout

LEAST_SINGULAR = 0.5
"""Singular value that parts the motions of the refresh, a projection whose others are 1 or more, from rounding."""
FEEDBACK = 1e-9
"""Share of the largest weight in a row by which the torque of a law may seem to change its own motion at once."""


@dataclass(frozen=True, eq=False)
class SmoothForm:
    """Equations y' = A y + U u + S u' in one contact state, z = Z_y y + Z_u u + Z_s u', and y = take z.

    Attributes
    ----------
    form : ContactForm
    A, U, S : arrays (r, r), (r, n_u), (r, n_u)
    over_y, over_u, over_s : arrays (N, r), (N, n_u), (N, n_u)
    take : (r, N) array
    motions : tuple of arrays
        Rows over z of the twist and of all rates of each smooth law, the twist first.
    """

    form: ContactForm
    A: FloatArray
    U: FloatArray
    S: FloatArray
    over_y: FloatArray
    over_u: FloatArray
    over_s: FloatArray
    take: FloatArray
    motions: tuple[FloatArray, ...]

    def whole(self, y: FloatArray, u: FloatArray, slopes: FloatArray) -> FloatArray:
        """States z from y, u and the rates of change of u."""
        return np.asarray(self.over_y @ y + self.over_u @ u + self.over_s @ slopes)


def smooth_form(form: ContactForm, at: Layout, laws: Sequence[SmoothLaw], places: Sequence[int]) -> SmoothForm:
    """Equations of motion over as few states as there are; the torques of laws stand at ``places`` in u.

    Raises
    ------
    UsageError
        The torque of a law changes its own motion at once, since nothing there has inertia.
    """
    own = form.refresh[: at.n_p, : at.n_p]
    left, sizes, _ = np.linalg.svd(own)
    basis = left[:, : int((sizes > LEAST_SINGULAR).sum())]
    take = np.zeros((basis.shape[1], at.size))
    take[:, : at.n_p] = basis.T @ own
    over_y, over_u, over_s = form.refresh[:, : at.n_p] @ basis, form.refresh[:, at.u], form.refresh[:, at.slope]
    rates = take @ form.A
    angles, speeds, _ = form.motion
    motions = tuple(np.vstack([one.row @ angles, one.row @ speeds, one.sensed @ speeds]) for one in laws)
    prompt = [place for place, one in zip(places, laws, strict=True) if not one.lag]
    for one, rows in zip(laws, motions, strict=True):
        used = rows[1:] if one.over_rate else rows[:1]
        if one.lag:
            continue
        at_once = np.hstack([used @ over_u[:, prompt], used @ over_s[:, prompt]])
        if np.abs(at_once).max(initial=0.0) > FEEDBACK * _size(form, at):
            text = "its torque acts where nothing has inertia, so that its motion follows from a curve alone"
            raise UsageError(f"{one.owner}: {text}; give the node an inertia")
    return SmoothForm(form, rates @ over_y, rates @ over_u, rates @ over_s, over_y, over_u, over_s, take, motions)


def _size(form: ContactForm, at: Layout) -> float:
    """Largest acceleration that a torque of 1 N m gives to a coordinate."""
    return max(1e-300, float(np.abs(form.motion[2][:, at.u]).max(initial=0.0)))
