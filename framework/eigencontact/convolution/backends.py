"""The bare FFTs: pyFFTW where it is installed, scipy.fft otherwise.

A plan is a function of no arguments that transforms one fixed array into another, along the last axis and without
normalisation; it releases the interpreter lock, so plans on different arrays run in parallel threads.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, Protocol

import numpy as np

from eigencontact.core.array_types import Array
from eigencontact.errors import require

__all__ = ["Backend", "backend"]

Plan = Callable[[], Any]


class Backend(Protocol):
    """Maker of plans for one library."""

    name: str

    def forward(self, source: Array, target: Array) -> Plan:
        """Plan of a forward transform, complex, or real ``(n, F)`` to ``(n, F//2 + 1)``; it keeps the source."""

    def inverse(self, source: Array, target: Array) -> Plan:
        """Plan of an inverse transform, complex, or ``(n, F//2 + 1)`` to real ``(n, F)``; destroys the source maybe."""

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        """Array aligned for this library; its values are arbitrary."""


class _FFTW:
    name = "pyfftw"

    def __init__(self, effort: str) -> None:
        self._fftw = _pyfftw()
        # ESTIMATE costs no planning time; on the sizes used here MEASURE gained nothing that pays for its 0.5 s.
        self._flags = {"estimate": ("FFTW_ESTIMATE",), "measure": ("FFTW_MEASURE",)}[effort]

    def _plan(self, source: Array, target: Array, direction: str, *, destroy: bool) -> Plan:
        keep = ("FFTW_DESTROY_INPUT",) if destroy else ()
        # Any planning but ESTIMATE overwrites both arrays; plans are made when the first data are already there.
        saved = None if "FFTW_ESTIMATE" in self._flags else (source.copy(), target.copy())
        plan = self._fftw.FFTW(source, target, axes=(-1,), direction=direction, flags=self._flags + keep, threads=1)
        if saved is not None:
            np.copyto(source, saved[0])
            np.copyto(target, saved[1])
        execute: Plan = plan.execute
        return execute

    def forward(self, source: Array, target: Array) -> Plan:
        return self._plan(source, target, "FFTW_FORWARD", destroy=False)

    def inverse(self, source: Array, target: Array) -> Plan:
        return self._plan(source, target, "FFTW_BACKWARD", destroy=True)

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        array: Array = self._fftw.empty_aligned(shape, dtype)
        return array


def _pyfftw() -> Any:
    """Import pyFFTW without its interfaces module.

    They stand for the FFTs of SciPy and dask, and import both: a tenth of a second, and most of a second where dask is
    installed. Other users of pyFFTW find them as ever.
    """
    name = "pyfftw.interfaces"
    if "pyfftw" in sys.modules or name in sys.modules:
        return import_module("pyfftw")
    sys.modules[name] = ModuleType(name)
    try:
        fftw: Any = import_module("pyfftw")
    finally:
        del sys.modules[name]
    vars(fftw).pop("interfaces", None)

    def interface_of(attribute: str) -> Any:
        if attribute == "interfaces":
            return import_module(name)
        raise AttributeError(f"module 'pyfftw' has no attribute {attribute!r}")

    fftw.__getattr__ = interface_of
    return fftw


class _SciPy:
    name = "scipy"

    def __init__(self) -> None:
        from scipy import fft

        self._fft = fft

    def forward(self, source: Array, target: Array) -> Plan:
        transform = self._fft.fft if np.iscomplexobj(source) else self._fft.rfft
        return lambda: np.copyto(target, transform(source))

    def inverse(self, source: Array, target: Array) -> Plan:
        if np.iscomplexobj(target):
            return lambda: np.copyto(target, self._fft.ifft(source, norm="forward"))
        n = target.shape[-1]
        return lambda: np.copyto(target, self._fft.irfft(source, n=n, norm="forward"))

    def empty(self, shape: tuple[int, ...], dtype: Any) -> Array:
        return np.empty(shape, dtype)


@cache
def backend(name: str = "auto", effort: str = "estimate") -> Backend:
    """Return the FFT backend: ``"pyfftw"``, ``"scipy"`` or ``"auto"`` (pyFFTW where it is installed)."""
    require(name in ("auto", "pyfftw", "scipy"), "numerics", "library", name, "'auto', 'pyfftw' or 'scipy'")
    require(effort in ("estimate", "measure"), "numerics", "effort", effort, "'estimate' or 'measure'")
    if name == "auto":
        name = "pyfftw" if find_spec("pyfftw") else "scipy"
    return _FFTW(effort) if name == "pyfftw" else _SciPy()
