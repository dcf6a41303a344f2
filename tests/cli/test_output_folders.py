"""An output folder that is a file: each command refuses it in one line, before it computes anything."""

import pytest

import eigencontact as ec
from conftest import QUICK


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hertz")
    ec.run(ec.load_scene("hertz", QUICK), folder).dataset.close()
    return folder


@pytest.mark.parametrize("inside", ["", "deeper"])
@pytest.mark.parametrize(
    "words",
    [
        "run hertz",
        "sweep hertz --vary steps.normal-load=0.1,0.2",
        "plot RESULTS",
        "plot RESULTS --field pressure",
        "report RESULTS",
        "verify cuboid --quick",
        "verify RESULTS",
        "campaign voids --coarse",
        "study spence-radius --coarse",
        "tradeoff hertz --quick --only grid",
        "extremes --quick --feature layers",
        "new-plugin bowl",
    ],
)
def test_a_file_is_no_output_folder(command, results, tmp_path, words, inside):
    taken = tmp_path / "taken"
    taken.write_text("notes", encoding="utf-8")
    refused = command(*(str(results) if word == "RESULTS" else word for word in words.split()), "-o", taken / inside)
    assert refused.code in (2, 5)
    assert refused.err.count("\n") == 1, refused.err  # no progress, no traceback
    assert "Errno" not in refused.err
    assert " must be " in refused.err
    assert taken.name in refused.err
    assert taken.read_text(encoding="utf-8") == "notes"
