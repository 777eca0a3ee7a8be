"""What goes wrong while a cluster calculates, as against a question that does not fit."""

from __future__ import annotations

from torsionnet.core.errors import TorsionnetError


class ClusterError(TorsionnetError):
    """The cluster is lost, or its workers cannot do the work; what they had finished is kept."""

    exit_code = 3
