"""A scalar is declared once, by the block or the observer that computes it; every place that shows scalars finds it."""

import json

import pytest
from typer.testing import CliRunner

import eigencontact as ec
from eigencontact.cli import app
from eigencontact.core.numbers import Number, accumulate
from eigencontact.execution.blocks.block import Stateless
from eigencontact.execution.mechanics import separation
from eigencontact.reference.numbers import known_numbers, numbers_as_markdown

pytestmark = pytest.mark.usefixtures("small_pictures")

SCENE = {
    "geometry": {"type": "sphere", "radius": "105 um"}, "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
    "grid": {"cells": [12, 12], "size": ["22 um", "22 um"]}, "steps": [{"normal-load": "0.65 N"}],
    "numerics": {"threads": 1},
}  # fmt: skip
STRANGER = '''
from dataclasses import dataclass
from eigencontact.plugin import Observer, hookimpl

@dataclass(frozen=True, kw_only=True)
class Spread(Observer):
    """Spread of the pressure over the window."""
    key, references = "window-spread", ("none",)
    @property
    def units(self):
        return {"pressure": "Pa"}
    def observe(self, step):
        return {"pressure": float(step.fields["pressure"].std())}

@hookimpl
def eigencontact_register():
    return [Spread]
'''


class Stiffness(Stateless):
    """Load by approach: a number that no other place knows."""

    name, reason = "secant-stiffness", "a test"
    requires = frozenset({"pressure"})
    provides = frozenset({"secant_stiffness"})
    requesters = dict.fromkeys(provides, "a test")
    numbers = (Number(name="secant_stiffness", unit="N/m", meaning="load by approach", headline=True),)

    def advance(self, step):
        step.scalars["secant_stiffness"] = step.scalars["normal_load"] / step.scalars["approach"]


@pytest.fixture
def told(tmp_path, monkeypatch):
    """Console, summary, report, sweep table and reference page of a scene with one number more of each sort."""
    blocks = separation.blocks_beside_contact
    more = lambda model, **options: [*blocks(model, **options), Stiffness()]  # noqa: E731
    monkeypatch.setattr(separation, "blocks_beside_contact", more)
    (tmp_path / "mean.py").write_text(STRANGER)
    scene = {**SCENE, "plugins": ["mean.py"], "observers": [{"type": "window-spread"}]}
    (tmp_path / "scene.toml").write_text(_toml(scene))
    console = CliRunner().invoke(app, ["run", str(tmp_path / "scene.toml"), "-o", str(tmp_path / "out")])
    assert console.exit_code == 0, console.output
    sweep = ec.sweep(str(tmp_path / "scene.toml"), {"geometry.radius": ["105 um", "210 um"]}, folder=tmp_path / "sweep")
    loaded = ec.load_scene(tmp_path / "scene.toml")
    return {
        "console": console.output,
        "summary": json.loads((tmp_path / "out" / "summary.json").read_text()),
        "report": ec.report(tmp_path / "out").read_text(encoding="utf-8"),
        "table": (tmp_path / "sweep" / "sweep.csv").read_text(),
        "figures": {path.stem for path in (tmp_path / "sweep").glob("*.png")},
        "dataset": sweep.dataset,
        "page": numbers_as_markdown(loaded.known_plugins()),
    }


def _toml(table):
    import tomli_w

    return tomli_w.dumps(table)


def test_one_declaration_reaches_every_place(told):
    for name, words, unit in (
        ("secant_stiffness", "secant stiffness", "N/m"), ("window_spread_pressure", "window-spread: pressure", "Pa"),
    ):  # fmt: skip
        assert words in told["console"]
        assert told["summary"]["units"][name] == unit
        assert f"<code>{name}</code>" in told["report"]
        assert f"<dt>{name.replace('_', ' ')}</dt>" in told["report"]
        assert name in told["table"].splitlines()[0].split(",")
        assert name in told["figures"]
        assert told["dataset"][name].attrs["units"] == unit
        assert f"| `{name}` | {unit} |" in told["page"]


@pytest.mark.parametrize(
    ("over", "values", "expected"),
    [("last", [1.0, 5.0, 2.0], 2.0), ("sum", [1.0, None, 2.0], 3.0), ("max", [1.0, 5.0, None], 5.0), ("max", [], None)],
)
def test_rules_of_a_run(over, values, expected):
    assert Number(name="n", unit="1", meaning="", over=over).of_run(values) == expected


def test_efforts_add_up_and_certificates_are_the_worst():
    numbers = {role: Number(name=role, unit="1", meaning="", role=role) for role in ("effort", "certificate")}
    total = {}
    for values in ({"effort": 3.0, "certificate": 1e-7}, {"effort": 4.0, "certificate": 1e-8}):
        accumulate(numbers, total, values)
    assert total == {"effort": 7.0, "certificate": 1e-7}


def test_every_scalar_of_the_blocks_has_a_unit_and_a_meaning():
    for number in known_numbers().values():
        assert number.unit
        assert number.meaning
    assert {"max_pressure", "worn_volume", "law_residual"} <= set(known_numbers())
