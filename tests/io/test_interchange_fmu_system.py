"""The matrices an FMU makes its state space of: for random drivetrains, also with other values of every parameter."""

import random

import numpy as np
import pytest
from support import campaigns
from support.made_up_elements import EXPORTED
from support.models import EVERY_ELEMENT, around, without_indeterminate
from support.random_drivetrains import draw

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Name
from torsionnet.base.program import ProgramAlgebra, ProgramNode
from torsionnet.io.fmu.archive import suggested_step
from torsionnet.io.fmu.traced_matrices import dependencies, trace_system
from torsionnet.io.fmu.traced_numbers import NumberTape

F = np.array([0.3, 2.0, 9.0, 40.0])


class Floats(ProgramAlgebra):
    """Recorded numbers at values of the parameters: what the C code does."""

    def __init__(self, values):
        self.values = values

    def leaf(self, payload):
        return float(self.values[payload.name] if isinstance(payload, Name) else payload)


def evaluated(tape, values):
    """Value of a number on a tape for other values of the parameters."""
    found = {}
    return lambda number: tape.values_in(Floats(values), [number], found)[0]


def response(system, number):
    """Outputs over inputs at F: M h'' + C (h', b') + K c = L u solved as it stands."""
    n, n_u, n_y = len(system.coordinates), len(system.inputs), len(system.outputs)
    shapes = (
        dict.fromkeys("MCK", (n, n)) | {"L": (n, n_u), "F": (n_y, n_u)} | dict.fromkeys(("R0", "R1", "R2"), (n_y, n))
    )
    m = {letter: np.zeros(shape) for letter, shape in shapes.items()}
    for letter, entries in system.matrices.items():
        for i, j, value in entries:
            m[letter][i, j] = number(value)
    heavy, damped = len(system.motion.heavy), len(system.motion.damped)
    assert not m["M"][heavy:].any()
    assert not m["C"][heavy + damped :].any()
    s = 2j * np.pi * F
    return np.array(
        [
            (m["R0"] + m["R1"] * p + m["R2"] * p * p) @ np.linalg.solve(m["M"] * p * p + m["C"] * p + m["K"], m["L"])
            + m["F"]
            for p in s
        ]
    )


def with_every_sensor(drawn, source):
    """The drivetrain with torques on two nodes and every sensor that has a state space; None where that cannot be."""
    free = [node for node in drawn.nodes if not drawn.assembly.kinematics.holds(node)]
    inputs = {"first": {"torque": free[0]}, "last": {"torque": free[-1]}}
    wanted = [(quantity, node) for node in free for quantity in ("angle", "velocity", "acceleration")]
    between = [name for name, element in drawn.elements.items() if len(element.ports) > 1]
    wanted += [(quantity, name) for name in between for quantity in ("torque", "twist")]
    source.shuffle(wanted)
    definition, sensors = drawn.definition, {}
    for number, (quantity, of) in enumerate(wanted[:12]):
        sensor = {f"y{number}": {quantity: of}}
        model = tn.Drivetrain("drawn", drawn.elements.values(), definition.parameters, inputs=inputs, sensors=sensor)
        try:
            trace_system(model)
        except UsageError:
            continue
        sensors |= sensor
    if not sensors:
        return None
    return tn.Drivetrain("drawn", drawn.elements.values(), definition.parameters, inputs=inputs, sensors=sensors)


ELEMENTS = EVERY_ELEMENT | EXPORTED
OVER_FREQUENCY = "unsupported-law"
FOLLOWS = "unsupported-law"
REFUSED = {
    "arc_spring": OVER_FREQUENCY,
    "clearance": "no-counterpart",
    "friction": "no-counterpart",
    "hysteretic_spring": OVER_FREQUENCY,
    "tabulated_spring": OVER_FREQUENCY,
    "continuous_shaft": OVER_FREQUENCY,
    "controller": "unsupported-law",
    "fluid_coupling": FOLLOWS,
    "torque_converter": FOLLOWS,
}


@pytest.mark.parametrize("case", sorted(ELEMENTS.keys() - REFUSED.keys()))
def test_every_element_with_all_its_sensors(case):
    rig = without_indeterminate(around(ELEMENTS[case]))
    system = trace_system(rig)
    found = response(system, evaluated(system.motion.tape, {}))
    expected = rig.frequency_response(list(system.outputs), list(system.inputs), F).values
    scale = np.maximum(np.abs(expected).max(axis=0), 1e-300)
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-8, rtol=0)


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_element_that_cannot_be_written_is_named(case):
    with pytest.raises(UsageError, match=REFUSED[case]):
        trace_system(around(ELEMENTS[case]))


