"""The benchmark of lower fidelities: its judge, its rows, its table."""

from __future__ import annotations

import numpy as np
import pytest

from close import close
from eigencontact import inclusion_field, make
from eigencontact.core.tensors import from_mandel, to_matrix
from eigencontact_verification.benchmarks import fidelity
from eigencontact_verification.benchmarks.__main__ import main
from eigencontact_verification.benchmarks.benchmark import Task
from eigencontact_verification.benchmarks.process import perform

#: Largest error of any quantity that each way of computing may have for a cell two cells below the surface, and
#: the least: it would mean that the judge compares a thing with itself.
BOUNDS = {
    "exact": (1e-11, 0.0),
    "exact, single": (1e-3, 1e-9),
    "image-pressure": (0.5, 1e-3),
    "periodic, pad 1": (3.0, 1e-2),
    "periodic, pad 4": (0.05, 1e-5),
}


@pytest.mark.parametrize("method", BOUNDS)
def test_errors_are_of_the_right_size(method):
    sample = perform(Task(benchmark="fidelity", code=method, n=12, case="cell, 2 h below", warm=1))
    assert sample["status"] == "ok", sample
    most, least = BOUNDS[method]
    assert least <= max(sample[name] for name in fidelity.ERRORS) <= most


def test_judge_adds_up_cells():
    case = fidelity.Case(name="two", cells=(2, 1), top=1.0)
    found = from_mandel(fidelity.reference(case, "stress", 0.5, 4))
    total = 0.0
    for x in (-0.5, 0.5):
        for y in (-0.5, 0.5):
            total += inclusion_field(
                make("cuboid", center=(x, y, 1.5), edges=(1, 1, 1)),
                to_matrix(fidelity.DIRECTION),
                [[1.5, -0.5, 0.5]],
                young_modulus=1.0,
                poisson_ratio=fidelity.POISSON_RATIO,
                quantity="stress",
            )[0]
    expected = [total[j, k] for j, k in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    assert found[:, 1, 3] == close(np.array(expected), rel=1e-12)


@pytest.mark.slow
def test_command_writes_a_row_for_each_case(tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("<!-- benchmark:fidelity -->\n<!-- /benchmark:fidelity -->\n", encoding="utf-8")
    cases = ["cell, flush", "cell, 8 h below"]
    options = ["--size", "8", "--repeats", "1", "--warm", "1", "--threads", "1", "--codes", "image-pressure"]
    assert main(["fidelity", *options, "--cases", *cases, "--markdown", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert [text.count(f" {case} |") for case in cases] == [1, 1]
    assert "ImagePressureVolume, pressure on the window" in text
    assert "cell, flush: N = 8, image-pressure, process 1 of 1" in capsys.readouterr().err
