"""Symbolic transfer functions of drivetrains, each recorded as a straight-line program that many algebras evaluate."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Expanded": "torsionnet.symbolic.normalised",
        "Normalised": "torsionnet.symbolic.normalised",
        "Rational": "torsionnet.symbolic.rational",
        "Simplified": "torsionnet.symbolic.simplified",
        "SymbolicSystem": "torsionnet.symbolic.symbolic_system",
        "TransferFunction": "torsionnet.symbolic.transfer_function",
        "TransferMatrix": "torsionnet.symbolic.transfer_matrix",
    },
)
