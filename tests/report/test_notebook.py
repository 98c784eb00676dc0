"""What a notebook shows of a result without a call: its sentences, its numbers with units, one picture."""

from __future__ import annotations

import base64
import inspect
import io
import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import harness
from harness.formatting import number
from harness.identify.record import EffectRecord, ParameterRecord
from harness.report.diagnosis.kept_errors import drawn
from harness.report.notebook import notebook_html
from harness.report.tables import Summary, Table, texts
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing

ODD = "<b>rig</b> & \"co\" <script>alert('1')"
SOURCE = re.compile(r'src="data:image/png;base64,([^"]+)"')
LARGEST = 200_000  # bytes of a result in a notebook, so that one with ten results stays below 2 MB


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short case in a folder whose name is markup."""
    return write_short_case(tmp_path_factory.mktemp("notebook") / "<b>my rig<i>")


def pictures(html: str) -> list[Image.Image]:
    """The pictures in a text, decoded."""
    return [Image.open(io.BytesIO(base64.b64decode(one))) for one in SOURCE.findall(html)]


def cells(html: str) -> list[list[str]]:
    """Every row of every table as plain texts."""
    rows = re.findall(r"<tr[^>]*>(.*?)</tr>", html, re.DOTALL)
    found = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL) for row in rows]
    return [[unescape(re.sub(r"<[^>]+>", "", cell)) for cell in row] for row in found]


def _figure() -> Figure:
    """A line < two lines.

    More on it.
    """
    figure = Figure()
    figure.add_subplot().plot([0, 1])
    return figure


def test_every_result_shows_itself() -> None:
    """Show each public result class by text and HTML; tables, effects and errors of Python show themselves."""
    given = {"Effect", "Parameter", "Force", "Acting", "HarnessError", "InputError", "EngineFailure"}
    classes = {name for name in harness.__all__ if inspect.isclass(getattr(harness, name))} - given
    assert len(classes) > 10
    for name in classes:
        assert hasattr(getattr(harness, name), "_repr_html_"), name


def test_texts_are_escaped_wherever_they_stand() -> None:
    """Escape title, sentences, caption, headings and cells."""
    html = notebook_html(Summary(ODD, [ODD], [Table(ODD, texts(ODD, "b"), [(ODD, ODD)])]))
    assert "<b>" not in html
    assert "<script" not in html
    assert html.count("&lt;b&gt;rig&lt;/b&gt; &amp;") == 6


def test_a_picture_is_part_of_the_text() -> None:
    """Embed the figure with the first line of its function's docstring as caption, and load nothing."""
    html = notebook_html(Summary("t", ["l"], []), _figure)
    (image,) = pictures(html)
    assert image.format == "PNG"
    assert html.count("A line &lt; two lines.") == 2  # caption and alternative text
    assert "More on it" not in html
    assert not re.search(r'(src|href)="(?!data:)', html)
    assert "@import" not in html


def test_a_picture_that_cannot_be_drawn_costs_itself_only() -> None:
    """Say what the drawing raised, and show sentences and tables all the same."""

    def broken() -> Figure:
        raise ZeroDivisionError("no <b>scale</b>")

    html = notebook_html(Summary("t", ["the answer"], [Table("c", ["x [m]"], [("1",)])]), broken)
    assert "picture failed: ZeroDivisionError: no &lt;b&gt;scale" in html
    assert "the answer" in html
    assert ["1"] in cells(html)
    assert pictures(html) == []


def test_a_case_shows_its_recording(folder: Path) -> None:
    """Draw beam angle and position, and escape the folder's name."""
    html = harness.load_case(folder)._repr_html_()
    assert "&lt;b&gt;my rig&lt;i&gt;" in html
    assert "<b>" not in html
    (image,) = pictures(html)
    assert image.width == 900
    assert np.ptp(np.asarray(image.convert("L"), dtype=float)) > 200.0  # it is not blank


def test_the_recording_to_draw_is_chosen_by_name(folder: Path) -> None:
    """Draw the one that is named, say where it is simulated, and say which there are if there is none of this name."""
    case = harness.load_case(folder)
    assert case.plot("rec_02.csv").axes[0].get_title() == "rec_02.csv"
    assert harness.load_case().plot("rec_02.csv").axes[0].get_title() == "rec_02.csv (simulated)"
    with pytest.raises(harness.InputError, match=r"no recording 'rec_2\.csv'\. Did you mean 'rec_02\.csv'\?"):
        case.plot("rec_2.csv")


