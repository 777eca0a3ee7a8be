"""Published and closed numbers of motions with laws that are not linear, by references that are not the package."""

import math

import numpy as np
import pytest
import scipy
from support.motion_reference import reference_motion

import torsionnet as tn


def rotor(*elements, inertia=0.5):
    return tn.Drivetrain("rotor", [tn.Inertia("J", node="a", inertia=inertia), *elements])


def spring(k):
    return tn.Spring("k", nodes=("a", "ground"), stiffness=k)


class TestFreeMotion:
    def test_period_of_duffing(self):
        w0, a, amplitude = 2.0, 3.0, 1.7
        square = w0**2 + a * amplitude**2
        closed = 4 * scipy.special.ellipk(a * amplitude**2 / (2 * square)) / math.sqrt(square)

        def slowness(angle):  # x = A sin(angle)
            return 1 / math.sqrt(w0**2 + a * amplitude**2 * (1 + math.sin(angle) ** 2) / 2)

        by_energy = 4 * scipy.integrate.quad(slowness, 0, math.pi / 2, epsabs=0, epsrel=1e-13)[0]
        found = scipy.integrate.solve_ivp(lambda _, y: (y[1], -(w0**2) * y[0] - a * y[0] ** 3), (0, closed), (amplitude, 0),
                          method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]  # fmt: skip
        assert closed == pytest.approx(1.95465730046, abs=1e-11)
        assert by_energy == pytest.approx(closed, rel=1e-12)
        assert found == pytest.approx([amplitude, 0], abs=1e-10)

    def test_clearance(self):
        v, half = 3.0, 0.1
        plant = rotor(tn.Clearance("gap", nodes=("a", "ground"), gap=2 * half, stiffness=100))
        period = 4 * half / v + 2 * math.pi * math.sqrt(0.5 / 100)
        motion = reference_motion(plant, {}, [0, period, 10 * period], speeds={"a": v})
        assert motion.angle("a") == pytest.approx(0, abs=1e-11)
        assert motion.speed("a") == pytest.approx(v, rel=1e-10)

    def test_coulomb(self):
        plant = rotor(spring(100), tn.Friction("f", nodes=("a", "ground"), torque=2))
        period = 2 * math.pi * math.sqrt(0.5 / 100)
        motion = reference_motion(plant, {}, [0, period, 2 * period, 9 * period], angles={"a": 0.205})
        assert motion.angle("a") == pytest.approx([0.205, 0.125, 0.045, -0.005], abs=1e-11)
        assert motion.speed("a")[-1] == pytest.approx(0, abs=1e-15)
        assert motion.works[-1] == pytest.approx(50 * (0.205**2 - 0.005**2), rel=1e-10)

    def test_jenkins(self):
        """A friction behind a spring, against the equations of its two states written out here."""
        plant = rotor(spring(100), tn.Friction("f", nodes=("a", "ground"), torque=2, stiffness=400))
        motion = reference_motion(plant, {}, [0, 0.3], angles={"a": 0.02})
        t, x, v, slid, sliding = 0.0, 0.02, 0.0, 0.015, True  # the spring carries 2 N m: 400 (0.02 - 0.015)
        while t < 0.3:
            way = math.copysign(1, v) if v else 1.0
            if sliding and v == 0:
                sliding = False  # a turning point
            stiffness, push = (100, -2 * way) if sliding else (500, 400 * slid)
            w, mean = math.sqrt(stiffness / 0.5), push / stiffness
            a, b = x - mean, v / w

            def at(s, w=w, mean=mean, a=a, b=b):
                return mean + a * math.cos(w * s) + b * math.sin(w * s), w * (b * math.cos(w * s) - a * math.sin(w * s))

            grid = np.linspace(0, 0.3 - t, 2001)[1:]
            ends = (lambda s: at(s)[1]) if sliding else (lambda s, slid=slid: abs(400 * (at(s)[0] - slid)) - 2)
            start = np.sign(ends(1e-9))
            last = next((i for i, s in enumerate(grid) if np.sign(ends(s)) != start), None)
            s = (
                grid[-1]
                if last is None
                else scipy.optimize.brentq(ends, grid[last - 1] if last else 1e-9, grid[last], xtol=1e-15)
            )
            t, (x, v) = t + s, at(s)
            if last is None:
                break
            if sliding:
                slid, v = x - 2 * way / 400, 0.0
            sliding = not sliding
        assert len(motion.events) >= 2
        assert (motion.angle("a")[-1], motion.speed("a")[-1]) == pytest.approx((x, v), abs=1e-10)


