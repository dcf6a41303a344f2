"""Stored values of a run along one line, with their numerical error."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Fields, Profile, error_key

__all__ = ["StoredProfile", "fields_of"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredProfile:
    """Stored values along one line.

    Attributes
    ----------
    profile : Profile
        ``along`` of lines over load steps is the number of the step.
    kind : str
        What is compared. Of contacts of revolution (`contact_lines`): ``"approach"``, ``"radius"``, ``"edge"``,
        ``"pressure"``, ``"print"``, ``"stress"``. Of line contacts (`line_profiles`): ``"half width"``, ``"pressure"``,
        ``"shear"``, ``"slip"``, ``"stress"``, ``"history of stress"``, stress at one point over the steps, and
        ``"plastic strain"``, the equivalent one.
    moments : tuple of int
        Load steps, from 0: of every point, or one for all.
    body : int
        Of stress and plastic strain in line contacts, from 1 among the bodies that deform.
    values, error : (n, components) float64
        Stored values and their numerical error.
    """

    profile: Profile
    kind: str
    moments: tuple[int, ...]
    body: int = 1
    values: FloatArray
    error: FloatArray


def fields_of(profiles: Iterable[StoredProfile]) -> Fields:
    """Values by name of profile, and errors that are not zero, as `Case.judged` gives them."""
    fields: Fields = {}
    for stored in profiles:
        fields[stored.profile.name] = stored.values
        if np.any(stored.error):
            fields[error_key(stored.profile.name)] = stored.error
    return fields
