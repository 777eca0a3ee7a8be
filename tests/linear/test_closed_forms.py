"""Textbook closed forms, written without any matrix: what one or two masses, gears and shafts must do."""

from math import cos, exp, log, pi, sin, sqrt, tan

import numpy as np
import pytest

import torsionnet as tn

F = np.array([0.0, 0.7, 3.0, 11.0, 40.0, 230.0])
S = 2j * pi * F
J1, J2, K, C = 0.078, 0.152, 460.0, 0.9


def frf(drivetrain, output, at, f=F, **more):
    return drivetrain.frequency_response(output, at, f, **more).values[:, 0, 0]


def train(*elements, **more):
    return tn.Drivetrain("closed form", elements, **more)


# --- one mass -------------------------------------------------------------------------------------------------------


def one_mass(J=J1, k=K, c=C):
    return train(tn.Inertia("disc", "a", J), tn.Spring("shaft", ("a", "ground"), k, c))


def test_receptance_of_a_mass_on_a_damped_spring():
    assert frf(one_mass(), "a", "a") == pytest.approx(1 / (J1 * S**2 + C * S + K), rel=1e-13)


def test_mobility_accelerance_and_dynamic_stiffness_of_one_mass():
    H = one_mass().frequency_response("a", "a", F)
    D = J1 * S**2 + C * S + K
    assert H.mobility().values.ravel() == pytest.approx(S / D, rel=1e-13)
    assert H.accelerance().values.ravel() == pytest.approx(S**2 / D, rel=1e-13)
    assert H.dynamic_stiffness().values.ravel() == pytest.approx(D, rel=1e-12)


def test_torque_and_twist_of_the_spring_of_one_mass():
    D = J1 * S**2 + C * S + K
    assert frf(one_mass(), "torque(shaft)", "a") == pytest.approx((K + C * S) / D, rel=1e-13)
    assert frf(one_mass(), "twist(shaft)", "a") == pytest.approx(1 / D, rel=1e-13)
    assert frf(one_mass(), "torque(disc)", "a") == pytest.approx(J1 * S**2 / D, rel=1e-13)


@pytest.mark.parametrize("c", [0.0, 1e-6, 0.3, 5.0, 11.9])
def test_underdamped_mass(c):
    omega, zeta = sqrt(K / J1), c / (2 * sqrt(K * J1))
    modes = one_mass(c=c).modes()
    assert modes.kinds == ("oscillatory",)
    assert modes.natural_frequencies == pytest.approx([omega / (2 * pi)], rel=1e-13)
    assert modes.undamped_natural_frequencies == pytest.approx([omega / (2 * pi)], rel=1e-13)
    assert modes.damping_ratios == pytest.approx([zeta], rel=1e-12, abs=1e-16)
    assert modes.damped_frequencies == pytest.approx([omega * sqrt(1 - zeta**2) / (2 * pi)], rel=1e-12)
    assert modes.eigenvalues == pytest.approx([omega * complex(-zeta, sqrt(1 - zeta**2))], rel=1e-12)


@pytest.mark.parametrize("c", [12.1, 60.0, 4e3, 2e7])
def test_overdamped_mass_has_two_real_poles(c):
    large = -(c + sqrt(c * c - 4 * K * J1)) / (2 * J1)
    small = K / J1 / large
    modes = one_mass(c=c).modes()
    assert modes.kinds == ("real pole", "real pole")
    assert modes.eigenvalues == pytest.approx([small, large], rel=1e-11)
    assert modes.damping_ratios == pytest.approx([1, 1])
    assert modes.undamped_natural_frequencies == pytest.approx([sqrt(K / J1) / (2 * pi)], rel=1e-13)


def test_critically_damped_mass_has_a_double_pole():
    modes = train(tn.Inertia("disc", "a", 1), tn.Spring("shaft", ("a", "ground"), 100, 20)).modes()
    both = [*modes.eigenvalues, *modes.eigenvalues.conj()[modes.eigenvalues.imag > 0]]
    assert both == pytest.approx([-10, -10], abs=1e-5)
    assert sum(both) == pytest.approx(-20, rel=1e-12)


