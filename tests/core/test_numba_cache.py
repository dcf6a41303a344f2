import subprocess
import sys

import pytest

pytest.importorskip("numba")

NOWHERE = """
import numba
import numba.core.caching as caching
caching.CacheImpl._locator_classes = []
"""
REFUSED = """
try:
    numba.njit(cache=True)(lambda x: x)
except RuntimeError as error:
    print(error)
"""
OURS = """
from eigencontact.core.numba_cache import compiled
def double(x):
    return 2 * x
print(compiled()(double)(21), compiled(nogil=True, fastmath=True)(double)(0.5))
"""


def test_loops_are_compiled_where_they_cannot_be_kept():
    """As in a container whose packages and home are read-only: numba itself refuses to compile there."""
    code = NOWHERE + REFUSED + OURS
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    refused, numbers = done.stdout.splitlines()
    assert "cannot cache function" in refused
    assert numbers.split() == ["42", "1.0"], done.stderr
