"""Remarks on the tracked orders of a campaign, each said once with the records and channels that it concerns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from torsionnet.base.equal_remarks import grouped_remarks
from torsionnet.base.notes import Note, NoteOrText, about_channel
from torsionnet.signals.orders.tracked_orders import TrackedOrders


def campaign_remarks(records: Mapping[str, Sequence[TrackedOrders]]) -> Iterator[str]:
    """Yield the remarks on the orders of records, with the names of records and channels unless they concern all.

    Parameters
    ----------
    records : mapping of str to sequence of TrackedOrders
        Orders of each channel, by the name of the record.

    Examples
    --------
    >>> import numpy as np
    >>> def orders(name, *notes):
    ...     return TrackedOrders(name, "angle", [1], [0], [100], np.ones((1, 1)), np.ones((1, 1)), notes=notes)
    >>> first = [orders("fly", "averaged", Note("1 pulse missing", channel="fly")), orders("torque", "averaged")]
    >>> list(campaign_remarks({"900 rpm": first, "950 rpm": [orders("fly", "averaged"), orders("torque", "averaged")]}))
    ['averaged', '900 rpm: fly: 1 pulse missing']
    """
    said = [
        (one.name, record, _within(note, one.name))
        for record, orders in records.items()
        for one in orders
        for note in one.notes
    ]
    every = {one.name for orders in records.values() for one in orders}
    for channels, names, note in grouped_remarks(said):
        where = [", ".join(names)] if len(names) < len(records) else []
        where += [", ".join(channels)] if set(channels) != every else []
        yield ": ".join([*where, note])


def _within(note: NoteOrText, channel: str) -> str:
    """Text of a note that stands behind the name of a channel."""
    is_own = isinstance(note, Note) and note.channel == channel
    return str(about_channel(note, "") if is_own else note)