def test_mass_with_a_damper_to_ground_only():
    """Rigid-body mode and the pole -c/J."""
    modes = train(tn.Inertia("disc", "a", J1), tn.Damper("bearing", ("a", "ground"), C)).modes()
    assert modes.kinds == ("rigid body", "real pole")
    assert modes.eigenvalues == pytest.approx([0, -C / J1], rel=1e-14)
    assert np.isnan(modes.damping_ratios[0])


def test_kelvin_voigt_element_without_mass_has_the_real_pole_k_over_c():
    modes = train(tn.Spring("rubber", ("a", "ground"), K, C)).modes()
    assert modes.kinds == ("real pole",)
    assert modes.eigenvalues == pytest.approx([-K / C], rel=1e-14)
    assert frf(train(tn.Spring("rubber", ("a", "ground"), K, C)), "a", "a") == pytest.approx(1 / (K + C * S), rel=1e-14)


def test_maxwell_element_behind_a_mass():
    """Spring and damper in series: J s^3 + J (k/c) s^2 + k s = 0 over s."""
    maxwell = train(
        tn.Inertia("disc", "a", J1), tn.Spring("spring", ("a", "b"), K), tn.Damper("damper", ("b", "ground"), C)
    )
    assert frf(maxwell, "a", "a", F[1:]) == pytest.approx(
        (1 / (J1 * S**2 + 1 / (1 / K + 1 / (C * np.where(S == 0, 1, S)))))[1:], rel=1e-12
    )
    modes = maxwell.modes()
    roots = [*modes.eigenvalues, *modes.eigenvalues.conj()[modes.eigenvalues.imag > 0]]
    assert sum(roots) == pytest.approx(-K / C, rel=1e-12)
    assert modes.kinds.count("rigid body") == 1


# --- two masses -----------------------------------------------------------------------------------------------------


def two_masses(c=C, **more):
    return train(
        tn.Inertia("motor", "a", J1), tn.Spring("shaft", ("a", "b"), K, c), tn.Inertia("load", "b", J2), **more
    )


def test_two_free_masses():
    reduced = J1 * J2 / (J1 + J2)
    omega, zeta = sqrt(K / reduced), C / (2 * sqrt(K * reduced))
    modes = two_masses().modes()
    assert modes.kinds == ("rigid body", "oscillatory")
    assert modes.natural_frequencies == pytest.approx([0, omega / (2 * pi)], rel=1e-12)
    assert modes.damping_ratios[1] == pytest.approx(zeta, rel=1e-12)
    assert np.abs(modes.shape_at("a")[1] / modes.shape_at("b")[1]) == pytest.approx(J2 / J1, rel=1e-10)
    assert modes.shape_at("a")[0] == pytest.approx(modes.shape_at("b")[0], rel=1e-14)
    assert modes.energy_shares(1)["motor"][0] == pytest.approx(J2 / (J1 + J2), rel=1e-10)
    assert modes.energy_shares(1)["shaft"][1:] == pytest.approx((1, 1))


def test_receptances_of_two_free_masses():
    s, kappa = S[1:], K + C * S[1:]
    together = s**2 * (J1 * J2 * s**2 + kappa * (J1 + J2))
    drivetrain = two_masses()
    assert frf(drivetrain, "a", "a", F[1:]) == pytest.approx((J2 * s**2 + kappa) / together, rel=1e-9)
    assert frf(drivetrain, "b", "a", F[1:]) == pytest.approx(kappa / together, rel=1e-9)
    assert frf(drivetrain, "torque(shaft)", "a") == pytest.approx(
        J2 * (K + C * S) / (J1 * J2 * S**2 + (K + C * S) * (J1 + J2)), rel=1e-11
    )


def test_static_torque_in_the_shaft_of_two_free_masses_is_shared_by_inertia():
    limit = frf(two_masses(), "torque(shaft)", "a", [0.0])
    assert limit == pytest.approx([J2 / (J1 + J2)], rel=1e-14)
    with pytest.warns(tn.TorsionnetWarning, match="infinite"):
        assert np.isinf(frf(two_masses(), "a", "a", [0.0]))


