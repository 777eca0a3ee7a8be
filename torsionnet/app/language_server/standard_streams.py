"""Serving of an editor on standard input and output."""

from __future__ import annotations

import logging
import os
import signal
from typing import BinaryIO

from torsionnet.app.language_server.features import add_features
from torsionnet.app.language_server.guarded_input import GuardedInput
from torsionnet.app.language_server.model_server import ModelServer

INTERRUPTED = 130
"""Exit code after Ctrl-C."""


def serve(requests: BinaryIO, answers: BinaryIO) -> int:
    """Answer an editor until it says that it ends, and return the exit code: 1 where it went away without a word."""
    if not os.environ.get("TORSIONNET_DEBUG"):
        logging.getLogger("pygls").setLevel(logging.CRITICAL)  # what matters goes to the log of the editor
    server = ModelServer()
    add_features(server)
    try:
        server.start_io(GuardedInput(requests), answers)  # type: ignore[arg-type]
    finally:
        server.end()
    return 0 if server.shut_down else 1


def serve_standard_streams() -> int:
    """Answer an editor on standard input and output; whatever else is printed goes to the messages on stderr."""
    # A thread waits for the next message and cannot be interrupted; there is nothing to be saved.
    signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return serve(requests, answers)
