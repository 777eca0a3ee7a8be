"""Transfer functions (H1, H2, Hs, Hr) and coherences from arrays of auto and cross spectral densities.

All follow scipy's convention ``S_ab = mean(conj(A) B)``. With ``y = H x`` that gives ``S_xy = S_xx H^T`` and
``S_yy = S_yx H^T``, hence ``H1 = S_xy / S_xx`` and ``H2 = S_yy / S_yx``. ``S_yy / S_xy`` has the phase of the opposite
sign.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

ComplexArray = NDArray[np.complex128]


def h1(s_xx: ComplexArray, s_xy: ComplexArray) -> ComplexArray:
    """Transfer functions by H1, (n_f, n_out, n_in), least squares on the outputs, unbiased if only these are noisy."""
    if s_xx.shape[1] == 1:
        return _quotient(s_xy.transpose(0, 2, 1), s_xx)
    return _complex((np.linalg.pinv(s_xx, hermitian=True) @ s_xy).transpose(0, 2, 1))


def h2(s_yy: ComplexArray, s_yx: ComplexArray) -> ComplexArray:
    """Transfer functions by H2, (n_f, n_out, n_in), least squares on the inputs, unbiased if only these are noisy.

    It needs as many outputs as inputs, or more.
    """
    if s_yx.shape[2] == 1:
        return _quotient(np.einsum("foo->fo", s_yy)[:, :, None], s_yx)
    return _complex((np.linalg.pinv(s_yx) @ s_yy).transpose(0, 2, 1))


def hr(s_rx: ComplexArray, s_ry: ComplexArray) -> ComplexArray:
    """Transfer functions by Hr, (n_f, n_out, n_in), from references without the noise of inputs and outputs.

    It needs as many references as inputs, or more: ``S_ry = S_rx H^T``, by least squares. The method of instrumental
    variables; see Schoukens, Godfrey and Schoukens (2018), IEEE Control Systems 38(4), on noisy inputs.
    """
    if s_rx.shape[1] == s_rx.shape[2] == 1:
        return _quotient(s_ry.transpose(0, 2, 1), s_rx)
    return _complex((np.linalg.pinv(s_rx) @ s_ry).transpose(0, 2, 1))


def unexplained_spectra(H: ComplexArray, s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray) -> FloatArray:
    """Spectral densities (n_f, n_out) of outputs minus their prediction by H (n_f, n_out, n_in) from the inputs."""
    crossed = np.einsum("foi,fio->fo", H.conj(), s_xy).real
    passed = np.einsum("foi,fij,foj->fo", H.conj(), s_xx, H).real
    return np.asarray(np.maximum(np.einsum("foo->fo", s_yy).real - 2 * crossed + passed, 0.0))


def hs(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray, noise_ratio: float | FloatArray) -> ComplexArray:
    """Transfer functions by Hs, (n_f, n_out, n_in), total least squares for each output, noise on both sides.

    ``noise_ratio`` is the spectral density of the output's noise over that of each input's noise, a number or
    (n_f, n_out): towards infinity the result becomes H1, towards zero H2.
    """
    ratio = np.broadcast_to(noise_ratio, (len(s_xx), s_xy.shape[2])).astype(np.float64)
    columns = []
    for o in range(s_xy.shape[2]):
        column = _hs_single if s_xx.shape[1] == 1 else _hs_several
        columns.append(column(s_xx, s_xy[:, :, o], s_yy[:, o, o].real, ratio[:, o]))
    return np.stack(columns, axis=1)


def _hs_single(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: FloatArray, ratio: FloatArray) -> ComplexArray:
    gap = ratio * s_xx[:, 0, 0].real - s_yy
    root = np.hypot(gap, 2 * np.sqrt(ratio) * np.abs(s_xy[:, 0]))
    # Two forms of one root; either cancels where the other does not.
    from_input = _quotient(2 * ratio * s_xy[:, 0], gap + root)
    from_output = _quotient(root - gap, 2 * s_xy[:, 0].conj())
    return _complex(np.where(gap >= 0, from_input, from_output)[:, None])


def _hs_several(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: FloatArray, ratio: FloatArray) -> ComplexArray:
    scaled = (s_xy / np.sqrt(ratio)[:, None])[:, :, None]
    below = np.concatenate([scaled.conj().transpose(0, 2, 1), (s_yy / ratio)[:, None, None]], axis=2)
    joint = np.concatenate([np.concatenate([s_xx, scaled], axis=2), below], axis=1)
    smallest = np.linalg.eigh(joint).eigenvectors[:, :, 0]
    return _quotient(-np.sqrt(ratio)[:, None] * smallest[:, :-1], smallest[:, -1:])


def ordinary_coherence(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray) -> FloatArray:
    """Ordinary coherence, the share of each output's power that is linear in one input alone, (n_f, n_out, n_in)."""
    inputs, outputs = np.einsum("fii->fi", s_xx).real, np.einsum("foo->fo", s_yy).real
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((np.abs(s_xy) ** 2 / inputs[:, :, None] / outputs[:, None, :]).transpose(0, 2, 1))


def multiple_coherence(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray) -> FloatArray:
    """Multiple coherence, the share of each output's power that is linear in all inputs together, (n_f, n_out)."""
    explained = np.einsum("fio,foi->fo", s_xy.conj(), h1(s_xx, s_xy)).real
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(explained / np.einsum("foo->fo", s_yy).real)


def independence(s_xx: ComplexArray) -> FloatArray:
    """Smallest eigenvalue of the normalised input spectra, (n_f,), from 1 (uncorrelated) to 0 (inseparable)."""
    sizes = np.sqrt(np.einsum("fii->fi", s_xx).real)
    scaled = np.divide(s_xx, sizes[:, :, None] * sizes[:, None, :], out=np.zeros_like(s_xx), where=s_xx != 0)
    return np.asarray(np.linalg.eigvalsh(scaled)[:, 0])


def _quotient(above: ComplexArray | FloatArray, below: ComplexArray | FloatArray) -> ComplexArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return _complex(above / below)


def _complex(values: NDArray[np.generic]) -> ComplexArray:
    return np.asarray(values, dtype=np.complex128)
