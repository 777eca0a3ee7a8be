"""The determinant of a network and the bilinear forms of its adjugate, each recursion taken down once."""

from __future__ import annotations

from torsionnet.symbolic.algebra.bundle import Quotient, quotient
from torsionnet.symbolic.algebra.loops import tied
from torsionnet.symbolic.algebra.network import Network, NetworkMember, Stiffness, SymbolRow, added_up, reflected
from torsionnet.symbolic.algebra.program import Program, ProgramNode
from torsionnet.symbolic.algebra.recursion import Recursion


def seen_from(root: str, network: Network[Stiffness], program: Program) -> Recursion:
    """The recursion from a root, taken down once."""
    return program.memo.once(
        Recursion, (network, root), lambda: Recursion(quotients(network, program), program, root, tied)
    )


def quotients(network: Network[Stiffness], program: Program) -> Network[Quotient]:
    """The network with parallel laws added up, its laws as steps of a program."""

    def added() -> Network[Quotient]:
        members = added_up(network, reflected).members
        return Network(
            network.coordinates, tuple(NetworkMember(member.row, quotient(member.law, program)) for member in members)
        )

    return program.memo.once(Network, network, added)


def determinant(network: Network[Stiffness], program: Program, first: str = "") -> ProgramNode:
    """Det D."""
    root = first or next(iter(network.coordinates), "")
    return seen_from(root, network, program).determinant if root else program.leaf(1)


def bilinear(network: Network[Stiffness], program: Program, reading: SymbolRow, load: SymbolRow) -> ProgramNode:
    """Reading^T adj(D) load."""
    total = program.leaf(0)
    for root, share in load.items():
        total = total + program.leaf(share) * seen_from(root, network, program).reading(reading)
    return total
