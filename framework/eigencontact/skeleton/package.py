"""Writer of plugin packages from the templates in this folder."""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass
from pathlib import Path

from eigencontact.errors import PluginError, nearest

__all__ = ["TEMPLATES", "NewPackage", "write_file", "write_package"]

_FOLDER = Path(__file__).with_name("templates")
_MODULE = ".module.py.txt"


def _examples() -> dict[str, str]:
    """Kinds with templates, and the example of each: the words after "The example is" in its docstring."""
    examples = {}
    for path in sorted(_FOLDER.glob(f"*{_MODULE}")):
        words = re.search(r"The example is (.+?);", path.read_text(encoding="utf-8"))
        examples[path.name.removesuffix(_MODULE)] = words[1] if words else "one of its kind"
    return examples


#: Kinds that have a template of their own, and what the example in it is.
TEMPLATES = _examples()
_PREFIX = "eigencontact-"
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@dataclass(frozen=True, slots=True)
class NewPackage:
    """A package that was written.

    Attributes
    ----------
    folder : Path
        Where it is.
    files : tuple of Path
        What it holds.
    key : str
        Name of its plugin in scenes.
    kind : str
        Kind of plugin.
    """

    folder: Path
    files: tuple[Path, ...]
    key: str
    kind: str

    def next_steps(self) -> str:
        """Text for the terminal: written files and next commands."""
        listed = "\n".join(f"  {path}" for path in self.files)
        return (
            f"{self.folder}: a package with one {self.kind}, {self.key!r} (the example is {TEMPLATES[self.kind]})\n"
            f"{listed}\n\n"
            f'next:\n  pip install -e "{self.folder}[test]"\n'
            f"  python -m pytest {self.folder}\n"
            f"  eigencontact plugins {self.key}\n"
            f"then write your own {self.kind} in place of the example; the tests say when it is right"
        )


def write_package(name: str, *, kind: str = "inclusion-shape", folder: Path | None = None) -> NewPackage:
    """Write a package with one plugin.

    Parameters
    ----------
    name : str
        Key of the plugin, in lower case with hyphens: ``"hollow-ball"``. The package is called
        ``eigencontact-hollow-ball``, its module ``eigencontact_hollow_ball``, the class ``HollowBall``.
    kind : str
        One of `TEMPLATES`.
    folder : Path, optional
        Where to write; must be new or empty. By default the package's name in the current folder.

    Raises
    ------
    PluginError
        A name that cannot be used or is taken, an unknown kind, a folder that holds something.
    """
    words = _mark_values(name, kind)
    key = words["key"]
    target = Path(f"{_PREFIX}{key}") if folder is None else folder
    written = []
    try:
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise PluginError(f"folder must be new or empty (got {str(target)!r}); choose another with -o")
        for template, place in _places(kind, words["module"]).items():
            path = target / place
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(_fill(template, words), encoding="utf-8")
            written.append(path)
    except OSError as problem:
        got = f"{target}: {problem.strerror}"
        raise PluginError(f"folder must be one that can be written (got {got}); choose another with -o") from None
    return NewPackage(target, tuple(written), key, kind)


def write_file(name: str, *, kind: str = "inclusion-shape", path: Path | None = None) -> Path:
    """Write a plugin as a single file for the key ``plugins`` of a scene: the module of the package.

    Parameters
    ----------
    name, kind
        As of `write_package`.
    path : Path, optional
        The file, which must be new; by default the name with underscores and ``.py`` in the current folder.

    Raises
    ------
    PluginError
        As of `write_package`; a file that is there already.
    """
    words = _mark_values(name, kind)
    target = Path(f"{words['key'].replace('-', '_')}.py") if path is None else path
    try:
        with target.open("x", encoding="utf-8") as file:
            file.write(_fill(f"{kind}{_MODULE}", words))
    except OSError as problem:
        got = f"{target}: {problem.strerror}"
        raise PluginError(f"file must be new, where it can be written (got {got}); choose another with -o") from None
    return target


def _mark_values(name: str, kind: str) -> dict[str, str]:
    """Values of the marks of a template; an unusable name or kind is refused."""
    key = name.removeprefix(_PREFIX)
    if not _NAME.fullmatch(key):
        suggestion = re.sub(r"[^a-z0-9]+", "-", key.lower()).strip("-0123456789")
        hint = f"; say {suggestion!r}" if suggestion else ""
        raise PluginError(f"name must be of lower-case letters, digits and single hyphens (got {name!r}){hint}")
    if kind not in TEMPLATES:
        raise PluginError(f"kind must be one of {', '.join(TEMPLATES)} (got {kind!r}){nearest(kind, TEMPLATES)}")
    class_name = "".join(word.capitalize() for word in key.split("-"))
    if keyword.iskeyword(class_name):
        raise PluginError(f"name must not stand for a word of Python, {class_name} (got {name!r}); choose another")
    _refuse_taken(kind, key)
    return {
        "package": f"{_PREFIX}{key}",
        "module": f"eigencontact_{key.replace('-', '_')}",
        "class": class_name,
        "key": key,
        "version": _version(),
    }


def _places(kind: str, module: str) -> dict[str, str]:
    """Template -> file of the package."""
    return {
        "pyproject.toml.txt": "pyproject.toml",
        f"{kind}.readme.md.txt": "README.md",
        f"{kind}{_MODULE}": f"src/{module}/__init__.py",
        f"{kind}.tests.py.txt": "tests/test_conformance.py",
    }


def _fill(template: str, words: dict[str, str]) -> str:
    text = (_FOLDER / template).read_text(encoding="utf-8")
    for word, value in words.items():
        text = text.replace(f"<{word}>", value)
    return text


def _version() -> str:
    """Required version of the program: the present one, without its last part."""
    from eigencontact import __version__

    return ".".join(__version__.split(".")[:2])


def _refuse_taken(kind: str, key: str) -> None:
    from eigencontact.scene.installed import installed_plugins

    for entry in installed_plugins().named(key):
        if entry.kind == kind:
            raise PluginError(f"name must be new (got {key!r}, the {kind} of {entry.origin}); choose another")
