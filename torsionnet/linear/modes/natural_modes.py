"""Modes of a drivetrain, and poles of its responses over a measured input, mostly those of the drivetrain cut there.

The reading of a torque transducer contains all that happens upstream. The poles of theta/T are therefore the poles of
the drivetrain cut at the transducer, without everything on the side of the excitation, if the cut separates the two
sides. Where it does not, or other quantities are measured, the poles are the rates s at which the measured inputs can
stay zero under suitable excitations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError, UsageError, warn_user
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray, Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import LARGE_SYSTEM, require_resistance
from torsionnet.linear.modes.eigen import (
    RIGID,
    EigenSolution,
    complex_modes,
    undamped_modes,
    unit_shapes,
    with_zero_damping,
)
from torsionnet.linear.modes.mode_shapes import (
    accuracy_warnings,
    convergence_warnings,
    describe,
    with_chosen_shapes,
    with_growth,
)
from torsionnet.linear.modes.modes import Modes
from torsionnet.model.channels import Channels

if TYPE_CHECKING:
    from torsionnet.linear.assembly.action_laws import ActionLaw
    from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest

ModesAndWarnings: TypeAlias = tuple[Modes, tuple[str, ...]]
"""Modes of a drivetrain, and texts of warnings about uncertain ones."""


def poles_against_measured(
    drivetrain: AssembledModel, request: TransferRequest, modes_of: Callable[[AssembledModel], ModesAndWarnings]
) -> ModesAndWarnings:
    """Poles of responses over a measured input, and texts of warnings about uncertain ones.

    Under the same excitation theta = N_theta/det D and T = N_T/det D, so that theta/T = N_theta/N_T: its poles are the
    zeros of the measured torque. A meter that separates the drivetrain has N_T = n_before det D_beyond, with D_beyond
    of the side without excitation. For outputs at the meter and beyond, n_before stands in N_theta as well and
    cancels, which leaves the modes of that side; for outputs before the meter its roots may be poles, too.

    Raises
    ------
    UsageError
        The measured input is no sensor, or no excitation reaches that sensor.
    SolveError
        Some coordinates have neither inertia nor spring nor damper.
    """
    system = drivetrain.assembly.system
    require_resistance(system, np.ones(len(system.sparse_rows), dtype=bool))
    if not request.is_measured:
        raise UsageError(f'"{request.names}" is no sensor; name a sensor as measured input', kind="unknown-channel")
    from torsionnet.linear.dynamic_stiffness.transfer_request import elements_beyond_cut

    kept = elements_beyond_cut(drivetrain, request)
    if kept is None:
        from torsionnet.linear.modes.bordered_poles import measured_poles

        return measured_poles(drivetrain, request)
    return _of_cut_system(drivetrain, kept, request.names, modes_of)


def _of_cut_system(
    drivetrain: AssembledModel,
    kept: Sequence[str],
    measured: str,
    modes_of: Callable[[AssembledModel], ModesAndWarnings],
) -> ModesAndWarnings:
    from torsionnet.linear.dynamic_stiffness.transfer_request import cut_definition

    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, kept))
    try:
        rest_modes, warned = modes_of(rest)
    except SolveError as error:  # the whole drivetrain resists every motion, so the cut leaves a loose end
        raise UsageError(
            f"{measured} is zero at every frequency: nothing on the other side of the transducer resists a motion",
            kind="zero-reading",
        ) from error
    shapes = np.full((len(drivetrain.nodes), len(rest_modes)), np.nan + 0j)
    place = {node: number for number, node in enumerate(drivetrain.nodes)}
    shapes[[place[node] for node in rest_modes.nodes]] = rest_modes.shapes
    removed = [name for name in drivetrain.elements if name not in rest.elements]
    said = "poles of the drivetrain cut at {sensor}, without {removed}"
    notes = (phrase(said, sensor=str(measured), removed=", ".join(removed)),)
    rest_modes = replace(
        rest_modes, nodes=drivetrain.nodes, shapes=shapes, title=f"{drivetrain.title}, cut at {measured}", notes=notes
    )
    return rest_modes, warned


CONTINUOUS = "a continuous shaft has infinitely many modes, of which the lowest"
"""Beginning of the note on modes of drivetrains with continuous shafts."""
MANY_COORDINATES = 1000
"""Number of coordinates from which on all modes take a minute or more, and the lowest ones seconds."""
EXTRA_MODES = 2
"""Number of modes above a frequency limit that are calculated too, as damping may lower them below the limit."""


def modes(
    drivetrain: AssembledModel,
    *,
    measured_input: Channels | None = None,
    driven_by: str | Sequence[str] | None = None,
    lowest: int | None = None,
    up_to: float | None = None,
) -> Modes:
    """Complex modes with natural frequencies, damping ratios, shapes at all nodes and energy shares.

    Parameters that follow the operating point have their values at its speed, else at the rated one; a note says
    which that is.

    Parameters
    ----------
    measured_input : str, Sensor or sequence of these, optional
        The poles of transfer functions against this measured input instead: for an output at the torque meter or
        downstream of it, those of the drivetrain cut there.
    driven_by : str or sequence of str, optional
        Which input drives the drivetrain then; default: the model's only input.
    lowest : int, optional
        Only so many modes, those of the smallest ``|lambda|``, rigid bodies included; likewise the undamped
        natural frequencies. Much quicker for large models. Default: all; with continuous shafts, which have
        infinitely many, the lowest 20.
    up_to : float, optional
        Only modes of natural frequencies up to this one in Hz; with continuous shafts all of these.

    Examples
    --------
    >>> import torsionnet as tn
    >>> tn.load("dmf_rig").modes().natural_frequencies.round(5).tolist()
    [7.10526, 80.98336]
    """
    if up_to is not None and not 0 < up_to < math.inf:
        raise UsageError(f"up_to={up_to}: modes are asked for up to a frequency above 0 Hz", kind="out-of-range")
    if lowest is not None and lowest < 1:
        raise UsageError(f"lowest={lowest}: at least one mode must be asked for", kind="out-of-range")
    if measured_input is None and driven_by is not None:
        raise UsageError(
            "driven_by= goes with measured_input=; the modes of the drivetrain itself need none",
            kind="wrong-count",
        )
    request = None
    if measured_input is not None:
        from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_inputs

        request = resolve_inputs(drivetrain, measured_input, driven_by)
    solved = modes_against(drivetrain, request, lowest, up_to)
    if not drivetrain.definition.following and drivetrain.definition.tangents is None:
        return solved
    from torsionnet.model.operating_values import operating_speed_notes

    return replace(solved, notes=(*solved.notes, *operating_speed_notes(drivetrain.external_torques)))


def modes_against(
    drivetrain: AssembledModel, request: TransferRequest | None, lowest: int | None = None, up_to: float | None = None
) -> Modes:
    """Modes of a drivetrain, or its poles against the measured inputs of a request, warning if they are uncertain."""
    size = drivetrain.assembly.system.n_coordinates
    if size >= MANY_COORDINATES and lowest is None and up_to is None:
        few = "the lowest N take seconds (lowest=N; modes --lowest N)"
        warn_user(f"all modes of {size} coordinates take a minute or more; {few}")
    if request is None:
        solved, texts = natural_modes(drivetrain, lowest, up_to)
    else:
        solved, texts = poles_against_measured(drivetrain, request, partial(natural_modes, lowest=lowest, up_to=up_to))
    for text in texts:
        warn_user(text)
    if drivetrain.assembly.system.is_continuous and lowest is None and up_to is None:
        text = f"{CONTINUOUS} {len(solved)} are given; more with lowest or up_to"
        solved = replace(solved, notes=(*solved.notes, text))
    if up_to is not None:
        solved = solved.first(int(np.sum(solved.natural_frequencies <= up_to)))
    return solved.first(lowest)


def natural_modes(
    drivetrain: AssembledModel, lowest: int | None = None, up_to: float | None = None
) -> tuple[Modes, tuple[str, ...]]:
    """Eigenvalues, shapes and energy shares of the whole drivetrain's modes, and texts of warnings.

    Nodes with an imposed angle are held.
    """
    assembly = drivetrain.assembly
    system = assembly.system
    # Numbers of modes below a limit are those of the laws alone, without torques of controllers.
    passive = replace(system, actions=()) if system.actions else system
    if up_to is not None and passive.is_continuous:
        from torsionnet.linear.modes import continuous

        # Of infinitely many modes those that (4.8) counts below the limit, and some more against rounding.
        count = continuous.number_below(passive, 2 * np.pi * up_to) + EXTRA_MODES
        lowest = count if lowest is None else min(lowest, count)
    if system.actions:
        from torsionnet.linear.modes.active_modes import active_modes

        # det P(s) = 0 with controllers and delays, equation (8.6).
        solution, warned, more = active_modes(assembly)
    else:
        # (lambda^2 M + lambda C + K) phi = 0, equation (4.1).
        solution, warned, more = complex_modes(system, lowest), (), ()
        if system.is_active:
            solution = replace(solution, eigenvalues=with_zero_damping(solution.eigenvalues, solution.errors))
    elements = tuple(drivetrain.elements)
    solution, notes = with_chosen_shapes(solution, _motion(assembly.node_rows, solution.vectors), assembly.nodes)
    # Shares of elements, equation (4.10), do not depend on the size of a shape.
    kinetic, strain, dissipated = energies(assembly, solution, elements)
    shapes = unit_shapes(_motion(assembly.node_rows, solution.vectors)).astype(complex)
    motions = describe(assembly, solution, shapes, elements, strain, dissipated)
    modes = Modes(
        eigenvalues=solution.eigenvalues,
        kinds=solution.kinds,
        nodes=assembly.nodes,
        shapes=shapes,
        undamped_natural_frequencies=_undamped_rates(passive, solution, lowest) / (2 * np.pi),
        elements=elements,
        kinetic=kinetic,
        strain=strain,
        dissipated=dissipated,
        converged=solution.converged,
        descriptions=with_growth(solution, motions),
        title=drivetrain.title,
        notes=(*notes, *more, *(_table_notes(assembly, solution) if assembly.system.dynamic else ())),
        motions=motions,
    )
    return modes, (*warned, *convergence_warnings(solution), *accuracy_warnings(solution.errors))


def _table_notes(assembly: Assembly, solution: EigenSolution) -> tuple[str, ...]:
    """Notes on tables that are read beyond their rows, and on steep ones that let more modes vibrate than at rest."""
    from torsionnet.linear.assembly.table_range import range_notes

    read = np.abs(solution.eigenvalues.imag[[kind != RIGID for kind in solution.kinds]]) / (2 * np.pi)
    further = f"{solution.more} vibration{'s' * (solution.more > 1)} more than with their values at rest"
    steep = f"tables over frequency are so steep that there {'are' if solution.more > 1 else 'is'} {further}"
    return (*range_notes(assembly, read), *([steep] if solution.more > 0 else []))


def _motion(rows: Rows, vectors: ComplexArray) -> ComplexArray:
    """Motions (n_rows, n_modes) of rows, such as node angles, in mode shapes over coordinates.

    They are sparse products where that pays for the import of scipy.
    """
    return np.asarray((rows.csr if rows.n_columns > LARGE_SYSTEM else rows.dense) @ vectors)


def _undamped_rates(system: RowSystem, solution: EigenSolution, lowest: int | None) -> FloatArray:
    """Natural frequencies (n,) in rad/s without damping, those of the solution itself where there is none."""
    if system.damping.any() or system.dynamic or system.is_active:
        return undamped_modes(system, lowest)[0]
    return np.abs(solution.eigenvalues)


def energies(
    assembly: Assembly, solution: EigenSolution, elements: tuple[str, ...]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shares (n_elements, n_modes) of the elements in the kinetic, strain and dissipated energy of each mode.

    Kinetic J |lambda|^2 |gamma|^2, strain Re(k) |gamma|^2, dissipated (c |lambda| + Im(k)) |lambda| |gamma|^2; tables
    over frequency give their own energies. A torque T that follows the motion dissipates
    -Re(T conj(lambda gamma)), which is negative where the torque drives the vibration.
    """
    system = assembly.system
    motion = np.abs(_motion(system.law_rows, solution.vectors)) ** 2
    sizes = np.array([sum(map(abs, row.values())) for row in system.sparse_rows])
    # Motions that are rounding have no energy.
    motion[motion < (1e-12 * sizes[:, None]) ** 2] = 0.0
    rate = np.abs(solution.eigenvalues)
    inertia, stiffness, loss = (np.zeros((len(motion), len(rate))) for _ in range(3))
    for law, table in system.dynamic:
        parts = [table.energy(value) for value in solution.eigenvalues.tolist()]
        inertia[law], stiffness[law], loss[law] = np.array(parts).reshape(-1, 3).T
    kinetic = (system.inertia[:, None] + inertia) * motion
    strain = (system.stiffness[:, None] + stiffness) * motion
    dissipated = (system.damping[:, None] * rate + loss) * rate * motion
    # A rigid body strains nothing, and what it loses is no part of a vibration.
    rigid = np.array([kind == "rigid body" for kind in solution.kinds], dtype=bool)
    strain[:, rigid], dissipated[:, rigid] = 0.0, 0.0
    place = {element: number for number, element in enumerate(elements)}
    owner = np.array([place[name] for name in assembly.owners], dtype=int)
    power = _summed(dissipated, owner, len(elements))
    for action in system.actions:
        power[place[action.owner]] += _drawn(assembly, action, solution) * ~rigid
    return (
        _shares(_summed(kinetic, owner, len(elements))),
        _shares(_summed(strain, owner, len(elements))),
        _shares(power),
    )


def _drawn(assembly: Assembly, action: ActionLaw, solution: EigenSolution) -> FloatArray:
    """Power (n_modes,) that an action takes out of each mode, twice its mean in W for shapes in rad."""
    row, sensed = (assembly.over_coordinates(part) @ solution.vectors for part in (action.row, action.sensed))
    with np.errstate(all="ignore"):
        power = -(action.kappa(solution.eigenvalues) * sensed * np.conj(solution.eigenvalues * row)).real
    return np.where(np.isfinite(power), power, 0.0)


def _summed(parts: FloatArray, owner: NDArray[np.int_], count: int) -> FloatArray:
    total = np.zeros((count, parts.shape[1]))
    np.add.at(total, owner, parts)
    return total


def _shares(parts: FloatArray) -> FloatArray:
    """Shares (n_elements, n_modes) of the magnitudes' sum in each column, negative where an element drives the mode."""
    total = np.abs(parts).sum(axis=0)
    return np.asarray(np.divide(parts, total, out=np.zeros_like(parts), where=total != 0))
