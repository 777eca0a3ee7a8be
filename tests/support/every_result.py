"""A result of every kind, small, from models that are calculated in no time; made when it is first asked for."""

from dataclasses import dataclass
from functools import cache

import numpy as np

import torsionnet as tn
from support.stepped_sines import steps
from torsionnet.base.units import RPM

PLANT = """torsionnet: 1
name: fan drive
parameters:
  c: {value: 20 kN*m*s/rad, bounds: [2 kN*m*s/rad, 200 kN*m*s/rad]}
  k: {value: 40 MN*m/rad}
elements:
  motor: {type: inertia, node: m, inertia: 500 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: k, damping: c}
  fan: {type: inertia, node: f, inertia: 2000 kg*m^2}
  frame: {type: spring, nodes: [f, ground], stiffness: 2 MN*m/rad, damping: 1 kN*m*s/rad}
speeds: {of: m, range: 300..900 rpm, step: 50 rpm, rated: 900 rpm}
excitations: {motor: {type: harmonic, node: m, orders: {3: {amplitude: 2 kN*m}, 6: {amplitude: 20 kN*m}}}}
inputs: {T: {torque: m}}
sensors: {T_s: {torque: shaft}, theta: {angle: m}}
limits: {shaft: {rule: curve, output: T_s, over_lambda: {0.2: 150 kN*m, 1.05: 90 kN*m}, source: letter of the maker}}
configurations: {soft: {k: 30 MN*m/rad}, stiff: {}}
"""
F = np.geomspace(1.0, 60.0, 80)


@cache
def plant():
    return tn.loads(PLANT).configured("stiff")


@cache
def ship():
    return tn.load("two_stroke_ship").configured("normal")


@cache
def response():
    return plant().frequency_response("theta", "T", F)


@cache
def estimate():
    """A response with a coherence, as of a record."""
    from dataclasses import replace

    return replace(response(), coherence=np.full(response().values.shape, 0.97), usable_up_to=30.0)


@cache
def orders():
    return plant().order_response(["T_s", "theta"])


@cache
def record():
    from torsionnet.signals import Recording, Signal

    t = np.arange(4000) / 500
    decay = np.exp(-t) * np.cos(60 * t)
    return Recording((Signal("T", "torque", decay), Signal("n", "velocity", 20 + 5 * t)), 500, title="run")


@cache
def tracked():
    from torsionnet.signals.orders.tracked_orders import TrackedOrders

    speeds, values = np.linspace(40, 90, 30), np.ones((2, 30)) * [[1.0], [0.5j]]
    return TrackedOrders(
        "T", "torque", np.array([0.5, 3]), np.arange(30.0), speeds, values, np.abs(values) / 20, reference="tooth 0",
        title="run",
    )  # fmt: skip


@cache
def study():
    """A study with an answer of each type, its variants, and the conclusions by name."""
    from torsionnet.study import define, run_study

    spread = {name: {"type": "normal", "deviation": "5 %"} for name in ("k", "c")}
    asked = {
        "f_1": {"type": "natural_frequency", "mode": 1},
        "twist": {"type": "response", "output": "theta", "input": "T", "at": "5 Hz"},
        "curve": {"type": "response", "output": "theta", "input": "T", "band": "1..50 Hz", "points": 12},
    }
    answers = {
        "limit_shares": {"type": "yield"},
        "study_tornado": {"type": "tornado"},
        "percentile_bands": {"type": "percentile_bands", "quantity": "curve"},
        "parallel_coordinates": {"type": "parallel_coordinates"},
        "scatter_matrix": {"type": "scatter", "quantities": ["twist"]},
        "sobol_indices": {"type": "sobol_indices", "quantities": ["twist"], "count": 64},
        "failure_probabilities": {
            "type": "failure_probability", "limits": ["twist"], "method": "subset", "count": 200,
        },
        "worst_variants": {"type": "worst_case", "quantity": "twist", "tried": 5},
    }  # fmt: skip
    asked_of = define(
        plant(), spread, asked, sampling={"count": 20}, answers=answers, limits={"twist": {"below": "0.1 deg/(N*m)"}}
    )
    result = run_study(asked_of)
    return asked_of, result, {name: one.conclude(asked_of, result) for name, one in asked_of.answers.items()}


