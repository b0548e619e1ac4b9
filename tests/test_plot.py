"""The figure of a history: the right curves in the right units, whole files, and no change of pyplot's state."""

from __future__ import annotations

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from cases import combinations

import film_model as fm
from film_model.laws.example_ball import STEEL_BALL
from film_model.plot import history as plot
from film_model.plot import picture_style, plot_laws
from film_model.plot.style import COLOURS, NO_CONTACT, UNLOADING
from film_model.studies.law_gallery import gallery_loops

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
HEADS = {".png": b"\x89PNG\r\n", ".svg": b"<?xml", ".pdf": b"%PDF-"}

pytest.importorskip("matplotlib")
from matplotlib.colors import to_rgb  # noqa: E402

ENERGY = 0.5 * STEEL_BALL.mass * STEEL_BALL.velocity**2  # of the impact of the gallery, J


def _history(stem: str, title: str | None = None, **impactor: str) -> fm.History:
    scene = fm.Scene.from_toml(SCENES / f"{stem}.toml")
    changes: dict[str, str | None] = {f"impactor.{key}": value for key, value in impactor.items()}
    if "velocity" in impactor:
        changes |= {"impactor.drop_height": None, "target.size": None}
    return fm.simulate(scene.replace({**changes, "title": scene.title if title is None else title}))


@pytest.fixture(scope="module")
def history() -> fm.History:
    return _history("tungsten_carbide_on_steel")


@pytest.mark.slow
@combinations(suffix=[".png", ".svg", ".pdf", ".PNG"], fast=1)
def test_picture_is_of_its_suffix_and_always_the_same(history: fm.History, tmp_path: Path, suffix: str) -> None:
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    plot.plot_history(history, first)
    plot.plot_history(history, second)
    assert first.read_bytes().startswith(HEADS[suffix.lower()])
    assert first.read_bytes() == second.read_bytes()
    assert sorted(tmp_path.iterdir()) == [first, second]


