"""Refusals: one line that says what is wrong, and an exit code."""

from contextlib import contextmanager

import pytest

from eigencontact import EigencontactError


@contextmanager
def one_line_error(words, code=2):
    """The block must raise one error of the package, in one line with these words."""
    with pytest.raises(EigencontactError) as caught:
        yield
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == code
