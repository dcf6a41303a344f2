"""Stored values of a run along one line, with their numerical error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Fields, Profile, Quantity, error_key

__all__ = ["Form", "StoredProfile", "fields_of", "stored_profile"]

FloatArray = NDArray[np.float64]
#: Quantity, label of the abscissa, components and unit of a kind of line.
Form = tuple[Quantity, str, tuple[str, ...], str]


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


def stored_profile(
    forms: Mapping[str, Form], kind: str, name: str, points: FloatArray, along: FloatArray, values: FloatArray,
    error: FloatArray, moments: tuple[int, ...], body: int = 1,
) -> StoredProfile:  # fmt: skip
    """Profile of one of the kinds in `forms`; of one component, values and errors may be (n,)."""
    quantity, label, components, unit = forms[kind]
    profile = Profile(
        name=name, quantity=quantity, points=points, along=along, label=label, components=components, unit=unit
    )
    table = along.size, len(components)
    return StoredProfile(
        profile=profile, kind=kind, moments=moments, body=body, values=values.reshape(table), error=error.reshape(table)
    )


def fields_of(profiles: Iterable[StoredProfile]) -> Fields:
    """Values by name of profile, and errors that are not zero, as `Case.judged` gives them."""
    fields: Fields = {}
    for stored in profiles:
        fields[stored.profile.name] = stored.values
        if np.any(stored.error):
            fields[error_key(stored.profile.name)] = stored.error
    return fields
