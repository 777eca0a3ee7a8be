"""Exact derivatives of responses and modes against closed forms in many digits."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support import campaigns, strategies

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.linear.sensitivity.parametric import parametric_response

F = np.array([0.4, 3.0, 5.6, 8.1, 20.0, 80.0])
mp.mp.dps = 40

DMF = {"I_1": 0.078, "I_2": 0.152, "k_1": 13300, "k_2": 460, "c_1": 0.1, "c_2": 4, "c_B": 0.3, "c_M": 0.3}
AMT = {"I_MT": 0.078, "I_1": 0.23, "I_2": 0.13, "k_1": 460, "k_2": 12300, "c_1": 4, "c_M": 0.3, "c_B": 1.5, "c_O": 170}


def dmf_tt(s, p):
    """Equation (13) of Galvagno et al. (2015)."""
    return 1 / (p["k_1"] + p["c_1"] * s) + 1 / (p["I_2"] * s**2 + (p["c_2"] + p["c_B"]) * s + p["k_2"])


def dmf_tm(s, p):
    return 1 / (p["I_1"] * s**2 + p["c_M"] * s + 1 / dmf_tt(s, p))


def amt_tt(s, p):
    """Equation (20)."""
    out = p["I_2"] * s**2 + (p["c_B"] + p["c_O"] / p["tau"] ** 2) * s + p["k_2"] / p["tau"] ** 2
    return 1 / ((p["I_1"] - p["I_MT"]) * s**2 + 1 / (1 / (p["k_1"] + p["c_1"] * s) + 1 / out))


def slopes(function, values, names, s):
    """Derivatives by mpmath."""
    exact = {name: mp.mpf(str(value)) for name, value in values.items()}

    def one(name):
        return mp.diff(lambda x: function(s, {**exact, name: x}), exact[name])

    return [complex(one(name)) for name in names]


@pytest.mark.parametrize(
    ("rig", "values", "function", "against"),
    [
        ("dmf_rig", DMF, dmf_tt, "T_T"),
        ("dmf_rig", DMF, dmf_tm, "T_M"),
        ("amt_rig", {**AMT, "tau": 4.14}, amt_tt, "T_T"),
    ],
)
def test_derivatives_of_the_papers_equations(rig, values, function, against):
    names = [name for name in values if not (against == "T_T" and name in ("c_M", "I_1" if rig == "dmf_rig" else ""))]
    response = parametric_response(tn.load(rig).configured(**values), "theta_1", against, F, names)
    found = response.evaluation(response.start)
    for line, f in enumerate(F):
        s = 2j * mp.pi * mp.mpf(float(f))
        exact = {name: mp.mpf(str(value)) for name, value in values.items()}
        assert found.values[line, 0, 0] == pytest.approx(complex(function(s, exact)), rel=1e-11)
        expected = slopes(function, values, names, s)
        for p, name in enumerate(names):
            scale = abs(complex(function(s, exact))) / values[name]
            assert abs(found.jacobian[line, 0, 0, p] - expected[p]) <= 1e-8 * max(abs(expected[p]), 1e-6 * scale), name


def test_ratio_in_readings_too():
    """Torque behind the gear, and speeds of both shafts, follow the ratio that is varied."""
    rig = tn.load("amt_rig").configured("III")
    outputs = ["torque(gearbox, output_shaft)", "torque(gearbox)", "velocity(output_shaft)", "twist(half_shaft)"]
    response = parametric_response(rig, outputs, "T_M", F, ["tau", "k_2", "c_O"])
    found = response.evaluation(response.start)
    torque_out, torque_in, speed, twist = (found.jacobian[:, i, 0] for i in range(4))
    values = found.values[:, :, 0]
    tau = 5.42
    # torque out = tau torque in; speed out = s twist of the half-shaft, whose other end is locked
    assert np.allclose(torque_out[:, 0], values[:, 1] + tau * torque_in[:, 0], rtol=1e-9)
    assert np.allclose(torque_out[:, 1:], tau * torque_in[:, 1:], rtol=1e-9)
    assert np.allclose(speed, 2j * np.pi * F[:, None] * twist, rtol=1e-9)


def test_numbers_of_elements_without_a_name():
    rig = tn.Drivetrain(
        "two",
        [
            tn.Inertia("rotor", node="a", inertia=0.1),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=400, damping=1),
        ],
    )
    response = parametric_response(rig, "a", "a", F, ["shaft.stiffness", "rotor.inertia", "shaft.damping"])
    s = 2j * np.pi * F
    H = 1 / (0.1 * s**2 + s + 400)
    found = response.evaluation([400, 0.1, 1])
    assert np.allclose(found.jacobian[:, 0, 0], -(H**2)[:, None] * np.column_stack([np.ones(6), s**2, s]), rtol=1e-9)


@pytest.mark.slow
@settings(max_examples=campaigns.examples(10, 30), deadline=None, suppress_health_check=list(HealthCheck))
@given(strategies.blueprints(size=4), st.data())
def test_random_drivetrains_against_differences_of_the_solver(blueprint, data):
    drivetrain, mechanics = blueprint.drivetrain(), blueprint.mechanics
    moving = [node for node in drivetrain.nodes if mechanics.moves(node)]
    ends = [data.draw(st.sampled_from(moving)) for _ in range(2)]
    fields = [
        f"{name}.{field}"
        for name, element in drivetrain.elements.items()
        for field in ("inertia", "stiffness", "damping")
        if type(element).__name__ in ("Inertia", "Spring", "Damper") and hasattr(element, field)
    ]
    if not fields:
        return
    name = data.draw(st.sampled_from(fields))
    f = np.array([0.7, 3.1])
    try:
        response = parametric_response(drivetrain, *ends, f, [name])
    except UsageError:  # given as a damping ratio
        return
    x = response.start
    step = 1e-4 * abs(x) + 1e-7
    found = response.evaluation(x)
    high, low = (response.evaluation(x + sign * step).values for sign in (1, -1))
    expected = (high - low) / (2 * step)
    size = np.abs(found.values).max() / max(abs(x[0]), 1e-3)
    curved = np.abs(high + low - 2 * found.values).max() / step[0]
    assert (
        np.abs(found.jacobian[..., 0] - expected).max() <= 1e-5 * size + 1e-3 * curved + 1e-6 * np.abs(expected).max()
    )
    assert np.allclose(found.values, drivetrain.frequency_response(*ends, f).values, rtol=1e-7, atol=1e-9 * size)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["c_3"], "unknown-parameter"),
        (["c_2", "c_2"], "named twice"),
        (["dmf.stifness"], 'did you mean "stiffness"'),
        (["dmf.stiffness"], "expression-not-allowed"),
        (["flywhel.inertia"], "no parameter is named"),
    ],
)
def test_unknown_names(names, message):
    with pytest.raises(UsageError, match=message):
        parametric_response(tn.load("dmf_rig"), "theta_1", "T_T", F, names)


def test_zero_frequency_is_refused_and_infinite_values_are_told():
    rig = tn.load("dmf_rig")
    with pytest.raises(UsageError, match="above 0"):
        parametric_response(rig, "theta_1", "T_T", [0.0, 1.0], ["c_2"])
    with pytest.raises(SolveError, match="not-finite"):
        parametric_response(rig, "theta_1", "T_T", [1.0], ["k_2"]).evaluation([np.nan])


# Modes


def test_one_mass_in_closed_form():
    k, c, inertia = 460.0, 4.0, 0.152
    rig = tn.Drivetrain(
        "one",
        [
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.Spring("dmf", nodes=("a", "ground"), stiffness="k", damping="c"),
        ],
        parameters={"J": inertia, "k": k, "c": c},
    )
    found = mode_sensitivities(rig, ["J", "k", "c"])
    omega, zeta = np.sqrt(k / inertia), c / (2 * np.sqrt(k * inertia))
    assert found.natural_frequencies[0] == pytest.approx(omega / 2 / np.pi)
    assert found.relative_frequencies[0] == pytest.approx([-0.5, 0.5, 0], abs=1e-10)
    assert found.relative_dampings[0] == pytest.approx([-0.5, -0.5, 1], abs=1e-10)
    assert found.damping_slopes[0, 2] == pytest.approx(zeta / c)


@pytest.mark.few(1)
@pytest.mark.parametrize("gear", ["II", "V_c_O_360"])
@pytest.mark.parametrize("measured", [None, "T_T"])
def test_poles_of_the_papers_rig_overdamped_ones_too(gear, measured):
    """Roots of the characteristic polynomial in many digits, moved by a millionth."""
    rig = tn.load("amt_rig").configured(gear)
    values = {**AMT, "tau": rig.parameters["tau"], "c_O": rig.parameters["c_O"]}
    names = ["I_1", "I_2", "k_1", "k_2", "c_1", "c_B", "c_O", "tau"]
    found = mode_sensitivities(rig, names, measured_input=measured)

    def poles(p):
        first = p["I_1"] - (p["I_MT"] if measured else 0)
        bearing = 0 if measured else p["c_M"]
        out_c, out_k = p["c_B"] + p["c_O"] / p["tau"] ** 2, p["k_2"] / p["tau"] ** 2
        # (I s^2 + (c_1 + c) s + k_1) (I_2 s^2 + (c_1 + out_c) s + k_1 + out_k) - (c_1 s + k_1)^2
        a = [first, p["c_1"] + bearing, p["k_1"]]
        b = [p["I_2"], p["c_1"] + out_c, p["k_1"] + out_k]
        product = [mp.mpf(0)] * 5
        for i in range(3):
            for j in range(3):
                product[i + j] += a[i] * b[j]
        square = [p["c_1"] ** 2, 2 * p["c_1"] * p["k_1"], p["k_1"] ** 2]
        for i in range(3):
            product[i + 2] -= square[i]
        roots = [complex(root) for root in mp.polyroots(product, maxsteps=500, extraprec=300)]
        return np.array(sorted((root for root in roots if root.imag > -1e-9), key=abs))

    exact = {name: mp.mpf(str(value)) for name, value in values.items()}
    assert np.allclose(found.poles, poles(exact), rtol=1e-9)
    for p, name in enumerate(names):
        step = exact[name] * mp.mpf("1e-7")
        moved = [poles({**exact, name: exact[name] + sign * step}) for sign in (1, -1)]
        expected = (moved[0] - moved[1]) / float(2 * step)
        assert np.allclose(found.pole_slopes[:, p], expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max()), name


def test_repeated_modes_part_as_the_parameter_wants():
    """Two equal branches on one wheel: their common mode is double; the stiffness of one moves one of the two."""
    elements = [tn.Inertia("hub", node="h", inertia=1), tn.Lock("clamp", node="h")]
    for branch in "abc":
        elements += [
            tn.Inertia(f"disc_{branch}", node=branch, inertia=0.1),
            tn.Spring(f"arm_{branch}", nodes=("h", branch), stiffness=f"k_{branch}", damping=0.2),
        ]
    rig = tn.Drivetrain("branches", elements, parameters={"k_a": 100, "k_b": 100, "k_c": 100})
    found = mode_sensitivities(rig, ["k_a", "k_b", "k_c"])
    assert len(found.poles) == 3
    for p in range(3):
        moved = np.sort(np.abs(found.pole_slopes[:, p]))
        omega = abs(found.poles[0].imag)
        assert moved[:2] == pytest.approx([0, 0], abs=1e-9)
        assert moved[2] == pytest.approx(1 / 0.1 / (2 * omega), rel=1e-6)


def test_words_say_which_parameter_moves_which_mode():
    words = mode_sensitivities(tn.load("dmf_rig")).words()
    assert words[0].startswith("mode 1 (7.105 Hz, 22.3 % damping): frequency by k_2 (+0.5), I_2 (-0.33)")
    assert "damping by c_2 (+0.87)" in words[0]


@pytest.mark.parametrize("modes", [[1], [1, 2]])
def test_tornado_shows_the_strongest_first(modes):
    from torsionnet import plot

    found = mode_sensitivities(tn.load("dmf_rig"))
    figure = plot.tornado(found, mode=modes)
    for number, axes in enumerate(figure.axes):
        bottom, top = axes.get_ylim()
        assert bottom > top
        slopes = (found.relative_dampings if number % 2 else found.relative_frequencies)[number // 2]
        labels = [text.get_text() for text in axes.get_yticklabels()]
        by_size = sorted(found.parameters, key=lambda name: -abs(slopes[found.parameters.index(name)]))
        assert labels == by_size[: len(labels)]
        assert [bar.get_width() for bar in axes.patches] == [slopes[found.parameters.index(name)] for name in labels]
        assert all(abs(slopes[found.parameters.index(name)]) < 0.01 for name in by_size[len(labels) :])
    with pytest.raises(UsageError, match="unknown-mode"):
        plot.tornado(found, mode=[3])


def one_mass(**parameters):
    return tn.Drivetrain(
        "one",
        [
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.Spring("spring", nodes=("a", "ground"), stiffness="k/q", damping="c"),
        ],
        parameters={"q": 1, **parameters},
    )


def test_tornado_leaves_out_bars_below_half_a_percent_of_the_largest():
    """Springs side by side: f over each is k_i/(2 k), relative to the stiffest k_i/k_1."""
    from torsionnet import plot

    springs = {"k": 1000.0, "a": 6.0, "b": 4.0}
    elements = [tn.Spring(f"s_{name}", nodes=("a", "ground"), stiffness=name) for name in springs]
    rig = tn.Drivetrain("three", [tn.Inertia("rotor", node="a", inertia=1), *elements], parameters=springs)
    (panel,) = plot.tornado(mode_sensitivities(rig)).axes
    assert [text.get_text() for text in panel.get_yticklabels()] == ["k", "a"]


def test_poles_that_meet_have_no_derivative_and_say_so():
    found = mode_sensitivities(one_mass(J=0.25, k=400, c=20), ["k", "c"])
    assert np.isnan(found.pole_slopes).all()
    assert all("two poles meet (critical damping)" in text for text in found.words())


def test_just_beside_critical_damping():
    found = mode_sensitivities(one_mass(J=0.25, k=400, c=20.002), ["c"])
    root = np.sqrt(20.002**2 - 4 * 0.25 * 400)
    expected = sorted([(-1 + 20.002 / root) / 0.5, (-1 - 20.002 / root) / 0.5])
    assert np.allclose(np.sort(found.pole_slopes[:, 0].real), expected, rtol=1e-5)


TABLE = [[0.5, 200, 5], [3, 300, 2], [9, 900, 1], [30, 950, 0.5]]


def tabulated(J=0.2, J_2=0.15, k=800.0, c=0.6):
    return tn.Drivetrain(
        "tabulated",
        [
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.TabulatedSpring("mount", nodes=("a", "ground"), table=TABLE),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k", damping="c"),
            tn.Inertia("load", node="b", inertia="J_2"),
        ],
        parameters={"J": J, "J_2": J_2, "k": k, "c": c},
        inputs={"T": {"torque": "b"}},
        sensors={"T_m": {"torque": "mount"}},
    )


@pytest.mark.parametrize("measured", [None, "T_m"])
def test_tabulated_springs_move_with_the_pole(measured):
    """Against differences of the modes, which read the table anew."""
    rig = tabulated()
    found = mode_sensitivities(rig, measured_input=measured)
    for p, name in enumerate(found.parameters):
        h = 1e-4 * rig.parameters[name]
        up, down = (
            rig.configured(**{name: rig.parameters[name] + sign * h}).modes(measured_input=measured).eigenvalues
            for sign in (1, -1)
        )
        assert np.allclose(found.pole_slopes[:, p], (up - down) / (2 * h), rtol=1e-5, atol=1e-7)


def test_what_poles_are_not_derived_for():
    star: list[tn.Element] = [tn.Inertia("hub", node="h", inertia=1)]
    for n in "abc":
        star += [
            tn.TabulatedSpring(f"mount_{n}", nodes=("h", n), table=TABLE),
            tn.Inertia(f"rotor_{n}", node=n, inertia="J"),
        ]
    with pytest.raises(UsageError, match="unsupported-law"):
        mode_sensitivities(tn.Drivetrain("star", star, parameters={"J": 0.2}))
    with pytest.raises(UsageError, match="wrong-form"):
        mode_sensitivities(one_mass(J=1, k=1, c=1), [3])


def test_values_at_which_the_drivetrain_cannot_be_calculated():
    response = parametric_response(one_mass(J=1, k=1, c=1), "a", "a", [1.0], ["q"])
    with pytest.raises(SolveError, match="no-solution"):
        response.evaluation([0.0])


def test_modes_have_the_numbers_of_their_table():
    """Rigid-body modes have neither a number nor a derivative."""
    from torsionnet import plot

    ship = tn.load("marine_steam_turbine").configured("undamped")
    table, found = ship.modes(), mode_sensitivities(ship)
    for index, number in enumerate(found.numbers):
        place = table.numbers.index(number)
        assert found.natural_frequencies[index] == pytest.approx(table.natural_frequencies[place])
    assert found.numbers[0] == 1
    assert found.words()[0].startswith("mode 1 (")
    assert "mode 2: 3.67 Hz" in plot.tornado(found, mode=[2]).axes[0].get_title()
    with pytest.raises(UsageError, match="unknown-mode"):
        plot.tornado(found, mode=[0])


@pytest.mark.slow
def test_tornado_shows_four_modes_unless_others_are_asked_for():
    from torsionnet import plot

    found = mode_sensitivities(tn.load("marine_medium_speed"))
    first, all_five = (
        [axes.get_title().partition(":")[0] for axes in plot.tornado(found, mode=modes).axes if ":" in axes.get_title()]
        for modes in (None, [1, 2, 3, 4, 5])
    )
    assert first == ["real pole", "mode 1", "real pole", "mode 2"]
    assert all_five == [f"mode {number}" for number in range(1, 6)]


def test_tornado_has_no_empty_panels():
    undamped = mode_sensitivities(tn.load("geared_branch"))
    from torsionnet import plot

    figure = plot.tornado(undamped)
    assert [axes.get_title() for axes in figure.axes] == [
        f"mode {undamped.number(mode)}: {undamped.natural_frequencies[mode]:.4g} Hz" for mode in range(3)
    ]
    overdamped = plot.tornado(mode_sensitivities(tn.load("marine_steam_turbine")))
    assert [axes.get_title() for axes in overdamped.axes][:3] == [
        "real pole: 0.02097 Hz",
        "mode 1: 2.961 Hz",
        "damping ratio 3.91 %",
    ]
    assert all(max(abs(bar.get_width()) for bar in axes.patches) > 0 for axes in overdamped.axes)
    labels = [axes.get_xlabel() for axes in overdamped.axes]
    assert labels[0] == ""
    assert labels[-2:] == ["natural frequency [% per %]", "damping ratio [% per %]"]


# --- stiff and free chains --------------------------------------------------------------------------------------------

CHAINS = {
    "even": ([1e4] * 5, [0.1] * 6, 0.0),
    "stiff": ([1e2, 1e4, 1e6, 1e8, 1e10], [0.1, 0.2, 0.3, 0.1, 0.2, 0.3], 0.0),
    "mixed": ([1e2, 1e10, 1e2, 1e9, 1e3], [1e-3, 10.0, 0.1, 1e-2, 100.0, 1e-3], 0.0),
    "on a soft mount": ([1e8] * 5, [0.1] * 6, 1e-2),
}


def chain(springs, inertias, mount, loss=0.0):
    """Rotors n0, n1, ... in a row, the first on a mount where there is one; every number a parameter."""
    parts = [tn.Inertia(f"rotor_{i}", node=f"n{i}", inertia=f"J_{i}") for i in range(len(inertias))]
    parts += [
        tn.Spring(f"shaft_{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=f"k_{i}", damping=f"{loss}*k_{i}/1000000")
        for i in range(len(springs))
    ]
    values = {f"J_{i}": x for i, x in enumerate(inertias)} | {f"k_{i}": x for i, x in enumerate(springs)}
    if mount:
        parts.append(tn.Spring("mount", nodes=("n0", "ground"), stiffness="k_m"))
        values["k_m"] = mount
    return tn.Drivetrain("chain", parts, parameters=values), values


def exact_chain(values, loss, s):
    """The receptance matrix in many digits, and of every parameter the derivative of the dynamic stiffness by node."""
    n = sum(name.startswith("J") for name in values)
    exact = {name: mp.mpf(str(value)) for name, value in values.items()}
    lossy = 1 + mp.mpf(str(loss)) * s / 10**6
    rows = {f"J_{i}": ({i: 1}, s**2) for i in range(n)} | {"k_m": ({0: 1}, 1)}
    rows |= {f"k_{i}": ({i: 1, i + 1: -1}, lossy) for i in range(n - 1)}
    D = mp.zeros(n)
    for name, value in exact.items():
        row, factor = rows[name]
        for i, a in row.items():
            for j, b in row.items():
                D[i, j] += value * factor * a * b
    return D**-1, {name: rows[name] for name in values}


@pytest.mark.parametrize("loss", [0.0, 30.0])
@pytest.mark.parametrize("name", CHAINS)
def test_responses_of_stiff_and_free_chains_at_low_frequency(name, loss):
    """Motion of the far end and torque in a shaft, down to a millionth of a radian per second: -H dD H in many digits."""
    rig, values = chain(*CHAINS[name], loss)
    f = np.array([1e-7, 1e-3, 0.3, 7.0])
    found = parametric_response(rig, ["n5", "torque(shaft_2)", "torque(shaft_2, n3)"], "n0", f, list(values))
    got = found.evaluation(found.start)
    with mp.workdps(80):
        for line, frequency in enumerate(f.tolist()):
            s = 2j * mp.pi * mp.mpf(frequency)
            H, rows = exact_chain(values, loss, s)
            kappa, k = 1 + mp.mpf(str(loss)) * s / 10**6, mp.mpf(str(values["k_2"]))
            torque = k * kappa * (H[2, 0] - H[3, 0])
            for p, (parameter, (row, factor)) in enumerate(rows.items()):

                def moved(i, row=row, factor=factor, H=H):
                    return -factor * sum(a * H[i, j] for j, a in row.items()) * sum(a * H[j, 0] for j, a in row.items())

                slope = k * kappa * (moved(2) - moved(3))
                slope += kappa * (H[2, 0] - H[3, 0]) if parameter == "k_2" else 0
                x = mp.mpf(str(values[parameter]))
                for reading, (value, expected) in enumerate(((H[5, 0], moved(5)), (torque, slope), (torque, slope))):
                    assert abs(mp.mpc(got.values[line, reading, 0]) / value - 1) < 1e-11
                    error = abs(mp.mpc(got.jacobian[line, reading, 0, p]) - expected)
                    assert error < 1e-10 * abs(expected) + 1e-12 * abs(value) / x, (parameter, frequency, reading)


@pytest.mark.parametrize("name", CHAINS)
def test_modes_of_stiff_and_free_chains(name):
    """Every derivative to ten digits of itself, however little of the mode is in that spring: (a q)^2 / 2 omega."""
    rig, values = chain(*CHAINS[name])
    found = mode_sensitivities(rig, list(values))
    n = sum(parameter.startswith("J") for parameter in values)
    with mp.workdps(60):
        J = [mp.mpf(str(values[f"J_{i}"])) for i in range(n)]
        K = mp.zeros(n)
        for parameter, value in values.items():
            ends = {"k_m": {0: 1}}.get(parameter) or {int(parameter[2:]): 1, int(parameter[2:]) + 1: -1}
            for i, a in ends.items() if parameter[0] == "k" else ():
                for j, b in ends.items():
                    K[i, j] += a * b * mp.mpf(str(value)) / mp.sqrt(J[i] * J[j])
        squares, vectors = mp.eigsy(K)
        first = 0 if "k_m" in values else 1
        for mode, which in enumerate(range(first, n)):
            omega = mp.sqrt(squares[which])
            q = [vectors[i, which] / mp.sqrt(J[i]) for i in range(n)]
            for p, parameter in enumerate(values):
                if parameter[0] == "J":
                    expected = -omega * q[int(parameter[2:])] ** 2 / 2
                else:
                    twist = q[0] if parameter == "k_m" else q[int(parameter[2:])] - q[int(parameter[2:]) + 1]
                    expected = twist**2 / (2 * omega)
                error = abs(mp.mpc(found.pole_slopes[mode, p]) - 1j * expected)
                if abs(expected) * values[parameter] > 1e-6 * omega:
                    assert found.damping_slopes[mode, p] == 0
                floor = 1e-15 * omega / mp.mpf(str(values[parameter]))
                assert error < 1e-10 * abs(expected) + floor, (mode, parameter)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("model", "measured", "excitation"),
    [
        ("direct_drive_wind_turbine", "spider_torque", None),
        ("direct_drive_wind_turbine", "generator_speed", None),
        ("marine_steam_turbine", "T_LT", None),
        ("marine_steam_turbine", "velocity(hp_turbine)", None),
        ("six_cylinder_diesel", "velocity(flywheel)", None),
    ],
)
def test_poles_against_measured_inputs_against_differences(model, measured, excitation):
    """Cut in two by the sensor or not, massless ends and readings of speed: the modes of two moved drivetrains."""
    rig = tn.load(model)
    rig = rig.configured(rig.configurations[0]) if rig.configurations else rig
    excitation = excitation or next(iter(rig.inputs))
    found = mode_sensitivities(rig, measured_input=measured, driven_by=excitation)
    kinds = rig.modes(measured_input=measured, driven_by=excitation).kinds
    found_at = [place for place, kind in enumerate(kinds) if kind != "rigid body"]
    for p, name in enumerate(found.parameters[::3]):
        x = rig.parameters[name]

        def poles(share, name=name, x=x):
            moved = rig.configured(**{name: float(x) * (1 + share)})
            return moved.modes(measured_input=measured, driven_by=excitation).eigenvalues

        coarse, fine = ((poles(h) - poles(-h)) / (2 * h) for h in (2e-4, 1e-4))
        expected = ((4 * fine - coarse) / 3)[found_at]
        error = np.abs(found.pole_slopes[:, 3 * p] * float(x) - expected) / np.abs(found.poles)
        assert error.max() < 1e-7, name
