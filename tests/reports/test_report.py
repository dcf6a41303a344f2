"""The report of a run, parsed: sections, numbers, pictures, sources; nothing from outside, nothing unescaped."""

import base64
import json
import re
import tomllib
from html.parser import HTMLParser

import h5py
import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.numbers import Number
from eigencontact.reference.numbers import known_numbers
from eigencontact.reports.columns import Column, answer, cards

pytestmark = pytest.mark.usefixtures("small_pictures")

SECTIONS = (
    *("top", "pictures", "surface", "numbers", "certificates", "scene"),
    *("model", "left-out", "times", "provenance", "references"),
)
EMPTY = {"meta", "link", "br", "img", "input", "path", "circle"}
PREFIXES = {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
HOSTILE = '</script><script>alert(1)</script>"&'
QUICK = ["stress=[]", "grid.cells-per-contact-radius=8", "output.vtk=false", "output.pictures=false"]
FRETTING = [
    "grid.cells-per-contact-radius=8",
    'steps=[{normal-load = "12.3 N"}, {shift-x = "0.5 um"}]',
    f"title={json.dumps(HOSTILE)}",
    'description="<img src=x onerror=alert(1)>"',
    "output.vtk=false",
]


class Page(HTMLParser):
    """Elements of a page, in order; complains of tags that do not match."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements = [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        element = {"tag": tag, "attrs": dict(attrs), "text": "", "inside": [one["tag"] for one in self.open]}
        self.elements.append(element)
        if tag not in EMPTY:
            self.open.append(element)

    def handle_startendtag(self, tag, attrs):
        assert tag in EMPTY
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop()["tag"] == tag

    def handle_data(self, data):
        for element in self.open:
            element["text"] += data

    def all(self, tag):
        return [element for element in self.elements if element["tag"] == tag]

    def id(self, name):
        return next(element for element in self.elements if element["attrs"].get("id") == name)

    def after(self, element, tag):
        """Elements of a tag inside of another."""
        start = self.elements.index(element) + 1
        depth = len(element["inside"])
        found = []
        for one in self.elements[start:]:
            if len(one["inside"]) <= depth:
                break
            found += [one] if one["tag"] == tag else []
        return found


@pytest.fixture(scope="module")
def fretting(tmp_path_factory, small_pictures):
    """A run with friction in two steps, whose texts are hostile, and its report."""
    folder = tmp_path_factory.mktemp("fretting")
    ec.run(ec.load_scene("fretting-mode-1", FRETTING), folder)
    return folder, Page(ec.report(folder).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def hertz(tmp_path_factory, small_pictures):
    """A run of one step that drew nothing, and its report."""
    folder = tmp_path_factory.mktemp("hertz")
    ec.run(ec.load_scene("hertz", QUICK), folder)
    return folder, Page(ec.report(folder).read_text(encoding="utf-8"))


@pytest.fixture(params=["fretting", "hertz"])
def run(request):
    return request.getfixturevalue(request.param)


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def test_all_sections_are_there_and_linked(run):
    _, page = run
    ids = [element["attrs"]["id"] for element in page.elements if "id" in element["attrs"]]
    assert len(ids) == len(set(ids))
    assert [name for name in ids if name in SECTIONS] == list(SECTIONS)
    links = [one["attrs"]["href"] for one in page.all("a") if "nav" in one["inside"]]
    assert links == [f"#{name}" for name in SECTIONS]


def test_nothing_is_fetched_but_dois_on_a_click(run):
    folder, page = run
    text = (folder / "report.html").read_text(encoding="utf-8")
    addresses = set(re.findall(r"[a-z]+://[^\s\"'<>]+", text))
    assert addresses
    assert all(address.startswith("https://doi.org/10.") for address in addresses)
    for element in page.elements:
        assert not {"srcset", "action", "poster"} & set(element["attrs"])
        assert element["attrs"].get("src", "data:").startswith("data:")
    policy = next(one for one in page.all("meta") if one["attrs"].get("http-equiv") == "Content-Security-Policy")
    assert policy["attrs"]["content"].startswith("default-src 'none'")


def test_numbers_are_those_of_the_summary(run):
    folder, page = run
    summary = summary_of(folder)
    rows = [row for row in page.all("tr") if row["attrs"].get("id", "").startswith("n-")]
    assert {"n-normal_load", "n-max_pressure", "n-approach"} <= {row["attrs"]["id"] for row in rows}
    for row in rows:
        name = row["attrs"]["id"][2:]
        values = [float(one["attrs"]["value"]) for one in page.after(row, "data")]
        column = [step[name] for step in summary["history"]]
        assert values == [column[-1], *([max(column, key=abs)] if len(column) > 1 else [])]
        unit = page.after(row, "td")[-1]["text"]
        shown = float(page.after(row, "data")[0]["text"]) * factor(unit)
        assert shown == close(column[-1], rel=5e-5, abs=1e-300)
    shown = {row["attrs"]["id"][2:] for row in rows}
    absent = set(summary["history"][0]) - shown
    assert "tilt_x" in absent
    assert not [name for name in ("contact_radius", "contact_area") if name in absent]


def factor(unit):
    """SI value of an engineering unit."""
    if unit in ("", "N", "m", "m²", "Pa", "J", "N m", "rad"):
        return 1.0
    return PREFIXES[unit[0]] ** (2 if unit.endswith("²") else 3 if unit.endswith("³") else 1)


def test_the_table_of_steps_is_the_history(fretting):
    folder, page = fretting
    history = summary_of(folder)["history"]
    table = page.id("steps")
    heads = [head["text"] for head in page.after(table, "th") if "thead" in head["inside"]]
    heads = [head.split(" [")[0].replace(" ", "_") for head in heads]
    assert {"tangential_load_x", "shift_x", "slip_fraction", "dissipated_energy"} <= set(heads)
    assert not {"normal_load", "moment_x", "gap_residual", "iterations"} & set(heads)
    rows = [row for row in page.after(table, "tr") if "tbody" in row["inside"]]
    assert len(rows) == len(history) == 2
    for row, step in zip(rows, history, strict=True):
        assert [float(one["attrs"]["value"]) for one in page.after(row, "data")] == [step[name] for name in heads[1:]]


def test_the_result_is_told_in_sentences(fretting):
    folder, page = fretting
    last = summary_of(folder)["history"][-1]
    text = page.id("answer")["text"]
    assert f"Largest contact pressure: {last['max_pressure'] / 1e9:.5g} GPa." in text
    assert f"Work of friction in the solved increments: {last['dissipated_energy'] * 1e9:.5g} nJ." in text
    assert "The shift along x spans 500 nm over all steps, peak to peak." in text


def test_a_number_that_falls_names_its_largest_value_and_the_skipped_cycles_count():
    columns = [
        declared("max_pressure", [1e9, 2e9, 0.0]),
        declared("dissipated_energy", [0.0, 1e-4, 2e-4]),
        declared("worn_volume", [0.0, 1e-18, 2e-18]),
        declared("wear_energy", [0.0, 0.08, 0.16]),
        declared("wear_error", [None, 0.001, 0.0064]),
    ]
    assert answer(columns, [1, 2, 3]) == [
        "Largest contact pressure: 0 GPa; the largest value is 2 GPa, at step 2.",
        "Worn volume of both bodies: 2 µm³ (estimated error 0.64 %).",
        "Work of friction of all cycles, with the skipped ones: 160 mJ.",
    ]


def declared(name, values):
    return Column(known_numbers()[name], values)


def test_cards_have_the_work_of_friction_of_all_cycles():
    solved, whole = declared("dissipated_energy", [0.0, 2e-4]), declared("wear_energy", [0.0, 0.16])
    assert cards([solved, whole]) == [whole]
    assert cards([solved]) == [solved]


def test_paper_has_the_steps_that_say_most_and_no_folded_part(tmp_path):
    changes = [*QUICK, 'steps=[{normal-load = "0.6 N", increments = 3}, {normal-load = "0.1 N", increments = 4}]']
    ec.run(ec.load_scene("hertz", changes), tmp_path)
    text = ec.report(tmp_path).read_text(encoding="utf-8")
    page = Page(text)
    rows = [row for row in page.after(page.id("steps"), "tr") if "tbody" in row["inside"]]
    printed = [page.after(row, "th")[0]["text"] for row in rows if row["attrs"].get("class") != "on-screen"]
    assert (len(rows), printed) == (7, ["1", "3", "7"])
    style = page.all("style")[0]["text"].partition("@media print")[2]
    assert ".on-screen, details:not([open]) { display: none; }" in style
    assert "beforeprint" not in text


def test_residuals_and_times_are_those_of_the_summary(run):
    folder, page = run
    summary = summary_of(folder)
    residuals = [name for name, value in summary["history"][-1].items() if name.endswith("_residual")]
    assert residuals
    for name in residuals:
        assert name.replace("_", " ") in page.id("certificates")["text"]
    times = [float(one["attrs"]["value"]) for one in page.after(page.id("blocks"), "data")]
    assert times == list(summary["seconds_by_block"].values())


def test_the_plan_is_what_explain_tells(hertz):
    folder, page = hertz
    with ec.open_results(folder) as dataset:
        scene = tomllib.loads(dataset.attrs["scene"])
    plan = ec.plan(scene)
    left = [(head["text"], cell["text"]) for head, cell in pairs(page)]
    assert left == [(item.effect, item.reason) for item in plan.left_out]
    for kernel in plan.kernels:
        assert str(kernel) in page.id("model")["text"]
    for part in plan.parts:
        assert f"{part.name}: {part.reason}" in page.id("model")["text"]


def pairs(page):
    rows = [row for row in page.after(page.id("left-out"), "tr") if "tbody" in row["inside"]]
    return [(page.after(row, "th")[0], page.after(row, "td")[0]) for row in rows]


def test_the_scene_on_the_page_runs_again(run):
    folder, page = run
    with ec.open_results(folder) as dataset:
        stored = tomllib.loads(dataset.attrs["scene"])
    shown = next(one for one in page.all("pre") if one["attrs"].get("class") == "toml")
    link = next(one for one in page.all("a") if "download" in one["attrs"])["attrs"]["href"]
    assert tomllib.loads(shown["text"]) == stored
    assert tomllib.loads(base64.b64decode(link.partition(",")[2]).decode()) == stored


def test_texts_of_the_scene_stay_texts(fretting):
    folder, page = fretting
    assert page.all("h1")[0]["text"] == page.all("title")[0]["text"] == HOSTILE
    assert [one["attrs"].get("type") for one in page.all("script")] == ["application/json", None]
    assert not [one for one in page.all("img") if "onerror" in one["attrs"]]
    assert "<script>alert" not in (folder / "report.html").read_text(encoding="utf-8")


def test_every_picture_of_the_run_has_words_and_its_step(fretting):
    folder, page = fretting
    files = {name: text for name, text in summary_of(folder)["files"].items() if name.endswith(".png")}
    images, captions = page.all("img"), [one for one in page.all("figcaption") if "Figure" in one["text"]]
    assert [one["attrs"]["alt"] for one in images] == list(files.values())
    for (name, sentence), image, caption in zip(files.items(), images, captions, strict=True):
        assert base64.b64decode(image["attrs"]["src"].partition(",")[2]) == (folder / name).read_bytes()
        assert sentence in caption["text"]
    of_one_step = [text for name, text in files.items() if name.startswith(("pressure", "shear", "dissipation"))]
    assert len(of_one_step) == 5
    assert all("(step 2 of 2)" in text for text in of_one_step)
    for drawing in page.all("svg"):
        assert page.after(drawing, "title")[0]["text"]
    assert len(page.all("svg")) == len(page.all("figcaption")) - len(images) >= 5


def test_pictures_that_were_not_drawn_are_drawn_for_the_page(hertz):
    folder, page = hertz
    assert not list(folder.glob("*.png"))
    assert page.all("img")[0]["attrs"]["alt"].startswith("Contact pressure, cut to the contact")
    assert "Drawn for this page" in page.id("pictures")["text"]


def test_heights_are_those_of_the_fields(fretting):
    folder, page = fretting
    fields = {field["name"]: field for field in json.loads(page.id("surfaces")["text"])}
    assert {"pressure", "shear", "gap", "displacement_z", "dissipated_energy_density"} == set(fields)
    with ec.open_results(folder) as dataset:
        for name in ("pressure", "gap"):
            field, stored = fields[name], dataset[name]
            assert [step["step"] for step in field["steps"]] == [1, 2]
            scale = {"µm": 1e6, "nm": 1e9}[field["length"]]
            window = stored.sel(
                x=slice(*(np.array(field["x"]) / scale + [-1e-12, 1e-12])),
                y=slice(*(np.array(field["y"]) / scale + [-1e-12, 1e-12])),
            )[:, :: field["every"], :: field["every"]]
            assert list(window.shape[1:]) == field["shape"]
            span = field["high"] - field["low"]
            assert field["high"] == float(stored.max())
            for step, values in zip(field["steps"], window.values, strict=True):
                levels = np.frombuffer(base64.b64decode(step["heights"]), "<u2").reshape(values.shape)
                assert np.abs(field["low"] + span * levels / 65535 - values).max() <= 0.51 * span / 65535


def test_sources_are_those_of_the_run(run):
    folder, page = run
    cited = [one["text"] for one in page.after(page.id("references"), "li")]
    assert cited == summary_of(folder)["references"]
    links = [one["attrs"]["href"] for one in page.after(page.id("references"), "a")]
    assert "https://doi.org/10.1016/S0043-1648(99)00113-1" in links
    bibtex = page.after(page.id("references"), "pre")[0]["text"]
    assert bibtex.count("doi = {") == len(links)
    assert bibtex.count("{") == bibtex.count("}")


def test_a_report_is_written_again_and_replaces_only_reports(fretting, tmp_path, command):
    folder, _ = fretting
    target = tmp_path / "page.html"
    done = command("report", folder, "-o", target)
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith(str(target))
    assert ec.report(folder / "results.nc", target) == target
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    target.write_text("a page about eigencontact", encoding="utf-8")
    with pytest.raises(ec.EigencontactError, match="must be a file that eigencontact wrote"):
        ec.report(folder, target)
    assert target.read_text(encoding="utf-8") == "a page about eigencontact"
    with pytest.raises(ec.EigencontactError, match=r"the report must be a file \.html in a folder that exists"):
        ec.report(folder, tmp_path / "page.pdf")


def test_a_folder_that_is_no_result_is_one_clear_error(tmp_path, command):
    done = command("report", tmp_path)
    assert done.code == 5
    assert re.fullmatch(r"eigencontact: \S+results\.nc must exist \(got nothing there\); give .+\n", done.err)
    (tmp_path / "results.nc").write_bytes(b"no results")
    done = command("report", tmp_path)
    assert done.code == 5
    assert "must be a complete results file" in done.err
    assert not (tmp_path / "report.html").exists()


class _Stops:
    """Interrupts a run before its third step."""

    def step_started(self, point, _total):
        if point.index == 3:
            raise KeyboardInterrupt

    def iterated(self, *_):
        pass

    def step_finished(self, *_):
        pass


def test_a_run_that_is_not_finished_says_so(tmp_path):
    changes = [*QUICK, 'steps=[{normal-load = "0.6 N", increments = 4}]']
    with pytest.raises(KeyboardInterrupt):
        ec.run(ec.load_scene("hertz", changes), tmp_path, watcher=_Stops())
    before = sorted(path.name for path in tmp_path.rglob("*"))
    page = Page(ec.report(tmp_path).read_text(encoding="utf-8"))
    assert "This run is not finished. 2 of 4 steps are stored" in page.id("top")["text"]
    assert len([row for row in page.after(page.id("steps"), "tr") if "tbody" in row["inside"]]) == 2
    row = next(row for row in page.all("tr") if row["attrs"].get("id") == "n-normal_load")
    assert float(page.after(row, "data")[0]["attrs"]["value"]) == close(0.3)
    assert "(step 2 of 2)" in page.all("img")[0]["attrs"]["alt"]
    assert "normal-contact" in page.id("model")["text"]
    assert sorted(path.name for path in tmp_path.rglob("*")) == sorted([*before, "report.html"])


@pytest.mark.parametrize(
    ("unit", "value", "shown", "label"),
    [
        ("m^3", 2.0852e-15, "2085.2", "worn volume [µm³]"),
        ("m3", 2.0852e-15, "2085.2", "worn volume [µm³]"),
        ("m2", 3e-10, "300", "worn volume [µm²]"),
        ("J/m^2", 1.2e4, "12", "worn volume [kJ/m²]"),
        ("1", 0.5, "0.5", "worn volume"),
        ("unknown", 1e-7, "1e-07", "worn volume"),
    ],
)
def test_numbers_are_told_in_units_of_engineers(unit, value, shown, label):
    column = Column(Number(name="worn_volume", unit=unit, meaning=""), [0.0, None, value])
    assert (column.text(value), column.label, column.text(None)) == (shown, label, "")


def test_a_missing_summary_and_a_missing_plan_are_told(hertz, tmp_path):
    folder, _ = hertz
    (tmp_path / "results.nc").write_bytes((folder / "results.nc").read_bytes())
    with h5py.File(tmp_path / "results.nc", "r+") as file:  # as earlier versions wrote it
        del file.attrs["plan"]
    page = Page(ec.report(tmp_path).read_text(encoding="utf-8"))
    assert "There is no summary.json of this run" in page.id("top")["text"]
    assert "which this run has not written" in page.id("times")["text"]
    assert "did not store the plan" in page.id("model")["text"]
    assert "Not known" in page.id("left-out")["text"]


def test_a_sweep_tells_every_variant_and_why_some_failed(tmp_path):
    vary = {"steps.normal-load": ["0.2 N", "0.4 N"], "geometry.radius": ["0.1 mm", "-1 mm"]}
    scene = ec.load_scene("hertz", [*QUICK, "title=<b>bold</b>"])
    found = ec.sweep(scene, vary, tmp_path, fields=["pressure"], grid="shared")
    page = Page(ec.report(tmp_path).read_text(encoding="utf-8"))
    assert page.all("h1")[0]["text"] == "<b>bold</b>"
    assert "2 of 4 variants converged." in page.id("top")["text"]
    heads = [head["text"] for head in page.after(page.id("variants"), "th") if "thead" in head["inside"]]
    assert heads[:2] == list(vary)
    names = [head.split(" [")[0].replace(" ", "_") for head in heads[2:]]
    assert {"normal_load", "max_pressure", "contact_radius"} <= set(names)
    assert not {"gap_residual", "iterations", "peak_memory_bytes"} & set(names)
    rows = [row for row in page.after(page.id("variants"), "tr") if "tbody" in row["inside"]]
    for k, load in enumerate(vary["steps.normal-load"]):
        whole, failed = rows[2 * k : 2 * k + 2]
        assert [head["text"] for head in page.after(whole, "th")] == [load, "0.1 mm"]
        stored = [float(found.dataset[name][k, 0]) for name in names]
        assert [float(one["attrs"]["value"]) for one in page.after(whole, "data")] == stored
        assert page.after(failed, "td")[0]["text"] == str(found.dataset["failed"].values[k, 1])
    drawn = [name for name in found.files if name.endswith(".png")]
    assert "pressure-profiles.png" in drawn
    assert sorted(one["attrs"]["src"].partition(",")[2] for one in page.all("img")) == sorted(
        base64.b64encode((tmp_path / name).read_bytes()).decode() for name in drawn
    )
    (tmp_path / "sweep.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ec.EigencontactError, match=r"sweep\.json must describe a sweep"):
        ec.report(tmp_path)
