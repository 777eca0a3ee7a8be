"""Showing of results in a notebook as tables, and as a picture where there is one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any, ClassVar, Protocol, TypeVar

from torsionnet.core.attribute_hints import AttributeHints
from torsionnet.core.errors import TorsionnetError

MOST_ROWS = 30
"""Largest number of rows of a table in a notebook, as many as fit on a screen."""
DOTS_PER_INCH = 100
"""Resolution of a picture in a notebook in dots per inch, sharp at the size at which it is shown."""


class NotebookTable(Protocol):
    """Interface of a table that a notebook shows, as :class:`torsionnet.response.Table`."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def title(self) -> str: ...
    @property
    def rows(self) -> Sequence[Any]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    def to_html(self) -> str: ...


T = TypeVar("T", bound=NotebookTable)


class Plots:
    """Holder of the package that draws plots, which a layer above this one sets.

    Plots are made from results and not the other way.
    """

    package: ClassVar[Callable[[], ModuleType] | None] = None


class NotebookResult(AttributeHints):
    """Base class of results that a notebook shows as tables, and as a picture where ``picture`` names one."""

    picture: ClassVar[str] = ""
    """Name of the function of :mod:`torsionnet.plot` that draws the result alone; empty: none does."""

    def table(self) -> NotebookTable:
        """Table of the result that a notebook shows."""
        raise NotImplementedError

    def notebook_tables(self) -> Iterable[NotebookTable]:
        """Tables of the result that a notebook shows."""
        return (self.table(),)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {getattr(self, 'title', '')}>".replace(" >", ">")

    def _repr_html_(self) -> str:
        return "\n".join([*(thinned(table).to_html() for table in self.notebook_tables()), self._picture()])

    def _picture(self) -> str:
        return drawn(lambda plot: getattr(plot, self.picture)(self)) if self.picture else ""


def drawn(draw: Callable[[ModuleType], Any]) -> str:
    """HTML with the picture of the figure that ``draw`` makes with :mod:`torsionnet.plot`.

    Empty where nothing is to draw.
    """
    if Plots.package is None:
        return ""
    try:
        return figure_html(draw(Plots.package()))
    except TorsionnetError:  # as of a response without frequencies
        return ""


def thinned(table: T) -> T:
    """Copy of a table with at most ``MOST_ROWS`` rows, evenly chosen, and a note on how many there are."""
    step = -(-len(table.rows) // MOST_ROWS)
    if step <= 1:
        return table
    rows = table.rows[::step]
    return replace(table, rows=rows, notes=(*table.notes, f"{len(rows)} of {len(table.rows)} lines"))


def figure_html(figure: Any) -> str:
    """HTML element with the picture of a matplotlib figure, which needs no other file."""
    import base64  # with io only where a picture is drawn, as everything imports this module
    import io

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
    return f'<img src="data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode("ascii")}" alt="">'
