"""Frequency responses of known poles, written as sums over the poles: nothing of torsionnet.modal is in them."""

import numpy as np

from torsionnet.linear.frequency_response import Channel, FrequencyResponse

S_POWER = {"rad": 0, "rad/s": 1, "rad/s^2": 2}


def pole(hertz, zeta):
    return 2 * np.pi * hertz * (-zeta + 1j * np.sqrt(1 - zeta**2))


def response_of(poles, residues, frequencies, *, output="rad", lower=0.0, upper=0.0, noise=0.0, seed=0, inputs="N*m"):
    """``residues`` (n_poles, n_out, n_in) of the receptance; real poles count once, others with their conjugates."""
    s = (2j * np.pi * np.asarray(frequencies))[:, None, None]
    values = np.zeros((len(frequencies), *np.shape(residues)[1:]), dtype=complex) + upper
    values = values + (lower / s**2 if lower else 0)
    for value, residue in zip(poles, np.asarray(residues), strict=True):
        values = values + residue / (s - value)
        if value.imag:
            values = values + residue.conj() / (s - np.conj(value))
    values = values * s ** S_POWER.get(output, 0)
    rng = np.random.default_rng(seed)
    size = np.sqrt(np.mean(np.abs(values) ** 2, axis=0))
    shape = values.shape
    values = values + noise * size * (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2)
    outputs = tuple(Channel(f"y{o}", output) for o in range(shape[1]))
    drives = tuple(Channel(f"u{i}", inputs) for i in range(shape[2]))
    return FrequencyResponse(np.asarray(frequencies, dtype=float), values, outputs, drives, "test")


def chain_residues(poles, outputs=1, inputs=1, seed=1):
    """Residues of rank one, complex for oscillatory poles and real for real ones; and their shapes."""
    rng = np.random.default_rng(seed)
    count = len(poles)
    shapes = rng.normal(size=(count, outputs)) + 0.2j * rng.normal(size=(count, outputs))
    rows = rng.normal(size=(count, inputs)) + 0.2j * rng.normal(size=(count, inputs))
    factor = np.array([1 / (2j * value.imag) if value.imag else 1 / abs(value) for value in poles])
    real = np.array([value.imag == 0 for value in poles])
    shapes[real], rows[real] = shapes[real].real, rows[real].real
    return shapes[:, :, None] * rows[:, None, :] * factor[:, None, None], shapes.T
