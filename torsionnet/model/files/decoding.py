"""Decoding of the bytes of a model file to text."""

from __future__ import annotations

import codecs

from torsionnet.core.errors import Fault, ModelError, Position

MOST_BYTES = 4_000_000
"""Size in bytes of the largest model file, as a larger one is no model and would only fill the memory."""


def decode(raw: bytes, file: str) -> str:
    """Text of a model file from its bytes in UTF-8 code.

    Raises ModelError with the position of bytes that are not UTF-8.
    """
    if len(raw) > MOST_BYTES:
        raise _fault(f"the file is too large: more than {MOST_BYTES // 1_000_000} MB", file)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or b"\0" in raw[:4]:
        raise _fault("the file is saved as UTF-16 or UTF-32; save it as UTF-8", file)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        good = raw[: error.start + (3 if raw.startswith(codecs.BOM_UTF8) else 0)]
        lines = good.decode("utf-8-sig", "replace").splitlines() or [""]
        if good.endswith((b"\n", b"\r")):
            lines.append("")
        text = f"the byte 0x{raw[len(good)]:02x} is no UTF-8 text; save the file as UTF-8"
        raise _fault(text, file, len(lines), len(lines[-1]) + 1) from None


def _fault(message: str, file: str, line: int = 1, column: int = 1) -> ModelError:
    return ModelError([Fault(message, position=Position(file, line, column, column + 1))])
