import base64
import csv
import hashlib
import html
import json
import re
import shutil
from html.parser import HTMLParser

import pytest
from made_up_runs import BAD, GOOD, TASKS, record

import polyfold
from polyfold.cli import main
from polyfold.errors import ConfigError
from polyfold.viz._report import report_html


class Page(HTMLParser):
    """Elements with their attributes, and the text outside of scripts and styles."""

    VOID = ("meta", "link", "img", "br", "line", "rect", "circle", "polyline", "polygon")

    def __init__(self, html):
        super().__init__()
        self.elements, self.text, self.raw, self._inside = [], "", {"script": [], "style": []}, None
        self.open = []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in self.VOID:
            self.open.append(tag)
        if tag in self.raw:
            self._inside = tag
            self.raw[tag].append("")

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag, f"</{tag}> closes something else"
        self._inside = None if tag == self._inside else self._inside

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_data(self, data):
        if self._inside:
            self.raw[self._inside][-1] += data
        else:
            self.text += data

    def all(self, tag, **attributes):
        return [found for name, found in self.elements if name == tag and attributes.items() <= found.items()]

    def cards(self):
        return [found for found in self.all("article") if found["class"].startswith("card")]

    def options(self, name):
        """Values of a filter, without the first, which is everything."""
        start = next(i for i, (tag, found) in enumerate(self.elements) if tag == "select" and found["name"] == name)
        values = []
        for tag, found in self.elements[start + 1 :]:
            if tag != "option":
                break
            values.append(found["value"])
        return values[1:]


def test_every_variant_kind_and_section_is_there(full_run):
    page = Page(report_html(full_run))
    assert page.open == [], "every element is closed"
    for wanted in ("made-up", "ours", "theirs", "square", "tshirt", "12 episodes", "seed 11", "numpy", "2.4.6"):
        assert wanted in page.text
    ids = {found["id"] for _, found in page.elements if "id" in found}
    assert {"success", "comparison", "thresholds", "failures", "time", "gallery", "made"} <= ids
    inner = {found["href"][1:] for found in page.all("a") if "download" not in found}
    assert inner <= ids, "links lead somewhere on the page"
    assert len(page.all("svg", **{"class": "panel"})) == 3, "square, tshirt and all"
    assert "100.0 [51.0, 100.0]" in page.text, "intervals stand beside means"
    assert "−100.0 [−100.0, −7.0]" in page.text, "so do paired differences"


def test_the_numbers_behind_every_chart_can_be_saved(full_run):
    page = Page(report_html(full_run))
    saved = {found["download"]: found["href"] for found in page.all("a") if "download" in found}
    assert set(saved) == {f"{name}.csv" for name in ("success", "thresholds", "failures", "time")}
    rows = {}
    for name, link in saved.items():
        kind, content = link.split(",", 1)
        assert kind == "data:text/csv;charset=utf-8;base64"
        rows[name] = list(csv.DictReader(base64.b64decode(content).decode().splitlines()))
    results = polyfold.open(full_run)
    whole = next(row for row in rows["success.csv"] if (row["variant"], row["kind"]) == ("ours", "all"))
    succeeded = [record.succeeded for record in results.of("ours")]
    assert float(whole["success %"]) == pytest.approx(100 * sum(succeeded) / len(succeeded), abs=1e-3)
    as_it_stands = [
        row
        for row in rows["thresholds.csv"]
        if (row["kind"], row["variant"], row["thresholds ×"]) == ("all", "ours", "1")
    ]
    assert [row["success %"] for row in as_it_stands] == [whole["success %"]]


def test_one_kind_of_interval_is_spoken_of(full_run):
    text = Page(report_html(full_run)).text
    assert "bootstrap" not in text
    assert text.count("Wilson") == 1


def test_the_pictures_can_be_skipped(full_run):
    text = report_html(full_run)
    assert text.index('href="#made">Skip') < text.index('class="cards"')


def test_nothing_is_fetched_and_only_our_own_script_and_style_run(full_run):
    html = report_html(full_run)
    page = Page(html)
    for tag, attributes in page.elements:
        for name, value in attributes.items():
            assert not name.startswith("on"), f"<{tag} {name}>"
            assert name != "style", f"<{tag} style> would be blocked"
            if name in ("src", "href", "srcset", "action", "poster", "data", "xlink:href"):
                assert value.startswith(("data:", "#")), f"<{tag} {name}={value[:60]}>"
    assert not re.search(r"https?://|//[a-z]+\.|@import|url\(", re.sub(r"data:[^\"]*", "", html))
    policy = page.all("meta", **{"http-equiv": "Content-Security-Policy"})[0]["content"]
    assert policy.startswith("default-src 'none'")
    for tag in ("script", "style"):
        (content,) = page.raw[tag]
        digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in policy


HOSTILE = "<script>alert('1')</script>\"><img src=x onerror=alert(2)> & {{ 7*7 }}"