def test_imposed_angle_of_two_masses():
    """Transmissibility (k + c s)/(J_2 s^2 + c s + k), torque of the shaft, and the torque needed."""
    driven = two_masses(inputs={"phi": {"angle": "a"}})
    D = J2 * S**2 + C * S + K
    assert frf(driven, "b", "phi") == pytest.approx((K + C * S) / D, rel=1e-12)
    assert frf(driven, "a", "phi") == pytest.approx(np.ones(len(F)), rel=1e-15)
    assert frf(driven, "torque(shaft)", "phi") == pytest.approx((K + C * S) * J2 * S**2 / D, rel=1e-11, abs=1e-12)
    assert driven.modes().natural_frequencies == pytest.approx([sqrt(K / J2) / (2 * pi)], rel=1e-12)


def test_measured_torque_sees_the_load_only():
    """theta_1/T_T across the shaft: 1/(k + c s) + 1/(J_2 s^2)."""
    drivetrain = two_masses(inputs={"T_M": {"torque": "a"}}, sensors={"T_T": {"torque": "shaft"}})
    expected = 1 / (K + C * S[1:]) + 1 / (J2 * S[1:] ** 2)
    assert frf(drivetrain, "a", "T_T", F[1:]) == pytest.approx(expected, rel=1e-10)
    assert frf(drivetrain, "b", "T_T", F[1:]) == pytest.approx(1 / (J2 * S[1:] ** 2), rel=1e-10)


def test_chain_of_equal_masses_and_springs():
    """Both ends free: omega = 2 sqrt(k/J) sin(m pi / 2n)."""
    n = 7
    elements = [tn.Inertia(f"J{i}", f"n{i}", J1) for i in range(n)]
    elements += [tn.Spring(f"k{i}", (f"n{i}", f"n{i + 1}"), K) for i in range(n - 1)]
    expected = [2 * sqrt(K / J1) * sin(m * pi / (2 * n)) / (2 * pi) for m in range(n)]
    modes = train(*elements).modes()
    assert modes.natural_frequencies == pytest.approx(expected, rel=1e-12)
    third = [cos(3 * pi * (2 * i + 1) / (2 * n)) for i in range(n)]
    shape = np.array([modes.shape_at(f"n{i}")[3] for i in range(n)])
    assert np.abs(shape) == pytest.approx(np.abs(third) / max(map(abs, third)), abs=1e-9)


# --- gears ----------------------------------------------------------------------------------------------------------

TAU = -61 / 17


def geared():
    return train(
        tn.Inertia("pinion", "a", J1),
        tn.Gear("stage", ("a", "b"), teeth=(17, -61)),
        tn.Spring("shaft", ("b", "c"), K, C),
        tn.Inertia("load", "c", J2),
    )


def test_geared_shafts_reflect_by_tau_squared():
    """J_2/tau^2 and k/tau^2 on the pinion's shaft."""
    J, k, c = J2 / TAU**2, K / TAU**2, C / TAU**2
    reduced = J1 * J / (J1 + J)
    modes = geared().modes()
    assert modes.natural_frequencies == pytest.approx([0, sqrt(k / reduced) / (2 * pi)], rel=1e-12)
    assert modes.damping_ratios[1] == pytest.approx(c / (2 * sqrt(k * reduced)), rel=1e-12)
    s, kappa = S[1:], k + c * S[1:]
    together = s**2 * (J1 * J * s**2 + kappa * (J1 + J))
    assert frf(geared(), "a", "a", F[1:]) == pytest.approx((J * s**2 + kappa) / together, rel=1e-9)
    assert frf(geared(), "c", "a", F[1:]) == pytest.approx(kappa / together / TAU, rel=1e-9)
    assert geared().ratio_between("a", "c") == pytest.approx(TAU, rel=1e-15)
    assert geared().ratio_between("c", "a") == pytest.approx(1 / TAU, rel=1e-15)


