"""A fan, a campaign of two steady points with it, and their records, from the two inertias written out."""

import numpy as np

from torsionnet.io import write_recording
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel

STEADY_FAN = """
torsionnet: 1
name: fan
elements:
  rotor: {type: inertia, node: motor, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [motor, fan], stiffness: 20 kN*m/rad, damping: 40 N*m*s/rad}
  fan: {type: inertia, node: fan, inertia: 3 kg*m^2}
sensors: {T: {torque: shaft}}
speeds: {of: motor, range: 500..1500 rpm, step: 20 rpm}
excitations:
  blades: {type: harmonic, node: fan, orders: {3: {amplitude: 50 N*m, phase: 0 deg}}}
configurations: {blades: {clean: {}, dirty: {blades.orders: {3: {amplitude: 80 N*m, phase: 0 deg}}}}}
"""
CAMPAIGN = """
torsionnet: 1
name: two steady points
model: fan.yaml
wheels: {wheel: {teeth: 60}}
phase: {index: mark, tdc: 0 deg}
channels: {T: {gain: 2}}
records:
  first: {file: first.npz, configuration: clean}
  again: {file: again.npz, configuration: clean}
orders: {tracked: "1:4:1", cycle: 1, cycles: 10}
"""
RATE, TURNS, SPEED = 2000, 120, 100.0


def torque(speed):
    """Complex order 3 of the torque in the shaft at a steady speed in rad/s, from the two inertias written out."""
    s = 3j * speed
    stiffness = np.array([[20e3 + 40 * s, -20e3 - 40 * s], [-20e3 - 40 * s, 20e3 + 40 * s]])
    angles = np.linalg.solve(stiffness + s**2 * np.diag([2, 3]), [0, 50])
    return (20e3 + 40 * s) * (angles[0] - angles[1])


def write_steady_record(path, seed, order_3):
    """Record of a wheel of 60 teeth without vibration, a mark at angle 0, and half of the torque with noise."""
    time = np.arange(int(RATE * TURNS * 2 * np.pi / SPEED)) / RATE
    noise = np.random.default_rng(seed).normal(scale=0.5, size=len(time))
    values = np.real(order_3 * np.exp(3j * SPEED * time)) / 2 + noise
    pulses = (
        PulseChannel("wheel", np.arange(1, 60 * TURNS) * 2 * np.pi / 60 / SPEED),
        PulseChannel("mark", np.arange(1, TURNS) * 2 * np.pi / SPEED),
    )
    write_recording(Recording((Signal("T", "torque", values),), sampling_rate=RATE, pulses=pulses), path)
