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
    "rotational_inertia": "inertia",
    "rotary_inertia": "inertia",
    "rotary_load": "inertia",
    "inertia_load": "inertia",
    "lumped_mass": "inertia",
    "pulley": "inertia",
    "rotary_spring": "spring",
    "torsion_spring": "spring",
    "torsion_bar": "spring",
    "rotary_damper": "damper",
    "worm_gear": "gear",
    "gear_mesh": "gear",
    "transformer": "gear",
    "belt_pulley": "belt",
    "belt_drive": "belt",
    "chain": "chain_drive",
    "sun_planet": "planetary",
    "ring_planet": "planetary",
    "vehicle_body": "vehicle",
    "variable_ratio_transmission": "gearbox",
    "synchronous_motor": "synchronous_machine",
    "hydrodynamic_coupling": "fluid_coupling",
    "mechanical_rotational_reference": "lock",
    "reference": "lock",
    "loaded_contact_friction": "friction",
    "disk_brake": "friction",
    "brake": "friction",
    "band_brake": "friction",
    "cone_clutch": "clutch",
    "dog_clutch": "clutch",
    "synchronizer": "clutch",
    "hysteresis": "hysteretic_spring",
    "viscous_torsional_damper": "viscous_damper",
}
"""Element type by a word that other programs have for it."""