def test_compliant_mesh_is_a_spring_referred_to_the_first_shaft():
    mesh = train(
        tn.Inertia("pinion", "a", J1),
        tn.Gear("stage", ("a", "b"), ratio=-2.5, stiffness=K, damping=C),
        tn.Inertia("wheel", "b", J2),
    )
    reduced = 1 / (1 / J1 + 2.5**2 / J2)
    modes = mesh.modes()
    assert modes.natural_frequencies == pytest.approx([0, sqrt(K / reduced) / (2 * pi)], rel=1e-12)
    assert modes.damping_ratios[1] == pytest.approx(C / (2 * sqrt(K * reduced)), rel=1e-12)
    assert (modes.shape_at("a") / modes.shape_at("b"))[0] == pytest.approx(-2.5, rel=1e-12)


def test_gear_torques_of_a_held_output():
    """T_out = tau T_in; the housing takes the difference."""
    stage = train(
        tn.Gear("stage", ("a", "b"), ratio=4, housing="h"),
        tn.Spring("shaft", ("b", "ground"), K),
        tn.Spring("mount", ("h", "ground"), 2 * K),
    )
    torques = [frf(stage, f"torque(stage, {port})", "a", [0.0])[0] for port in ("first", "second", "housing")]
    assert torques == pytest.approx([1, 4, -3], rel=1e-13)  # second and housing: out of the gear
    assert frf(stage, "torque(shaft)", "a", [0.0]) == pytest.approx([4], rel=1e-13)
    assert frf(stage, "torque(mount)", "a", [0.0]) == pytest.approx([-3], rel=1e-13)
    assert frf(stage, "a", "a", [0.0]) == pytest.approx([16 / K + 9 / (2 * K)], rel=1e-13)


# --- planetary sets and differentials -------------------------------------------------------------------------------

Z = 62 / 28


@pytest.mark.parametrize(
    ("held", "first", "second", "ratio"),
    [
        ("ring", "sun", "carrier", 1 + Z),
        ("carrier", "sun", "ring", -Z),
        ("sun", "ring", "carrier", 1 + 1 / Z),
    ],
)
@pytest.mark.parametrize("how", ["ground", "lock"])
def test_planetary_ratios(held, first, second, ratio, how):
    members = {"sun": "sun", "ring": "ring", "carrier": "carrier"}
    lock = [tn.Lock("brake", held)] if how == "lock" else []
    if how == "ground":
        members[held] = "ground"
    stage = train(
        tn.Planetary("set", **members, teeth=(28, 62)),
        tn.Inertia("in", first, J1),
        tn.Inertia("out", second, J2),
        *lock,
    )
    f = [5.0]
    angles = frf(stage, first, first, f) / frf(stage, second, first, f)
    assert angles == pytest.approx([ratio], rel=1e-13)
    assert frf(stage, first, first, f) == pytest.approx([1 / ((J1 + J2 / ratio**2) * (10j * pi) ** 2)], rel=1e-13)
    assert stage.modes().kinds == ("rigid body",)
    if how == "ground":
        assert stage.ratio_between(first, second) == pytest.approx(ratio, rel=1e-14)


def test_planetary_torques():
    """Carrier out (1 + z) T_sun, ring held by z T_sun."""
    stage = train(
        tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=Z),
        tn.Lock("brake", "r"),
        tn.Inertia("rotor", "s", J1),
        tn.Spring("shaft", ("c", "ground"), K),
    )
    assert frf(stage, "torque(shaft)", "s", [0.0]) == pytest.approx([1 + Z], rel=1e-13)
    assert frf(stage, "torque(brake)", "s", [0.0]) == pytest.approx([-Z], rel=1e-13)


def test_planets_count_with_their_spin_and_their_orbit():
    """Ring held: the planet turns at -(z + 1)/(z - 1) of the carrier's speed, relative -2 z/(z - 1)."""
    z, planets, J_p, m_p, r = 3.0, 4, 0.002, 1.3, 0.09
    stage = train(
        tn.Planetary(
            "set",
            sun="s",
            ring="ground",
            carrier="c",
            ratio=z,
            planets=planets,
            planet_inertia=J_p,
            planet_mass=m_p,
            orbit_radius=r,
        ),
        tn.Inertia("sun", "s", 0.01),
        tn.Inertia("carrier", "c", 0.4),
    )
    planet_speed = 1 - 2 * z / (z - 1)  # planet of z_p = (z_ring - z_sun)/2 rolling inside a ring that stands
    total = 0.4 + 0.01 * (1 + z) ** 2 + planets * (J_p * planet_speed**2 + m_p * r**2)
    assert frf(stage, "c", "c", [3.0]) == pytest.approx([1 / (total * (6j * pi) ** 2)], rel=1e-13)