@cache
def contour_map():
    from torsionnet.study.answers.map_and_scatter import MapResult, ParameterMap
    from torsionnet.study.quantities.quantity import QuantityLimit

    values = np.add.outer(np.arange(5.0), np.arange(4.0)) + 1
    maps = {case: ParameterMap(np.geomspace(10, 1000, 5), np.linspace(1, 2, 4), values) for case in ("a", "b")}
    unit = ("k_1", "N*m/rad"), ("c", ""), ("theta", "rad")
    return MapResult("map", *unit, "fixed", maps, QuantityLimit(below=3.0))


def _goals(*names):
    from torsionnet.study.design.design_goals import DesignGoals, DesignObjective

    return DesignGoals(objectives=tuple(DesignObjective((name,), "minimise") for name in names), limits={})


def _parabolas(values):
    x = values["x"]
    return {"a": x**2, "b": (x - 2) ** 2}


def _problem(*names):
    from torsionnet.machinery.design.damper_optimum import DesignParameter
    from torsionnet.study.design.design_problem import DesignProblem

    return DesignProblem((DesignParameter("x", "", 3.5, -1.0, 4.0, 3.5),), _goals(*names), _parabolas)


@cache
def design_optimum():
    from torsionnet.study.design.optimise import optimise

    return optimise(_problem("a"), generations=3, title="parabola")


@cache
def pareto_front():
    from torsionnet.study.design.pareto import pareto_front as front

    return front(_problem("a", "b"), population=12, generations=3, title="parabolas")


@dataclass(frozen=True)
class Uniform:
    """Uniform scatter of x around its design, 0.1 to either side."""

    shares: np.ndarray | None = None

    def even_draws(self, count, _seed):
        return Uniform((np.arange(count) + 0.5) / count)

    random_draws = even_draws

    @property
    def count(self):
        return len(self.shares)

    def around(self, designs):
        values = np.repeat(designs["x"], self.count)
        return {"x": values + np.tile(0.1 * (2 * self.shares - 1), len(designs["x"]))}


@cache
def robust_optimum():
    from torsionnet.study.design.robust_optimum import robust_optimum as best
    from torsionnet.study.design.robust_problem import MeanAndDeviation

    return best(_problem("a"), Uniform(), MeanAndDeviation(1.0), samples=16, compared=16, title="parabola")


@cache
def damper_over_conditions():
    from torsionnet.study.design.best_damper import damper_over_conditions as best

    return best(plant(), "theta", {"c": (2e3, 2e5)}, ["soft", "stiff"], input="T", band=(2.0, 60.0))


@cache
def damper_design():
    return plant().damper_design("T_s", "c")


@cache
def fit():
    measured = tn.Measurement(estimate(), "theta", "T")
    return tn.identify(plant(), measured, ["c"])


@cache
def modes():
    return plant().modes()


@cache
def limits():
    return plant().check_limits()


@cache
def criticals():
    return ship().critical_speeds()


@cache
def stars():
    return [one.star for one in criticals().crossings if one.star is not None]


@cache
def passage():
    return plant().passage_response("T_s", [0.0, 2.0], [40.0, 90.0])


@cache
def periodic():
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=0.1, damping=0.05)
    rig = tn.Drivetrain("cubic", [tn.Inertia("mass", node="a", inertia=1), spring])
    return rig.periodic_response("a", frequencies=[0.19, 0.2], excitation={"a": 0.1}, harmonics=3)


