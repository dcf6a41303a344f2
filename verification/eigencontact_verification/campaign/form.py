"""Keys of the file of a campaign; those that it shares with a study are defined there."""

from __future__ import annotations

from eigencontact_verification.studies.form import FORM as STUDY

__all__ = ["FORM", "JUDGES", "SHARED"]

#: Who judges a campaign.
JUDGES = {
    "scene": "the same scene with the changes of [reference], solved by this package at three refinements",
    "audit": "finite elements under the tractions of each run",
    "contact": "a contact of revolution solved by finite elements alone",
}
#: Keys that a campaign shares with a study.
SHARED = ("title", "trend", "source", "scene", "constants", "vary", "set", "when", "label")

#: Keys of each table, and what they mean; `eigencontact campaign --form` prints them.
FORM: dict[str, dict[str, str]] = {
    "campaign": {key: STUDY["study"][key] for key in SHARED}
    | {
        "scenes": "instead of scene: several, each with all variants; their name is the parameter `scene`",
        "judge": "; ".join(f"{key}: {words}" for key, words in JUDGES.items()),
        "model": "what is judged, in a few words",
        "tolerance": "largest error that is agreement, as a part of the largest value of a quantity",
        "expect": "formula of the parameters: where agreement is claimed; by default everywhere",
        "meshes": "judge = audit or contact: quick (default) or full, as of `eigencontact verify`",
        "reference": "judge = scene: how the reference differs from the model",
        "quantity": "judge = scene: what is compared, tables [[quantity]]",
        "map": "which parameters the axes of the picture are",
        "coarse": "what differs in a first look",
    },
    "reference": {
        "words": "what it is, in a few words",
        "set": "keys of the scene, dotted, and what is put there: formulas too",
        "when": "changes of the scene for some variants: tables [[reference.when]]",
        "without": "keys of the scene that are left out",
        "refine": "one constant with three values, coarse to fine and by one ratio; the differences are its own error",
    },
    "quantity": {
        "name": "in tables and above its map",
        "is": "formula: a number, or several at the same places in model and reference",
        "scale": "formula: what errors are parts of; by default the largest value of the reference",
        "tolerance": "of this quantity instead of that of the campaign",
        "expect": "where agreement of this quantity is claimed, instead of that of the campaign",
        "if": "formula of the parameters: which variants have it",
        "order": "largest order of convergence of the reference that is believed; by default 2",
    },
    "map": {
        "x": "parameter across; by default the first that varies",
        "y": "parameter upwards; by default the second that varies, none where there is but one",
        "x-label": "of the axis",
        "y-label": "of the axis",
        "quantities": "names of the quantities that are drawn; by default all",
    },
    "coarse": {key: STUDY["coarse"][key] for key in ("constants", "vary", "set")}
    | {"refine": "the three values of the constant of reference.refine", "scenes": "fewer scenes"},
}
