"""A real package of a stranger: built as a wheel, installed into an environment of its own, used from scenes.

`sample_package` brings a torus (only `contains`), a spheroid (potentials), a friction law, an eigenstrain field that
reads a file, a constitutive law and an observer that asks for a region. A second package beside it cannot be imported.
Nothing here needs a network.
"""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

import pytest

OFFLINE = {"PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
ORIGIN = "eigencontact-sample-shapes 0.3.0"
BROKEN_PROJECT = """
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"
[project]
name = "eigencontact-broken-shapes"
version = "0.0.1"
[project.entry-points.eigencontact]
fibre = "eigencontact_broken_shapes"
[tool.hatch.build.targets.wheel]
packages = ["eigencontact_broken_shapes"]
"""
INCLUSIONS = """
title = "Shapes of a stranger"

[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[[inclusions]]
name = "ring"
type = "torus"
center = ["0 um", "0 um", "6 um"]
ring-radius = "3 um"
tube-radius = "1 um"
eigenstrain = 1e-3

[[inclusions]]
name = "lens"
type = "spheroid"
center = ["0 um", "0 um", "12 um"]
equatorial-radius = "3 um"
polar-radius = "1 um"
eigenstrain = [1e-3, 0.0, -1e-3]

[grid]
cells = 17
spacing = ["1 um", "1 um"]

[output]
pictures = false
vtk = false
"""
FRICTION = """
title = "Friction of a stranger"

[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[geometry]
type = "sphere"
radius = "105 um"

[friction]
type = "adhesive"
tau0 = "50 MPa"
coefficient = 0.1
cap = "500 MPa"

[grid]
cells = 24
size = ["16 um", "16 um"]

[[steps]]
normal-load = "0.65 N"

[[steps]]
shift-x = "2 um"

[numerics]
coupling = "none"

[output]
pictures = false
vtk = false
"""


COMMANDS = """
import contextlib, io, json
from eigencontact.cli import app
outcomes = []
for line in LINES:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app(args=line, prog_name="eigencontact")
            code = 0
        except SystemExit as leaving:
            code = leaving.code or 0
    outcomes.append((code, out.getvalue(), err.getvalue()))
print(json.dumps(outcomes))
"""


def run(*arguments, **more):
    """Run a process that must succeed or not, as its caller says."""
    return subprocess.run(
        [str(item) for item in arguments],
        capture_output=True, text=True, check=False, timeout=400, env=os.environ | OFFLINE, **more,
    )  # fmt: skip


@dataclass(frozen=True)
class Stranger:
    """The environment with both packages."""

    python: Path
    sources: Path
    folder: Path

    def __call__(self, *arguments):
        """Call the command line."""
        return run(self.python, "-m", "eigencontact.cli", *arguments, cwd=self.folder)

    def commands(self, *lines):
        """Call the command line several times in one process: code, standard output and error of each."""
        return [tuple(outcome) for outcome in self.script(f"LINES = {[list(line) for line in lines]!r}\n{COMMANDS}")]

    def script(self, code):
        """Run Python; the last line printed is JSON."""
        done = run(self.python, "-W", "error", "-c", code, cwd=self.folder)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def stranger(root, tmp_path_factory):
    """Build two wheels and install them into a new environment that sees what the current one has."""
    folder = tmp_path_factory.mktemp("stranger")
    sources, broken = folder / "sample_package", folder / "broken"
    shutil.copytree(root / "tests" / "sample_package", sources, ignore=shutil.ignore_patterns("__pycache__"))
    (broken / "eigencontact_broken_shapes").mkdir(parents=True)
    (broken / "pyproject.toml").write_text(BROKEN_PROJECT, encoding="utf-8")
    (broken / "eigencontact_broken_shapes" / "__init__.py").write_text("import a_module_that_is_nowhere\n")
    pip = [sys.executable, "-m", "pip"]
    built = run(*pip, "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", folder / "wheels", sources, broken)
    assert built.returncode == 0, built.stderr
    wheels = sorted((folder / "wheels").glob("*.whl"))
    assert [wheel.name.split("-")[0] for wheel in wheels] == [
        "eigencontact_broken_shapes",
        "eigencontact_sample_shapes",
    ]

    home = folder / "environment"
    made = run(sys.executable, "-m", "venv", "--without-pip", home)
    assert made.returncode == 0, made.stderr
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    paths = {"base": str(home), "platbase": str(home)}
    own = Path(sysconfig.get_path("purelib", scheme="venv", vars=paths))
    outer = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    # a line that begins with import is executed; addsitedir also follows what editable installs leave there
    lines = "".join(f"import site; site.addsitedir({path!r})\n" for path in sorted(outer))
    (own / "outer.pth").write_text(lines, encoding="utf-8")
    installed = run(*pip, "--python", python, "install", "-q", "--no-deps", *wheels)
    assert installed.returncode == 0, installed.stderr
    (folder / "scene.toml").write_text(INCLUSIONS, encoding="utf-8")
    (folder / "friction.toml").write_text(FRICTION, encoding="utf-8")
    return Stranger(python, sources, folder)


LISTED = {
    "torus": "Ring of circular section",
    "spheroid": "Ellipsoid of revolution about z",
    "adhesive": "Shear strength that begins at tau0",
    "measured": "Isotropic eigenstrain of two columns of text",
    "laminate": "Thin layers of two isotropic solids in turn",
    "deepest-shear": "Largest shear stress on a line into a body",
}


#: Command lines; one process calls all of them.
ASKED = {
    "plugins": ["plugins"],
    "plugin": ["plugins", "spheroid"],
    "broken": ["explain", "scene.toml", "--set", "inclusions=[{type='fibre', eigenstrain=1e-3}]"],
    "thick tube": ["explain", "scene.toml", "--set", "inclusions.0.tube-radius='4 um'"],
    "misspelt": ["explain", "scene.toml", "--set", "inclusions.1.polar-radios='4 um'"],
    "scene": ["explain", "scene.toml"],
    "low cap": ["explain", "friction.toml", "--set", "friction.cap=1 MPa"],
    "run": ["run", "scene.toml", "-o", "out", "--json"],
    "run with a file": ["run", "deeper/patch.toml", "-o", "peened", "--json"],
    "run with friction": ["run", "friction.toml", "-o", "slid", "--json"],
}


#: A patch of eigenstrain from a file of two columns.
PATCH = '[[eigenstrain]]\ntype = "measured"\nmeasurement = "peened.txt"\ndepth = "4 um"\nlayers = 4\n'


@pytest.fixture(scope="module")
def answers(stranger):
    """Code, standard output and error of each command line."""
    place = stranger.folder / "deeper"
    place.mkdir()
    (place / "peened.txt").write_text("0.0 1e-3\n5e-6 0.0\n")
    head = INCLUSIONS[: INCLUSIONS.index("[[inclusions]]")] + INCLUSIONS[INCLUSIONS.index("[grid]") :]
    (place / "patch.toml").write_text(head + PATCH, encoding="utf-8")
    return dict(zip(ASKED, stranger.commands(*ASKED.values()), strict=True))


def test_all_are_listed_with_their_package(answers):
    code, listed, err = answers["plugins"]
    assert code == 0, err
    for key, words in LISTED.items():
        (line,) = (line for line in listed.splitlines() if line.split()[:1] == [key])
        assert words in line
        assert line.endswith(f"({ORIGIN})")
    detailed = answers["plugin"][1]
    assert "polar-radius: a length [m]; required" in detailed
    assert "J. D. Eshelby 1959, doi:10.1098/rspa.1959.0173" in detailed


def test_the_broken_package_is_reported_and_stops_nothing(answers):
    listed = answers["plugins"][1]
    assert "cuboid" in listed
    reason = "ModuleNotFoundError: No module named 'a_module_that_is_nowhere'"
    assert f"fibre of eigencontact-broken-shapes 0.0.1: {reason}" in listed
    code, _, err = answers["broken"]
    assert code == 2
    assert err.count("\n") == 1
    assert "plugin 'fibre' of eigencontact-broken-shapes 0.0.1 is broken: " in err


@pytest.mark.parametrize(
    ("question", "words"),
    [
        (
            "thick tube",
            "tube-radius of inclusion 'ring' (first) must be positive and below ring_radius, 3e-06 [m] (got 4e-06)",
        ),
        ("misspelt", "did you mean 'polar-radius'?"),
        ("low cap", "friction.cap must be finite and at least tau0, 50000000.0 [Pa] (got 1000000.0)"),
    ],
)
def test_refusals_of_its_components_read_like_ours(answers, question, words):
    code, _, err = answers[question]
    assert code == 2
    assert words in err


def test_explain_says_how_each_is_computed(answers):
    code, out, err = answers["scene"]
    assert code == 0, err
    (ring,) = (line for line in out.splitlines() if line.startswith("  ring (plugin 'torus'"))
    (lens,) = (line for line in out.splitlines() if line.startswith("  lens (plugin 'spheroid'"))
    assert "cells" in ring
    assert "cells" not in lens


def summary_of(answer):
    """Summary that a run printed."""
    code, out, err = answer
    assert code == 0, err
    return json.loads(out)


def test_a_scene_with_both_runs_and_cites(answers):
    summary = summary_of(answers["run"])
    assert summary["versions"]["plugin inclusion-shape torus"] == ORIGIN
    assert summary["versions"]["plugin inclusion-shape spheroid"] == ORIGIN
    assert "J. D. Eshelby 1959, doi:10.1098/rspa.1959.0173" in summary["references"]


def test_a_file_of_theirs_counts_from_the_scene_and_in_its_hash(stranger, answers):
    summary = summary_of(answers["run with a file"])
    assert summary["versions"]["plugin eigenstrain-field measured"] == ORIGIN
    (stranger.folder / "deeper" / "peened.txt").write_text("0.0 2e-3\n5e-6 0.0\n")
    again = stranger("run", "deeper/patch.toml", "-o", "peened", "--resume")
    assert again.returncode == 5
    assert "--resume continues the same scene only" in again.stderr


SLIDING = """
fields = ec.open_results("slid").isel(step=-1)
pressure = fields["pressure"].values
bound = np.where(pressure > 0, np.minimum(50e6 + 0.1 * pressure, 500e6), 0.0)
found = {"error": float(np.abs(fields["shear_x"].values - bound).max() / bound.max()),
                  "load": float(fields["tangential_load_x"]) / (bound.sum() * (16e-6 / 24) ** 2),
                  "capped": int(np.sum(bound == 500e6)), "below": int(np.sum((bound > 0) & (bound < 500e6)))}
"""


MATERIAL = """
title = "A material and an observer of a stranger"

[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[geometry]
type = "sphere"
radius = "105 um"

[[inclusions]]
name = "grain"
type = "sphere"
center = ["0 um", "0 um", "4 um"]
radius = "2 um"
material = { type = "laminate", moduli = ["210 GPa", "210 GPa"], poisson-ratios = [0.3, 0.3], share = 0.4 }
eigenstrain = { type = "measured", measurement = "grain.txt" }

[[observers]]
type = "deepest-shear"
depth = "5 um"
points = 40

[grid]
cells = 20
size = ["16 um", "16 um"]

[steps]
normal-load = "0.65 N"

[output]
pictures = false
vtk = false
"""


@pytest.mark.slow
def test_their_material_observer_and_prestrain_in_one_scene(stranger):
    """Layers of steel in steel are steel: Hertz's largest shear, .31 p0 at .48 a. Of another metal they are not."""
    place = stranger.folder / "grain"
    place.mkdir()
    (place / "grain.txt").write_text("0.0 0.0\n1.0 0.0\n")
    (place / "grain.toml").write_text(MATERIAL, encoding="utf-8")

    def observed(out, *changes):
        done = stranger("run", "grain/grain.toml", "-o", out, "--json", *(p for c in changes for p in ("--set", c)))
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    steel = observed("steel")
    assert steel["versions"]["plugin constitutive-law laminate"] == ORIGIN
    assert steel["versions"]["plugin observer deepest-shear"] == ORIGIN
    assert "G. E. Backus 1962, J. Geophys. Res. 67, 4427, eq. (13)" in steel["references"]
    radius = (0.75 * 0.65 * 105e-6 * 0.91 / 210e9) ** (1 / 3)
    pressure = 1.5 * 0.65 / (3.14159265 * radius**2)
    assert abs(steel["observed"]["deepest_shear_shear"] / (0.31 * pressure) - 1) < 0.02
    assert abs(steel["observed"]["deepest_shear_depth"] / (0.48 * radius) - 1) < 0.05
    soft = observed("soft", 'inclusions.0.material.moduli=["210 GPa", "50 GPa"]')
    assert soft["approach"] > 1.001 * steel["approach"]

    (place / "grain.txt").write_text("0.0 1e-3\n1.0 1e-3\n")
    again = stranger("run", "grain/grain.toml", "-o", "steel", "--resume")
    assert again.returncode == 5
    assert "--resume continues the same scene only" in again.stderr


FIELDS = """
steel = dict(young_modulus=210e9, poisson_ratio=0.3)
strain = np.array([[1.0, 0.2, -0.3], [0.2, 0.5, 0.1], [-0.3, 0.1, -0.8]])
points = np.random.default_rng(1).uniform((-3, -3, 0), (3, 3, 5), (40, 3))
lens = ec.make("spheroid", center=(0.3, 0.2, 2.0), equatorial_radius=1.5, polar_radius=0.8)
same = ec.make("ellipsoid", kind="inclusion-shape", center=(0.3, 0.2, 2.0), semi_axes=(1.5, 1.5, 0.8))
theirs, ours = (ec.inclusion_field(s, strain, points, quantity="stress", **steel) for s in (lens, same))

# lift of a swelling ring above its centre: (1 + nu) / pi times the integral of z / R^3 over the region
ring = ec.make("torus", center=(0, 0, 2.0), ring_radius=1.0, tube_radius=0.3)
lift = ec.inclusion_field(ring, 1e-3 * np.eye(3), [[0, 0, 0]], cells=32, **steel)[0, 2]
t, w = np.polynomial.legendre.leggauss(40)
r, angle = 0.15 * (t + 1)[:, None], 2 * np.pi * np.arange(64) / 64
rho, z = 1 + r * np.cos(angle), 2 + r * np.sin(angle)
volumes = 0.15 * w[:, None] * r * (2 * np.pi / 64) * (2 * np.pi * rho)
exact = -1e-3 * 1.3 / np.pi * np.sum(volumes * z / np.hypot(rho, z) ** 3)
found |= {"lens": np.max(np.abs(theirs - ours)) / np.max(np.abs(ours)), "ring": lift / exact - 1}
"""


@pytest.fixture(scope="module")
def found(stranger, answers):
    """Numbers of a stored run of theirs, and of fields in Python."""
    head = "import json\nimport numpy as np\nimport eigencontact as ec\n"
    return stranger.script(f"{head}{SLIDING}{FIELDS}print(json.dumps(found))")


def test_a_contact_slips_by_their_law(answers, found):
    """Far behind the shift all of it slips: the shear is min(tau0 + coefficient p, cap), where there is contact."""
    summary = summary_of(answers["run with friction"])
    assert summary["versions"]["plugin friction-law adhesive"] == ORIGIN
    assert "B. J. Briscoe and D. Tabor 1975, Wear 34, 29" in summary["references"]
    assert found["error"] < 1e-9
    assert abs(found["load"] - 1) < 1e-9
    assert found["capped"] > 0
    assert found["below"] > 0


def test_their_fields_are_right(found):
    """The spheroid is our ellipsoid to round-off; the torus of 32 cells lifts the surface as it should."""
    assert found["lens"] < 1e-10
    assert abs(found["ring"]) < 1e-3


@pytest.mark.slow
def test_the_package_passes_its_own_conformance_tests(stranger):
    done = run(
        stranger.python, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider", "tests",
        cwd=stranger.sources,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]
    assert "skipped" not in done.stdout


ELEMENTS = """
import json
from test_conformance import SHAPES
from eigencontact_verification.conformance import checks_for

found = []
for shape in SHAPES[:2]:
    check = checks_for(shape, finite_elements=True)[-1]
    check(shape)
    found.append(f"{check.__name__} {shape.key}")
print(json.dumps(found))
"""


@pytest.mark.slow
def test_finite_elements_agree_with_both_shapes(stranger):
    found = stranger.script(f"import sys; sys.path.insert(0, {str(stranger.sources / 'tests')!r})\n{ELEMENTS}")
    assert found == [f"check_against_finite_elements {key}" for key in ("torus", "spheroid")]
