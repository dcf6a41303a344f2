"""Lines of progress of a command whose output is no terminal."""

from eigencontact_verification.reporting import progress


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