def test_whatever_people_and_models_write_is_escaped(make_run):
    hostile = record(
        HOSTILE,
        "tshirt-half-left",
        2000,
        BAD,
        instruction=HOSTILE,
        type=HOSTILE,
        cause=HOSTILE,
        garment={"kind": HOSTILE},
        task=HOSTILE,
        subgoals=[HOSTILE],
        failure={"stage": HOSTILE, "reason": HOSTILE},
        seconds={HOSTILE: 1.0},
    )
    other = record("plain", "tshirt-half-left", 2000, GOOD)
    page = Page(report_html(make_run([hostile, other], [HOSTILE, "plain"])))
    assert len(page.all("script")) == 1
    assert not any("onerror" in attributes for _, attributes in page.elements)
    assert all(found["src"].startswith("data:image/webp") for found in page.all("img"))
    assert page.text.count(HOSTILE) > 10
    assert page.cards()[0]["data-variant"] == HOSTILE


def test_filters_offer_what_the_cards_have(full_run):
    page = Page(report_html(full_run))
    cards = page.cards()
    assert len(cards) == 12
    for name in ("variant", "kind", "type", "cause"):
        assert set(page.options(name)) == {card[f"data-{name}"] for card in cards} - {""}
    assert {card["data-success"] for card in cards} == {"yes", "no"} == set(page.options("success"))
    assert {card["data-pick"] for card in cards} == {"best", "median", "failure", ""}


def test_an_interrupted_run_says_so_and_ignores_a_half_written_line(make_run):
    records = [record("ours", "square-corner-top_left", 2000, GOOD)]
    page = Page(report_html(make_run(records, ["ours", "theirs"], tail='{"key": "ours/squ')))
    assert "1 of 12 episodes" in page.text
    assert "Unfinished run." in page.text
    assert "Compared with" not in page.text, "the other variant has no episode yet"


@pytest.mark.parametrize("missing", ["episodes", "first variant"])
def test_what_has_not_run_yet_is_left_out(make_run, missing):
    records = [record("theirs", "square-corner-top_left", 2000, BAD)] if missing == "first variant" else []
    page = Page(report_html(make_run(records, ["ours", "theirs"])))
    assert "Unfinished run." in page.text
    assert ("No episode is finished yet." in page.text) == (not records)


def test_a_run_without_pictures_says_how_to_get_them(make_run):
    page = Page(report_html(make_run([record("ours", "square-corner-top_left", 2000, GOOD)], ["ours"], pictured=False)))
    assert "This run has no pictures." in page.text
    assert not page.cards()


def test_episodes_whose_reference_moved_nothing_are_named(make_run):
    idle = {"miou": 1.0, "mppe": 0.0, "moved-part": None}
    made = record("ours", "tshirt-half-left", 2001, GOOD, metrics=idle, reference_idle=True)
    page = Page(report_html(make_run([made], ["ours"])))
    assert "the reference itself moves nothing" in page.text
    assert "tshirt-half-left on tshirt 2001" in page.text


@pytest.fixture
def noise_run(full_run, tmp_path):
    """The same run, of variants that differ in the order of particles alone."""
    folder = tmp_path / "noise"
    shutil.copytree(full_run, folder)
    description = json.loads((folder / "run.json").read_text("utf-8"))
    variants = description["asked"]["study"]["variants"]
    description["components"] = {
        name: {"simulator": {"name": "xpbd", "params": {"order": number}}} for number, name in enumerate(variants)
    }
    (folder / "run.json").write_text(json.dumps(description), "utf-8")
    return folder


def test_the_noise_floor_is_a_footnote_where_it_is_given(full_run, noise_run):
    assert "Noise floor" not in report_html(full_run)
    page = report_html(full_run, noise=polyfold.open(noise_run))
    assert "Noise floor" in page
    assert "MPPE [mm]" in page.partition("Noise floor")[2]


def test_a_single_variant_needs_no_comparison(make_run):
    records = [record("ours", task, 2000, GOOD) for task in TASKS]
    assert 'id="comparison"' not in report_html(make_run(records, ["ours"]))


def test_the_configuration_on_the_page_is_the_file_that_runs_the_study_again(full_run, tmp_path):
    shown = html.unescape(re.search(r'<pre tabindex="0">(.*?)</pre>', report_html(full_run), re.DOTALL)[1])
    (tmp_path / "again.toml").write_text(shown)
    assert polyfold.load(tmp_path / "again.toml") == polyfold.open(full_run).study


def test_the_same_run_gives_the_same_page(full_run):
    assert report_html(full_run) == report_html(full_run)


def test_the_verb_writes_the_page_into_the_run_directory_or_where_asked(full_run, noise_run, tmp_path, capsys):
    assert main(["report", str(full_run)]) == 0
    assert (full_run / "report.html").read_text("utf-8") == report_html(full_run)
    assert str(full_run / "report.html") in capsys.readouterr().out
    assert (
        main(["report", str(full_run), "--out", str(tmp_path / "new" / "page.html"), "--noise-floor", str(noise_run)])
        == 0
    )
    assert "Noise floor" in (tmp_path / "new" / "page.html").read_text("utf-8")
    assert main(["report", str(tmp_path)]) == 1
    assert "no run directory" in capsys.readouterr().err


def test_there_must_be_a_run(tmp_path):
    with pytest.raises(ConfigError, match="no run directory"):
        report_html(tmp_path)
