"""Pictures of datasets: the right values in the right units."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

pytest.importorskip("matplotlib")

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
BALL = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
VELOCITY = {"from": "0.1 m/s", "to": "5 m/s", "count": 30, "spacing": "log"}


@pytest.mark.slow
def test_a_history_is_drawn_from_its_file(tmp_path: Path) -> None:
    history = fm.simulate(BALL)
    ds = fd.open(fd.write(fd.to_dataset(history), tmp_path / "x.nc"))
    figure = ds.film.plot(tmp_path / "x.png")
    top = max(np.max(line.get_ydata()) for line in figure.axes[0].lines)
    assert top == pytest.approx(history.summary["maximum_force"], rel=1e-9)
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")


def test_a_history_of_a_law_of_python_is_drawn_from_its_samples() -> None:
    own = fm.Scene(BALL.impactor, BALL.target, fm.Contact(law=fm.Hertz(effective_modulus=1e11, radius=0.01)))
    history = fm.simulate(own)
    figure = fd.to_dataset(history).film.plot()
    assert len(figure.axes) == 4  # no energies: the mass is not known
    top = max(np.max(line.get_ydata()) for line in figure.axes[0].lines)
    assert top == pytest.approx(history.summary["maximum_force"], rel=1e-9)


@pytest.mark.slow
def test_points_of_a_measurement(tmp_path: Path) -> None:
    text = "time [us], force [kN], displacement [um]\n0, 0, 0\n10, 0.09, 2.4\n20, , 4.9\n"
    (tmp_path / "m.csv").write_text(text, encoding="utf-8")
    path = fd.write(fd.from_csv(tmp_path / "m.csv"), tmp_path / "m.nc")
    assert main(["plot", str(path)]) == 0 and (tmp_path / "m.png").stat().st_size > 5000
    force, way = fd.open(path).film.plot().axes
    assert (force.get_ylabel(), way.get_ylabel()) == ("contact force (N)", "impactor displacement (µm)")
    assert way.get_xlabel() == "time (µs)"
    np.testing.assert_allclose(force.lines[0].get_xydata(), [[0, 0], [10, 90], [20, np.nan]], rtol=1e-12)
    np.testing.assert_allclose(way.lines[0].get_xydata(), [[0, 0], [10, 2.4], [20, 4.9]], rtol=1e-12)
    assert way.lines[0].get_linestyle() == "None"
    (tmp_path / "r.csv").write_text("velocity [mm/s], restitution\n50, 0.98\n500, 0.9\n4000, 0.8\n", encoding="utf-8")
    (panel,) = fd.plot(fd.from_csv(tmp_path / "r.csv")).axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("impactor velocity (m/s)", "coefficient of restitution")
    np.testing.assert_allclose(panel.lines[0].get_xydata(), [[0.05, 0.98], [0.5, 0.9], [4, 0.8]], rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("option", [{"quantity": "maximum_force"}, {"over": "foo"}, {"at": {"impact": 1}}])
def test_sweep_arguments_are_refused_for_histories(option: dict, tmp_path: Path) -> None:
    ds = fd.to_dataset(fm.simulate(BALL))
    with pytest.raises(ValueError, match=f"^{next(iter(option))}: is for sweeps, this is an impact history"):
        fd.plot(ds, **option)
    assert main(["plot", str(fd.write(ds, tmp_path / "x.nc")), "--over", "foo"]) == 3


def test_a_selection_is_labelled_by_its_words() -> None:
    laws = ["hertz", "stronge", "big-alabo"]
    ds = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "contact.law": laws})
    for order in ([2, 1], [1]):
        (panel,) = fd.plot(ds.isel(contact_law=order)).axes
        assert [text.get_text() for text in panel.get_legend().get_texts()] == [laws[k] for k in order]
        for line, k in zip(panel.lines, order, strict=True):
            assert np.array_equal(line.get_ydata(), ds["coefficient_of_restitution"].values[:, k])
    picked = fd.plot(ds.isel(contact_law=[1, 2]), over="impactor_velocity", at={"contact_law": "stronge"})
    assert np.array_equal(picked.axes[0].lines[0].get_ydata(), ds["coefficient_of_restitution"].values[:, 1])
    assert "contact law stronge" in picked.axes[0].get_title()
    with pytest.raises(ValueError, match='at: contact_law has stronge, not "hertz"'):
        fd.plot(ds.isel(contact_law=[1]), over="impactor_velocity", at={"contact_law": "hertz"})
    for one in (ds.isel(impactor_velocity=3, contact_law=1), ds.isel(impactor_velocity=[3], contact_law=1)):
        (point,) = fd.plot(one, quantity="maximum_force").axes[0].lines
        force = float(ds["maximum_force"][3, 1])
        assert point.get_xdata().size == 1 and point.get_ydata()[0] == pytest.approx(force, rel=1e-12)


def test_lines_for_words_and_few_values() -> None:
    ds = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "contact.law": ["hertz", "stronge"]})
    panel = fd.plot(ds, quantity="maximum_force").axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("impactor velocity (m/s)", "maximum force (kN)")
    assert panel.get_xscale() == "log"
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["hertz", "stronge"]
    for k, line in enumerate(panel.lines):
        np.testing.assert_allclose(line.get_ydata() * 1e3, ds["maximum_force"].values[:, k])
    few = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "target.material.yield_strength": ["250 MPa", "310 MPa"]})
    panel = few.film.plot().axes[0]
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["250 MPa", "310 MPa"]
    panel = few.film.plot(over="target_material_yield_strength", at={"impactor_velocity": 1.0}).axes[0]
    assert panel.get_title() == f"at impactor velocity {float(few['impactor_velocity'][17]):.4g} m/s"
    assert len(panel.lines) == 1
    panel = fd.plot(ds, over="contact_law", at={"impactor_velocity": 5.0}).axes[0]
    assert [text.get_text() for text in panel.get_xticklabels()] == ["hertz", "stronge"]
    assert {(line.get_linestyle(), line.get_marker()) for line in panel.lines} == {("None", "o")}  # words have no order


@pytest.mark.parametrize("kind", [None, "scatter"])
def test_points_have_the_colour_of_their_word(kind: str | None) -> None:
    """The impacts of a sampled sweep over two laws."""
    over = {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}, "contact.law": ["hertz", "stronge"]}
    ds = fd.sweep(BALL, over, design="random", samples=40)
    panel = ds.film.plot(kind=kind, quantity="maximum_force").axes[0]
    assert {text.get_text() for text in panel.get_legend().get_texts()} == {"hertz", "stronge"}
    lines = {line.get_label(): line for line in panel.get_lines()}
    words = np.array(ds["contact_law"].attrs["flag_meanings"].split())[ds["contact_law"].values]
    for word, line in lines.items():
        assert line.get_xdata() == pytest.approx(ds["impactor_velocity"].values[words == word])
    assert len({line.get_color() for line in lines.values()}) == 2


def test_names_of_materials_are_written_with_spaces() -> None:
    ds = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "target.material": ["mild steel", "aluminium 6061-T6"]})
    panel = fd.plot(ds, quantity="maximum_force").axes[0]
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["mild steel", "aluminium 6061-T6"]
    panel = fd.plot(ds, over="target_material", at={"impactor_velocity": 5.0}, quantity="maximum_force").axes[0]
    assert [text.get_text() for text in panel.get_xticklabels()] == ["mild steel", "aluminium 6061-T6"]


def test_heat_map_and_cloud() -> None:
    radius = {"from": "5 mm", "to": "15 mm", "count": 11}
    ds = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "impactor.radius": radius, "impactor.mass": ["60 g", "70 g"]})
    figure = fd.plot(ds, quantity="contact_duration", at={"impactor_mass": "70 g"})
    panel, bar = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("impactor velocity (m/s)", "impactor radius (mm)")
    assert bar.get_ylabel() == "contact duration (µs)"
    assert panel.get_title() == "at impactor mass 0.07 kg"
    expected = ds["contact_duration"].values[:, :, 1].T * 1e6
    np.testing.assert_allclose(panel.collections[0].get_array().reshape(expected.shape), expected)
    drawn = fd.sweep(BALL, {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}}, "random", samples=500)
    panel = fd.plot(drawn).axes[0]
    assert len(panel.lines[0].get_xdata()) == 500
    two = {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}, "impactor.mass": {"uniform": ["1 g", "2 g"]}}
    panel, bar = fd.plot(fd.sweep(BALL, two, "random", samples=50)).axes
    assert bar.get_ylabel() == "coefficient of restitution"


WIDE = """
impactor = { radius = "1 mm", velocity = "1 m/s", material = "mild steel" }
contact = { law = "hertz" }
effects = { boundary_reflections = true }
[target]
kind = "plate"
material = "mild steel"
thickness = "1 mm"
size = ["10 m", "10 m"]
edges = "clamped"
"""


@pytest.mark.slow
def test_a_sweep_that_failed(tmp_path, capsys):
    """The reasons stand on standard error and, instead of empty axes, in the picture; the exit status is 3."""
    (tmp_path / "scene.toml").write_text(WIDE, encoding="utf-8")
    sweep, found = tmp_path / "sweep.toml", str(tmp_path / "sweep.nc")
    sweep.write_text('scene = "scene.toml"\n[over]\n"impactor.velocity" = ["1 m/s", "2 m/s"]\n', encoding="utf-8")
    assert main(["sweep", str(sweep), "--output", found]) == 3
    said = "2 of 2 impacts failed: 2 vibrates (the target vibrates between its edges; use simulate()"
    printed = capsys.readouterr()
    assert f"warning: {said}" in printed.err
    assert printed.out.splitlines()[1:] == ["2 impacts: 2 vibrates"]
    assert main(["sweep", str(sweep), "--output", found, "--force", "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["accuracy"]["estimated"] is None
    with fd.open(found) as ds:
        figure = fd.plot(ds)
        assert fd.validate(ds) == []
    assert figure.axes == []
    assert said in figure.texts[0].get_text().replace("\n", " ")


def test_impacts_that_failed_are_counted() -> None:
    balls = fm.Scene.from_toml(SCENES / "two_steel_balls.toml")
    target = {"from": "-0.5 m/s", "to": "1.5 m/s", "count": 21}
    ds = fd.sweep(
        balls, {"impactor.velocity": {"from": "1 m/s", "to": "2 m/s", "count": 11}, "target.velocity": target}
    )
    failed = np.isnan(ds["maximum_force"].values)
    (title,) = (panel.get_title() for panel in fd.plot(ds).axes[:1])
    assert title == f"{failed.sum()} of 231 impacts failed and are not drawn"
    panel = fd.plot(ds, over="target_velocity", at={"impactor_velocity": "1.1 m/s"}).axes[0]
    assert (
        panel.get_title() == f"at impactor velocity 1.1 m/s; {failed[1].sum()} of 21 impacts failed and are not drawn"
    )
    assert np.array_equal(np.isnan(panel.lines[0].get_ydata()), failed[1])
    over = {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}, "impactor.radius": {"normal": ["10 mm", "6 mm"]}}
    ds = fd.sweep(BALL, over, "random", samples=30_000)  # two of three are drawn
    count = int(np.isnan(ds["maximum_force"].values).sum())
    assert fd.plot(ds).axes[0].get_title().startswith(f"{count} of 30000 impacts failed and are not drawn; 2000")


def test_axes_of_values_in_a_geometric_sequence_are_logarithmic() -> None:
    over = {"impactor.velocity": {**VELOCITY, "from": "0.5 m/s"}, "impactor.radius": ["5 mm", "6 mm"]}
    panel = fd.plot(fd.sweep(BALL, over)).axes[0]
    assert panel.get_xscale() == "log"
    panel.figure.canvas.draw()
    assert {"0.5", "1", "2", "5"} <= {text.get_text() for text in panel.get_xticklabels()}
    over["impactor.velocity"] = {"from": "0.5 m/s", "to": "5 m/s", "count": 30}
    assert fd.plot(fd.sweep(BALL, over)).axes[0].get_xscale() == "linear"


def test_a_thinned_picture_says_so_and_keeps_the_extremes() -> None:
    ds = fd.sweep(BALL, {"impactor.velocity": {**VELOCITY, "count": 60_000}}).copy(deep=True)
    force = ds["maximum_force"].values
    force[[1, 10_001, 50_003]] = np.nan, 1e9, -1.0
    panel = fd.plot(ds, quantity="maximum_force").axes[0]
    shown = panel.lines[0].get_ydata()
    assert len(shown) == 20_002 and shown.max() == 1.0 and shown.min() < 0.0 and "(GN)" in panel.get_ylabel()
    assert panel.get_title() == "20002 of 60000 values are drawn, the least and the greatest among them"
    ds = fd.sweep(BALL, {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}}, "random", samples=60_000)
    ds = ds.copy(deep=True)
    ds["maximum_force"].values[10_001] = 1e9
    panel = fd.plot(ds, quantity="maximum_force").axes[0]
    assert panel.lines[0].get_ydata().max() == 1.0
    assert "of 60000 impacts are drawn" in panel.get_title()


def test_a_thinned_scatter_plot_keeps_the_distribution() -> None:
    """Equal steps of 6 would draw only the lighter half of this Sobol sequence, of 2 every other column of the grid."""
    over = {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}, "impactor.mass": {"uniform": ["50 g", "70 g"]}}
    ds = fd.sweep(BALL, over, "sobol", samples=120_000, variables=["maximum_force"])
    points = fd.plot(ds, over=["impactor_velocity", "impactor_mass"]).axes[0].collections[0].get_offsets()
    assert np.mean(np.asarray(points), axis=0) == pytest.approx([1.5, 0.06], rel=0.01)
    ends = {"impactor.velocity": ("1 m/s", "2 m/s"), "impactor.mass": ("50 g", "70 g")}
    over = {name: {"from": low, "to": high, "count": 200} for name, (low, high) in ends.items()}
    ds = fd.sweep(BALL, over, variables=["maximum_force"])
    line = fd.plot(ds, kind="scatter", quantity="maximum_force", over="impactor_mass").axes[0].lines[0]
    assert len(np.unique(line.get_xdata())) == 200


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"quantity": "maximum_farce"}, 'did you mean "maximum_force"'),
        ({"over": "impactor_velocty"}, 'did you mean "impactor_velocity"'),
        ({"over": ["impactor_velocity", "contact_law", "contact_law"]}, "no more"),
        ({"at": {"contact_law": "meyer"}}, "has hertz, stronge"),
        ({"at": {"speed": 1}}, "no other swept quantity"),
    ],
)
def test_wrong_names_are_refused(options: dict, says: str) -> None:
    ds = fd.sweep(BALL, {"impactor.velocity": VELOCITY, "contact.law": ["hertz", "stronge"]})
    with pytest.raises(ValueError, match=says):
        fd.plot(ds, **options)


@pytest.mark.slow
def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "sweep.nc"
    fd.sweep(BALL, {"impactor.velocity": VELOCITY, "contact.law": ["hertz", "stronge"]}, output=path).close()
    assert main(["plot", str(path)]) == 0
    assert (tmp_path / "sweep.png").exists()
    assert main(["plot", str(path)]) == 3
    assert "--force" in capsys.readouterr().err
    for suffix in ("svg", "pdf"):
        picture = tmp_path / f"x.{suffix}"
        options = ["--quantity", "maximum_force", "--over", "impactor.velocity", "--at", "contact.law=stronge"]
        assert main(["plot", str(path), "--output", str(picture), *options]) == 0
        assert picture.stat().st_size > 5000
    assert main(["plot", str(tmp_path / "none.nc")]) == 3
    assert main(["plot", str(path), "--output", str(tmp_path / "x.gif")]) == 3
    assert "must end in .png" in capsys.readouterr().err
