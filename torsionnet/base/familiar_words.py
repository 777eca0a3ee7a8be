"""Words that users of other programs try first, and what stands for them here.

Model files, Python names and methods have a table each. A word is added where somebody tried it; the misspelt name of
something that exists needs no row, since :func:`torsionnet.base.errors.nearest` finds it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

ELEMENT_TYPES: Mapping[str, str] = {
    "backlash": "clearance",
    "bearing": "damper",
    "cardan_shaft": "shaft",
    "coupling": "flexible_coupling",
    "cylinder": "inertia",
    "crank": "crank_throw",
    "crankshaft": "crank_throw",
    "clamp": "lock",
    "coulomb": "friction",
    "coulomb_friction": "friction",
    "dashpot": "damper",
    "dead_zone": "clearance",
    "deadband": "clearance",
    "disc": "inertia",
    "disk": "inertia",
    "disk_element": "inertia",
    "disc_friction_clutch": "clutch",
    "dmf": "dual_mass_flywheel",
    "dry_friction": "friction",
    "duffing": "spring",
    "elasto_backlash": "clearance",
    "fixed": "lock",
    "flywheel": "inertia",
    "gear_element": "gear",
    "gear_pair": "gear",
    "free_play": "clearance",
    "flexible_shaft": "shaft",
    "gap": "clearance",
    "generator": "synchronous_machine",
    "hard_stop": "clearance",
    "ideal_gear": "gear",
    "intermediate_shaft": "shaft",
    "jenkins": "friction",
    "lash": "clearance",
    "mass": "inertia",
    "motor": "induction_machine",
    "nonlinear_spring": "spring",
    "planetary_gear": "planetary",
    "play": "clearance",
    "propeller_shaft": "shaft",
    "rigid": "rigid_coupling",
    "rigid_connection": "rigid_coupling",
    "rotational_damper": "damper",
    "rotational_friction": "friction",
    "rotational_hard_stop": "clearance",
    "rotational_spring": "spring",
    "rotor": "inertia",
    "screw": "propeller",
    "stop": "clearance",
    "shaft_element": "shaft",
    "tire": "tyre",
    "simple_gear": "gear",
    "timing_belt": "belt",
    "torsional_damper": "tuned_damper",
    "torsional_spring": "spring",
    "wheel": "inertia",
}
"""Element type by a word that other programs have for it."""

SECTIONS: Mapping[str, str] = {
    **dict.fromkeys(("ideal_torque_source", "torque_source"), "a torque is an input, inputs: {T: {torque: node}}"),
    **dict.fromkeys(("motion_sensor", "sensor", "speed_sensor", "torque_sensor"), "see the section sensors:"),
    **dict.fromkeys(("diesel_engine", "engine"), "an engine excites, excitations: {gas: {type: reciprocating_engine}}"),
}
"""Section to write instead, by the element that other programs have for it."""

KEYS: Mapping[str, tuple[str, ...]] = {
    "G": ("shear_modulus",),
    "I": ("inertia",),
    "J": ("inertia",),
    "L": ("length",),
    "backlash": ("gap",),
    "breakaway": ("stick",),
    "breakaway_torque": ("stick",),
    "c": ("damping",),
    "coulomb_torque": ("torque",),
    "d": ("outer_diameter",),
    "diameter": ("outer_diameter",),
    "do": ("outer_diameter",),
    "ido": ("inner_diameter",),
    "idl": ("inner_diameter",),
    "id": ("inner_diameter",),
    "excitation": ("driven_by",),
    "free_angle": ("backlash", "gap"),
    "free_play": ("backlash", "gap"),
    "gap": ("backlash",),
    "k": ("stiffness",),
    "k3": ("cubic",),
    "k_3": ("cubic",),
    "l": ("length",),
    "lash": ("backlash", "gap"),
    "moment_of_inertia": ("inertia",),
    "inertia": ("ring_inertia",),
    "nodes": ("node",),
    "node": ("nodes",),
    "od": ("outer_diameter",),
    "odl": ("outer_diameter",),
    "play": ("backlash", "gap"),
    "rho": ("density",),
    "ring": ("ring_inertia",),
    "static_torque": ("stick",),
    "stick_torque": ("stick",),
    "teeth_ratio": ("ratio",),
}
"""Entries by words of other programs, the first that the section has; keys are as written, capitals included."""

ADVICE: Mapping[str, tuple[str, str]] = {
    "node": ("nodes", "write nodes: [first, second], to the ground nodes: [first, ground]"),
    "material": ("shear_modulus", "leave it out for steel; for another material give shear_modulus and density"),
    "E": ("shear_modulus", "torsion takes the shear modulus: give shear_modulus, E/(2 (1 + nu))"),
    "youngs_modulus": ("shear_modulus", "torsion takes the shear modulus: give shear_modulus, E/(2 (1 + nu))"),
    "nu": ("shear_modulus", "torsion takes the shear modulus: give shear_modulus, E/(2 (1 + nu))"),
    "mass": ("inertia", "an inertia is given in kg*m^2; that of a solid disc is m d^2/8"),
    "zeta": ("damping", "write damping: {zeta: 2 %, at: 12 Hz}, with the frequency where it holds"),
    "damping_ratio": ("damping", "write damping: {zeta: 2 %, at: 12 Hz}, with the frequency where it holds"),
    "backlash": (
        "stages",
        "a gap is an element of its own, type: clearance with gap and stiffness; teeth have a backlash",
    ),
    "gap": ("stages", "a gap is an element of its own, type: clearance with gap and stiffness; teeth have a backlash"),
    "stiffness": (
        "outer_diameter",
        "a shaft of known stiffness is a spring: write type: spring; a shaft has outer_diameter and length",
    ),
    "coefficient": (
        "stick",
        "dry friction is given by the torque at which it slips; a clutch has rows of a coefficient",
    ),
    "mu": ("stick", "dry friction is given by the torque at which it slips; a clutch has rows of a coefficient"),
    "damping": ("elements", "damping belongs to the elements: write damping: {zeta: 2 %, at: 12 Hz} in the springs"),
    "modal_damping": (
        "elements",
        "damping belongs to the elements: write damping: {zeta: 2 %, at: 12 Hz} in the springs",
    ),
    "loss_factor": (
        "damping",
        "take type: hysteretic_spring, which has a loss factor, or give damping: {zeta: ..., at: ...}",
    ),
}
"""Entry that the section must have, and what to write there, by a key that it has not."""


def _class_name(kind: str) -> str:
    return "".join(map(str.capitalize, kind.split("_")))


PYTHON: Mapping[str, Mapping[str, str]] = {
    "torsionnet": {
        **{_class_name(word): f"tn.{_class_name(kind)}" for word, kind in ELEMENT_TYPES.items()},
        "Assembly": "tn.Drivetrain(name, elements)",
        "Coupling": "tn.FlexibleCoupling or tn.RigidCoupling",
        "Disc": "tn.Inertia(name, node, inertia)",
        "Disk": "tn.Inertia(name, node, inertia)",
        "DiskElement": "tn.Inertia(name, node, inertia)",
        "Engine": 'excitations={"engine": {"type": "reciprocating_engine", ...}} of tn.Drivetrain',
        "Flywheel": "tn.Inertia(name, node, inertia)",
        "GearElement": "tn.Gear(name, nodes, ratio)",
        "Mass": "tn.Inertia(name, node, inertia)",
        "Material": "shear_modulus= and density= of tn.Shaft; their defaults are those of steel",
        "Model": "tn.Drivetrain(name, elements), or tn.load(path) for a file",
        "Network": "tn.Drivetrain(name, elements)",
        "Rotor": "tn.Drivetrain(name, elements)",
        "ShaftElement": "tn.Shaft(name, nodes, outer_diameter=, length=)",
        "System": "tn.Drivetrain(name, elements)",
        "bode": "tn.plot.bode(response)",
        "Sensor": 'sensors={"theta": {"angle": node}} of tn.Drivetrain',
        "Torque": 'inputs={"T": {"torque": node}} of tn.Drivetrain',
        "eig": "tn.Drivetrain.modes()",
        "fit": "tn.identify(model, measurements, unknowns), or tn.plot.fit for its picture",
        "frf": "tn.Drivetrain.frequency_response(output, input, frequencies)",
        "from_file": "tn.load(path)",
        "load_model": "tn.load(path)",
        "modes": "tn.Drivetrain.modes()",
        "open": "tn.load(path)",
        "read": "tn.load(path) for models, tn.signals.read_recording(path) for records",
        "read_model": "tn.load(path)",
        "read_yaml": "tn.load(path)",
        "run_study": "tn.study.run_study(study)",
        "read_csv": "tn.signals.read_recording(path)",
        "pwelch": "tn.signals.estimate(record, output, input)",
        "ss": "tn.Drivetrain.to_control(output, input)",
        "tf": "tn.Drivetrain.frequency_response, or to_control(output, input)",
        "ode45": "tn.Drivetrain.simulate(output, input, sampling_rate)",
        "lsim": "tn.Drivetrain.simulate(output, input, sampling_rate)",
        "simulate": "tn.Drivetrain.simulate(output, input, sampling_rate)",
    },
    "torsionnet.report": {"bode": "plot.bode(response)"},
    "torsionnet.plot": {
        "campbell": "plot.interference_diagram(critical_speeds)",
        "campbell_diagram": "plot.interference_diagram(critical_speeds)",
        "frequency_response": "plot.bode(response)",
        "frf": "plot.bode(response)",
        "modes": "plot.mode_shapes(modes)",
        "mode_shape": "plot.mode_shapes(modes)",
        "model": "plot.schematic(model)",
        "orders": "plot.order_response(result)",
        "response": "plot.bode(response)",
        "shapes": "plot.mode_shapes(modes)",
        "time_series": "plot.time_histories(record)",
    },
    "torsionnet.signals": {
        "Record": "signals.Recording(signals, sampling_rate)",
        "coherence": "signals.estimate(...).coherence",
        "csd": "signals.estimate(record, output, input).coherence",
        "frf": "signals.estimate(record, output, input)",
        "read": "signals.read_recording(path)",
        "read_csv": "signals.read_recording(path)",
        "tfestimate": "signals.estimate(record, output, input)",
        "welch": "signals.estimate(record, output, input, settings=signals.Welch(...))",
    },
    "torsionnet.io": {
        "read": "tn.load(path) for models, io.read_recording(path) for records",
        "write": "model.to_yaml(path) for models, io.write_recording(record, path) for records",
    },
}
"""Python code by a name that a package has not, and by the package."""

_MATRICES = "model.matrices(), which has M, C and K in numbers, or model.symbolic() for formulas"
_DAMPING = 'damping={"zeta": "2 %", "at": "12 Hz"} of its springs, to which damping belongs'
_RECORD = "io.write_recording(record, path)"
METHODS: Mapping[str, Mapping[str, str]] = {
    "Drivetrain": {
        "C": _MATRICES,
        "K": _MATRICES,
        "M": _MATRICES,
        "T": _MATRICES,
        "bode": "plot.bode(model.frequency_response(output, input, frequencies))",
        "campbell": "model.critical_speeds(), and plot.interference_diagram for its picture",
        "damping": _DAMPING,
        "damping_ratio": _DAMPING,
        "damping_ratios": "model.modes().damping_ratios",
        **dict.fromkeys(("damp", "eigenfrequency", "pole", "poles", "pzmap"), "model.modes()"),
        **dict.fromkeys(("bodeplot", "freqresp", "tf"), "model.frequency_response(output, input, frequencies)"),
        "campbell_diagram": "model.critical_speeds(), and plot.interference_diagram for its picture",
        "impulse": "model.simulate(output, input, sampling_rate), whose input is a row of zeros after a first number",
        "inertia_matrix": _MATRICES,
        "nyquist": "model.loop_margins(), and plot.nyquist for its picture",
        "sim": "model.simulate(output, input, sampling_rate)",
        "eig": "model.modes()",
        "eigenfrequencies": "model.modes().natural_frequencies",
        "eigenvalues": "model.modes().eigenvalues",
        "frf": "model.frequency_response(output, input, frequencies)",
        "holzer": "model.holzer_table()",
        "limits": "model.check_limits()",
        "linearise": "model.at(torque={...}), whose results are linear about that operating point",
        "linearize": "model.at(torque={...}), whose results are linear about that operating point",
        "lsim": "model.simulate(output, input, sampling_rate)",
        "modal": "model.modes()",
        "modal_damping": _DAMPING,
        "mass_matrix": _MATRICES,
        "mode_shapes": "model.modes().shapes",
        "natural_frequencies": "model.modes().natural_frequencies",
        "orders": "model.order_response(output)",
        "plot": "plot.schematic(model)",
        "response": "model.frequency_response(output, input, frequencies)",
        "run": "the method for what you want: modes(), frequency_response(), order_response(), simulate()",
        "run_freq_response": "model.frequency_response(output, input, frequencies)",
        "run_modal": "model.modes()",
        "save": "model.to_yaml(path)",
        "sensitivity": "tn.sensitivity.mode_sensitivities(model)",
        "show": "torsionnet show FILE on the command line, or plot.schematic(model)",
        "solve": "the method for what you want: modes(), frequency_response(), order_response(), simulate()",
        "solve_ivp": "model.simulate(output, input, sampling_rate)",
        "ss": "model.to_control(output, input)",
        "state_space": "model.to_control(output, input)",
        "stiffness_matrix": _MATRICES,
        "step": "model.simulate(output, input, sampling_rate), whose input is a row of ones",
        "to_file": "model.to_yaml(path)",
        "to_networkx": "model.graph()",
        "zeta": _DAMPING,
        "transfer_function": "model.frequency_response for numbers, model.symbolic().transfer_function for a formula",
    },
    "Modes": {
        "damping": "modes.damping_ratios",
        "eigenvectors": "modes.shapes",
        "frequencies": "modes.natural_frequencies",
        **dict.fromkeys(("freq", "f0", "fn"), "modes.natural_frequencies"),
        **dict.fromkeys(("mode_shape", "vectors"), "modes.shapes"),
        "eigenvalue": "modes.eigenvalues",
        "mode_shapes": "modes.shapes",
        "omega": "2 * np.pi * modes.natural_frequencies",
        "plot": "plot.mode_shapes(modes)",
        "poles": "modes.eigenvalues",
        "wn": "2 * np.pi * modes.natural_frequencies",
        "zeta": "modes.damping_ratios",
    },
    "FrequencyResponse": {
        "H": "response.values",
        "bode": "plot.bode(response)",
        **dict.fromkeys(("abs", "amplitude", "mag"), "response.magnitude"),
        **dict.fromkeys(("omega", "w"), "2 * np.pi * response.frequencies"),
        "freq": "response.frequencies",
        "real": "response.values",
        "f": "response.frequencies",
        "to_xarray": "response.to_dataframe().to_xarray()",
        "plot": "plot.bode(response)",
    },
    "Recording": {"save": _RECORD, "to_json": _RECORD},
    "StudyResult": {"to_json": "tn.study.run_study(study, folder), which keeps all in the folder"},
    "TransferFunction": dict.fromkeys(
        ("den", "expr", "expand", "factor", "num", "poles", "simplify", "zeros"),
        "numerator and denominator, or sympify of sympy",
    ),
}
"""Python code by an attribute that objects of a class have not, and by the class."""


def familiar_key(key: str, known: Iterable[str]) -> tuple[str, str]:
    """Entry meant by a key of another program, and advice what to write instead, empty where there is none.

    >>> familiar_key("k", ["nodes", "stiffness"])
    ('stiffness', '')
    >>> familiar_key("material", ["shear_modulus"])[1]
    'leave it out for steel; for another material give shear_modulus and density'
    >>> familiar_key("material", ["stiffness"])
    ('', '')
    """
    there = {*known}
    needed, advice = ADVICE.get(key, ("", ""))
    if needed in there:
        return needed if needed in KEYS.get(key, ()) else "", advice
    return next((entry for entry in KEYS.get(key, ()) if entry in there), ""), ""
