"""What README shows can be typed: its scenes are planned, its library examples run."""

import re
import tomllib
from pathlib import Path

import pytest

import eigencontact as ec

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("text", blocks("toml"), ids=lambda text: text.splitlines()[0])
def test_scenes_are_planned(text):
    assert "predicted" in str(ec.explain(tomllib.loads(text)))


def test_library_examples_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for text in blocks("python"):
        exec(text, names)  # the blocks build on each other
    assert names["stress"].shape == (1, 3, 3)