def test_a_comparison_shows_its_scores(folder: Path) -> None:
    """Have the errors of the table of scores, in mm and with the unit, and the picture of the trajectories."""
    comparison = harness.compare(folder, engines=["mujoco"], windows=[1.0])
    html = comparison._repr_html_()
    scores = comparison.scores
    shown = scores[scores["horizon"] == comparison.study.headline.name].set_index("source")
    rows = {row[0]: row for row in cells(html)}
    for source, score in shown.iterrows():
        assert rows[str(source)][1] == f"{score['rms_error_mm']:.2f}"
    assert any("mm" in head for head in rows["source"])
    assert unescape(re.sub(r"<[^>]+>", "", html)).count(comparison.answer[0]) == 1
    assert len(pictures(html)) == 1
    assert len(html) < LARGEST


def test_a_kept_diagnosis_shows_the_numbers_of_its_file(folder: Path, tmp_path: Path) -> None:
    """Have effects with intervals and units, errors in mm, and the errors' picture, which needs no recording."""
    record = nothing_missing(folder)
    held = record.errors.heldout
    before = held.before.model_copy(update={"rms_m": {"3 s": 0.0791, "whole": 0.2}})
    after = held.after.model_copy(update={"rms_m": {"3 s": 0.0081, "whole": None}})
    errors = record.errors.model_copy(update={"heldout": held.model_copy(update={"before": before, "after": after})})
    size = ParameterRecord(value=0.0151, low=0.0112, high=0.0189, unit="1")
    effect = EffectRecord(
        name="rolling_resistance", parameters={"coefficient": size}, indistinguishable_from=("stribeck_friction",)
    )
    told = record.model_copy(update={"errors": errors, "effects": (effect,), "verdict": "effect"})
    (tmp_path / "diagnosis.json").write_text(told.text(), encoding="utf-8")
    kept = harness.load_diagnosis(tmp_path)
    html = kept._repr_html_()
    numbers = ["0.01510", "0.01120 … 0.01890", "1", "stribeck_friction"]
    assert ["rolling_resistance", "coefficient", *numbers] in cells(html)
    assert ["cam", "3 s", "79.1", "8.10"] in cells(html)
    assert ["cam", "whole", "200", "–"] in cells(html)
    assert len(pictures(html)) == 1
    marks = [line for line in kept.plot().axes[0].lines if line.get_linestyle() == "None"]
    shown = np.concatenate([line.get_ydata() for line in marks])
    assert {79.1, 8.1, 200.0} == {round(float(value), 6) for value in shown if np.isfinite(value)}


def test_kept_errors_are_over_the_length_of_the_horizon() -> None:
    """Place 1, 3 and 5 s on a logarithmic axis in seconds, whatever their order, and the rest beyond them."""
    errors = [("cam", name, 0.01, 0.005) for name in ("5 s", "1 s", "3 s", "whole")]
    axes = drawn(errors).axes[0]
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert "[s]" in axes.get_xlabel()
    assert [one.get_text() for one in axes.get_xticklabels()] == ["1", "3", "5", "rest"]
    assert list(axes.get_xticks()) == [1.0, 3.0, 5.0, 10.0]
    assert list(axes.lines[0].get_xdata()) == pytest.approx([1.0, 3.0, 5.0, 10.0])


@pytest.mark.slow
def test_a_check_shows_its_limits(folder: Path) -> None:
    """Have every limit in the table, and left of 1 in the picture just those that show."""
    check = harness.check(folder)
    html = check._repr_html_()
    rows = {row[0]: row for row in cells(html) if len(row) == 7}
    for one in check.record()["effects"]:
        shown = rows[one["effect"]]
        assert (shown[4], shown[5]) == (number(one["typical"]), one["unit"])
        if one["limit"] is not None and not one["shows_below_limit"] and np.isfinite(one["limit"]):
            assert shown[2] == number(one["limit"])
    (axes,) = check.plot().axes
    recorded, explained = (line.get_xdata() for line in axes.lines[:2])
    assert int(np.sum(recorded <= 1.0)) == int(check.effects["shows"].sum())
    assert int(np.sum(explained <= 1.0)) == int(check.effects["shows_explained"].sum())
    assert len(pictures(html)) == 1


def test_a_replay_shows_what_differs() -> None:
    """Say whether all came out again, and list what did not."""
    from harness.identify.selection.replay import Mismatch

    differs = harness.Replayed(Path("d.json"), 7, 5, (Mismatch("verdict", "is <none>"),), 1e-9, {"numpy": "1 → 2"})
    html = differs._repr_html_()
    assert "7 decisions, 5 fits replayed: 1 differ." in html
    assert ["verdict", "is <none>"] in cells(html)
    assert ["numpy", "1 → 2"] in cells(html)
    same = harness.Replayed(Path("d.json"), 7, 5, (), 0.0, {})
    assert "nothing differs" in repr(same)
