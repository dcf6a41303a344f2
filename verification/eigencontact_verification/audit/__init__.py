"""Audit: what a run has stored against finite elements under its own tractions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eigencontact_verification.audit.cases import AuditCase
    from eigencontact_verification.audit.contact_case import ContactCase
    from eigencontact_verification.crosscheck.case import Gap

__all__ = ["cases_of", "contact_cases_of"]


def cases_of(
    folder: str | Path, step: int | None = None, *, quick: bool = True
) -> tuple[tuple[AuditCase, ...], tuple[Gap, ...]]:
    """Cases of a step of a run, and what cannot be judged of it; see `audit.cases.cases_of`."""
    from eigencontact_verification.audit.cases import cases_of as found

    return found(folder, step, quick=quick)


def contact_cases_of(folder: str | Path, *, quick: bool = True) -> tuple[tuple[ContactCase, ...], tuple[Gap, ...]]:
    """Case of a run as a whole contact of revolution, or why there is none; see `audit.contact_cases`."""
    from eigencontact_verification.audit.contact_cases import contact_cases_of as found

    return found(folder, quick=quick)
