"""The public names: what they take, return and refuse."""

import dataclasses
import doctest
import importlib
import inspect
import pkgutil
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import eigencontact as ec
import eigencontact.plugin
from bodies import STEEL
from close import close
from eigencontact_verification.oracles import hertz

QUICK = ["stress=[]", "grid.cells-per-contact-radius=8"]


def modules():
    """Every module of the three packages, but those that start something when they are imported."""
    for package in ("eigencontact", "eigencontact_plugins", "eigencontact_verification"):
        yield package
        for found in pkgutil.walk_packages(importlib.import_module(package).__path__, f"{package}."):
            if not found.name.endswith("__main__"):
                yield found.name


MODULES = sorted(modules())


def written_with_examples(name):
    return ">>>" in Path(find_spec(name).origin).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [name for name in MODULES if "benchmarks" not in name and written_with_examples(name)])
def test_examples_in_docstrings(name):
    found = doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert found.failed == 0


def test_there_are_examples_to_run():
    finder = doctest.DocTestFinder(exclude_empty=True)
    examples = {
        name: sum(len(test.examples) for test in finder.find(importlib.import_module(name))) for name in MODULES
    }
    assert sum(examples.values()) > 30
    assert [name for name in MODULES if examples[name] and not written_with_examples(name)] == []


@pytest.mark.parametrize("module", [ec, eigencontact.plugin], ids=["eigencontact", "eigencontact.plugin"])
def test_public_names_have_docstrings(module):
    for name in module.__all__:
        item = getattr(module, name)
        if not (inspect.isclass(item) or inspect.isfunction(item)):
            continue
        assert item.__doc__, name
        if inspect.isclass(item):
            # a dataclass without a docstring gets its signature
            assert not item.__doc__.startswith(f"{name}("), name
            for method, value in vars(item).items():
                if inspect.isfunction(value) and not method.startswith("_"):
                    assert inspect.getdoc(getattr(item, method)), f"{name}.{method}"


#: Methods for the package itself.
NOT_FOR_USERS = {"scene_table", "scene_inclusions", "tables"}
#: Too far inside for an example of a few lines.
NO_EXAMPLE = {
    "CornerInfluence", "FileArrays", "GriddedData", "NotUnique", "PointSources", "SceneError",
    "by_material", "integrated_chi", "read_arrays", "read_columns", "turned_derivatives",
}  # fmt: skip


def test_what_users_meet_has_an_example():
    """Names of the top of the package with their methods, what authors of plugins use; tests above run the examples.

    Optional abilities (protocols) are described by the classes that may have them.
    """
    met = [(name, getattr(ec, name)) for name in ec.__all__]
    for name in sorted(set(eigencontact.plugin.__all__) - NO_EXAMPLE):
        item = getattr(eigencontact.plugin, name)
        if inspect.isfunction(item) or (inspect.isclass(item) and not getattr(item, "_is_protocol", False)):
            met.append((name, item))
    for name, item in list(met):
        if inspect.isclass(item) and item.__module__.startswith("eigencontact.library"):
            own = {method: value for base in item.__mro__[:-1] for method, value in vars(base).items()}
            met += [
                (f"{name}.{method}", value)
                for method, value in own.items()
                if inspect.isfunction(value) and not method.startswith("_") and method not in NOT_FOR_USERS
            ]
    finder = doctest.DocTestFinder(recurse=False)
    without = [name for name, item in met if not any(test.examples for test in finder.find(item, name))]
    assert without == []


def test_public_functions_are_documented_by_parameter():
    for name in ("load_scene", "make", "rectangle_field", "run", "solve_contact"):
        function = getattr(ec, name)
        for parameter in inspect.signature(function).parameters:
            assert parameter in function.__doc__, f"{name}: {parameter}"


def test_what_a_module_offers_exists():
    modules = {name: importlib.import_module(name) for name in MODULES}
    offered = [(name, public) for name, module in modules.items() for public in getattr(module, "__all__", ())]
    assert [(name, public) for name, public in offered if not hasattr(modules[name], public)] == []


def test_public_names_survive_the_import_of_every_module():
    """A subpackage of the same name would replace a function as soon as it is imported."""
    before = {name: getattr(ec, name) for name in ec.__all__}
    for name in MODULES:
        importlib.import_module(name)
    assert {name: getattr(ec, name) for name in ec.__all__} == before
    assert not any(inspect.ismodule(item) for item in before.values())


def test_an_unknown_public_name():
    with pytest.raises(AttributeError, match=r"module 'eigencontact' has no attribute 'runn'"):
        _ = ec.runn
    assert set(dir(ec)) == set(ec.__all__)


