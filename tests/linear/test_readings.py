"""What every kind of sensor reads, in numbers, in symbols and with derivatives, each against Lagrange's equations."""

import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from support import campaigns
from support.models import EVERY_ELEMENT
from support.random_drivetrains import draw

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.base.registers import Groups
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Constraint, Values

F = np.array([0.37, 5.3])
STEP = Fraction(1, 10**20)


def every_sensor(drivetrain):
    for node in drivetrain.nodes:
        yield from (Sensor(quantity, node) for quantity in ("angle", "velocity", "acceleration"))
    for name, element in drivetrain.elements.items():
        yield Sensor("twist", name)
        yield Sensor("torque", name)
        yield from (Sensor("torque", name, at=port) for port, node in element.ports.items() if node != GROUND)


def number(value):
    fraction = Fraction(value)
    return mpmath.mpf(fraction.numerator) / fraction.denominator


class Lagrange:
    """All angles and multipliers of a drivetrain under a unit torque on a node, in 60 digits."""

    def __init__(self, drivetrain, driven, s, **changed):
        self.drivetrain, self.s = drivetrain, s
        self.value = Values(drivetrain.exact_values | changed)
        owned = [(name, part) for name, element in drivetrain.elements.items() for part in element.parts(self.value)]
        self.place = {node: place for place, node in enumerate(drivetrain.nodes)}
        rigid = [pair for pair in owned if isinstance(pair[1], Constraint)]
        n = len(self.place)
        matrix = mpmath.zeros(n + len(rigid))
        for _, law in owned:
            for i, a in () if isinstance(law, Constraint) else law.row.items():
                for j, b in law.row.items():
                    matrix[self.place[i], self.place[j]] += number(a) * number(b) * self.kappa(law)
        for column, (_, constraint) in enumerate(rigid, n):
            for node, a in constraint.row.items():
                matrix[self.place[node], column] = matrix[column, self.place[node]] = number(a)
        load = mpmath.zeros(n + len(rigid), 1)
        load[self.place[driven]] = 1
        self.solved = mpmath.lu_solve(matrix, load)
        self.torques = [
            (name, part.row, self.solved[n + rigid.index((name, part))])
            if isinstance(part, Constraint)
            else (name, part.row, self.kappa(part) * self.motion(part.row))
            for name, part in owned
        ]

    def kappa(self, law):
        J, c, k, eta = (number(size) for size in (law.inertia, law.damping, law.stiffness, law.loss_factor))
        return J * self.s**2 + c * self.s + k * (1 + 1j * eta)

    def motion(self, row):
        return mpmath.fsum(number(a) * self.solved[self.place[node]] for node, a in row.items())

    def reading(self, sensor):
        if not sensor.is_on_element:
            return self.motion({sensor.of: 1}) * self.s ** ["angle", "velocity", "acceleration"].index(sensor.quantity)
        element = self.drivetrain.elements[sensor.of]
        if sensor.quantity == "twist":
            return self.motion(element.twist(self.value))
        ports = list(element.ports.items())
        place = 0 if sensor.at is None else [port for port, _ in ports].index(sensor.at)
        if ports[place][1] == GROUND:
            place = 1 - place
        node, sign = ports[place][1], 1 if place == 0 else -1
        return sign * mpmath.fsum(
            number(row[node]) * torque for name, row, torque in self.torques if name == element.name and node in row
        )


def close(found, expected, size):
    """To 1e-9 of the value, or to rounding of the largest reading of its kind where next to nothing is left."""
    return abs(complex(found) - complex(expected)) <= 1e-9 * abs(expected) + 1e-13 * size


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(campaigns.examples(5, 20)))
def test_numbers_symbols_and_derivatives_read_the_same(seed):
    drivetrain, made = draw(random.Random(seed), loops=seed % 2, planetary=seed % 4 == 1, count=3)
    name, driven = random.Random(seed).choice(sorted(made.parameters)), f"n{seed % 3}"
    sensors = list(every_sensor(drivetrain))
    system = drivetrain.symbolic()
    response = parametric_response(drivetrain, sensors, driven, F, [name])
    numbers, derived = drivetrain.frequency_response(sensors, driven, F).values, response.evaluation(response.start)
    with mpmath.workdps(60):
        value = drivetrain.exact_values[name]
        for point, f in enumerate(F):
            s = 2j * mpmath.pi * mpmath.mpf(f)
            rig, up, down = (Lagrange(drivetrain, driven, s, **{name: value + step}) for step in (0, STEP, -STEP))
            for place, sensor in enumerate(sensors):
                expected, size = rig.reading(sensor), max(abs(rig.reading(one)) for one in sensors)
                slope = (up.reading(sensor) - down.reading(sensor)) / (2 * number(STEP))
                H = system.transfer_function(sensor, driven)
                assert close(numbers[point, place, 0], expected, size), (sensor, f)
                assert close(H.evaluate([f]).values[0, 0, 0], expected, size), (sensor, f)
                assert close(derived.values[point, place, 0], expected, size), (sensor, f)
                assert close(derived.jacobian[point, place, 0, 0], slope, size / abs(number(value))), (sensor, f)


@pytest.mark.parametrize("name", ["motor", "T_M"])
def test_what_is_no_sensor_cannot_be_measured(name):
    """Derivatives of poles against a node or an input: refused in the words of the poles themselves."""
    for asked in (mode_sensitivities, modes):
        with pytest.raises(UsageError, match="unknown-channel"):
            asked(tn.load("dmf_rig"), measured_input=name)


@pytest.mark.parametrize("seed", range(20))
def test_groups_are_the_connected_parts_of_the_graph(seed):
    import networkx as nx

    source, graph, joined = random.Random(seed), nx.Graph(), Groups(range(12))
    graph.add_nodes_from(range(12))
    for _ in range(source.randint(0, 12)):
        first, second = source.sample(range(12), 2)
        assert joined.join(first, second) == (not nx.has_path(graph, first, second))
        graph.add_edge(first, second)
    assert sorted(map(sorted, joined.groups())) == sorted(map(sorted, nx.connected_components(graph)))


GEARED = ("mass_elastic", "gear", "planetary", "differential", "belt", "gearbox", "final_drive", "chain_drive")


@pytest.mark.parametrize("kind", [kind for kind in EVERY_ELEMENT if kind not in GEARED])
def test_twist_is_what_the_page_on_signs_says(kind):
    """Of two nodes their difference; of one that of its ring or pendulum, or else its angle."""
    element = EVERY_ELEMENT[kind]
    nodes = [node for node in element.ports.values() if node != "ground"]
    first = nodes[0]
    others = element.internal_nodes if len(nodes) == 1 else nodes[1:]
    assert element.twist(Values({})) == {first: 1, **({others[0]: -1} if others else {})}