@pytest.mark.slow
def test_random_drivetrains_with_any_values():
    counts = dict.fromkeys(("all", "damped", "relative", "fed through", "open"), 0)
    for seed in range(campaigns.examples(40, 60)):
        source = random.Random(seed)
        drawn, _ = draw(source, loops=seed % 2, planetary=seed % 4 == 0)
        model = with_every_sensor(drawn, source)
        if model is None:
            continue
        system = trace_system(model)
        tape = system.motion.tape
        names = [payload.name for payload in tape.present]
        changes = {name: model.parameters[name] * source.uniform(0.7, 1.3) for name in names}
        for values in (model.parameters, changes):
            other = model.configured(**{name: float(values[name]) for name in names})
            expected = other.frequency_response(list(model.sensors), list(model.inputs), F).values
            found = response(system, evaluated(tape, values))
            scale = np.maximum(np.abs(expected).max(axis=0), 1e-12 * np.abs(expected).max())
            np.testing.assert_allclose(found / scale, expected / scale, atol=1e-8, rtol=0)
        counts["all"] += 1
        counts["damped"] += bool(system.motion.damped)
        counts["relative"] += bool(system.motion.relative)
        counts["fed through"] += bool(list(system.matrices["F"]))
        counts["open"] += len(names)
        assert dependencies(system).keys() >= {1 + len(system.inputs)}
    assert min(counts.values()) >= 5, counts


def test_what_moves_as_one_body_meets_no_stiffness():
    """The column of the first angle is empty, not small: a free drivetrain may turn as far as it likes."""
    for name in ("drill_string", "turbine_generator_ssr", "wind_turbine_5mw"):
        system = trace_system(tn.load(name))
        assert not [entry for entry in system.matrices["K"] if 0 in entry[:2]]


@pytest.mark.parametrize(
    ("value", "decided"),
    [
        (lambda a, b: a * b - b * a, False),
        (lambda a, b: a / b * b - a, False),
        (lambda a, b: (a + b) * (a - b) - (a**2 - b**2), False),
        (lambda a, b: a - 2 * b, True),
        (lambda a, b: 1 / a**-1 - 2 * b, True),
        (lambda a, b: a * 0 + b * 0, False),
    ],
)
def test_decisions_that_rest_on_values_are_noted(value, decided):
    tape = NumberTape()
    a, b = tape.parameter("a", 6), tape.parameter("b", 3)
    assert value(a, b) == 0
    assert tape.settled == ({"a", "b"} if decided else set())


def test_numbers_are_calculated_again():
    tape = NumberTape()
    a = tape.parameter("a", 4)
    result = tape.sqrt(a + 5) * 3 - 1 / (2 - a) + tape.sqrt(9)
    assert isinstance(result, ProgramNode)
    assert float(result.value) == 12.5
    assert evaluated(tape, {"a": 20})(result) == 3 * 5 + 1 / 18 + 3


@pytest.mark.parametrize(
    ("stiffness", "expected"),
    [(4 * np.pi**2, 2e-2), (400 * np.pi**2, 2e-3), (4e4 * np.pi**2, 2e-4), (4e10 * np.pi**2, 2e-5), (0, 2e-2)],
)
def test_the_advised_step_is_a_fiftieth_of_a_period(stiffness, expected):
    """1, 10, 100 Hz and 100 kHz, the last of which counts as 1 kHz; without any mode as 1 Hz."""
    parts = [tn.Inertia("i", node="a", inertia=1), tn.Spring("s", nodes=("a", "ground"), stiffness=stiffness)]
    assert suggested_step(tn.Drivetrain("x", parts[: 1 + bool(stiffness)])) == expected


def test_a_machine_on_its_curve_needs_an_operating_point():
    """Without load it is linear about no slip; an FMU does not take that for the point that is meant."""

    def machine(**more):
        own = {"synchronous_speed": "1500 rpm", "breakdown_torque": 1600, "breakdown_slip": 0.1}
        elements = [
            tn.InductionMachine("m", node="a", **own, **more),
            tn.Inertia("J", node="a", inertia=1),
            tn.Damper("c", nodes=("a", "ground"), damping=1),
        ]
        return tn.Drivetrain("rig", elements, inputs={"T": {"torque": "a"}}, sensors={"w": {"velocity": "a"}})

    with pytest.raises(UsageError, match="no-counterpart"):
        trace_system(machine())
    for meant in (machine(slip=0.02), machine().at(torque={"a": -50})):
        assert trace_system(meant)