# ---------------------------------------------------------------- make


def test_make_gives_the_component_of_the_scene():
    sphere = ec.make("sphere", radius="105 um", profile="circle")
    assert dataclasses.asdict(sphere) == {"radius": 105e-6, "profile": "circle", "center": (0.0, 0.0)}
    assert ec.make("sphere", kind="geometry", radius=105e-6) == ec.make("sphere", radius="105 um")


@pytest.mark.parametrize(
    ("key", "parameters", "words"),
    [
        (
            "shpere",
            {"radius": 1.0},
            "unknown plugin 'shpere'; installed: 'amplitude-scaled', 'archard', 'armstrong-frederick', ",
        ),
        ("shpere", {"radius": 1.0}, "did you mean 'sphere'?"),
        ("sphere", {"radius": 1.0, "kind": "observer"}, "unknown observer 'sphere'; installed: 'dissipated-energy', "),
        (
            "sphere",
            {"radius": 1.0, "kind": "shape"},
            "make.kind must be one of constitutive-law, damage-law, eigenstrain-field, fatigue-criterion, friction-law",
        ),
        ("sphere", {"radus": 1.0}, "unknown key 'radus' in sphere (sphere); known: radius, profile, center; did you"),
        ("sphere", {}, "sphere.radius must be given (sphere needs it)"),
        ("sphere", {"radius": "1 N"}, "sphere.radius must be a length [m]; '1 N' has the dimension"),
        ("sphere", {"radius": -1.0}, "sphere.radius must be positive and finite [m] (got -1.0)"),
    ],
)
def test_make_refuses(key, parameters, words):
    with pytest.raises(ec.EigencontactError) as caught:
        ec.make(key, **parameters)
    assert words in str(caught.value)


TWO_KINDS = """
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from eigencontact.plugin import Geometry, Length, Observer, hookimpl

@dataclass(frozen=True, kw_only=True)
class Wave(Geometry):
    '''A wave.'''
    key: ClassVar[str] = "wave"
    length: Length
    def separation(self, x, y):
        return 1 - np.cos(x / self.length) + 0 * y

@dataclass(frozen=True, kw_only=True)
class WaveObserver(Observer):
    '''Sees waves.'''
    key: ClassVar[str] = "wave"
    length: Length
    count: int = 1
    def observe(self, step):
        return {}

@hookimpl
def eigencontact_register():
    return [Wave, WaveObserver]
"""


def test_make_tells_kinds_apart(install):
    install(TWO_KINDS)
    with pytest.raises(ec.EigencontactError, match=r"'wave' must be told apart by kind .*'geometry'.*give kind="):
        ec.make("wave", length="1 um")
    assert ec.make("wave", kind="geometry", length="1 um").kind == "geometry"
    assert ec.make("wave", length="1 um", count=3).kind == "observer"  # only one of them knows count


# ---------------------------------------------------------------- rectangle_field


@pytest.mark.parametrize("count", [0, 1, 5])
@pytest.mark.parametrize(("quantity", "shape"), [("displacement", (3,)), ("stress", (3, 3))])
def test_rectangle_field_shapes(count, quantity, shape):
    points = np.random.default_rng(1).uniform(0.1, 1.0, (count, 3))
    points.flags.writeable = False
    field = ec.rectangle_field((1e6, 2e6, 3e6), (1.0, 2.0), points, quantity=quantity, **STEEL)
    assert field.shape == (count, *shape)
    assert field.dtype == np.float64
    if quantity == "stress":
        assert np.array_equal(field, field.transpose(0, 2, 1))