def test_compliant_planetary_is_a_spring_at_the_sun():
    stage = train(
        tn.Planetary("set", sun="s", ring="ground", carrier="c", ratio=Z, stiffness=K, damping=C),
        tn.Inertia("sun", "s", J1),
        tn.Inertia("carrier", "c", J2),
    )
    reduced = 1 / (1 / J1 + (1 + Z) ** 2 / J2)
    modes = stage.modes()
    assert modes.natural_frequencies[1] == pytest.approx(sqrt(K / reduced) / (2 * pi), rel=1e-12)


def test_open_differential_shares_the_torque_and_adds_the_speeds():
    axle = train(
        tn.Inertia("ring", "cage", J1),
        tn.Differential("axle", cage="cage", left="l", right="r"),
        tn.Inertia("left", "l", J2),
        tn.Inertia("right", "r", 3 * J2),
    )
    s = S[1:]
    # q = (l, r): cage = (l + r)/2
    a, b = J1 / 4 + J2, J1 / 4 + 3 * J2
    determinant = (a * b - (J1 / 4) ** 2) * s**2
    left, right = (3 * J2 / 2) / determinant, (J2 / 2) / determinant
    assert frf(axle, "l", "cage", F[1:]) == pytest.approx(left, rel=1e-12)
    assert frf(axle, "r", "cage", F[1:]) == pytest.approx(right, rel=1e-12)
    assert frf(axle, "cage", "cage", F[1:]) == pytest.approx((left + right) / 2, rel=1e-12)
    assert axle.modes().kinds == ("rigid body", "rigid body")
    torque = frf(axle, "torque(axle)", "cage", F[1:])
    assert frf(axle, "torque(axle, left)", "cage", F[1:]) == pytest.approx(torque / 2, rel=1e-13)
    assert torque == pytest.approx(2 * J2 * s**2 * left, rel=1e-12)


def test_locked_differential_turns_as_one():
    axle = train(
        tn.Inertia("ring", "cage", J1),
        tn.Differential("axle", cage="cage", left="l", right="r", locked=True),
        tn.Inertia("left", "l", J2),
        tn.Inertia("right", "r", 3 * J2),
    )
    total = J1 + 4 * J2
    assert frf(axle, "l", "r", F[1:]) == pytest.approx(1 / (total * S[1:] ** 2), rel=1e-13)
    assert frf(axle, "torque(axle, left)", "cage", F[1:]) == pytest.approx(np.full(5, J2 / total), rel=1e-12)


# --- frequency-dependent laws ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("eta", [0.001, 0.05, 0.3, 1.2])
def test_hysteretic_mass(eta):
    """J lambda^2 + k (1 + j eta) = 0: lambda = j omega_0 sqrt(1 + j eta); in the FRF the lag at 0 Hz stays."""
    drivetrain = train(tn.Inertia("disc", "a", J1), tn.HystereticSpring("rubber", ("a", "ground"), K, loss_factor=eta))
    modes = drivetrain.modes()
    exact = 1j * sqrt(K / J1) * np.sqrt(1 + 1j * eta)
    assert modes.eigenvalues == pytest.approx([exact], rel=1e-12)
    assert modes.damping_ratios == pytest.approx([-exact.real / abs(exact)], rel=1e-11)
    assert modes.natural_frequencies == pytest.approx([abs(exact) / (2 * pi)], rel=1e-12)
    assert modes.converged.all()
    expected = 1 / (J1 * S**2 + K * (1 + 1j * eta))
    assert frf(drivetrain, "a", "a") == pytest.approx(expected, rel=1e-13)


def test_constant_table_is_a_spring_with_a_damper():
    tabulated = train(
        tn.Inertia("disc", "a", J1), tn.TabulatedSpring("bush", ("a", "ground"), [[1, K, C], [10, K, C], [500, K, C]])
    )
    assert frf(tabulated, "a", "a") == pytest.approx(1 / (J1 * S**2 + C * S + K), rel=1e-13)


