"""Times of periodic motions against LSODA over 100 periods, and of a Newton step against one on all degrees of freedom.

python -m benchmarks.periodic_motion

The driveline of the how-to on booms at 300 speeds, with all branches, folds, doublings and stability; LSODA of scipy at
a relative tolerance of 1e-8 steps 100 periods of each, stopped at every corner of the flywheel. Then a chain of 20
inertias with two springs in stages: one Newton step of the condensed balance, and one of the same balance on all
coordinates, with the same torques by FFT. One thread; processor time.
"""

import time

import numpy as np
from scipy.integrate import solve_ivp

import torsionnet as tn
from benchmarks._sizes import sized
from torsionnet.base.threads import one_thread
from torsionnet.model.channels import Input
from torsionnet.motion.periodic.all_branches import from_rest
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.periodic_problem import PeriodicDrive, PeriodicProblem, packed

POINTS, STEPPED, PERIODS = sized(300, 20), sized(12, 2), sized(100, 3)
SPEEDS = np.linspace(1000, 3000, POINTS) * np.pi / 30
J = np.array([0.16, 0.055, 0.018, 4.2])
FIRST, SECOND, CORNER = 900.0, 9000.0, 0.08
N, HARMONICS, REPEATS = 20, 32, sized(10, 2)


def car():
    stages = [{"stiffness": FIRST, "to": f"{CORNER} rad"}, {"stiffness": SECOND}]
    gas = {"type": "harmonic", "node": "engine", "orders": {2: {"amplitude": 300}, 4: {"amplitude": 60}}}
    elements = [tn.Inertia(name, node=name, inertia=size) for name, size in zip("abcd", J, strict=True)]
    elements[0] = tn.Inertia("a", node="engine", inertia=J[0])
    elements += [
        tn.Spring("dmf", nodes=("engine", "b"), stages=stages, damping=1.2),
        tn.Spring("shaft", nodes=("b", "c"), stiffness=9000, damping=0.6),
        tn.Spring("driveshaft", nodes=("c", "d"), stiffness=420, damping=2.5),
    ]
    means = {"torque": {"engine": "60 N*m", "d": "-60 N*m"}}
    return tn.Drivetrain("car", elements, excitations={"gas": gas}, operating_point=means)


def stepped(speed):
    """Seconds that LSODA takes for 100 periods of order 2 at a speed, from corner to corner of the flywheel."""
    k = np.array([0.0, 9000.0, 420.0])
    c = np.array([1.2, 0.6, 2.5])

    def rates(t, y, stage):
        twist, rate = y[:3] - y[1:4], y[4:7] - y[5:8]
        torque = k * twist + c * rate
        torque[0] += FIRST * twist[0] if not stage else SECOND * (twist[0] - stage * CORNER) + stage * FIRST * CORNER
        push = np.zeros(4)
        push[:3] -= torque
        push[1:] += torque
        push[0] += 60 + 300 * np.cos(2 * speed * t) + 60 * np.cos(4 * speed * t)
        push[3] -= 60
        return np.concatenate([y[4:], push / J])

    def corner(side, direction):
        def passed(*state):
            return state[1][0] - state[1][1] - side * CORNER

        passed.terminal, passed.direction = True, direction
        return passed

    # from a stage only its own corners, in the sense in which they are passed
    events = {0: [corner(1, 1), corner(-1, -1)], 1: [corner(1, -1)], -1: [corner(-1, 1)]}
    began, t, y, stage = time.process_time(), 0.0, np.zeros(8), 0
    end = PERIODS * np.pi / speed
    while t < end:
        found = solve_ivp(rates, (t, end), y, "LSODA", events=events[stage], args=(stage,), rtol=1e-8, atol=1e-10)
        t, y = found.t[-1], found.y[:, -1]
        if found.status == 1:
            stage = 0 if stage else (1 if len(found.t_events[0]) else -1)
    return time.process_time() - began


def chain():
    """Problem of a chain of 20 inertias with two springs in stages."""
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=0.1) for i in range(N)]
    for i in range(N):
        nodes = (f"n{i}", f"n{i + 1}" if i + 1 < N else "ground")
        stages = [{"stiffness": 2000, "to": "0.01 rad"}, {"stiffness": 20000}]
        law = {"stages": stages} if i in (6, 13) else {"stiffness": 2e4}
        elements.append(tn.Spring(f"k{i}", nodes=nodes, damping=4.0, **law))
    plant = CondensedPlant(tn.Drivetrain("chain", elements), [Input("torque", "n0")])
    loads = np.array([[10.0], [60.0]], dtype=complex)
    return PeriodicProblem(plant, PeriodicDrive(lambda p: 2 * np.pi * p, lambda _: loads), 12.0)


def full_step(problem, x, omega, D):
    """Newton step of the balance on all coordinates, real and imaginary parts of all harmonics at once."""
    plant, H = problem.plant, HARMONICS
    balance = problem.balance(omega / (2 * np.pi), H)
    _, answers, _ = balance.residual(x)
    n_q = plant.rows.shape[1]
    parts = n_q * (2 * H + 1)
    jacobian = np.zeros((2 * H + 1, n_q, 2 * H + 1, n_q))
    k = np.arange(1, H + 1)
    jacobian[0, :, 0] = D[0].real
    jacobian[k, :, k], jacobian[k, :, H + k] = D[1:].real, -D[1:].imag
    jacobian[H + k, :, k], jacobian[H + k, :, H + k] = D[1:].imag, D[1:].real
    for m, answer in enumerate(answers):
        change = balance.change(answer)
        rows = np.concatenate([change.real, change.imag[1:]]) - plant.references[m] * np.eye(2 * H + 1)
        jacobian += np.einsum("kn,i,j->kinj", rows, plant.rows[m], plant.rows[m])
    return np.linalg.solve(jacobian.reshape(parts, parts), np.ones(parts))


def step(problem, x, omega):
    balance = problem.balance(omega / (2 * np.pi), HARMONICS)
    left, answers, _ = balance.residual(x)
    return np.linalg.solve(balance.slopes(answers), packed(left))


def seconds(work):
    work()
    began = time.process_time()
    for _ in range(REPEATS):
        work()
    return (time.process_time() - began) / REPEATS


def main():
    with one_thread():
        began = time.process_time()
        found = car().periodic_response("twist(dmf)", speeds=SPEEDS, speed_of="engine")
        ours = time.process_time() - began
        theirs = np.mean([stepped(speed) for speed in SPEEDS[:: max(1, POINTS // STEPPED)]]) * POINTS
        print(f"{POINTS} speeds, {len(found.motions)} motions with stability: {ours:.2f} s")
        print(f"LSODA over {PERIODS} periods of each: {theirs:.1f} s, {theirs / ours:.1f} times as long")
        problem = chain()
        x, omega = next(iter(from_rest(problem, 12.0))).x[: HARMONICS + 1], 2 * np.pi * 12.0
        if len(x) <= HARMONICS:
            x = np.vstack([x, np.zeros((HARMONICS + 1 - len(x), x.shape[1]))])
        D = problem.plant.stiffness(1j * omega * np.arange(HARMONICS + 1))
        small, large = seconds(lambda: step(problem, x, omega)), seconds(lambda: full_step(problem, x, omega, D))
        print(f"Newton step of {N} inertias, {HARMONICS} harmonics: {1e3 * small:.2f} ms, on all coordinates")
        print(f"{1e3 * large:.0f} ms, {large / small:.0f} times as long")


if __name__ == "__main__":
    main()