@cache
def periodic_orders():
    spring = tn.Spring("spring", nodes=("a", "b"), stiffness=1e4, cubic=1e6, damping=20)
    fan = {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}
    rig = tn.Drivetrain(
        "fan", [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1), spring],
        speeds={"of": "a", "list": ["500 rpm", "600 rpm"], "nonlinear": "periodic"}, excitations={"blades": fan},
    )  # fmt: skip
    return rig.order_response("twist(spring)")


@cache
def stabilisation():
    return tn.modal.stabilisation(response())


@cache
def margins():
    governor = tn.Controller("governor", sense={"velocity": "a"}, act="a", law=-30, delay="50 ms")
    return tn.Drivetrain("governed", [tn.Inertia("rotor", node="a", inertia=2), governor]).loop_margins()


@cache
def harmonics():
    from torsionnet.signals import Recording, Signal
    from torsionnet.signals.order_tracking import sweep_harmonics

    t = np.arange(8000) / 500
    sweep = Recording((Signal("T", "torque", np.cos(2 * np.pi * (5 * t + t**2 / 4))),), 500)
    return sweep_harmonics(sweep, "T", 5 + t / 2, (1, 2))


@cache
def wheel():
    from support.wheel_tests import record, teeth
    from torsionnet.signals import Wheel, calibrate_wheel

    return calibrate_wheel([record(teeth(), speed) for speed in (60.0, 90.0)], Wheel(teeth=24))


@cache
def rotation():
    from torsionnet.signals import Wheel, wheel_rotation
    from torsionnet.signals.rotation.pulse_channel import PulseChannel

    pulses = PulseChannel("n1", np.round(np.arange(6000) / 601.3, 6), tick=1e-6)
    return wheel_rotation(pulses, Wheel(teeth=60))


@cache
def torque_loops():
    from support.loop_records import stage_record

    return tn.signals.loops(stage_record(1), "T", "gamma")


def _speed():
    return 2 * np.pi * (20 + np.arange(4000) / 500)


PLOTS = {
    "bode": lambda: (response(),),
    "circle": lambda: (tn.modal.circle_fit(fine(), near=natural()),),
    "coherence": lambda: (estimate(),),
    "comparison": lambda: (estimate(), response()),
    "contour_map": lambda: (contour_map(),),
    "correlation": lambda: (fit(),),
    "damper_design": lambda: (damper_design(),),
    "damper_over_conditions": lambda: (damper_over_conditions(),),
    "design_optimum": lambda: (design_optimum(),),
    "fit": lambda: (fit(),),
    "half_ranges": lambda: ([orders(), orders()], "T_s"),
    "interference_diagram": lambda: (criticals(),),
    "limit_check": lambda: (limits(),),
    "limit_families": lambda: ([limits()],),
    "mac_matrix": lambda: ([[1, 0.1], [0.05, 0.98]],),
    "mode_shapes": lambda: (modes(), plant()),
    "nyquist": lambda: (margins(),),
    "operational_modes": lambda: (tn.modal.modes_from_decay(record(), "T", start=0),),
    "order_map": lambda: (order_map(),),
    "order_overlay": lambda: (orders(), {"T_s": measured_orders()}),
    "order_response": lambda: (orders(),),
    "pareto_front": lambda: (pareto_front(),),
    "passage_response": lambda: (passage(),),
    "periodic_response": lambda: (periodic(),),
    "robust_optimum": lambda: (robust_optimum(),),
    "scenario_motion": lambda: (record(),),
    "schematic": lambda: (plant(),),
    "spectrogram": lambda: (tn.signals.spectrogram(record(), "T"),),
    "stabilisation": lambda: (stabilisation(),),
    "star_diagrams": lambda: (stars(),),
    "stepped_stiffness": lambda: (steps(np.array([5.0, 6.0]), np.array([0.1, 0.2 + 0.01j]), np.array([40.0, 60.0])),),
    "sweep_harmonics": lambda: (harmonics(),),
    "time_histories": lambda: (record(),),
    "torque_loops": lambda: (torque_loops(),),
    "tornado": lambda: (tn.sensitivity.mode_sensitivities(plant()),),
    "tracked_orders": lambda: (tracked(),),
    "waterfall": lambda: (orders(), "T_s"),
    "waveform": lambda: (orders(), "T_s"),
    "wheel_pattern": lambda: (wheel(),),
    "wheel_rotations": lambda: ([rotation()],),
    **{
        name: lambda name=name: (study()[2][name],)
        for name in (
            "limit_shares", "study_tornado", "percentile_bands", "parallel_coordinates", "scatter_matrix",
            "sobol_indices", "failure_probabilities", "worst_variants",
        )
    },
}  # fmt: skip
"""What each function of ``torsionnet.plot`` draws here."""
NEEDED = {"waveform": {"speed": 600.0 / RPM}}
"""Keywords that some of them need."""


