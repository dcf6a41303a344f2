"""What the commands of verification share: lines of progress, and files of another origin that they never replace."""

import json

import pytest

from eigencontact.results.ownership import is_ours
from eigencontact_verification.reporting import progress
from eigencontact_verification.reporting.files import open_folder, report_names, write_report_files
from eigencontact_verification.reporting.page import html_page


def test_lines_name_the_item_and_the_time_left(monkeypatch, capsys):
    now = iter([0.0, 30.0, 200.0, 300.0])
    monkeypatch.setattr(progress, "monotonic", lambda: next(now))
    with progress.counted("cells", "run ") as finished:
        finished("3 cells: model", 1, 4)
        finished("3 cells: reference, refinement 1 of 3", 2, 3)
        finished("4 cells: model", 3, 3)
    assert capsys.readouterr().err.splitlines() == [
        "run 1 of 4: 3 cells: model; about 90 s left",
        "run 2 of 3: 3 cells: reference, refinement 1 of 3; about 1 min 40 s left",
        "run 3 of 3: 4 cells: model",
    ]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["study", "spence-radius", "--coarse"], "spence-radius.json"),
        (["study", "spence-radius", "--coarse"], "spence-radius.png"),
        (["campaign", "coatings", "--coarse"], "coatings/report.md"),
        (["campaign", "coatings", "--coarse"], "coatings/table.csv"),
        (["tradeoff", "hertz", "--quick"], "tradeoff.md"),
        (["tradeoff", "hertz", "--quick"], "tradeoff.png"),
        (["extremes", "--quick", "--feature", "loads"], "report.html"),
        (["verify", "--quick", "--kernel", "sphere"], "report.json"),
        (["verify", "--quick", "--kernel", "sphere"], "figures/sphere-depth-1-5-zz-nu-30.png"),
    ],
)
def test_a_file_of_others_stops_a_command_before_it_computes(command, tmp_path, arguments, name):
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    path.write_text("my notes on eigencontact" if path.suffix != ".png" else "mine", encoding="utf-8")
    outcome = command(*arguments, "-o", tmp_path)
    assert outcome.code == 5, outcome.err
    assert f"{path} must be a file that eigencontact wrote, or not be there" in outcome.err
    assert [file for file in tmp_path.rglob("*") if file.is_file()] == [path]


def test_a_page_and_a_figure_of_others_stay(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, arguments in {
        "page.md": ["extremes", "--quick", "--markdown", "page.md"],
        "mine.png": ["verify", "--quick", "--kernel", "sphere", "--figure", "sphere/depth-1-5-zz-nu-30=mine.png"],
    }.items():
        (tmp_path / name).write_text("mine", encoding="utf-8")
        assert f"{name} must be a file that eigencontact wrote" in command(*arguments).err
        assert (tmp_path / name).read_text(encoding="utf-8") == "mine"


def test_report_files_say_whose_they_are_and_are_replaced(tmp_path):
    for content in ("first", "second"):
        open_folder(tmp_path, report_names().values())
        files = write_report_files(tmp_path, {"content": content}, markdown=f"# {content}", html=html_page(content, []))
    assert json.loads(files["json"].read_text(encoding="utf-8"))["content"] == "second"
    assert all(map(is_ours, files.values()))