@pytest.mark.parametrize("name", ["impact.xyz", "impact", ".png"])
def test_unknown_suffix_is_refused(history: fm.History, tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"must end in \.png, \.svg or \.pdf"):
        plot.plot_history(history, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_panels_show_the_motion_in_prefixed_units(history: fm.History) -> None:
    force, depth, speed, loop, energy = plot.plot_history(history).axes
    assert force.get_ylabel() == "contact force (N)"
    assert depth.get_ylabel() == "indentation (µm)"
    assert speed.get_ylabel() == "impactor velocity (m/s)"
    assert energy.get_xlabel() == "time (µs)"
    assert energy.get_ylabel() == "energy (mJ)"
    assert (loop.get_xlabel(), loop.get_ylabel()) == ("indentation (µm)", "contact force (N)")
    summary = history.summary
    for panel, name, size in ((force, "maximum_force", 1.0), (depth, "maximum_indentation", 1e-6)):
        curves = [line for line in panel.lines if len(line.get_xdata()) > 2]
        top = max(np.max(line.get_ydata()) for line in curves)
        assert top * size == pytest.approx(summary[name], rel=1e-9)
        assert len({line.get_color() for line in curves}) == 3  # elastic, elastoplastic, unloading
        for one, two in itertools.pairwise(curves):  # adjacent curves share a point
            assert one.get_xdata()[-1] == two.get_xdata()[0]


@combinations(stem=["tungsten_carbide_on_steel", "two_steel_balls", "olsson_plate"], fast=2)
def test_energies_add_up(stem: str) -> None:
    history = _history(stem)
    found = plot.energies(history, history.sample_si(np.linspace(0.0, history.duration, 1001)))
    total = sum(found.values())
    np.testing.assert_allclose(total, total[0], rtol=1e-4)
    absorbed, radiated = history.summary["energy_absorbed"], history.summary["energy_radiated"]
    assert found["contact"][-1] == pytest.approx(absorbed, abs=1e-4 * total[0])
    assert found["target"][-1] - found["target"][0] == pytest.approx(radiated, abs=1e-4 * total[0])


@pytest.mark.parametrize(
    ("stem", "strokes"), [("tungsten_carbide_on_steel", {"-"}), ("two_steel_balls", {"-", "--", ":"})]
)
def test_target_and_relative_velocity_are_drawn_where_the_target_moves(stem: str, strokes: set[str]) -> None:
    speed = plot.plot_history(_history(stem)).axes[2]
    assert {line.get_linestyle() for line in speed.lines if len(line.get_xdata()) > 2} == strokes


@pytest.mark.slow
@combinations(
    stem=["tungsten_carbide_on_steel", "steel_ball_on_rod", "two_steel_balls"],
    changes=[
        *({}, {"velocity": "10 m/s"}, {"velocity": "100 m/s"}, {"velocity": "0.3 m/s"}),
        {"title": "a long\ntitle " * 20},
    ],
    fast=3,
)
def test_event_labels_stay_in_the_picture_and_apart(stem: str, changes: dict[str, str]) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = plot.plot_history(_history(stem, **changes))
    FigureCanvasAgg(figure).draw()
    top = figure.axes[0]
    boxes = [text.get_window_extent() for text in top.texts]
    assert len(boxes) >= 2
    for k, box in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert box.y0 >= top.bbox.y1
        assert not any(
            box.overlaps(other) for other in [*boxes[:k], *(text.get_window_extent() for text in figure.texts)]
        )
    for text in figure.texts:
        assert text.get_window_extent().x1 < figure.bbox.x1


def test_of_many_contacts_only_the_ends_are_marked() -> None:
    ball = {"radius": "5 mm", "velocity": "3 m/s", "material": "bearing steel"}
    modes = {"frequency": ["2 kHz", "11 kHz"], "modal_mass": ["5 g", "6 g"], "material": "mild steel"}
    history = fm.simulate(fm.Scene.from_table({"impactor": ball, "target": {"kind": "structure"} | modes}))
    ends = [event for event in history.events[1:] if event.name in ("contact_begins", "contact_ends")]
    assert len(ends) > 1 and len(history.events) > 12
    top = plot.plot_history(history).axes[0]
    assert {text.get_text() for text in top.texts} == {"contact ends", "contact again"}
    uprights = [line for line in top.lines if list(line.get_ydata()) == [0, 1]]
    assert len(uprights) == len(ends)


@pytest.mark.slow
def test_legends_lie_beside_the_curves() -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = plot.plot_history(_history("two_steel_balls"))
    FigureCanvasAgg(figure).draw()
    energy = figure.axes[4]
    boxes = [figure.legends[0].get_window_extent(), energy.get_legend().get_window_extent()]
    assert boxes[1].y0 >= energy.bbox.y1 - 1.0
    for panel in figure.axes:
        assert not panel.bbox.overlaps(boxes[0])
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 and box.y0 >= figure.bbox.y0


def test_motion_without_contact_has_its_own_colour() -> None:
    assert plot._colour(plot.Trace.of(_history("two_steel_balls")), "") == NO_CONTACT
    assert NO_CONTACT not in (*COLOURS, UNLOADING)


@pytest.mark.slow
def test_styles(history: fm.History, tmp_path: Path) -> None:
    with picture_style("dark"):
        figure = plot.plot_history(history, tmp_path / "dark.svg")
    light = {"screen": plot.plot_history(history), "dark": figure}
    ground = {style: sum(one.get_facecolor()[:3]) / 3.0 for style, one in light.items()}
    ink = {style: sum(to_rgb(one.texts[0].get_color())) / 3.0 for style, one in light.items()}
    assert ground["screen"] == 1.0 and ink["screen"] == 0.0
    assert ground["dark"] < 0.15 and ink["dark"] > 0.9
    for panel, other in zip(figure.axes, light["screen"].axes, strict=True):
        assert panel.patch.get_facecolor()[:3] == figure.get_facecolor()[:3] != other.patch.get_facecolor()[:3]
    text = (tmp_path / "dark.svg").read_text("utf-8")
    assert ">contact force (N)</text>" in text  # letters, not outlines
    with pytest.raises(ValueError, match='style: "drak" is not one of screen, paper, dark; did you mean "dark"'):
        picture_style("drak").__enter__()


@pytest.mark.slow
def test_unfinished_contact_and_a_title_with_dollar_signs(tmp_path: Path) -> None:
    history = _history("olsson_plate", mass="8 g", velocity="1 mm/s", title="$5 and $6 {x}")
    assert history.summary["contact_duration"] is None
    figure = plot.plot_history(history, tmp_path / "impact.svg")
    assert figure.axes[0].get_ylabel() == "contact force (mN)"
    assert "contact" not in figure.texts[1].get_text()
    assert len(figure.axes[0].texts) <= 3


@pytest.mark.slow
def test_stages_of_a_custom_law(tmp_path: Path) -> None:
    from dataclasses import dataclass

    @dataclass(frozen=True)
    class Odd(fm.AbstractLaw):
        name = "odd $law$"
        summary = source = ""

        def scales(self, energy: float) -> tuple[float, float]:
            return 1e-5, 500.0

        def stages(self) -> tuple[fm.Stage, ...]:
            soft = fm.Stage("soft {$}", 0.0, 0.1, fm.Power(slope=1.0))
            return soft, fm.Stage("hard", 0.1, float("inf"), fm.Power(constant=0.1, slope=2.0))

    scene = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    own = fm.simulate(fm.Scene(scene.impactor, scene.target, fm.Contact(law=Odd())))
    figure = plot.plot_history(own, tmp_path / "own.png")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [r"soft {\$}", "hard"]


@pytest.mark.slow
def test_a_failed_write_leaves_the_old_file(
    history: fm.History, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "impact.png"
    path.write_bytes(b"precious")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(plot.os, "fsync", full)
    with pytest.raises(OSError, match=r"impact\.png: cannot be written: No space left"):
        plot.plot_history(history, path)
    assert [p.read_bytes() for p in tmp_path.iterdir()] == [b"precious"]
    monkeypatch.undo()
    plot.plot_history(history, path)
    assert path.read_bytes().startswith(HEADS[".png"])
    with pytest.raises(FileNotFoundError, match=r"impact\.png: cannot be written: No such file"):
        plot.plot_history(history, tmp_path / "missing" / "impact.png")


def test_a_missing_matplotlib_names_the_extra_to_install(history: fm.History, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"install film-model\[plot\]"):
        plot.plot_history(history)


@pytest.mark.slow
def test_pyplot_and_settings_are_left_alone(tmp_path: Path) -> None:
    code = f"""
import sys, matplotlib, film_model as fm
from film_model.plot.history import plot_history
before = matplotlib.rcParams.copy()
scene = fm.Scene.from_toml({str(SCENES / "steel_ball_on_rod.toml")!r})
plot_history(fm.simulate(scene), {str(tmp_path / "a.png")!r})
assert matplotlib.rcParams.copy() == before
assert "matplotlib.pyplot" not in sys.modules
print("ok")
"""
    run = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout == "ok\n", run.stderr


def _area(force: np.ndarray, depth: np.ndarray) -> float:
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(depth)))