@pytest.mark.parametrize("c", [C, 80.0])
def test_poles_of_a_constant_table_are_those_of_spring_and_damper(c):
    """J s^2 + c s + k = 0, also overdamped; the shares of energies are those of the spring, too."""
    table = train(tn.Inertia("disc", "a", J1), tn.TabulatedSpring("bush", ("a", "ground"), [[1, K, c], [9, K, c]]))
    spring = train(tn.Inertia("disc", "a", J1), tn.Spring("bush", ("a", "ground"), K, damping=c))
    modes, expected = table.modes(), spring.modes()
    roots = np.roots([J1, c, K])
    assert np.sort_complex(modes.eigenvalues) == pytest.approx(np.sort_complex(roots[roots.imag >= 0]), rel=1e-13)
    assert modes.kinds == expected.kinds
    np.testing.assert_allclose(modes.dissipated, expected.dissipated, rtol=1e-13)
    assert modes.converged.all()


def test_table_is_interpolated_linearly_and_held_outside():
    table = [[2, 400, 2], [20, 500, 1.1]]
    bush = train(tn.TabulatedSpring("bush", ("a", "ground"), table))
    f = np.array([0.5, 2.0, 11.0, 20.0, 90.0])
    k, c = np.array([400, 400, 450, 500, 500]), np.array([2, 2, 1.55, 1.1, 1.1])
    assert 1 / frf(bush, "a", "a", f) == pytest.approx(k + 2j * pi * f * c, rel=1e-13)


# --- damping measures -----------------------------------------------------------------------------------------------

OMEGA = sqrt(K / J1)


@pytest.mark.parametrize(
    ("measure", "zeta"),
    [
        ({"zeta": 0.03}, 0.03),
        ({"Q": 20}, 1 / 40),
        ({"magnifier": 20}, 1 / 40),
        ({"eta": 0.08}, 0.04),
        ({"psi": 0.6}, 0.6 / (4 * pi)),
        ({"log_decrement": 0.2}, 0.2 / sqrt(4 * pi**2 + 0.2**2)),
        ({"c": 0.9}, 0.9 / (2 * sqrt(K * J1))),
    ],
)
def test_damping_measure_at_the_natural_frequency_is_that_damping_ratio(measure, zeta):
    spring = tn.Spring("shaft", ("a", "ground"), K, damping={**measure, "at": f"{OMEGA / (2 * pi)!r} Hz"})
    modes = train(tn.Inertia("disc", "a", J1), spring).modes()
    assert modes.damping_ratios == pytest.approx([zeta], rel=1e-12)


def test_logarithmic_decrement_is_the_decay_of_one_period():
    spring = tn.Spring("shaft", ("a", "ground"), K, damping={"log_decrement": 0.7, "at": OMEGA / (2 * pi)})
    lam = train(tn.Inertia("disc", "a", J1), spring).modes().eigenvalues[0]
    period = 2 * pi / lam.imag
    assert log(1 / exp(lam.real * period)) == pytest.approx(0.7, rel=1e-11)


def test_relative_damping_is_the_energy_lost_per_cycle():
    """psi = loss of a cycle / (k phi^2 / 2): the work of the torque over one cycle, phi = 1 rad."""
    psi, f = 0.6, 8.0
    spring = train(tn.Spring("shaft", ("a", "ground"), K, damping={"psi": psi, "at": "8 Hz"}))
    torque = 1 / frf(spring, "a", "a", [f])[0]
    assert pi * torque.imag / (K / 2) == pytest.approx(psi, rel=1e-12)
    hysteretic = train(tn.HystereticSpring("shaft", ("a", "ground"), K, loss_factor={"psi": psi}))
    for other in (0.1, 8.0, 300.0):
        assert pi * (1 / frf(hysteretic, "a", "a", [other])[0]).imag / (K / 2) == pytest.approx(psi, rel=1e-12)


# --- shafts ---------------------------------------------------------------------------------------------------------

D, d, L, G, RHO = 0.07, 0.03, 1.5, 80e9, 7850.0
POLAR = pi * (D**4 - d**4) / 32