SECTIONS: Mapping[str, str] = {
    **dict.fromkeys(("ideal_torque_source", "torque_source"), "a torque is an input, inputs: {T: {torque: node}}"),
    **dict.fromkeys(("motion_sensor", "sensor", "speed_sensor", "torque_sensor"), "see the section sensors:"),
    **dict.fromkeys(
        ("diesel_engine", "engine", "generic_engine", "piston_engine"),
        "an engine excites, excitations: {gas: {type: reciprocating_engine}}",
    ),
    **dict.fromkeys(
        ("angular_velocity_source", "ideal_angular_velocity_source"),
        "a motion is an input, inputs: {phi: {angle: node}}",
    ),
    **dict.fromkeys(
        ("cv_joint", "hookes_joint", "universal_joint"),
        "a joint excites at order 2, excitations: {joint: {type: universal_joint}}",
    ),
    **dict.fromkeys(
        ("freewheel", "one_way_clutch", "overrunning_clutch", "unidirectional_clutch"),
        "a freewheel is a coupling that a configuration switches off",
    ),
    **dict.fromkeys(("dc_motor", "electric_motor", "servomotor"), "a motor is an inertia; its control a controller"),
    **dict.fromkeys(("free_end", "rotational_free_end"), "an end to which nothing is attached is free"),
    "ground": "ground is a node of every model, nodes: [a, ground]",
    "scope": "what is read is a sensor, sensors: {theta: {angle: node}}",
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
    "units": ("elements", "a number has its unit with it, as stiffness: 10 kN*m/rad"),
    **dict.fromkeys(
        ("components", "bodies", "masses", "inertias", "springs", "shafts", "gears", "joints"),
        ("elements", "all of them are elements:, as elements: {disc: {type: inertia, node: a, inertia: 2 kg*m^2}}"),
    ),
    "materials": ("elements", "leave it out for steel; a shaft of another material has shear_modulus and density"),
    "connections": ("elements", "elements that name the same node are connected, as nodes: [a, b] and node: b"),
    "dofs": ("elements", "nodes exist by being named in elements; kinematics tells their degrees of freedom"),
    "boundary_conditions": ("elements", "write ground as a node, nodes: [a, ground], or an element type: lock"),
    **dict.fromkeys(("output", "outputs"), ("elements", "what is read is a sensor, sensors: {theta: {angle: node}}")),
    **dict.fromkeys(
        ("torque", "loads"), ("elements", "a torque is an input, inputs: {T: {torque: node}}; a mean one a load:")
    ),
    **dict.fromkeys(("rpm", "speed"), ("elements", "write speeds: {of: node, range: 600..4000 rpm}")),
    **dict.fromkeys(
        ("frequency", "frequencies", "solver", "simulation"),
        ("elements", "a model says nothing of calculations; give it where they are asked, as torsionnet frf --from 1"),
    ),
    **dict.fromkeys(
        ("M", "C", "K"), ("elements", "matrices are an element, type: lumped_matrices, or tn.Drivetrain.from_matrices")
    ),
    "engine": ("elements", "an engine excites, excitations: {gas: {type: reciprocating_engine}}"),
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

_SAMPLES = 'record["T"].values'
_RECORD = "io.write_recording(record, path)"
_STATES = "model.to_control(output, input)"
_FILTERED = f"scipy.signal.sosfiltfilt(sos, {_SAMPLES}), whose result makes a signals.Signal"
_ORDERS = "signals.track_orders(record, rotation, orders=[2, 4])"
_IDENTIFIED = "modal.identify_modes(response)"
_FITTED = "tn.identify(model, measurements, unknowns)"
_STUDY = "tn.study.run_study(study), of a file with variations and answers"
_IMPORTED = "tn.load(path) for models, tn.signals.read_recording(path) for records"
_LINEAR = "model.at(torque={...}), whose results are linear about that operating point"
_REDUCED = "model.modes(lowest=6) for the lowest modes; a model is not reduced, large ones are solved sparse"
_FATIGUE = "model.check_limits(), of stresses under limits: of the model"
ANYWHERE: Mapping[str, str] = {
    **dict.fromkeys(("c2d", "sample_system"), f"control.sample_system({_STATES}, 1e-3)"),
    "d2c": f"{_STATES}, which is continuous",
    **dict.fromkeys(("fft", "rfft"), f"signals.spectrogram(record, name), or np.fft.rfft({_SAMPLES})"),
    **dict.fromkeys(("ifft", "irfft"), "np.fft.irfft of a spectrum, and model.simulate(output, input, sampling_rate)"),
    **dict.fromkeys(("psd", "stft", "periodogram"), "signals.spectrogram(record, name)"),
    **dict.fromkeys(("cpsd", "mscohere"), "signals.estimate(record, output, input), which has coherence"),
    "xcorr": f"scipy.signal.correlate of two arrays such as {_SAMPLES}",
    "rms": 'record["T"].rms, or conventions of amplitude: tn.Conventions(amplitude="RMS")',
    **dict.fromkeys(("mean", "std", "kurtosis", "crest_factor"), f"np.mean and the like of {_SAMPLES}"),
    "peak2peak": f"np.ptp({_SAMPLES})",
    "unwrap": "signals.unwrapped(signal)",
    "resample": "signals.resampled(record, sampling_rate)",
    "detrend": 'signals.Welch(detrend="linear"), the settings of estimates',
    **dict.fromkeys(
        ("window", "hann", "hamming", "hanning"), 'signals.Welch(window="hann"), the settings of estimates'
    ),
    **dict.fromkeys(("butter", "filter", "filtfilt", "lowpass", "bandpass", "sosfiltfilt"), _FILTERED),
    **dict.fromkeys(("hilbert", "envelope"), f"scipy.signal.hilbert({_SAMPLES})"),
    **dict.fromkeys(("diff", "gradient", "derivative"), f"np.gradient({_SAMPLES}, record.time)"),
    **dict.fromkeys(
        ("trapz", "cumtrapz", "integrate"), f"scipy.integrate.cumulative_trapezoid({_SAMPLES}, record.time)"
    ),
    **dict.fromkeys(("interp1", "interp"), f"np.interp(times, record.time, {_SAMPLES})"),
    "mac": "modal.match(estimate, modes).mac, and plot.mac_matrix for its picture",
    **dict.fromkeys(("modalfit", "modalfrf", "ema", "rationalfit", "n4sid", "ssest", "tfest"), _IDENTIFIED),
    **dict.fromkeys(
        ("modalsd", "stabilization"), "modal.stabilisation(response), and plot.stabilisation for its picture"
    ),
    **dict.fromkeys(("tachorpm", "tacho", "rpm"), "signals.mean_rotation(record, name)"),
    **dict.fromkeys(("rpmtrack", "ordertrack", "orderspectrum", "order_tracking"), _ORDERS),
    **dict.fromkeys(("rpmfreqmap", "rpmordermap", "waterfall"), f"plot.waterfall({_ORDERS}[0])"),
    **dict.fromkeys(("tsa", "synchronous_average"), f"{_ORDERS}, whose method is signals.CycleAverage"),
    **dict.fromkeys(("rainflow", "sn_curve", "miner", "goodman"), _FATIGUE),
    **dict.fromkeys(("pole", "poles", "damp", "eigs", "eigh", "eigenfrequencies", "pzmap"), "model.modes()"),
    **dict.fromkeys(("zero", "zeros", "tzero"), 'model.modes(measured_input="T"), whose poles are the zeros of T'),
    **dict.fromkeys(("rlocus", "root_locus"), f"control.root_locus({_STATES})"),
    **dict.fromkeys(("margin", "allmargin", "nyquist"), "model.loop_margins(), and plot.nyquist for its picture"),
    **dict.fromkeys(("sigma", "svd"), "np.linalg.svd(response.values), or modal.cmif(response)"),
    **dict.fromkeys(("bodemag", "bodeplot"), "plot.bode(response)"),
    **dict.fromkeys(("freqresp", "freqs", "evalfr"), "model.frequency_response(output, input, frequencies)"),
    **dict.fromkeys(("zpk", "tf2zpk"), f"control.zeros({_STATES}), control.poles and its D matrix"),
    "frd": "response.to_control()",
    **dict.fromkeys(("minreal", "balreal", "modred"), f"control.minimal_realization({_STATES})"),
    **dict.fromkeys(("guyan", "craig_bampton", "superposition", "reduce"), _REDUCED),
    **dict.fromkeys(
        ("impulse", "step", "initial", "initial_response", "solve_ivp", "odeint", "sim"),
        "model.simulate(output, input, sampling_rate)",
    ),
    **dict.fromkeys(("linmod", "linearize", "linearise"), _LINEAR),
    **dict.fromkeys(("campbell", "campbell_diagram"), "plot.interference_diagram(model.critical_speeds())"),
    **dict.fromkeys(("db", "mag2db"), "response.decibels"),
    **dict.fromkeys(("db2mag", "db2pow"), "10 ** (decibels / 20)"),
    **dict.fromkeys(("deg2rad", "rad2deg", "rpm2rad"), 'tn.units.convert(3, "deg", "rad")'),
    **dict.fromkeys(("lsqcurvefit", "curve_fit", "least_squares", "fminsearch"), _FITTED),
    **dict.fromkeys(("fmincon", "optimize", "minimize", "montecarlo", "monte_carlo", "sobol"), _STUDY),
    **dict.fromkeys(("load_mat", "loadmat", "read_excel", "import_data"), _IMPORTED),
    "savemat": "tn.io.write_matlab(model, path) for models, io.write_recording(record, path) for records",
    **dict.fromkeys(("simulink", "simscape", "fmu", "fmi"), "tn.io.write_fmu(model, path), or io.write_matlab"),
    **dict.fromkeys(("welch", "tfestimate", "csd", "coherence", "frf"), "signals.estimate(record, output, input)"),
    "decimate": "signals.decimate(record, factor)",
    "spectrogram": "signals.spectrogram(record, name)",
    "eigenvalues": "model.modes().eigenvalues",
    **dict.fromkeys(("mass_matrix", "stiffness_matrix", "assemble"), "model.matrices()"),
    "holzer": "model.holzer_table()",
    "fatigue": _FATIGUE,
    "save": "model.to_yaml(path), io.write_recording(record, path), and plot.save(figure, path)",
    "to_csv": "io.write_recording(record, path), or to_csv of a response, modes and tables",
    "figure": "the plot that you want, as plot.bode(response), which returns its figure",
    "lookup": "tn.TabulatedSpring for tables over frequency, tn.Spring for those over twist",
    "linspace": "np.linspace(1, 100, 1000)",
    "animate": "plot.mode_shapes(modes); torsionnet explore on the command line shows them in motion",
}
"""Python code by words of Matlab, Simscape, Amesim, NumPy and SciPy, which may be tried on anything."""

_MATRICES = "model.matrices(), which has M, C and K in numbers, or model.symbolic() for formulas"
_DAMPING = 'damping={"zeta": "2 %", "at": "12 Hz"} of its springs, to which damping belongs'
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
