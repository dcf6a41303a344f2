"""Types of arrays by the kind of their numbers, for annotations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "BoolArray", "ComplexArray", "FloatArray", "IntArray"]

#: Numbers of any kind: single or double precision, real or complex.
Array = NDArray[Any]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]
FloatArray = NDArray[np.float64]
#: Indices.
IntArray = NDArray[np.intp]
