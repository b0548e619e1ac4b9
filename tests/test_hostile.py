"""The corpus in `tests/hostile`: scenes that once were slow or wrong, and texts that no reader may take or hang on.

A scene that the project meets and that is slow, wrong or ends in an undocumented exception is added to `scenes`, with a
comment that says what it did, or to `extreme_scenes.txt`, where an empty line ends a scene; a text to `texts`, its name
beginning with what reads it. Damaged datasets are made by tests/test_damaged_data.py.
"""

from __future__ import annotations

import json
import math
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import film_model as fm
from film_datasets.sweeps import read_sweep
from film_model.core import modal
from film_model.solve import vibration
from film_model.solve.simulate import simulate_quietly

CORPUS = Path(__file__).parent / "hostile"
SCENES = sorted((CORPUS / "scenes").glob("*.toml"))
TEXTS = sorted((CORPUS / "texts").iterdir())
SLOW = [path for path in SCENES if path.stem.startswith("creeping")]
EXTREMES = (CORPUS / "extreme_scenes.txt").read_text("utf-8").strip().split("\n\n")
ONCE_SLOW = "# took"
SCRIPT = str(CORPUS.parents[1] / "benchmarks" / "random_scenes.py")
MOST_SAID = 600
"""Characters of a refusal."""

READERS: dict[str, Callable[[Path], Any]] = {
    "modes": lambda path: fm.Structure(str(path)),
    "scene": fm.Scene.from_toml,
    "sweep": read_sweep,
    "table": lambda path: fm.Contact("tabulated", file=str(path)),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [pytest.param(path, id=path.stem, marks=pytest.mark.slow if path in SLOW else ()) for path in SCENES],
)
def test_one_and_many_agree_on_scenes_that_once_were_wrong(path: Path) -> None:
    compared = runpy.run_path(SCRIPT)["compared"](fm.Scene.from_toml(path))
    assert [text for kind, text in compared if kind == "disagreement"] == []


def test_effects_are_judged_or_said_to_be_unknown() -> None:
    for name in ("loaded_54960", "wide_55668"):
        history = simulate_quietly(fm.Scene.from_toml(CORPUS / "scenes" / f"{name}.toml"))
        assert all(effect.reason for effect in history.effects)


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_a_hostile_text_is_refused(path: Path) -> None:
    with pytest.raises((fm.SceneError, OSError)) as caught:
        READERS[path.name.partition("_")[0]](path)
    assert 0 < len(str(caught.value)) <= MOST_SAID


def ends(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A scene is refused in a few sentences, or its results are finite; its work on modes is bounded."""
    works, run = list[int](), vibration.run

    def counted(*given: Any, **named: Any) -> Any:
        works.append(0)
        found = run(*given, **named)
        works[-1] = found.work
        return found

    monkeypatch.setattr(vibration, "run", counted)
    try:
        history = simulate_quietly(fm.Scene.from_text(text))
    except (fm.SceneError, fm.SimulationError) as error:
        said = str(error).splitlines()
    else:
        said = [history.outcome.value]
        assert all(value is None or math.isfinite(value) for value in history.summary.values()), text
        assert (history.summary["maximum_force"] or 0.0) >= 0.0, text
    assert all(0 < len(line) <= MOST_SAID for line in said), text
    assert sum(works) <= 2 * modal.MOST_WORK and len(works) < 20, text


@pytest.mark.slow
def test_extreme_scenes_end_in_a_result_or_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(SCENES) + len(EXTREMES) >= 100
    for text in (text for text in EXTREMES if not text.startswith(ONCE_SLOW)):
        ends(text, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("text", [text for text in EXTREMES if text.startswith(ONCE_SLOW)], ids=lambda text: text[:16])
def test_the_work_of_scenes_that_took_long_is_bounded(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    ends(text, monkeypatch)


def test_the_script_of_random_scenes_goes_on_where_it_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script, file = runpy.run_path(SCRIPT), tmp_path / "found.jsonl"
    for count in (1, 2):
        script["main"]([str(file), "--count", str(count), "--seed", "9"])
        assert f"{count} scenes" in capsys.readouterr().out
    done = [json.loads(line) for line in file.read_text("utf-8").splitlines()]
    assert [row["done"] for row in done if "done" in row] == [10, 11]