@pytest.mark.slow
def test_every_law_has_its_panel_and_its_loop(tmp_path: Path) -> None:
    figure = plot_laws(tmp_path / "a.png", dpi=50)
    assert [panel.get_title(loc="left") for panel in figure.axes if panel.axison] == list(fm.LAWS)
    for panel, (name, loop) in zip(figure.axes, gallery_loops().items(), strict=False):
        assert f"e = {loop.restitution:.2f}" in [text.get_text() for text in panel.texts]
        depth, force = loop.curve
        absorbed = _area(force, depth)  # loading and unloading
        assert absorbed == pytest.approx(ENERGY * (1.0 - loop.restitution**2), abs=2e-3 * ENERGY)
        assert depth[loop.turn] == depth.max(), name


@pytest.mark.slow
def test_the_picture_of_the_laws_is_always_the_same(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        plot_laws(tmp_path / name, dpi=50)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_laws_are_compared_at_one_energy() -> None:
    loops = gallery_loops()
    for loop in loops.values():
        depth, force = loop.curve[:, : loop.turn + 1]
        assert _area(force, depth) == pytest.approx(ENERGY, rel=2e-3)


@pytest.mark.parametrize("ends", [pytest.param("clamped", marks=pytest.mark.slow), "free"])
def test_a_target_that_vibrates(ends: str) -> None:
    """Displacements of impactor and struck point, the energy of the vibrations, and each at the end."""
    beam = fm.Beam("mild steel", "150 mm", "10 mm", "4 mm", ends=ends)
    scene = fm.Scene(fm.Sphere("10 mm", "0.5 m/s", material="mild steel"), beam, fm.Contact("hertz"))
    history = fm.simulate(scene, accuracy=1e-2)
    run, figure = history.vibration, plot.plot_history(history)
    _, _, displacement, loop, energy, spectrum = figure.axes
    assert displacement.get_ylabel() == "displacement (µm)" and loop.get_xlabel() == "indentation (µm)"
    whole = "vibrations" if ends == "clamped" else "target"
    assert [text.get_text() for text in energy.get_legend().get_texts()] == ["impactor", "contact", whole]
    drawn = energy.lines[2].get_ydata()[-1] * 1e-3
    assert drawn == pytest.approx(run.energy * history.problem.scales.energy, rel=1e-3)
    bends = run.frequency > 0.0
    frequencies, energies = spectrum.lines[0].get_xdata(), spectrum.lines[0].get_ydata()
    assert (spectrum.get_xlabel(), spectrum.get_xscale()) == ("frequency (kHz)", "log")
    assert set(np.round(frequencies, 9)) <= set(np.round(run.frequency[bends] / (2e3 * np.pi), 9))
    unit = {"energy (mJ)": 1e-3, "energy (µJ)": 1e-6}[spectrum.get_ylabel()]
    assert sum(energies) * unit == pytest.approx(history.vibration_energy_by_mode[bends].sum(), rel=1e-4)
    assert ("motion as a whole" in spectrum.get_title(loc="right")) == (ends == "free")
