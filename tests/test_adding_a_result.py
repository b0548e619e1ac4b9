"""The summary value of docs/adding_a_result.md, added to a copy of the package: results of every kind contain it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import film_datasets as fd
import film_model as fm

ROOT = Path(__file__).parents[1]
GUIDE = (ROOT / "docs" / "adding_a_result.md").read_text(encoding="utf-8")

CHECK = """
import sys
import numpy as np
import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

scene = fm.Scene.from_toml(sys.argv[1])
history = fm.simulate(scene, accuracy=1e-8)
times = np.linspace(0.0, history.summary["contact_duration"], 4001)
mean = np.trapezoid(history.sample_si(times).contact_force, times) / times[-1]
found = history.mean_force.to("N").magnitude
assert abs(found / mean - 1.0) < 1e-6, (found, mean)
assert fm.History.mean_force.__doc__.startswith("impulse of the contact force")
drops = {"impactor.drop_height": [f"{scene.impactor.drop_height!r} m", "2 mm"]}
assert abs(float(fd.sweep(scene, drops).mean_force[0]) / mean - 1.0) < 1e-3
fd.write(fd.to_dataset(history), "impact.nc")
kept = fd.open("impact.nc").mean_force
assert float(kept) == found and kept.attrs["units"] == "N"
assert fd.validate(fd.read("impact.nc")) == [] and fd.validate(fd.sweep(scene, drops)) == []
for older in sys.argv[2:]:
    assert fd.validate(fd.read(older)) == [], older
    assert "mean_force" not in fd.read(older)
assert main(["run", sys.argv[1], "--verbose"]) == 0
"""


@pytest.mark.slow
def test_a_value_is_one_file(tmp_path):
    for source in (ROOT / "film_model", ROOT / "datasets" / "film_datasets"):
        shutil.copytree(source, tmp_path / source.name, ignore=shutil.ignore_patterns("__pycache__"))
    files = {name: tmp_path / name for name in ("film_model/problem/summary.py", "film_datasets/schema/tables.py")}
    changes = re.findall(r"```diff\n(.*?)```", GUIDE, re.DOTALL)
    assert len(changes) == 5
    for change, name in zip(changes, [*files][:1] * 3 + [*files][1:] * 2, strict=True):
        text, lines = files[name].read_text(encoding="utf-8"), change.splitlines(keepends=True)
        before, after = ("".join(line[1:] for line in lines if line[0] in marks) for marks in (" -", " +"))
        assert text.count(before) == 1, before
        files[name].write_text(text.replace(before, after), encoding="utf-8")
    scene = ROOT / "examples" / "scenes" / "steel_ball_on_rod.toml"
    older = [tmp_path / "older.nc", tmp_path / "older_sweep.nc"]
    fd.write(fm.simulate(fm.Scene.from_toml(scene)), older[0])
    fd.write(fd.sweep(fm.Scene.from_toml(scene), {"impactor.drop_height": ["1 mm", "2 mm"]}), older[1])
    ended = subprocess.run(
        [sys.executable, "-c", CHECK, str(scene), *map(str, older)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert re.search(r"^  mean force +\d+\.\d+ N$", ended.stdout, re.MULTILINE)
