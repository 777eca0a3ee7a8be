"""Plot of a matrix of modal assurance criteria (MAC), which compare the mode shapes of two sets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError

MOST_NUMBERS = 14
"""Largest number of modes on a side of a MAC matrix up to which its fields have numbers; in more, the fields are too
small for them."""
WHITE_TEXT_MAC = 0.55
"""MAC above which a field is so dark that its number is white."""


def mac_matrix(
    values: ArrayLike,
    *,
    rows: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    row_label: str = "identified mode",
    column_label: str = "mode of the model",
    title: str = "",
) -> Figure:
    """Figure of a matrix of modal assurance criteria (MAC) in shades from 0 to 1, with modes on rows and on columns.

    The fields have numbers if there are not too many modes.

    Parameters
    ----------
    values : (n_first, n_second) array
        As of :func:`torsionnet.modal.mac`, or the ``mac`` of a :class:`~torsionnet.modal.Match`.
    rows, columns : sequence of str, optional
        Names of the modes; by default their numbers.
    row_label, column_label, title : str, optional

    Raises
    ------
    UsageError
        The values are no matrix, or the names are not as many.

    Examples
    --------
    >>> mac_matrix([[1, 0.1], [0.05, 0.98]], rows=["8.7 Hz", "81 Hz"]).axes[0].get_ylabel()
    'identified mode'
    """
    matrix = np.asarray(values, dtype=float)
    if matrix.ndim != 2 or not matrix.size:
        raise UsageError(
            "a MAC plot needs a matrix; a match has none if model and test have fewer than two sensors in common"
        )
    names = [
        [str(number + 1) for number in range(size)] if given is None else list(given)
        for given, size in zip((rows, columns), matrix.shape, strict=True)
    ]
    for given, size in zip(names, matrix.shape, strict=True):
        if len(given) != size:
            raise UsageError(f"{size} modes need as many names, got {len(given)}")
    cell = 0.45
    figure = style.new_figure(min(style.WIDTH, 2.2 + cell * matrix.shape[1]), min(9, 1.6 + cell * matrix.shape[0]))
    axes = figure.subplots()
    picture = axes.imshow(matrix, cmap="Blues", vmin=0, vmax=1, aspect="equal")
    axes.set_xticks(range(matrix.shape[1]), names[1], fontsize=style.SMALL, rotation=45 if columns else 0)
    axes.set_yticks(range(matrix.shape[0]), names[0], fontsize=style.SMALL)
    axes.set_xlabel(column_label, fontsize=style.FONT)
    axes.set_ylabel(row_label, fontsize=style.FONT)
    if max(matrix.shape) <= MOST_NUMBERS:
        for (row, column), value in np.ndenumerate(matrix):
            color = style.PAPER if value > WHITE_TEXT_MAC else style.INK
            text = "-" if np.isnan(value) else f"{value:.2f}"
            axes.text(column, row, text, ha="center", va="center", fontsize=style.SMALL, color=color)
    bar = figure.colorbar(picture, ax=axes, shrink=0.9)
    bar.set_label("MAC [-]", fontsize=style.FONT)
    bar.ax.tick_params(labelsize=style.SMALL)
    style.set_title(figure, title)
    return figure
