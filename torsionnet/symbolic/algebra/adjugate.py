"""Determinant of a network and bilinear forms of its adjugate; the recursion from each root is recorded once."""

from __future__ import annotations

from torsionnet.symbolic.algebra.bundle import Quotient, quotient
from torsionnet.symbolic.algebra.loops import tied
from torsionnet.symbolic.algebra.network import Network, NetworkMember, Stiffness, SymbolRow, added_up, reflected
from torsionnet.symbolic.algebra.program import Program, ProgramNode
from torsionnet.symbolic.algebra.recursion import Recursion


def seen_from(root: str, network: Network[Stiffness], program: Program) -> Recursion:
    """Recursion from a root of the network, recorded once per program."""
    return program.memo.once(
        Recursion, (network, root), lambda: Recursion(quotients(network, program), program, root, tied)
    )


def quotients(network: Network[Stiffness], program: Program) -> Network[Quotient]:
    """Network with parallel laws added up, each law a quotient of program nodes."""

    def added() -> Network[Quotient]:
        members = added_up(network, reflected).members
        return Network(
            network.coordinates, tuple(NetworkMember(member.row, quotient(member.law, program)) for member in members)
        )

    return program.memo.once(Network, network, added)


def determinant(network: Network[Stiffness], program: Program, first: str = "") -> ProgramNode:
    """Determinant of the dynamic stiffness of a network, det D, as a program node."""
    root = first or next(iter(network.coordinates), "")
    return seen_from(root, network, program).determinant if root else program.leaf(1)


def bilinear(network: Network[Stiffness], program: Program, reading: SymbolRow, load: SymbolRow) -> ProgramNode:
    """Bilinear form reading^T adj(D) load as a program node."""
    total = program.leaf(0)
    for root, share in load.items():
        total = total + program.leaf(share) * seen_from(root, network, program).reading(reading)
    return total
