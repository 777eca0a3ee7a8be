# Written by `make generate`.
from torsionnet.symbolic.normalised import Expanded as Expanded
from torsionnet.symbolic.normalised import Normalised as Normalised
from torsionnet.symbolic.rational import Rational as Rational
from torsionnet.symbolic.simplified import Simplified as Simplified
from torsionnet.symbolic.symbolic_system import SymbolicSystem as SymbolicSystem
from torsionnet.symbolic.transfer_function import TransferFunction as TransferFunction
from torsionnet.symbolic.transfer_matrix import TransferMatrix as TransferMatrix

__all__ = [
    "Expanded",
    "Normalised",
    "Rational",
    "Simplified",
    "SymbolicSystem",
    "TransferFunction",
    "TransferMatrix",
]
