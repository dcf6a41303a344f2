import subprocess
import sys

import pytest

pytest.importorskip("numba")

NOWHERE = """
import numba
import numba.core.caching as caching
caching.CacheImpl._locator_classes = []
"""
OURS = """
from eigencontact.core.numba_cache import compiled
def double(x):
    return 2 * x
print(compiled()(double)(21), compiled(nogil=True, fastmath=True)(double)(0.5))
"""


def test_loops_are_compiled_where_they_cannot_be_kept():
    """As in a container whose packages and home are read-only: numba itself refuses to compile there."""
    refused = NOWHERE + "numba.njit(cache=True)(lambda x: x)"
    done = subprocess.run([sys.executable, "-c", refused], capture_output=True, text=True, check=False)
    assert "RuntimeError: cannot cache function" in done.stderr
    done = subprocess.run([sys.executable, "-c", NOWHERE + OURS], capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["42", "1.0"], done.stderr