class TestGearPair:
    """x'' + 0.1 x' + f(x) = 0.1 + 0.032 sin 0.8 t with the dead zone -1 to 1: two stable motions."""

    PLANT = rotor(
        tn.Damper("c", nodes=("a", "ground"), damping=0.1),
        tn.Clearance("mesh", nodes=("a", "ground"), gap=2, stiffness=1),
        inertia=1,
    )

    def extremes(self, angle, speed=0.0):
        period = 2 * math.pi / 0.8
        begin = 40 * period
        times = np.r_[0, np.linspace(begin, begin + period, 4001)]
        motion = reference_motion(
            self.PLANT,
            {"a": lambda t: 0.1 + 0.032 * math.sin(0.8 * t)},
            times,
            angles={"a": angle},
            speeds={"a": speed},
        )
        x = motion.angle("a")[1:]
        assert x[0] == pytest.approx(x[-1], abs=1e-7)
        return parabola(-x), parabola(x)

    @pytest.mark.slow
    def test_in_contact(self):
        low, high = self.extremes(1.1)
        amplitude = 0.032 / math.hypot(1 - 0.64, 0.08)
        assert (-low, high) == pytest.approx((1.1 - amplitude, 1.1 + amplitude), abs=2e-8)
        assert (-low, high) == pytest.approx((1.0132279, 1.1867721), abs=1e-7)  # the issue took the greatest sample

    @pytest.mark.slow
    def test_leaving_contact(self):
        low, high = self.extremes(1.3)
        assert (-low, high) == pytest.approx((0.7615701, 1.3330093), abs=1.2e-7)


def parabola(values):
    """Greatest of samples of a smooth motion over a period, by the parabola through the greatest three."""
    at = int(np.argmax(values[1:-1])) + 1
    before, here, after = values[at - 1 : at + 2]
    return here + (after - before) ** 2 / (8 * (2 * here - before - after))


class TestDualMassFlywheel:
    """dmf_rig with the stages of the flywheel 460 N m/rad to 0.12 rad, then 1500, under 40 + 60 cos N m."""

    def swing(self, frequency, angle=0.0, speed=0.0, cycles=120):
        rig = dmf_rig()
        period = 1 / frequency
        times = np.r_[0, (cycles + np.linspace(0, 1, 2001)) * period]
        motion = reference_motion(
            rig, {"motor": lambda t: 40 + 60 * math.cos(2 * math.pi * frequency * t)}, times,
            angles={"motor": angle, "primary": angle}, speeds={"motor": speed, "primary": speed},
        )  # fmt: skip
        twist = (motion.angle("primary"))[1:]
        assert twist[0] == pytest.approx(twist[-1], abs=1e-6)
        return parabola(twist) + parabola(-twist)

    @pytest.mark.nightly
    def test_at_10_hz(self):
        assert self.swing(10) == pytest.approx(0.7321389, abs=6e-8)

    @pytest.mark.nightly
    def test_at_11_hz_small(self):
        assert self.swing(11) == pytest.approx(0.2833270, abs=6e-8)

    @pytest.mark.nightly
    def test_at_11_hz_large(self):
        assert self.swing(11, 0.5) == pytest.approx(1.0509184, abs=6e-8)


def dmf_rig():
    """Rig of the library with the two stages of the issue and c_2 = 0.5 N m s/rad, written down again."""
    return tn.Drivetrain(
        "rig",
        [
            tn.Inertia("rotor", node="motor", inertia=0.078),
            tn.Damper("bearing", nodes=("motor", "ground"), damping=0.3),
            tn.Spring("meter", nodes=("motor", "primary"), stiffness=13300, damping=0.1),
            tn.Inertia("flywheel", node="primary", inertia=0.152),
            tn.Damper("support", nodes=("primary", "ground"), damping=0.3),
            tn.Spring(
                "dmf",
                nodes=("primary", "ground"),
                damping=0.5,
                stages=[{"stiffness": 460, "to": "0.12 rad"}, {"stiffness": 1500}],
            ),
        ],
    )


class TestClutch:
    """Inertias 0.25 and 1.2 kg m^2 slip by 250 rad/s under 180 N m."""

    PLANT = tn.Drivetrain(
        "clutch",
        [
            tn.Inertia("engine", node="a", inertia=0.25),
            tn.Inertia("vehicle", node="b", inertia=1.2),
            tn.Friction("clutch", nodes=("a", "b"), torque=180),
        ],
    )

    def locks(self, driving=0.0, braking=0.0):
        torques = {"a": lambda _: driving, "b": lambda _: -braking}
        motion = reference_motion(self.PLANT, torques, [0, 0.6], speeds={"a": 250})
        (time, *_), *others = motion.events
        assert not others
        slip = np.diff(motion.speeds, axis=1)[:, 0]
        assert slip[-1] == pytest.approx(0, abs=1e-10)
        return time, motion.works[-1, 0]

    def test_alone(self):
        time, work = self.locks()
        assert (time, work) == pytest.approx((250 / (180 / 0.25 + 180 / 1.2), 180 * 250 * time / 2), rel=1e-11)
        assert (time, work) == (pytest.approx(0.2873563, abs=5e-8), pytest.approx(6465.517, abs=5e-4))

    def test_driven_and_braked(self):
        time, work = self.locks(60, 20)
        assert (time, work) == pytest.approx((250 / (120 / 0.25 + 160 / 1.2), 180 * 250 * time / 2), rel=1e-11)
        assert (time, work) == (pytest.approx(0.4076087, abs=5e-8), pytest.approx(9171.196, abs=5e-4))


