"""Times of a simulation against scipy.signal.lsim: 80 s at 10 kHz of the AMT rig in fifth gear, chirp torque."""

import time

import numpy as np
from scipy.signal import lsim

import torsionnet as tn
from benchmarks._sizes import sized
from torsionnet.signals import LinearChirp

RATE = 10e3
SECONDS = sized(80, 2)


def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def main():
    rig = tn.load("amt_rig").configured("V")
    torque = LinearChirp(start=0.1, stop=80, duration=SECONDS, amplitude=15).samples(RATE)
    outputs, system = ["theta_1", "T_T"], rig.to_control()
    rig.simulate(outputs, {"T_M": torque[:100]}, RATE)
    ours, record = min(
        (timed(lambda: rig.simulate(outputs, {"T_M": torque}, RATE)) for _ in range(3)), key=lambda x: x[0]
    )
    matrices = (system.A, system.B, system.C, system.D)
    theirs, (_, motion, _) = timed(lambda: lsim(matrices, torque, np.arange(len(torque)) / RATE))
    apart = max(
        np.abs(record[name].values - values).max() / np.abs(values).max()
        for name, values in zip(outputs, motion.T, strict=True)
    )
    work = f"{SECONDS} s at 10 kHz, AMT rig, 2 outputs"
    print("| work | here, s | lsim, s | ratio | goal | apart |\n|---|---|---|---|---|---|")
    print(f"| {work} | {ours:.2f} | {theirs:.1f} | {theirs / ours:.0f} | >= 8 | {apart:.0e} |")


if __name__ == "__main__":
    main()
