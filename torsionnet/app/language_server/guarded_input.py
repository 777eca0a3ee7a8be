"""Input of the server that no length in a header can make fill the memory."""

from __future__ import annotations

from typing import BinaryIO

MOST_HEADER, MOST_MESSAGE = 8_000, 64_000_000
"""Longest line of a header and longest message that are read, in bytes; model files have at most 4 MB."""
_PIECE = 1_000_000


class GuardedInput:
    """Stream of messages in which one that is too long is passed over, and an empty one stands in its place."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def readline(self) -> bytes:
        """Line of a header."""
        return self._stream.readline(MOST_HEADER)

    def read(self, length: int) -> bytes:
        """Body of a message of that length in bytes; the text ``{}``, which no server answers, of a longer one."""
        if length <= MOST_MESSAGE:
            return self._stream.read(length)
        left = length
        while left > 0:
            piece = self._stream.read(min(left, _PIECE))
            if not piece:
                return b""
            left -= len(piece)
        return b"{}"
