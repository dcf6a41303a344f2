"""The layers of the house, kept by import-linter; and what a wheel holds."""

import ast
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile

import pytest

PACKAGES = {
    "framework/eigencontact": "eigencontact",
    "plugins/eigencontact_plugins": "eigencontact_plugins",
    "verification/eigencontact_verification": "eigencontact_verification",
}

# (file, a line planted in it, the contract that must notice)
FORBIDDEN = [
    ("eigencontact/core/grid.py", "import eigencontact.solvers.normal", "layers of the framework"),
    ("eigencontact/scene/loader.py", "import eigencontact.planning.plan", "layers of the framework"),
    ("eigencontact/convolution/layout.py", "import eigencontact_plugins", "verification > plugins > framework"),
    ("eigencontact_plugins/probe.py", "import eigencontact.core.grid", "plugins see only eigencontact.plugin"),
    ("eigencontact_verification/oracles/hertz.py", "import eigencontact_plugins.probe", "oracles share no code"),
    ("eigencontact_verification/audit/bodies.py", "import eigencontact.solvers.normal", "an audit reads results"),
    ("eigencontact/execution/blocks/step.py", "import eigencontact.execution.run.driver", "rooms of the execution"),
    ("eigencontact/viz/worn.py", "import eigencontact.scene.schema", "pictures and reports are made from results"),
    ("eigencontact_verification/reporting/page.py", "import eigencontact_verification.audit", "rooms of verification"),
    ("eigencontact/planning/plan.py", "import pluggy", "pluggy only in hooks"),
    ("eigencontact/execution/run/driver.py", "import matplotlib", "plotting libraries only where"),
]

# contract -> (the list that it must have in full, the modules of the framework that are not in the list)
COMPLETE = {
    "pictures and reports are made from results alone": (
        "forbidden_modules",
        {"viz", "reports", "results", "core", "errors", "command_help", "completion"},
    ),
    "plugins see only eigencontact.plugin": ("forbidden_modules", {"plugin"}),
    "an audit reads results and asks shapes, and solves nothing with what it judges": (
        "forbidden_modules",
        {"core", "errors", "hooks", "model", "plugin", "results", "scene", "viz"},
    ),
    "pluggy only in hooks": ("source_modules", {"hooks"}),
    "plotting libraries only where pictures are made": ("source_modules", {"viz", "reports", "postprocess", "library"}),
}


def lint(folder):
    """Run import-linter in `folder`, on the packages that lie in it."""
    code = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
    return subprocess.run(
        [sys.executable, "-c", code, "--no-cache", "--config", str(folder / "pyproject.toml")],
        cwd=folder,
        env={"PYTHONPATH": str(folder), "PATH": "", "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.fixture
def house(root, tmp_path):
    """Copy of the three packages and the contracts."""
    for folder, name in PACKAGES.items():
        shutil.copytree(root / folder, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_contracts_are_kept(house):
    done = lint(house)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"Contracts: \d+ kept, 0 broken", done.stdout)


def test_forbidden_imports_are_caught(house):
    """All planted at once: each contract names the file it was planted in."""
    for file, line, _ in FORBIDDEN:
        path = house / file
        path.write_text(path.read_text(encoding="utf-8") + f"\n{line}\n", encoding="utf-8")
    done = lint(house)
    assert done.returncode != 0
    assert "0 kept" in done.stdout
    broken = done.stdout[done.stdout.index("Broken contracts") :]
    for file, line, contract in FORBIDDEN:
        importer, imported = file.removesuffix(".py").replace("/", "."), line.split()[-1]
        assert any(contract in part for part in broken.splitlines())
        assert f"{importer} -> {imported}" in broken, f"{contract}: {importer}"


def test_contracts_name_every_module_of_the_framework(root):
    """A new module is forbidden everywhere until the table above allows it."""
    framework = root / "framework/eigencontact"
    modules = {path.stem for path in framework.glob("*.py")} | {
        path.parent.name for path in framework.glob("*/__init__.py")
    }
    settings = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = {contract["name"]: contract for contract in settings["tool"]["importlinter"]["contracts"]}
    for name, (key, allowed) in COMPLETE.items():
        listed = {module.removeprefix("eigencontact.") for module in contracts[name][key] if "eigencontact." in module}
        assert listed == modules - allowed - {"__init__"}, name


def test_every_package_declares_its_types(root):
    for folder in PACKAGES:
        assert (root / folder / "py.typed").is_file()


def test_the_framework_names_no_installed_plugin(root):
    """No concrete physics in the framework: it mentions no module of eigencontact_plugins."""
    for path in (root / "framework").rglob("*.py"):
        assert "eigencontact_plugins" not in path.read_text(encoding="utf-8"), path


def test_nothing_is_compared_within_an_absolute_part_that_nobody_chose(root):
    """``allclose`` and ``isclose`` of NumPy accept 1e-8 unless told: in metres that is everything."""
    bare = []
    for folder in (*PACKAGES, "tests"):
        for path in (root / folder).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            if not any(name in text for name in ("allclose", "isclose", "approx")):
                continue
            for node in ast.walk(ast.parse(text)):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                    told = {keyword.arg for keyword in node.keywords}
                    if node.func.attr in ("allclose", "isclose") and "atol" not in told:
                        bare.append(f"{path.relative_to(root)}:{node.lineno}")
                    if node.func.attr == "approx" and path.name != "close.py":
                        bare.append(f"{path.relative_to(root)}:{node.lineno}")
    assert bare == []


@pytest.mark.slow
def test_a_wheel_holds_three_packages_and_their_data(root, tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    for name in ("framework", "plugins", "verification"):
        shutil.copytree(root / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(root / name, source)
    done = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--no-deps", "-w", str(tmp_path / "wheels"), str(source)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    (wheel,) = (tmp_path / "wheels").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    tops = {name.split("/")[0] for name in names}
    (info,) = {top for top in tops if top.endswith(".dist-info")}
    assert tops - {info} == {"eigencontact", "eigencontact_plugins", "eigencontact_verification"}
    assert {f"{package}/py.typed" for package in PACKAGES.values()} <= names
    for path in (root / "framework/eigencontact/gallery").iterdir():
        assert f"eigencontact/gallery/{path.name}" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert f"{info}/entry_points.txt" in names
