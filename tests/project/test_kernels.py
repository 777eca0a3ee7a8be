"""The processor, the kernels of BLAS and the vector instructions of numpy change no answer but its rounding."""

import sys

import numpy as np
import pytest
from support import kernels
from support.kernel_answers import answers, answers_with

TOLERANCE = 1e-10
"""Of a pole, or of the largest response of a model: rounding moves them by 1e-12, a pole split by rounding by 1e-8."""


def differences(own, other):
    """A line for each model that another kernel answers otherwise."""
    assert own.keys() == other.keys()
    return [name for name, value in own.items() if not same(value, other[name])]


def same(value, other):
    if value.shape != other.shape:
        return False
    if value.dtype.kind == "U":
        return bool(np.all(value == other))
    if value.ndim == 1:  # poles of one size may change places
        apart = np.abs(value[:, None] - other)
        return all(np.all(apart.min(axis) <= TOLERANCE * np.abs(one)) for axis, one in ((1, value), (0, other)))
    return bool(np.all(np.abs(value - other) <= TOLERANCE * np.abs(value).max()))


def lower_kernels():
    try:
        return kernels.all_lower()
    except kernels.NoOtherKernelError as reason:
        pytest.skip(f"no other kernel to try: {reason}")


@pytest.mark.slow
def test_the_lowest_kernel_and_no_vectors_give_the_same_answers():
    environment = {"OPENBLAS_CORETYPE": lower_kernels()[-1]} | kernels.without_vectors()
    assert differences(answers("few"), answers_with("few", environment)) == []


@pytest.mark.nightly
def test_no_lower_kernel_and_no_vectors_change_an_answer():
    own = answers("many")
    environments = [{"OPENBLAS_CORETYPE": kernel} for kernel in lower_kernels()]
    for environment in [*environments, kernels.without_vectors()]:
        assert differences(own, answers_with("many", environment)) == [], environment


def test_what_differs_is_noticed():
    pole = np.array([-1 + 40j, -2 + 60j])
    assert same(pole, pole[::-1] * (1 + 1e-12))
    assert not same(pole, pole * [1, 1 + 1e-8])
    assert not same(pole, pole[:1])
    assert not same(pole, np.array([pole[0], pole[0]]))
    assert not same(np.array(["oscillatory"]), np.array(["real pole"]))
    response = np.ones((2, 2, 1)) * pole[:, None, None]
    assert same(response, response * (1 + 1e-12))
    assert not same(response, response * (1 + 1e-8))
    assert differences({"a": pole, "b": pole}, {"a": pole, "b": -pole}) == ["b"]


class TestChoice:
    @pytest.fixture
    def built_with(self, monkeypatch):
        """What OpenBLAS has: asked for a kernel that it lacks, it takes the processor's own."""

        def set_up(*names):
            monkeypatch.setattr(kernels, "kernel", lambda asked=None: asked if asked in names else names[0])

        return set_up

    @pytest.mark.parametrize(
        ("own", "below"),
        [("SkylakeX", "Haswell"), ("Cooperlake", "Haswell"), ("Zen", "Nehalem"), ("Haswell", "Nehalem")],
    )
    def test_takes_the_next_one_below(self, own, below, built_with):
        built_with(own, "Haswell", "Nehalem")
        assert kernels.lower() == below
        assert kernels.all_lower()[-1] == "Nehalem"

    def test_says_why_there_is_none(self, built_with):
        built_with("neoversen1", "Haswell")
        with pytest.raises(kernels.NoOtherKernelError, match="below the kernel neoversen1 there is none"):
            kernels.lower()
        built_with("Haswell")
        with pytest.raises(kernels.NoOtherKernelError, match="built without the kernel Nehalem"):
            kernels.lower()

    def test_another_blas_is_said(self, monkeypatch):
        monkeypatch.setattr(kernels, "ASK", "print()")
        with pytest.raises(kernels.NoOtherKernelError, match="BLAS is not OpenBLAS"):
            kernels.lower()

    def test_the_kernel_that_is_named_is_used(self):
        for name in lower_kernels():
            assert kernels.kernel(name) == name

    def test_a_command_runs_with_the_next_or_the_lowest(self, capfd, monkeypatch):
        show = "import os; print(os.environ['OPENBLAS_CORETYPE'], 'NPY_DISABLE_CPU_FEATURES' in os.environ)"
        monkeypatch.setattr(kernels, "kernel", lambda asked=None: asked or "SkylakeX")
        assert kernels.main(["next", sys.executable, "-c", show]) == 0
        assert capfd.readouterr().out.endswith("Haswell False\n")
        assert kernels.main(["lowest", sys.executable, "-c", f"{show}; exit(5)"]) == 5
        assert capfd.readouterr().out.endswith("Nehalem True\n")
        monkeypatch.setattr(kernels, "kernel", lambda asked=None: asked or "neoversen1")
        assert kernels.main(["next", sys.executable, "-c", show]) == 0
        assert "below the kernel neoversen1 there is none that is compared" in capfd.readouterr().out
