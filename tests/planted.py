"""Planted faults: classes with a fault, each with the checks of the conformance kit that must notice it."""

import pytest

from eigencontact_verification.conformance import ConformanceError, checks_for


class Faults(dict):
    """Name of a fault: (component, names of the checks that must notice it)."""

    def __init__(self, **usual):
        """Parameters of the components, where `plant` has none."""
        super().__init__()
        self.usual = usual

    def plant(self, *noticed, **parameters):
        """Register a class with a fault, made with `parameters`."""

        def keep(cls):
            self[cls.__name__] = (cls(**(parameters or self.usual)), noticed)
            return cls

        return keep

    @property
    def noticed(self):
        """All checks that must notice a fault."""
        return {check for _, noticed in self.values() for check in noticed}


def failing_checks(component):
    """Names of the checks that a component does not pass."""
    failed = set()
    for check in checks_for(component):
        try:
            check(component)
        except ConformanceError:
            failed.add(check.__name__)
    return failed


def assert_noticed(component, check):
    """Assert that a check fails by name, value and advice."""
    where = rf"^{check.__name__} of {component.kind} '{component.key}': "
    with pytest.raises(ConformanceError, match=where) as caught:
        check(component)
    message = str(caught.value)
    assert " must " in message
    assert "(got " in message
    assert len(message.rsplit("; ", 1)[1]) > 5, "it says what to do"
