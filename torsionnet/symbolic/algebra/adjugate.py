"""Determinant of a symbolic network and bilinear forms of its adjugate, as nodes of a straight-line program."""

from __future__ import annotations

from collections.abc import Mapping

from torsionnet.symbolic.algebra.block_tree import GraphBlock
from torsionnet.symbolic.algebra.bundle import Quotient, quotient
from torsionnet.symbolic.algebra.network import (
    Network,
    NetworkMember,
    Stiffness,
    SymbolRow,
    add_parallel_laws,
    reflected_sum,
)
from torsionnet.symbolic.algebra.program import Program, ProgramNode
from torsionnet.symbolic.algebra.recursion import Recursion, SolvedBlock


def _solve_block(block: GraphBlock[Quotient], hanging: Mapping[str, Quotient], program: Program) -> SolvedBlock:
    """Solved block with closed loops, whose algebra a tree does not need."""
    from torsionnet.symbolic.algebra.loops import solve_block

    return solve_block(block, hanging, program)


def recursion_from(root: str, network: Network[Stiffness], program: Program) -> Recursion:
    """Determinants of a network's parts as seen from a root coordinate, recorded once per program."""
    return program.memo.once(
        Recursion, (network, root), lambda: Recursion(quotients(network, program), program, root, _solve_block)
    )


def quotients(network: Network[Stiffness], program: Program) -> Network[Quotient]:
    """Network with parallel laws added up, the dynamic stiffness of each law a quotient of program nodes."""

    def added() -> Network[Quotient]:
        members = add_parallel_laws(network, reflected_sum).members
        return Network(
            network.coordinates, tuple(NetworkMember(member.row, quotient(member.law, program)) for member in members)
        )

    return program.memo.once(Network, network, added)


def determinant(network: Network[Stiffness], program: Program, first: str = "") -> ProgramNode:
    """Determinant det D of the dynamic stiffness matrix of a network, as a node of the program."""
    root = first or next(iter(network.coordinates), "")
    return recursion_from(root, network, program).determinant if root else program.leaf(1)


def bilinear(network: Network[Stiffness], program: Program, reading: SymbolRow, load: SymbolRow) -> ProgramNode:
    """Bilinear form reading^T adj(D) load of a network's dynamic stiffness matrix D, as a node of the program."""
    total = program.leaf(0)
    for root, share in load.items():
        total = total + program.leaf(share) * recursion_from(root, network, program).reading(reading)
    return total
