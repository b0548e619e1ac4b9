"""The corpus in `tests/hostile`: scenes that once were slow or wrong, and texts that no reader may take or hang on.

A scene that the project meets and that is slow, wrong or ends in an undocumented exception is added to `scenes`, with a
comment that says what it did; a text to `texts`, its name beginning with what reads it. Damaged datasets are made by
tests/test_damaged_data.py.
"""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from test_one_and_many import disagreements

import film_model as fm
from film_datasets.sweeps import read_sweep

CORPUS = Path(__file__).parent / "hostile"
SCENES = sorted((CORPUS / "scenes").glob("*.toml"))
TEXTS = sorted((CORPUS / "texts").iterdir())
SLOW = [path for path in SCENES if path.stem.startswith("creeping")]
MOST_SAID = 600
"""Characters of a refusal."""

READERS: dict[str, Callable[[Path], Any]] = {
    "modes": lambda path: fm.Structure(str(path)),
    "scene": fm.Scene.from_toml,
    "sweep": read_sweep,
    "table": lambda path: fm.Contact("tabulated", file=str(path)),
}


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, id=path.stem, marks=pytest.mark.slow if path in SLOW else ()) for path in SCENES],
)
def test_one_and_many_agree_on_scenes_that_once_were_wrong(path: Path) -> None:
    assert disagreements(fm.Scene.from_toml(path)) == []


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_a_hostile_text_is_refused(path: Path) -> None:
    with pytest.raises((fm.SceneError, OSError)) as caught:
        READERS[path.name.partition("_")[0]](path)
    assert 0 < len(str(caught.value)) <= MOST_SAID


def test_the_script_of_random_scenes_goes_on_where_it_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script, file = runpy.run_path(str(CORPUS.parents[1] / "benchmarks" / "random_scenes.py")), tmp_path / "found.jsonl"
    for count in (1, 2):
        script["main"]([str(file), "--count", str(count), "--seed", "9"])
        assert f"{count} scenes" in capsys.readouterr().out
    done = [json.loads(line) for line in file.read_text("utf-8").splitlines()]
    assert [row["done"] for row in done if "done" in row] == [10, 11]
