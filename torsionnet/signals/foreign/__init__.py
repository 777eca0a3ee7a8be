"""Binary files of other programs, read in a separate process.

The libraries behind them crash on damaged files, print, or take all the memory there is. In a process of its own that
becomes one sentence: :class:`ForeignFileError`. What is in a file comes as :class:`Content`, named arrays with
attributes, whichever format it is in.
"""

from torsionnet.signals.foreign.content import Content, ForeignFileError, StoredArray
from torsionnet.signals.foreign.process import open_content

__all__ = ["Content", "ForeignFileError", "StoredArray", "open_content"]