def order_map():
    from torsionnet.signals.order_tracking import order_map as calculated

    return calculated(record(), "T", _speed(), highest_order=3)


def fine():
    return plant().frequency_response("theta", "T", np.linspace(0.8, 1.2, 120) * natural())


def natural():
    return modes().natural_frequencies[0]


def measured_orders():
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder

    return [MeasuredOrder(6, np.array([40.0, 60.0]), np.array([2e4, 3e4]))]


@cache
def choice():
    from torsionnet.identification import Candidate, choose_model

    return choose_model({"c": Candidate(plant(), ["c"])}, tn.Measurement(estimate(), "theta", "T"))


@cache
def fit_of_a_file():
    from dataclasses import fields

    from torsionnet.identification.fit_result import FitResult

    return FitResult(**{one.name: getattr(fit(), one.name) for one in fields(FitResult) if one.name != "problem"})


def ranking():
    from torsionnet.identification.ranking import RankedCause, Ranking

    return Ranking((RankedCause("gain", "theta", "gain(theta)", None, 0.8, 0.5, 0.1, explains=True),), 3.0)


@cache
def misfiring():
    """The orders of a generating set with each cylinder out in turn, and the check of its limits."""
    from dataclasses import fields

    from torsionnet.machinery.verdicts.limit_conclusion import ConcludedCheck, LimitConclusion

    out = tn.load("engine_generator_set").configured("misfire")
    check = limits()
    shown = {one.name: getattr(check, one.name) for one in fields(check)}
    return out.order_response(next(iter(out.sensors))), ConcludedCheck(**shown, overall=LimitConclusion((check,)))


@cache
def vector_sums():
    from torsionnet.machinery.orders.vector_sums import vector_sums as sums

    return sums(ship(), "engine", modes=[1, 2])


def results():
    """A result of every class that JSON files keep."""
    decay = tn.modal.modes_from_decay(record(), "T", start=0)
    estimated = tn.modal.identify_modes(response())
    yield from (
        response(),
        estimate(),
        modes(),
        fit(),
        fit_of_a_file(),
        choice(),
        ranking(),
        orders(),
        tracked(),
        torque_loops(),
        steps(np.array([3.0, 7.0]), np.array([0.02, 0.02 - 0.001j]), np.array([4.0, 5.0])),
        wheel(),
    )
    yield from (
        stars()[0],
        vector_sums(),
        criticals(),
        limits(),
        margins(),
        passage(),
        periodic(),
        periodic_orders(),
        stabilisation(),
        decay,
        estimated,
    )
    yield from (tn.modal.match(estimated, modes()), tn.sensitivity.mode_sensitivities(plant()), *misfiring())
    yield from (
        ship().holzer_table(1),
        ship().mass_elastic_table(),
        ship().static_state(),
        ship().mean_response("T_tail"),
    )
    yield from (plant().dissipated_power(["shaft"]), damper_design(), damper_over_conditions(), contour_map())
    yield from (design_optimum(), pareto_front(), robust_optimum(), *study()[2].values())
