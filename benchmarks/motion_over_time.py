"""Times of a motion with clearances against LSODA with a compiled right side, both at an error of 1e-6 after 1 s.

python -m benchmarks.motion_over_time

A chain of 20 inertias with two clearances rattles for 60 s under a torque that rises and falls in straight lines. LSODA
of scipy gets the loosest tolerances that bring it to an error of 1e-6 of the largest angle after 1 s, found by halves
of decades; the answer that both are compared with is LSODA's own at the tightest tolerances. Longer motions of such
plants are chaotic: after 60 s no two programs agree. One thread; processor time.
"""

import time
from unittest.mock import patch

import numpy as np
from numba import njit
from scipy.integrate import odeint

import torsionnet as tn
from benchmarks._sizes import sized
from torsionnet.motion.marching import march

N, SECONDS, RATE = 20, sized(60, 2), 1000
GAPS = (6, 13)
J, K, C = 0.1, 2e4, 2.0
GAP, CONTACT, CONTACT_DAMPING = 0.01, 5e4, 5.0
FOOT, FOOT_DAMPING = 2e3, 5.0
MEAN, SWING, PERIOD = 40.0, 90.0, 0.1
REACHED = 1e-6
ROUNDS = sized(3, 1)


def plant():
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=J) for i in range(N)]
    for i in range(N - 1):
        nodes = (f"n{i}", f"n{i + 1}")
        if i in GAPS:
            elements.append(tn.Clearance(f"e{i}", nodes=nodes, gap=GAP, stiffness=CONTACT, damping=CONTACT_DAMPING))
        else:
            elements.append(tn.Spring(f"e{i}", nodes=nodes, stiffness=K, damping=C))
    elements.append(tn.Spring("foot", nodes=(f"n{N - 1}", "ground"), stiffness=FOOT, damping=FOOT_DAMPING))
    return tn.Drivetrain("rattling chain", elements, inputs={"T": {"torque": "n0"}})


def torques(times):
    phase = np.mod(times / PERIOD, 1)
    return MEAN + SWING * (4 * np.abs(phase - 0.5) - 1)


@njit
def rates(y, t):
    found = np.zeros(2 * N)
    phase = (t / PERIOD) % 1.0
    push = np.zeros(N)
    push[0] = MEAN + SWING * (4 * abs(phase - 0.5) - 1)
    for i in range(N - 1):
        twist, rate = y[i] - y[i + 1], y[N + i] - y[N + i + 1]
        if i == GAPS[0] or i == GAPS[1]:
            torque = 0.0
            if twist > GAP / 2:
                torque = max(0.0, CONTACT * (twist - GAP / 2) + CONTACT_DAMPING * rate)
            elif twist < -GAP / 2:
                torque = min(0.0, CONTACT * (twist + GAP / 2) + CONTACT_DAMPING * rate)
        else:
            torque = K * twist + C * rate
        push[i] -= torque
        push[i + 1] += torque
    push[N - 1] -= FOOT * y[N - 1] + FOOT_DAMPING * y[2 * N - 1]
    for i in range(N):
        found[i] = y[N + i]
        found[N + i] = push[i] / J
    return found


def by_lsoda(seconds, tolerance):
    times = np.arange(seconds * RATE + 1) / RATE
    began = time.process_time()
    motion = odeint(rates, np.zeros(2 * N), times, rtol=tolerance, atol=tolerance * 1e-2, mxstep=1_000_000)
    return time.process_time() - began, motion[:, :N]


def by_us(chain, seconds):
    times = np.arange(seconds * RATE + 1) / RATE
    outputs = [f"angle(n{i})" for i in range(N)]
    torque = torques(times)
    began = time.process_time()
    record = chain.simulate(outputs, {"T": torque}, RATE)
    took = time.process_time() - began
    return took, np.array([record[name].values for name in outputs]).T, len(record.events)


def least(work):
    return min((work() for _ in range(ROUNDS)), key=lambda found: found[0])


def main():
    chain = plant()
    exact = by_lsoda(1, 1e-12)[1]
    scale = np.abs(exact).max()

    def error(motion):
        return np.abs(motion[RATE] - exact[RATE]).max() / scale

    for tolerance in 10 ** -np.arange(4, 12.1, 0.5):
        if error(by_lsoda(1, tolerance)[1]) <= REACHED:
            break
    lsoda = least(lambda: by_lsoda(SECONDS, tolerance))
    rows = [("LSODA, compiled right side", lsoda[0], error(lsoda[1]), "", "")]
    by_us(chain, SECONDS)  # compiles
    whole = least(lambda: by_us(chain, SECONDS))
    with patch("torsionnet.motion.piece_system._compiled_march", lambda: march):
        plain = least(lambda: by_us(chain, SECONDS))
    for name, (took, motion, _), goal in (("here, numba", whole, ">= 40"), ("here, numpy", plain, ">= 3")):
        rows.append((name, took, error(motion), f"{lsoda[0] / took:.1f}", goal))
    print(
        f"{N} DOF, 2 clearances, {SECONDS} s, {whole[2]} events; LSODA: rtol {tolerance:.1e}, atol a hundredth of it\n"
    )
    print("| work | CPU s | error after 1 s | ratio | goal |\n|---|---|---|---|---|")
    for name, took, apart, ratio, goal in rows:
        print(f"| {name} | {took:.2f} | {apart:.0e} | {ratio} | {goal} |")


if __name__ == "__main__":
    main()