@pytest.mark.slow
def test_stick_slip():
    """J 0.2, k 800, 20 N m sliding, 30 sticking, the face at 0.5 rad/s."""
    w, v = math.sqrt(800 / 0.2), 0.5
    amplitude = math.hypot((30 - 20) / 800, v / w)
    slides = 2 * (math.pi - math.atan((30 - 20) / 800 * w / v)) / w
    sticks = 2 * (30 - 20) / 800 / v
    face = tn.Inertia("face", node="face", inertia=1e10)
    rub = tn.Friction("rub", nodes=("a", "face"), torque=20, stick=30)
    plant = rotor(spring(800), face, rub, inertia=0.2)
    motion = reference_motion(plant, {}, np.linspace(0, 1, 10001), speeds={"face": v})
    times = [time for time, *_ in motion.events]
    assert times[-1] - times[-3] == pytest.approx(slides + sticks, rel=5e-9)
    assert slides + sticks == pytest.approx(0.1175063735, abs=5e-11)
    assert amplitude == pytest.approx(0.0147901995, abs=5e-11)
    assert motion.angle("a").max() == pytest.approx(20 / 800 + amplitude, abs=1e-7)


def test_slips_of_kloss():
    """0.6 of the breakdown torque at a third of the breakdown slip, and at three times where the torque falls."""
    roots = np.roots([0.6, -2, 0.6])  # T = 2 T_k / (s/s_k + s_k/s)
    assert sorted(roots) == pytest.approx([1 / 3, 3], rel=1e-12)
    slope = [2 * (1 - s**2) / (1 + s**2) ** 2 for s in sorted(roots)]
    assert slope[0] > 0 > slope[1]


class TestShortCircuit:
    """Shaft of the first SSR benchmark under air-gap torques of x'' = 0.135 without decay, by a modal sum."""

    H = np.array([0.092897, 0.155589, 0.858670, 0.884215, 0.868495, 0.0342165])
    K = np.array([19.303, 34.929, 52.038, 70.858, 2.822])
    LINE = 2 * math.pi * 60

    def twists(self, amplitudes, times):
        """Twists of the five shafts in electrical rad under -sum_h a_h sin(h w t) pu at the generator, from rest."""
        stiffness = np.zeros((6, 6))
        for place, k in enumerate(self.K):
            row = np.eye(6)[place] - np.eye(6)[place + 1]
            stiffness += k * np.outer(row, row)
        squares, shapes = scipy.linalg.eigh(stiffness, np.diag(2 * self.H / self.LINE))
        total = np.zeros((6, len(times)))
        for square, shape in zip(squares[1:], shapes.T[1:], strict=True):
            w = math.sqrt(square)
            answer = sum(
                a * (w * np.sin(h * self.LINE * times) - h * self.LINE * np.sin(w * times)) / w
                / (square - (h * self.LINE) ** 2)
                for h, a in amplitudes.items()
            )  # fmt: skip
            total += -np.outer(shape * shape[4], answer)
        return -np.diff(total, axis=0)

    def peaks(self, amplitudes):
        torque = self.K[:, None] * self.twists(amplitudes, np.linspace(0, 0.5, 400_001))
        return np.abs(torque).max(axis=1)

    def test_three_phases(self):
        peaks = self.peaks({1: 1 / 0.135})
        assert peaks[[3, 2]] == pytest.approx([3.3568, 2.0078], abs=6e-5)

    def test_two_phases(self):
        peaks = self.peaks({1: 1 / 0.135, 2: -0.5 / 0.135})
        assert peaks[[3, 2]] == pytest.approx([2.8400, 1.5808], abs=6e-5)

    def test_crests(self):
        angle = np.linspace(0, 2 * np.pi, 1_000_001)
        assert (np.sin(angle) - np.sin(2 * angle) / 2).max() == pytest.approx(3 * math.sqrt(3) / 4, abs=1e-10)
        out = 2 * math.pi / 3
        air_gap = 2 * math.sin(out / 2) * np.sin(angle - out / 2) + np.sin(out)
        assert np.abs(np.r_[air_gap]).max() == pytest.approx(3 * math.sqrt(3) / 2, abs=1e-10)