def shaft(segments=1, inertia="consistent", nodes=("a", "b"), **more):
    return tn.Shaft(
        "shaft",
        nodes,
        outer_diameter=D,
        inner_diameter=d,
        length=L,
        shear_modulus=G,
        density=RHO,
        segments=segments,
        inertia=inertia,
        **more,
    )


@pytest.mark.parametrize("segments", [1, 4])
def test_stiffness_and_inertia_of_a_hollow_shaft(segments):
    held = train(shaft(segments, nodes=("a", "ground"), damping=12.0))
    assert frf(held, "a", "a", [0.0]) == pytest.approx([L / (G * POLAR)], rel=1e-12)
    for inertia in ("consistent", "lumped"):
        slow = frf(train(shaft(segments, inertia)), "a", "a", [1.0])
        assert slow == pytest.approx([1 / (RHO * POLAR * L * (2j * pi) ** 2)], rel=1e-5)
    weightless = train(shaft(segments, "none", nodes=("a", "ground"), damping=12.0))
    assert frf(weightless, "a", "a") == pytest.approx(1 / (G * POLAR / L + 12 * S), rel=1e-11)


def test_free_shaft_at_a_millihertz_is_its_inertia():
    slow = frf(train(shaft(4)), "a", "a", [1e-3])
    assert slow == pytest.approx([1 / (RHO * POLAR * L * (2e-3j * pi) ** 2)], rel=1e-9)


def test_solid_shaft_from_quantities_in_other_units():
    bar = tn.Shaft(
        "bar", ("a", "ground"), outer_diameter="2 in", length="1 ft", shear_modulus="11.5e6 psi", inertia="none"
    )
    k = 11.5e6 * (0.45359237 * 9.80665 / 0.0254**2) * pi * 0.0508**4 / 32 / 0.3048
    assert frf(train(bar), "a", "a", [0.0]) == pytest.approx([1 / k], rel=1e-12)


@pytest.mark.parametrize(
    ("nodes", "waves"), [(("a", "b"), [1, 2, 3]), (("a", "ground"), [0.5, 1.5, 2.5])], ids=["free", "clamped"]
)
def test_segments_converge_to_the_continuum_lumped_from_below_consistent_from_above(nodes, waves):
    exact = np.array(waves) * sqrt(G / RHO) / (2 * L)  # f = m c / 2L
    errors = {}
    for inertia, sign in (("lumped", -1), ("consistent", 1)):
        for n in (8, 16, 32):
            found = train(shaft(n, inertia, nodes)).modes().undamped_natural_frequencies
            found = found[found > 1e-3][: len(waves)]
            errors[inertia, n] = sign * (found - exact) / exact
            assert np.all(errors[inertia, n] > 0)
        for coarse, fine in ((8, 16), (16, 32)):
            order = np.log2(errors[inertia, coarse] / errors[inertia, fine])
            assert order == pytest.approx([2, 2, 2], abs=0.1)


@pytest.mark.parametrize("inertia", ["lumped", "consistent"])
def test_frequencies_of_n_segments_exactly(inertia):
    """Free shaft of n segments: 2 n c/L sin(m pi/2n) lumped; consistent the same over sqrt((2 + cos(m pi/n))/3)."""
    n, c = 6, sqrt(G / RHO)
    found = train(shaft(n, inertia)).modes().undamped_natural_frequencies
    m = np.arange(n + 1)
    expected = 2 * n * c / L * np.sin(m * pi / (2 * n)) / (2 * pi)
    if inertia == "consistent":
        expected = expected / np.sqrt((2 + np.cos(m * pi / n)) / 3)
    assert found == pytest.approx(expected, rel=1e-11, abs=1e-9)


def test_response_of_a_shaft_approaches_that_of_the_continuum():
    """Clamped-free: theta(end)/T = tan(omega L/c) / (omega sqrt(G rho) I_p)."""
    f, c = 300.0, sqrt(G / RHO)
    omega = 2 * pi * f
    exact = tan(omega * L / c) / (omega * sqrt(G * RHO) * POLAR)
    errors = [abs(frf(train(shaft(n, nodes=("a", "ground"))), "a", "a", [f])[0] / exact - 1) for n in (10, 20, 40)]
    assert errors[2] < 1e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.1)
