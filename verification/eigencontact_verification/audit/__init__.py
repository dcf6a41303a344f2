"""Audit: stored results of a run against finite elements under its own tractions."""

from eigencontact_verification.audit.cases import cases_of
from eigencontact_verification.audit.contact_cases import contact_cases_of

__all__ = ["cases_of", "contact_cases_of"]