def test_rectangle_field_signs_and_superposition():
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [3.0, 0.2, 0.1]])
    unit = [ec.rectangle_field(load, (1.0, 0.5), points, **STEEL) for load in np.eye(3)]
    both = ec.rectangle_field((2.0, -3.0, 5.0), (1.0, 0.5), points, **STEEL)
    np.testing.assert_allclose(both, 2 * unit[0] - 3 * unit[1] + 5 * unit[2], rtol=1e-13, atol=1e-27)
    assert unit[0][0, 0] > 0
    assert unit[1][0, 1] > 0
    assert unit[2][0, 2] == close(hertz.love_centre_displacement(1.0, 1.0, 0.5, 210e9, 0.3), rel=1e-12)
    stress = ec.rectangle_field((0.0, 0.0, 1.0), (1.0, 0.5), points, quantity="stress", **STEEL)
    assert stress[0, 2, 2] == close(-1.0, abs=1e-12)  # pressure 1 under the middle, tension positive


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"traction": (1.0, 2.0)}, "rectangle_field.traction must be three finite numbers (q_x, q_y, p) [Pa] (got"),
        ({"traction": (1.0, 2.0, np.nan)}, "rectangle_field.traction must be three finite numbers"),
        ({"half_widths": (1.0, 0.0)}, "rectangle_field.half_widths must be two positive numbers (a, b) [m]"),
        ({"half_widths": (1.0, np.inf)}, "rectangle_field.half_widths must be two positive numbers (a, b) [m]"),
        ({"half_widths": 1.0}, "rectangle_field.half_widths must be two positive numbers (a, b) [m]"),
        ({"points": [0.0, 0.0, 0.0]}, "rectangle_field.points must be of shape (n, 3) [m] (got (3,))"),
        ({"points": [[0.0, 0.0, -1e-9]]}, "rectangle_field.points must be at z of 0 or more [m]"),
        ({"points": [[np.nan, 0.0, 0.0]]}, "rectangle_field.points must be finite [m]"),
        ({"young_modulus": 0.0}, "young_modulus must be positive"),
        ({"young_modulus": np.nan}, "young_modulus must be positive"),
        ({"poisson_ratio": 0.51}, "poisson_ratio must be"),
        ({"quantity": "strain"}, "rectangle_field.quantity must be 'displacement' or 'stress' (got 'strain')"),
    ],
)
def test_rectangle_field_refuses(changes, words):
    arguments = {"traction": (0.0, 0.0, 1.0), "half_widths": (1.0, 1.0), "points": [[0.0, 0.0, 0.0]]}
    arguments |= STEEL | changes
    with pytest.raises(ec.EigencontactError) as caught:
        ec.rectangle_field(**arguments)
    assert words in str(caught.value)


# ---------------------------------------------------------------- plan, run, open_results


def test_a_run_in_memory_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = ec.run(ec.load_scene("hertz", QUICK))
    assert list(tmp_path.iterdir()) == []
    assert (result.folder, result.files) == (None, {})
    assert result.summary["converged"] is True
    assert float(result.dataset.pressure.max()) == close(result.summary["max_pressure"], rel=1e-12)
    assert result.seconds > 0


@pytest.mark.usefixtures("small_pictures")
def test_a_run_in_a_folder_can_be_opened_again(tmp_path):
    result = ec.run(ec.load_scene("hertz", [*QUICK, "output.vtk=false"]), tmp_path / "out")
    result.dataset.close()
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(result.files)
    for path in (tmp_path / "out", tmp_path / "out" / "results.nc"):
        with ec.open_results(path) as data:
            assert data.attrs["title"] == result.summary["title"]


def test_every_way_to_say_a_scene_is_the_same_run():
    scene = ec.load_scene("hertz", QUICK)
    planned = ec.plan(scene)
    results = [ec.run(source).dataset.pressure for source in (scene, planned, scene.resolved())]
    for other in results[1:]:
        np.testing.assert_array_equal(results[0], other)


def test_resume_needs_a_folder():
    with pytest.raises(ec.EigencontactError, match=r"resume must be given with a folder \(got folder=None\)"):
        ec.run("hertz", resume=True)


def test_opening_nothing(tmp_path):
    with pytest.raises(ec.EigencontactError, match=r"results.nc must exist \(got nothing there\)"):
        ec.open_results(tmp_path)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_scenes_of_any_size_give_the_same_dimensionless_answer(scale):
    """Lengths times s and loads times s^2: the same pressures, on the automatic grid, at the default tolerance."""
    one, other = (
        ec.run(
            ec.load_scene("hertz", [*QUICK, f"geometry.radius={105e-6 * s!r}", f"steps.normal-load={0.65 * s * s!r}"])
        )
        for s in (1.0, scale)
    )
    assert one.dataset.sizes == other.dataset.sizes
    peak = one.summary["max_pressure"]
    np.testing.assert_allclose(other.dataset.pressure, one.dataset.pressure, rtol=0, atol=1e-10 * peak)
    assert other.summary["approach"] == close(one.summary["approach"] * scale, rel=1e-10)


@pytest.mark.parametrize("center", [(0.0, 0.0, 1.0), (0.0, 1.0)])
def test_a_key_of_two_kinds_is_refused_by_the_one_that_fits(center):
    with pytest.raises(ec.EigencontactError, match=r"^sphere\.radius must be positive and finite \[m\] \(got -1\.0\)$"):
        ec.make("sphere", center=center, radius=-1.0)
