"""Physics that holds for every drivetrain, on random ones; the reference is Lagrange's equations in 100 digits.

``PROPERTY_EXAMPLES=500 pytest tests/linear/test_properties.py`` explores further than the fixed examples of a normal run.
"""

import os
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, event, given, settings
from hypothesis import strategies as st
from support import campaigns
from support.strategies import (
    GROUND,
    HOLDS,
    LOSSY,
    MP,
    TREE,
    TWO_PI,
    Blueprint,
    Piece,
    blueprints,
    decades,
    frequencies,
    matching,
    number,
    rank,
    ratios,
    solve,
    stiffnesses,
    written,
)

import torsionnet as tn
from torsionnet.model.channels import Sensor

EXPLORE = int(os.environ.get("PROPERTY_EXAMPLES", "0"))
RATIONAL = tuple(kind for kind in TREE if kind != "shaft")  # a shaft brings pi
ELASTIC_LOOPS = ("spring", "gear_loop", "compliant_gear", "damper")


def examples(count):
    """Settings of a property: a fixed set of examples, or many random ones where asked for."""
    return settings(
        max_examples=EXPLORE or campaigns.examples(max(10, count // 3), count),
        derandomize=not EXPLORE,
        deadline=None,
        phases=[Phase.explicit, Phase.generate, Phase.shrink],
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
    )


# --- helpers --------------------------------------------------------------------------------------------------------


def tolerance(sensitivity):
    """What rounding of all coefficients may change: per pair of nodes, and a floor for pairs hardly connected.

    The factor is wide: a heavy member eliminated by a planetary set with a massless one costs a dense solve 1e7.
    """
    own = np.sqrt(np.abs(np.diagonal(sensitivity, axis1=1, axis2=2)))
    return 1e-9 * sensitivity + 1e-12 * own[:, :, None] * own[:, None, :]


def all_receptances(drivetrain, mechanics, f):
    """Between all nodes; a torque on a node that cannot move is refused and would move nothing."""
    nodes = mechanics.nodes
    moving = [node for node in nodes if mechanics.moves(node)]
    H = np.zeros((len(f), len(nodes), len(nodes)), complex)
    H[:, :, [nodes.index(node) for node in moving]] = drivetrain.frequency_response(nodes, moving, f).values
    for node in set(nodes) - set(moving):
        with pytest.raises(tn.UsageError, match="locked"):
            drivetrain.frequency_response(moving, node, f)
    return H


def assert_same_receptances(drivetrain, mechanics, f):
    """Receptances between all nodes of ``mechanics`` are those of the reference."""
    H = all_receptances(drivetrain, mechanics, f)
    G, sensitivity = mechanics.receptances(f)
    assert np.all(np.abs(H - G) <= tolerance(sensitivity))


def poles(modes):
    """Every pole of the modes, conjugates and double zeros included once each as kinds say."""
    return [lam for lam, kind in zip(modes.eigenvalues, modes.kinds, strict=True) if kind != "rigid body"]


def assert_same_poles(first, second, relative=1e-5):
    assert first.kinds.count("rigid body") == second.kinds.count("rigid body")
    ours, theirs = poles(first), poles(second)
    assert len(ours) == len(theirs)
    for lam in ours:
        nearest = min(theirs, key=lambda mu: abs(mu - lam))
        assert abs(nearest - lam) <= relative * abs(lam)
        theirs.remove(nearest)


def to_digits(matrix):
    """A sympy matrix of numbers as an array of 100 digits."""
    import sympy

    cells = [[MP.mpf(str(sympy.N(cell, 100))) for cell in row] for row in matrix.tolist()]
    return np.array(cells, object).reshape(matrix.shape)


def substituted(system):
    """M, C, K, H, T of a symbolic system with its values, 100 digits."""
    return [to_digits(getattr(system, name).subs(system.values)) for name in ("M", "C", "K", "H", "T")]


def largest(array):
    return max((abs(cell) for cell in array.ravel()), default=MP.mpf(0))


@st.composite
def joined(draw, upstream, downstream, meters=("rigid_coupling", "spring", "gear", "damper")):
    """Two drivetrains joined at one element only: (upstream, meter, downstream)."""
    first, second = draw(upstream).prefixed("u_"), draw(downstream).prefixed("d_")
    at = draw(st.sampled_from([n for n in first.nodes if first.mechanics.moves(n)]))
    kind = draw(st.sampled_from(meters))
    values = {"nodes": (at, "d_n0")}
    if kind == "gear":
        values |= {"ratio": draw(ratios)}
    elif kind == "spring":
        values |= {"stiffness": draw(stiffnesses), "damping": draw(decades(-2, 2))}
    elif kind == "damper":
        values |= {"damping": draw(decades(-2, 4))}
    return first, Piece(kind, "meter", values), second


# --- receptance -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@examples(60)
@given(blueprints(kinds=LOSSY), frequencies)
def test_receptances_are_those_of_lagrange_in_100_digits(blueprint, f):
    assert_same_receptances(blueprint.drivetrain(), blueprint.mechanics, f)


@examples(40)
@given(blueprints(kinds=LOSSY), frequencies)
def test_receptance_is_reciprocal_between_any_two_nodes(blueprint, f):
    drivetrain, mechanics = blueprint.drivetrain(), blueprint.mechanics
    H = all_receptances(drivetrain, mechanics, f)
    _, sensitivity = mechanics.receptances(f)
    assert np.all(np.abs(H - H.transpose(0, 2, 1)) <= tolerance(sensitivity))


@examples(40)
@given(blueprints(kinds=LOSSY, closing=ELASTIC_LOOPS), frequencies, st.data())
def test_reaction_at_a_clamp_is_dual_to_the_angles_an_imposed_angle_there_causes(blueprint, f, data):
    """Betti: T_lock / T_n of the clamped drivetrain is theta_n / theta_m of the one driven there."""
    mechanics = blueprint.mechanics
    m = data.draw(st.sampled_from([node for node in blueprint.nodes if mechanics.moves(node)]))
    clamped = Blueprint((*blueprint.pieces, Piece("lock", "clamp", {"node": m})))
    assume(clamped.mechanics.degrees_of_freedom)
    moving = [node for node in clamped.mechanics.nodes if clamped.mechanics.moves(node)]
    driven = blueprint.drivetrain(inputs={"phi": {"angle": m}})
    reaction = clamped.drivetrain().frequency_response("torque(clamp)", moving, f).values[:, 0, :]
    angles = driven.frequency_response(moving, "phi", f).values[:, :, 0]
    G, sensitivity = mechanics.receptances(f)
    i, j = matching(mechanics, moving), mechanics.nodes.index(m)
    exact, own = G[:, i, j] / G[:, j, j, None], np.abs(G[:, j, j, None])
    allowed = (sensitivity[:, i, j] + np.abs(exact) * sensitivity[:, j, j, None]) / own
    # the clamped drivetrain has resonances of its own
    _, inside = clamped.mechanics.receptances(f)
    c = matching(clamped.mechanics, moving)
    scale = np.sqrt(np.abs(inside[:, c, c] * sensitivity[:, j, j, None])) / own
    assert np.all(np.abs(reaction - angles) <= 1e-10 * (allowed + scale))
    assert np.all(np.abs(angles - exact) <= 1e-10 * (allowed + scale))


@examples(40)
@given(blueprints(kinds=LOSSY), frequencies)
def test_passive_drivetrains_take_mean_power_from_any_torques(blueprint, f):
    drivetrain, mechanics = blueprint.drivetrain(), blueprint.mechanics
    H = all_receptances(drivetrain, mechanics, f)
    G, sensitivity = mechanics.receptances(f)
    for omega, h, size in zip(2 * np.pi * np.array(f), H, sensitivity, strict=True):
        power = np.real(1j * omega * np.diag(h))
        assert np.all(power >= -1e-9 * omega * np.diag(size))
        scale = np.sqrt(np.where(np.diag(size) > 0, np.diag(size), 1))  # any torques at once: no negative eigenvalue
        together = 1j * h / np.outer(scale, scale)
        assert np.linalg.eigvalsh((together + together.conj().T) / 2).min() >= -1e-9 * len(scale)
    assert G.shape == H.shape


@examples(40)
@given(blueprints(kinds=LOSSY, held=True))
def test_static_gain_is_the_compliance(blueprint):
    mechanics = blueprint.mechanics
    event(f"{mechanics.degrees_of_freedom} degrees of freedom")
    assert mechanics.rigid_modes == 0
    assert_same_receptances(blueprint.drivetrain(), mechanics, [0.0])


# --- energy ---------------------------------------------------------------------------------------------------------


@examples(40)
@given(blueprints())
def test_energy_shares_sum_to_one_and_are_those_of_the_shapes(blueprint):
    modes, mechanics = blueprint.drivetrain().modes(), blueprint.mechanics
    rows = np.array([mechanics.full(term.row) for term in mechanics.terms], float).reshape(-1, mechanics.n)
    shapes = np.array([modes.shape_at(node) for node in mechanics.nodes])
    motion = np.abs(rows @ shapes) ** 2
    sizes = {law: np.array([float(getattr(term, law)) for term in mechanics.terms]) for law in ("J", "c", "k")}
    for law, shares in (("J", modes.kinetic), ("k", modes.strain), ("c", modes.dissipated)):
        assert np.all((shares >= 0) & (shares <= 1 + 1e-12))
        energy = sizes[law][:, None] * motion
        total = shares.sum(0)
        rounding = (
            sum(
                size[:, None] * np.abs(modes.eigenvalues) ** power * (np.abs(rows) @ np.abs(shapes)) ** 2
                for size, power in ((sizes["J"], 2), (sizes["c"], 1), (sizes["k"], 0))
            ).sum(0)
            / np.abs(modes.eigenvalues + (modes.eigenvalues == 0)) ** {"J": 2, "c": 1, "k": 0}[law]
        )
        for mode, kind in enumerate(modes.kinds):
            assert total[mode] == pytest.approx(1, abs=1e-9) or total[mode] == 0
            if kind == "rigid body":
                assert law == "J" or total[mode] == 0
                continue
            # differences of shapes given in doubles: compare where they say something
            if rounding[mode] * 1e-6 >= energy[:, mode].sum():
                continue
            assert total[mode] == pytest.approx(1, abs=1e-9)
            for index, name in enumerate(modes.elements):
                own = sum(e for e, t in zip(energy[:, mode], mechanics.terms, strict=True) if t.owner == name)
                assert shares[index, mode] == pytest.approx(own / energy[:, mode].sum(), abs=1e-6)


# --- invariance -----------------------------------------------------------------------------------------------------


@examples(15)
@given(blueprints(kinds=(*TREE, "hysteretic_spring"), size=3), frequencies, st.data())
def test_equations_in_any_coordinates_describe_the_same_drivetrain(blueprint, f, data):
    """The matrices are congruent (same eigenvalues) and give the same receptances."""
    mechanics = blueprint.mechanics
    chosen = []
    for node in data.draw(st.permutations(mechanics.nodes)):
        rows = [[vector[mechanics.nodes.index(n)] for vector in mechanics.basis] for n in (*chosen, node)]
        if rank(rows, mechanics.degrees_of_freedom) == len(rows):
            chosen.append(node)
    system = blueprint.drivetrain().symbolic(referred_to=chosen)
    assert list(system.coordinates) == chosen
    assert not system.conditions
    M, C, K, H, T = substituted(system)
    order = [system.nodes.index(node) for node in mechanics.nodes]
    T = T[order]
    rows = np.array([[number(x) for x in mechanics.full(t.row)] for t in mechanics.terms], object)
    rows = rows.reshape(-1, mechanics.n) @ T
    for matrix, values in (
        (M, [t.J for t in mechanics.terms]),
        (C, [t.c for t in mechanics.terms]),
        (K, [t.k for t in mechanics.terms]),
        (H, [t.k * number(t.eta) for t in mechanics.terms]),
    ):
        own = rows.T @ (np.array(values, object)[:, None] * rows)
        size = np.abs(rows).T @ (np.array(values, object)[:, None] * np.abs(rows))
        assert all(abs(x) <= 1e-14 * abs(y) for x, y in zip((matrix - own).ravel(), size.ravel(), strict=True))
    G, sensitivity = mechanics.receptances(f)
    for frequency, reference, allowed in zip(f, G, tolerance(sensitivity), strict=True):
        s = MP.mpc(0, TWO_PI * MP.mpf(frequency))
        D = M * s**2 + C * s + K + MP.mpc(0, 1) * H

        response = (T @ solve(D, T.T)).astype(complex)
        assert np.all(np.abs(response - reference) <= allowed)


@examples(15)
@given(blueprints(size=3), st.data())
def test_named_symbols_give_the_numeric_equations(blueprint, data):
    """Every value a parameter: M, C, K with the values put in are the row-wise sums of first principles."""
    import sympy

    del data
    parameters, elements = {}, []
    for piece in blueprint.pieces:
        element = piece.element()
        names = {}
        for field, value in piece.values.items():
            if isinstance(value, Fraction) and value and field != "ratio":
                name = f"p_{len(parameters)}"
                parameters[name], names[field] = written(value), name
        if names:
            element = replace(element, **names)
        elements.append(element)
    drivetrain = tn.Drivetrain("symbols", elements, parameters=parameters)
    system = drivetrain.symbolic()
    assert {str(symbol) for symbol in system.values} == set(parameters)
    numeric = blueprint.drivetrain().symbolic()
    assert system.coordinates == numeric.coordinates
    for ours, theirs in zip(substituted(system), substituted(numeric), strict=True):
        assert largest(ours - theirs) <= 1e-14 * largest(theirs)
    for matrix in (system.M, system.C, system.K):
        assert sympy.simplify(matrix - matrix.T) == sympy.zeros(*matrix.shape)


@examples(30)
@given(blueprints(), frequencies, st.randoms(use_true_random=False))
def test_order_of_elements_changes_nothing(blueprint, f, random):
    pieces = list(blueprint.pieces)
    random.shuffle(pieces)
    shuffled = Blueprint(tuple(pieces)).drivetrain()
    assert_same_receptances(shuffled, blueprint.mechanics, f)
    assert_same_poles(shuffled.modes(), blueprint.drivetrain().modes())


WRITINGS = {  # field: SI in pint, then (text of torsionnet, unit of pint, factor or inverse)
    "stiffness": (
        "N*m/rad",
        ("kN*m/rad", "kN*m/rad", 1),
        ("kNm/rad", "kN*m/rad", 1),
        ("N·m/deg", "N*m/degree", 1),
        ("Nm/deg", "N*m/degree", 1),
        ("lbf*in/rad", "lbf*inch/rad", 1),
        ("Nm/rev", "N*m/turn", 1),
        ("rad/(N*m)", "rad/(N*m)", None),
        ("deg/kNm", "degree/(kN*m)", None),
    ),
    "inertia": (
        "kg*m^2",
        ("kg*cm^2", "kg*cm^2", 1),
        ("kgm²", "kg*m^2", 1),
        ("lb*ft^2", "lb*ft^2", 1),
        ("lb*ft^2 WR2", "lb*ft^2", 1),
        ("lbf·in·s²", "lbf*inch*s^2", 1),
        ("kg*m^2 GD2", "kg*m^2", 4),
        ("t*mm^2", "tonne*mm^2", 1),
    ),
    "damping": (
        "N*m*s/rad",
        ("kN*m*s/rad", "kN*m*s/rad", 1),
        ("Nms/rad", "N*m*s/rad", 1),
        ("Nm/rpm", "N*m/rpm", 1),
        ("Nms/deg", "N*m*s/degree", 1),
        ("lbf*in*s/rad", "lbf*inch*s/rad", 1),
    ),
    "length": ("m", ("mm", "mm", 1), ("in", "inch", 1), ("ft", "ft", 1)),
    "density": ("kg/m^3", ("g/cm^3", "g/cm^3", 1), ("lb/in^3", "lb/inch^3", 1)),
    "shear_modulus": ("Pa", ("GPa", "GPa", 1), ("psi", "psi", 1), ("kN/mm^2", "kN/mm^2", 1)),
    "planet_mass": ("kg", ("g", "g", 1), ("lb", "lb", 1)),
}
WRITINGS |= {"outer_diameter": WRITINGS["length"], "inner_diameter": WRITINGS["length"]}
WRITINGS |= {"orbit_radius": WRITINGS["length"], "planet_inertia": WRITINGS["inertia"]}


@examples(30)
@given(blueprints(), frequencies, st.data())
def test_unit_a_value_is_written_in_changes_nothing(blueprint, f, data):
    import pint

    units, elements = pint.get_application_registry(), []
    for piece in blueprint.pieces:
        element, texts = piece.element(), {}
        for field, value in piece.values.items():
            if isinstance(value, Fraction) and field in WRITINGS and (value or field != "stiffness"):
                si, *writings = WRITINGS[field]
                text, unit, factor = data.draw(st.sampled_from(writings))
                if factor is None:
                    size = (1 / units.Quantity(float(value), si)).to(unit).magnitude
                else:
                    size = units.Quantity(float(value), si).to(unit).magnitude * factor
                texts[field] = f"{size!r} {text}"
        if texts:
            element = replace(element, **texts)
        elements.append(element)
    assert_same_receptances(tn.Drivetrain("units", elements), blueprint.mechanics, f)


@examples(30)
@given(blueprints(kinds=LOSSY), frequencies, st.data())
def test_splitting_a_node_by_a_rigid_coupling_changes_nothing(blueprint, f, data):
    node = data.draw(st.sampled_from(blueprint.nodes))
    pieces = [
        piece.moved({node: "twin"}) if node in piece.nodes and data.draw(st.booleans()) else piece
        for piece in blueprint.pieces
    ]
    nodes = data.draw(st.permutations([node, "twin"]))
    split = Blueprint((*pieces, Piece("rigid_coupling", "seam", {"nodes": tuple(nodes)}))).drivetrain()
    mechanics = blueprint.mechanics
    assert_same_receptances(split, mechanics, f)
    moving = [at for at in mechanics.nodes if mechanics.moves(at)]
    H = split.frequency_response([node, "twin"], moving, f).values
    assert np.array_equal(H[:, 0], H[:, 1])


@pytest.mark.slow
@examples(25)
@given(blueprints(size=2), blueprints(kinds=RATIONAL, size=2, holds=HOLDS), ratios, frequencies, st.data())
def test_drivetrain_behind_a_gear_scaled_by_tau_squared_equals_no_gear(front, behind, tau, f, data):
    import sympy

    front, behind = front.prefixed("u_"), behind.prefixed("d_")
    joint = data.draw(st.sampled_from(front.nodes))
    plain = front.plus(*(piece.scaled(1 / tau**2).moved({"d_n0": joint}) for piece in behind.pieces))
    gear = Piece("gear", "gear", {"nodes": (joint, "d_n0"), "ratio": tau})
    geared = front.plus(gear, behind)
    assume(plain.mechanics.degrees_of_freedom)
    mechanics = plain.mechanics
    nodes = mechanics.nodes
    turns = np.array([1 if node.startswith("u_") else float(tau) for node in nodes])
    H = all_receptances(geared.drivetrain(), mechanics, f) * np.outer(turns, turns)
    G, sensitivity = mechanics.receptances(f)
    assert np.all(np.abs(H - G) <= tolerance(sensitivity))
    if any(piece.kind == "shaft" for piece in front.pieces):
        return
    ours = plain.drivetrain().symbolic()
    theirs = geared.drivetrain().symbolic(referred_to=ours.coordinates)
    assert theirs.coordinates == ours.coordinates
    S = sympy.diag(*(1 if n.startswith("u_") else 1 / sympy.Rational(str(tau)) for n in ours.coordinates))
    for name in ("M", "C", "K"):
        difference = getattr(ours, name) - S * getattr(theirs, name) * S
        assert sympy.simplify(difference) == sympy.zeros(*difference.shape)


# --- measured inputs ------------------------------------------------------------------------------------------------


def measured_response(first, meter, second, outputs, at, f):
    drivetrain = first.plus(meter, second).drivetrain(inputs={"T": {"torque": at}})
    end = meter.values["nodes"][1]
    return drivetrain.frequency_response(outputs, Sensor("torque", "meter", at=end), f)


@pytest.mark.slow
@examples(40)
@given(joined(blueprints(), blueprints()), blueprints(), frequencies, st.data())
def test_response_against_a_cut_torque_knows_nothing_of_the_upstream_side(parts, other, f, data):
    """It is the receptance of the downstream side alone, whatever drives it."""
    first, meter, second = parts
    alone = second.mechanics
    outputs = [node for node in alone.nodes if alone.moves(node)]
    assume(alone.moves("d_n0"))
    G, sensitivity = alone.receptances(f)
    i, cut = matching(alone, outputs), alone.nodes.index("d_n0")
    exact = G[:, i, cut]
    for upstream in (first, other.prefixed("u_")):
        moving = [node for node in upstream.nodes if upstream.mechanics.moves(node)]
        joint = meter.moved({meter.values["nodes"][0]: data.draw(st.sampled_from(moving))})
        whole = upstream.plus(joint, second)
        at = data.draw(st.sampled_from([node for node in upstream.nodes if whole.mechanics.moves(node)]))
        total, reach = whole.mechanics.receptances(f)
        e, o = whole.mechanics.nodes.index(at), matching(whole.mechanics, outputs)
        torque = np.abs(total[:, o, e]).max(1) / np.abs(exact).max(1)  # that arrives at the cut
        if not np.all(torque > 0):
            continue
        H = measured_response(upstream, joint, second, outputs, at, f)
        rounding = reach[:, o, e] / torque[:, None]
        rounding += np.abs(exact) * (rounding.max(1) / np.abs(exact).max(1) / H.conditioning)[:, None]
        assert np.all(np.abs(H.values[:, :, 0] - exact) <= 1e-10 * (sensitivity[:, i, cut] + rounding))


@pytest.mark.slow
@examples(30)
@given(joined(blueprints(), blueprints()), frequencies, st.data())
def test_measured_input_times_its_own_response_is_the_plain_response(parts, f, data):
    first, meter, second = parts
    whole = first.plus(meter, second)
    mechanics = whole.mechanics
    moving = [node for node in mechanics.nodes if mechanics.moves(node)]
    at = data.draw(st.sampled_from(moving))
    drivetrain = whole.drivetrain(inputs={"T_M": {"torque": at}}, sensors={"T_T": {"torque": "meter"}})
    own = drivetrain.frequency_response("T_T", "T_M", f).values[:, 0, 0]
    plain = drivetrain.frequency_response(moving, "T_M", f).values[:, :, 0]
    assume(np.all(np.abs(own) > 1e-9))
    measured = drivetrain.frequency_response(moving, "T_T", f).values[:, :, 0]
    _, sensitivity = mechanics.receptances(f)
    i = matching(mechanics, moving)
    allowed = sensitivity[:, i, mechanics.nodes.index(at)]
    assert np.all(np.abs(measured * own[:, None] - plain) <= 1e-12 * allowed + 1e-14 * np.abs(plain))


def chain_with_cut(upstream_inertia=Fraction(1), **inputs):
    """motor - spring - hub | meter | flywheel - spring - wheel with damper to ground."""
    return Blueprint(
        (
            Piece("inertia", "motor", {"node": "a", "inertia": upstream_inertia}),
            Piece("spring", "coupling", {"nodes": ("a", "b"), "stiffness": Fraction(5000), "damping": Fraction(2)}),
            Piece("inertia", "hub", {"node": "b", "inertia": upstream_inertia / 3}),
            Piece("rigid_coupling", "meter", {"nodes": ("b", "c")}),
            Piece("inertia", "flywheel", {"node": "c", "inertia": Fraction(2, 5)}),
            Piece("spring", "shaft", {"nodes": ("c", "d"), "stiffness": Fraction(900), "damping": Fraction(1)}),
            Piece("inertia", "wheel", {"node": "d", "inertia": Fraction(3)}),
            Piece("damper", "air", {"nodes": ("d", GROUND), "damping": Fraction(4)}),
            *inputs.get("more", ()),
        )
    ).drivetrain(inputs={"T": {"torque": inputs.get("at", "a")}}, sensors={"T_T": {"torque": "meter"}})


F = np.array([0.5, 3.0, 9.0, 25.0])


def against_cut(output, **changes):
    light, heavy = (
        chain_with_cut(J, **changes).frequency_response(output, "T_T", F).values.ravel()
        for J in (Fraction(1), Fraction(7))
    )
    return np.max(np.abs(light - heavy) / np.abs(light))


def test_upstream_side_does_not_matter_at_and_beyond_a_bridge_cut():
    assert max(against_cut(output) for output in ("b", "c", "d", "torque(shaft)", "velocity(d)")) < 1e-12


def test_upstream_side_matters_for_an_output_upstream_of_the_cut():
    assert against_cut("a") > 1e-3


def test_upstream_side_matters_when_the_excitation_is_downstream():
    assert against_cut("d", at="d") > 1e-3


def test_upstream_side_matters_when_a_closed_loop_bypasses_the_cut():
    bypass = Piece("spring", "bypass", {"nodes": ("a", "d"), "stiffness": Fraction(300), "damping": Fraction(0)})
    assert against_cut("d", more=(bypass,)) > 1e-3


def test_poles_against_a_cut_torque_are_those_of_the_downstream_side():
    cut = chain_with_cut().modes(measured_input="T_T")
    downstream = tn.Drivetrain(
        "downstream",
        [
            tn.Inertia("flywheel", "c", 0.4),
            tn.Spring("shaft", ("c", "d"), 900, 1),
            tn.Inertia("wheel", "d", 3),
            tn.Damper("air", ("d", "ground"), 4),
        ],
    ).modes()
    assert_same_poles(cut, downstream, 1e-10)


# --- torques --------------------------------------------------------------------------------------------------------


def torque_channels(blueprint, drivetrain):
    """(sensor, node, sign) at every port; at the first port torque counts into the element, elsewhere out of it."""
    found = []
    for name, element in drivetrain.elements.items():
        for index, (port, node) in enumerate(element.ports.items()):
            if node != GROUND:
                found.append((Sensor("torque", name, at=port), node, 1 if index == 0 else -1))
    assert {sensor.of for sensor, _, _ in found} == {piece.name for piece in blueprint.pieces}
    return found


@examples(40)
@given(blueprints(kinds=LOSSY, closing=ELASTIC_LOOPS, holds=("spring_to_ground", "damper_to_ground")), frequencies)
def test_torques_at_every_node_balance(blueprint, f):
    """Torques into all elements, inertias and clamps among them, add up to the applied torque."""
    drivetrain, mechanics = blueprint.drivetrain(), blueprint.mechanics
    channels = torque_channels(blueprint, drivetrain)
    nodes = [node for node in blueprint.nodes if mechanics.moves(node)]
    torques = drivetrain.frequency_response([sensor for sensor, _, _ in channels], nodes, f).values
    angles = np.abs(drivetrain.frequency_response(mechanics.nodes, nodes, f).values)
    rows = np.abs(np.array([mechanics.full(term.row) for term in mechanics.terms], float))
    for k, frequency in enumerate(f):
        s = MP.mpc(0, TWO_PI * MP.mpf(frequency))
        size = np.array([abs(t.J * s * s) + abs(t.c * s) + abs(t.kappa(s)) for t in mechanics.terms], float)
        terms = (rows.T @ (size[:, None] * (rows @ angles[k]))).sum(0) + np.abs(torques[k]).sum(0) + 1
        for node in blueprint.nodes:
            at = sum(sign * torques[k, i] for i, (_, place, sign) in enumerate(channels) if place == node)
            applied = np.array([float(node == driven) for driven in nodes])
            assert np.all(np.abs(at - applied) <= 1e-10 * terms)


@examples(30)
@given(blueprints(kinds=("gear", "planetary", "spring", "differential"), closing=(), holds=(), heavy=True), frequencies)
def test_rigid_connections_pass_on_torque_by_the_ratio_and_all_power(blueprint, f):
    drivetrain = blueprint.drivetrain()
    for piece in blueprint.pieces:
        v = piece.values
        if piece.kind not in {"gear", "planetary", "differential"} or v.get("stiffness") is not None:
            continue
        ports = {port: node for port, node in drivetrain.elements[piece.name].ports.items() if node != GROUND}
        torque = dict(
            zip(
                ports,
                drivetrain.frequency_response([f"torque({piece.name}, {p})" for p in ports], "n0", f).values[:, :, 0].T,
                strict=True,
            )
        )
        speed = dict(
            zip(
                ports,
                drivetrain.frequency_response([Sensor("velocity", node) for node in ports.values()], "n0", f)
                .values[:, :, 0]
                .T,
                strict=True,
            )
        )
        first, *others = ports
        z = float(v.get("ratio", 0))
        shares = {"gear": {"second": z}, "planetary": {"sun": 1, "ring": -z, "carrier": 1 + z}}.get(piece.kind)
        if piece.kind == "differential":
            shares = {"left": 0.5, "right": 0.5}
        if piece.kind == "planetary" and (first != "sun" or v["planet_inertia"] or v["planet_mass"]):
            continue  # planets take torque and power of their own
        if not v.get("locked"):
            for port in others:
                assert torque[port] == pytest.approx(shares[port] * torque[first], rel=1e-12)
        power = torque[first] * np.conj(speed[first]) - sum(torque[p] * np.conj(speed[p]) for p in others)
        scale = sum(np.abs(torque[p] * speed[p]) for p in ports)
        assert np.all(np.abs(power) <= 1e-9 * scale)


@examples(30)
@given(st.lists(ratios, min_size=1, max_size=4), st.lists(stiffnesses, min_size=1, max_size=4), decades(-1, 3))
def test_reaction_of_a_clamp_is_the_static_equilibrium(taus, stiffness, f):
    """A train of gears and springs to a clamp: each shaft carries the torque times the ratios before it."""
    pieces, at = [Piece("inertia", "motor", {"node": "n", "inertia": Fraction(1)})], "n"
    for i, (tau, k) in enumerate(zip(taus, stiffness, strict=False)):
        pieces += [
            Piece("gear", f"gear{i}", {"nodes": (at, f"g{i}"), "ratio": tau}),
            Piece("spring", f"spring{i}", {"nodes": (f"g{i}", f"s{i}"), "stiffness": k, "damping": Fraction(1)}),
        ]
        at = f"s{i}"
    blueprint = Blueprint((*pieces, Piece("lock", "clamp", {"node": at})))
    drivetrain = blueprint.drivetrain()
    total = np.prod([float(tau) for tau, _ in zip(taus, stiffness, strict=False)])
    static = drivetrain.frequency_response(["torque(clamp)", "n"], "n", [0.0]).values[0, :, 0]
    compliance, ratio, reflected = Fraction(0), Fraction(1), []
    for tau, k in zip(taus, stiffness, strict=False):
        ratio *= tau
        compliance += ratio**2 / k
        reflected += [k / ratio**2]
    spread = float(max(reflected) / min(reflected))  # a dense solve loses as many digits
    assert static == pytest.approx([total, float(compliance)], rel=1e-14 * spread + 1e-12)
    last = len(list(zip(taus, stiffness, strict=False))) - 1
    both = drivetrain.frequency_response(["torque(clamp)", f"torque(spring{last})"], "n", [float(f)]).values[0, :, 0]
    assert both[0] == pytest.approx(both[1], rel=1e-14 * spread + 1e-12)


@examples(20)
@given(st.lists(ratios, min_size=1, max_size=3), blueprints(size=2), st.booleans())
def test_torque_in_a_rigid_loop_is_refused_naming_the_loop(taus, rest, through):
    pieces, total = [], Fraction(1)
    for i, tau in enumerate(taus):
        pieces.append(Piece("gear", f"stage{i}", {"nodes": (f"l{i}", f"l{i + 1}"), "ratio": tau}))
        total *= tau
    closing = Piece("gear", "closing", {"nodes": ("l0", f"l{len(taus)}"), "ratio": total})
    bridge = Piece("spring", "bridge", {"nodes": ("l0", "r_n0"), "stiffness": Fraction(100)})
    rotor = Piece("inertia", "rotor", {"node": "l0", "inertia": Fraction(1)})
    drivetrain = rest.prefixed("r_").plus(rotor, bridge, *pieces, closing).drivetrain()
    names = [piece.name for piece in (*pieces, closing)]
    element = names[-1] if through else names[0]
    with pytest.raises(tn.UsageError) as refusal:
        drivetrain.frequency_response(Sensor("torque", element), "l0", [1.0])
    assert "statically indeterminate" in str(refusal.value)
    assert all(name in str(refusal.value) for name in names)
    assert not any(piece.name in str(refusal.value).split() for piece in rest.prefixed("r_").pieces)
    assert np.all(np.isfinite(drivetrain.frequency_response("torque(bridge)", "l0", [1.0]).values))


# --- zero frequency -------------------------------------------------------------------------------------------------


@examples(30)
@given(blueprints(kinds=(*TREE, "hysteretic_spring"), closing=ELASTIC_LOOPS, holds=(), heavy=True), st.data())
def test_torques_of_a_free_drivetrain_have_a_limit_at_zero_frequency(blueprint, data):
    mechanics = blueprint.mechanics
    driven = data.draw(st.sampled_from([node for node in mechanics.nodes if mechanics.moves(node)]))
    elastic = [p for p in blueprint.pieces if p.values.get("stiffness") and p.nodes[0] != GROUND]
    assume(elastic)
    drivetrain = blueprint.drivetrain()
    names, ports = [piece.name for piece in elastic], [piece.nodes[0] for piece in elastic]
    limit = drivetrain.frequency_response([f"torque({name})" for name in names], driven, [0.0]).values[0, :, 0]
    assert np.all(np.isfinite(limit))
    s = MP.mpc(0, MP.mpf(10) ** -16)
    column = mechanics.receptance(s.imag / TWO_PI)[:, mechanics.nodes.index(driven)]
    for name, port, value in zip(names, ports, limit, strict=True):
        exact = MP.mpc(0)
        for term in mechanics.terms:
            if term.owner == name and port in term.row:
                twist = sum(number(a) * column[mechanics.nodes.index(node)] for node, a in term.row.items())
                exact += number(term.row[port]) * term.kappa(s) * twist
        assert value == pytest.approx(complex(exact), rel=1e-7, abs=1e-7)


HYSTERETIC = tn.HystereticSpring("rubber", ("a", "b"), 720_000, loss_factor=0.38)
DISCS = tuple(tn.Inertia(f"J_{node}", node, 1) for node in ("a", "b", "p", "q", "c", "l"))
AXLE = tn.Differential("axle", cage="c", left="l", right="b")
STAGE = tn.Gear("stage", ("p", "q"), ratio="25/7", housing="b")


@pytest.mark.parametrize(
    "order",
    [
        (*DISCS, HYSTERETIC, STAGE, AXLE),
        (AXLE, STAGE, DISCS[4], DISCS[5], HYSTERETIC, *DISCS[:4]),
    ],
    ids=["discs first", "axle first"],
)
def test_static_torque_of_a_free_hysteretic_drivetrain_is_shared_by_inertia(order):
    """Behind the rubber: the disc at b, the gear turning in its housing and the differential."""
    torque = tn.Drivetrain("free", order).frequency_response("torque(rubber)", "a", [0.0, 0.01]).values.ravel()
    tau = 25 / 7
    seen = 1 + (1 - tau) ** 2 / (1 + tau**2) + 1 / (1 + 4)  # of b: its own, p - tau q = (1 - tau) b, 2 c - l = b
    assert torque[1] == pytest.approx(seen / (1 + seen), rel=1e-6)
    assert torque[0] == pytest.approx(seen / (1 + seen), rel=1e-9)


@pytest.mark.slow
@examples(25)
@given(blueprints(closing=ELASTIC_LOOPS, holds=(), heavy=True))
def test_angle_of_a_free_drivetrain_is_infinite_at_zero_frequency(blueprint):
    mechanics = blueprint.mechanics
    own = np.abs(np.diag(mechanics.receptance(MP.mpf(10) ** -15).astype(complex)))
    free = [node for node, size in zip(mechanics.nodes, own, strict=True) if size > 1e15]
    assume(free)
    event(f"{mechanics.rigid_modes} rigid-body modes")
    for node in free:
        with pytest.warns(tn.TorsionnetWarning, match="infinite"):
            assert np.isinf(blueprint.drivetrain().frequency_response(node, node, [0.0]).values[0, 0, 0])


# --- imposed angles -------------------------------------------------------------------------------------------------


@examples(30)
@given(blueprints(kinds=LOSSY), frequencies, st.data())
def test_imposed_angle_is_one_where_imposed_and_transmitted_elsewhere(blueprint, f, data):
    mechanics = blueprint.mechanics
    m = data.draw(st.sampled_from([node for node in mechanics.nodes if mechanics.moves(node)]))
    drivetrain = blueprint.drivetrain(inputs={"phi": {"angle": m}})
    assert np.array_equal(drivetrain.frequency_response(m, "phi", f).values.ravel(), np.ones(len(f)))
    G, _ = mechanics.receptances(f)
    j = mechanics.nodes.index(m)
    tied = [
        n
        for n in mechanics.nodes
        if len({r[mechanics.nodes.index(n)] / r[j] for r in mechanics.basis if r[j]}) == 1
        and not any(r[mechanics.nodes.index(n)] for r in mechanics.basis if not r[j])
    ]
    assume(tied)
    H = drivetrain.frequency_response(tied, "phi", f).values[:, :, 0]
    i = matching(mechanics, tied)
    assert H == pytest.approx(G[:, i, j] / G[:, j, j, None], rel=1e-12)


# --- modes ----------------------------------------------------------------------------------------------------------


def determinant(matrix):
    """Determinant of exact fractions."""
    matrix, value = [list(row) for row in matrix], Fraction(1)
    for i in range(len(matrix)):
        pivot = next((r for r in range(i, len(matrix)) if matrix[r][i]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != i:
            matrix[i], matrix[pivot], value = matrix[pivot], matrix[i], -value
        value *= matrix[i][i]
        for r in range(i + 1, len(matrix)):
            factor = matrix[r][i] / matrix[i][i]
            matrix[r] = [x - factor * y for x, y in zip(matrix[r], matrix[i], strict=True)]
    return value


def characteristic_polynomial(blueprint):
    """Exact coefficients of det D(s), ascending, by interpolation."""
    mechanics = blueprint.mechanics
    exact = {}
    for term in mechanics.terms:
        exact[id(term)] = [Fraction(str(MP.nstr(value, 40))) for value in (term.J, term.c, term.k)]
    n = mechanics.degrees_of_freedom
    rows = [mechanics.reduced(term.row) for term in mechanics.terms]
    points = range(-n, n + 1)
    values = []
    for x in points:
        D = [[Fraction(0)] * n for _ in range(n)]
        for row, term in zip(rows, mechanics.terms, strict=True):
            J, c, k = exact[id(term)]
            kappa = J * x * x + c * x + k
            for i in range(n):
                for j in range(n):
                    D[i][j] += kappa * row[i] * row[j]
        values.append(determinant(D))
    coefficients = [Fraction(0)] * len(points)
    for i, x in enumerate(points):  # Lagrange
        basis = [Fraction(1)]
        for y in points:
            if y != x:
                basis = [
                    (low - y * high) / (x - y)
                    for low, high in zip([Fraction(0), *basis], [*basis, Fraction(0)], strict=True)
                ]
        coefficients = [a + values[i] * b for a, b in zip(coefficients, basis, strict=True)]
    while not coefficients[-1]:
        coefficients.pop()
    return coefficients


@examples(40)
@given(blueprints(kinds=RATIONAL))
def test_poles_are_all_the_roots_of_the_exact_determinant(blueprint):
    coefficients = characteristic_polynomial(blueprint)
    zeros = next(i for i, value in enumerate(coefficients) if value)
    coefficients = [number(value) for value in coefficients[zeros:]]
    found = poles(blueprint.drivetrain().modes())
    every = [MP.mpc(lam) for lam in found] + [MP.mpc(lam.conjugate()) for lam in found if lam.imag]
    event(f"{zeros} zero roots, {len(coefficients) - 1} others")
    assert len(every) == len(coefficients) - 1
    if not every:
        return
    slope = [i * value for i, value in enumerate(coefficients)][1:]
    for lam in every:
        step = MP.polyval(coefficients[::-1], lam) / MP.polyval(slope[::-1], lam)  # a root is at most n steps away
        assert abs(step) <= 1e-8 * abs(lam)
    assert abs(sum(every) + coefficients[-2] / coefficients[-1]) <= 1e-8 * sum(map(abs, every))
    inverse = [1 / lam for lam in every]
    assert abs(sum(inverse) + coefficients[1] / coefficients[0]) <= 1e-8 * sum(map(abs, inverse))


@examples(40)
@given(blueprints())
def test_shapes_make_the_dynamic_stiffness_singular(blueprint):
    """D(lambda) theta = 0 at every node: the eigenvalues are the poles of the responses."""
    modes, mechanics = blueprint.drivetrain().modes(), blueprint.mechanics
    rows = np.abs(np.array([mechanics.full(t.row) for t in mechanics.terms], float))
    exact_rows = np.array([[number(x) for x in mechanics.full(t.row)] for t in mechanics.terms], object)
    for i, lam in enumerate(modes.eigenvalues):
        s = MP.mpc(lam)
        shape = np.array([modes.shape_at(node)[i] for node in mechanics.nodes])
        assert np.abs(shape).max() == pytest.approx(1, rel=1e-12)
        for _, row in mechanics.conditions:
            factors = np.array(mechanics.full(row), float)
            assert abs(factors @ shape) <= 1e-13 * (np.abs(factors) @ np.abs(shape))
        kappa = np.array([t.kappa(s) for t in mechanics.terms], object)
        torque = exact_rows.T @ (kappa * (exact_rows @ np.array([MP.mpc(x) for x in shape], object)))
        left = np.abs((mechanics.N.T @ torque).astype(complex))
        size = np.array([abs(t.J * s * s) + abs(t.c * s) + abs(t.k) for t in mechanics.terms], float)
        scale = np.abs(mechanics.N.astype(float)).T @ (rows.T @ (size * (rows @ np.abs(shape))))
        assert left.max() <= 1e-9 * scale.max()


@examples(60)
@given(blueprints())
def test_no_stable_drivetrain_has_an_unstable_pole(blueprint):
    modes = blueprint.drivetrain().modes()
    assert np.all(modes.eigenvalues.real <= 0)
    ratio = modes.damping_ratios[[kind != "rigid body" for kind in modes.kinds]]
    assert np.all((ratio >= 0) & (ratio <= 1))


@examples(40)
@given(blueprints())
def test_rigid_body_modes_are_as_many_as_motions_without_strain(blueprint):
    modes, mechanics = blueprint.drivetrain().modes(), blueprint.mechanics
    event(f"{mechanics.rigid_modes} rigid-body modes")
    rigid = [kind == "rigid body" for kind in modes.kinds]
    assert sum(rigid) == mechanics.rigid_modes
    assert np.all(modes.eigenvalues[rigid] == 0)
    assert np.all(np.isnan(modes.damping_ratios[rigid]))
    for i in np.flatnonzero(rigid):
        for term in mechanics.terms:
            if term.k:
                factors = np.array(mechanics.full(term.row), float)
                shape = np.array([modes.shape_at(node)[i] for node in mechanics.nodes])
                assert abs(factors @ shape) <= 1e-12 * (np.abs(factors) @ np.abs(shape))


@examples(40)
@given(blueprints())
def test_each_conjugate_pair_is_given_once_in_order(blueprint):
    modes = blueprint.drivetrain().modes()
    lam = modes.eigenvalues
    assert np.all(lam.imag >= 0)
    assert np.all(np.diff(np.abs(lam)) >= -1e-12 * np.abs(lam[1:]))
    for value, kind in zip(lam, modes.kinds, strict=True):
        assert (kind == "oscillatory") == (value.imag > 0)
        assert (kind == "rigid body") == (value == 0)
    assert modes.shapes.shape == (len(modes.nodes), len(lam))
    assert modes.undamped_natural_frequencies == pytest.approx(np.sort(modes.undamped_natural_frequencies))
    assert np.all(modes.converged)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the state space of .* has lost digits")  # where slow poles are far below f
@examples(25)
@given(blueprints(holds=HOLDS), frequencies, st.data())
def test_state_space_has_the_same_frequency_response(blueprint, f, data):
    import control

    mechanics = blueprint.mechanics
    moving = [node for node in mechanics.nodes if mechanics.moves(node)]
    at = data.draw(st.lists(st.sampled_from(moving), min_size=1, max_size=2, unique=True))
    outputs = data.draw(st.lists(st.sampled_from(moving), min_size=1, max_size=3, unique=True))
    drivetrain = blueprint.drivetrain(
        inputs={f"T_{i}": {"torque": node} for i, node in enumerate(at)},
        sensors={f"x_{i}": {"angle": node} for i, node in enumerate(outputs)},
    )
    system = drivetrain.to_control()
    assert isinstance(system, control.StateSpace)
    assert (list(system.input_labels), list(system.output_labels)) == (
        [f"T_{i}" for i in range(len(at))],
        [f"x_{i}" for i in range(len(outputs))],
    )
    G, sensitivity = mechanics.receptances(f)
    i, j = matching(mechanics, outputs), matching(mechanics, at)
    A, B, C, D = (np.array(part, float) for part in (system.A, system.B, system.C, system.D))
    digits = [np.array([[MP.mpf(x) for x in row] for row in part], object).reshape(part.shape) for part in (A, B, C, D)]

    for k, frequency in enumerate(f):
        s = MP.mpc(0, TWO_PI * MP.mpf(frequency))
        n = len(A)
        response = digits[3].astype(complex)
        if n:
            eye = np.array([[s if r == c else MP.mpc(0) for c in range(n)] for r in range(n)], object)
            response = (digits[3] + digits[2] @ solve(eye - digits[0], digits[1])).astype(complex)
        pick = np.ix_(i, j)
        assert np.all(np.abs(response - G[k][pick]) <= 1e-9 * sensitivity[k][pick] + tolerance(sensitivity)[k][pick])


# --- copies ---------------------------------------------------------------------------------------------------------


@examples(30)
@given(blueprints(kinds=LOSSY), frequencies)
def test_model_file_holds_the_whole_drivetrain(blueprint, f):
    drivetrain = blueprint.drivetrain()
    again = tn.loads(drivetrain.to_yaml())
    assert again.elements == drivetrain.elements
    moving = [node for node in drivetrain.nodes if blueprint.mechanics.moves(node)]
    H, back = (d.frequency_response(drivetrain.nodes, moving, f).values for d in (drivetrain, again))
    assert np.array_equal(H, back)
    assert again.to_yaml() == drivetrain.to_yaml()


def rig():
    return tn.Drivetrain(
        "rig",
        [
            tn.Inertia("rotor", "a", "J_1"),
            tn.Inertia("disc", "a", "J_2"),
            tn.Spring("shaft", ("a", "b"), "k"),
            tn.Gear("gear", ("b", "c"), ratio="tau"),
            tn.Damper("clutch", ("c", "d"), "c_C"),
            tn.RigidCoupling("lockup", ("c", "d"), enabled=False),
            tn.Inertia("load", "d", 3),
            tn.Damper("bearing", ("d", "ground"), 2),
            tn.Spring("end", ("c", "ground"), 500),
        ],
        parameters={"J": 1, "J_1": "J / 4", "J_2": "J - J_1", "k": "k_0 * 2", "k_0": 1000, "tau": 2, "c_C": 30},
        inputs={"T": {"torque": "a"}},
        configurations={
            "gear": {"low": {"tau": 4}, "high": {"tau": 1.5, "c_C": 60}},
            "clutch": {"open": {}, "closed": {"on": ["lockup"], "off": ["clutch"]}},
        },
    )


def plain_rig(J_1=0.25, J_2=0.75, k=2000.0, tau=2.0, c=30.0, closed=False):
    link = [tn.RigidCoupling("link", ("c", "d"))] if closed else [tn.Damper("link", ("c", "d"), c)]
    return tn.Drivetrain(
        "plain",
        [
            tn.Inertia("rotor", "a", J_1),
            tn.Inertia("disc", "a", J_2),
            tn.Spring("shaft", ("a", "b"), k),
            tn.Gear("gear", ("b", "c"), ratio=tau),
            *link,
            tn.Inertia("load", "d", 3),
            tn.Damper("bearing", ("d", "ground"), 2),
            tn.Spring("end", ("c", "ground"), 500),
        ],
    )


def drive(drivetrain):
    return drivetrain.frequency_response(("a", "d"), "a", F).values


@pytest.mark.parametrize(
    ("name", "overrides", "plain"),
    [
        ("", {}, {}),
        ("gear=low", {}, {"tau": 4}),
        ("gear=low,clutch=closed", {}, {"tau": 4, "closed": True}),
        ("gear=high,clutch=closed", {}, {"tau": 1.5, "closed": True}),
        ("gear=high,clutch=open", {}, {"tau": 1.5, "c": 60}),
        ("clutch=closed", {}, {"closed": True}),
        ("", {"J": 2}, {"J_1": 0.5, "J_2": 1.5}),
        ("", {"J_1": 0.4}, {"J_1": 0.4, "J_2": 0.6}),
        ("", {"J_2": 5}, {"J_2": 5}),
        ("", {"k": 7000, "k_0": 1}, {"k": 7000}),
        ("", {"k_0": "3 kN*m/rad"}, {"k": 6000}),
        ("", {"k": "k_0 * 5"}, {"k": 5000}),
        ("gear=low", {"tau": 3}, {"tau": 3}),
    ],
)
def test_configured_copy_is_the_drivetrain_with_those_values(name, overrides, plain):
    original = rig()
    before, text, parameters = drive(original), original.to_yaml(), dict(original.parameters)
    copy = original.configured(name, **overrides)
    assert drive(copy) == pytest.approx(drive(plain_rig(**plain)), rel=1e-12)
    assert np.array_equal(drive(original), before)
    assert (original.to_yaml(), dict(original.parameters)) == (text, parameters)


def test_axes_combine_in_any_order():
    original = rig()
    both = drive(original.configured("gear=low,clutch=closed"))
    assert np.array_equal(both, drive(original.configured("gear=low").configured("clutch=closed")))
    assert np.array_equal(both, drive(original.configured("clutch=closed").configured("gear=low")))
    assert len(original.configurations) == 4
    assert np.array_equal(drive(tn.loads(original.to_yaml()).configured("gear=low,clutch=closed")), both)
