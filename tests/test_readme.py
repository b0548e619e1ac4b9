"""README.md, typed from top to bottom in one folder."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import film_model as fm

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```(sh|toml|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# ([\w.]+\.toml)\n")

SKIPPED = ". .venv/bin/activate"


def typed(text):
    """What the blocks of a page have a reader type: ("file.toml", its text), ("python", code) or ("sh", command)."""
    for kind, body in BLOCK.findall(text):
        if kind == "sh":
            yield from (("sh", line) for line in body.splitlines() if not line.startswith(SKIPPED))
        elif kind == "toml":
            name = FILE.match(body)
            assert name, f"this block does not name its file:\n{body}"
            yield name[1], body
        else:
            yield kind, body


def run(command, folder):
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
    environment = {**os.environ, "PATH": path, "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, f"{command[-1]}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def test_python_example_is_the_impact_of_the_first_command():
    text, here = (ROOT / "README.md").read_text(encoding="utf-8"), {}
    exec(next(body for kind, body in typed(text) if kind == "python"), here)
    named = re.search(r"film-model run (\S+) --plot", text)
    assert named
    same = fm.simulate(fm.Scene.from_toml(ROOT / named[1]), accuracy=1e-6)
    assert here["history"].maximum_force == same.maximum_force


@pytest.mark.slow
def test_all_blocks_run_in_order_in_one_folder(tmp_path):
    """No command refuses, and none finds a file of an earlier one in its way."""
    if shutil.which("bash") is None:
        pytest.skip("needs bash")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    printed = {}
    for kind, body in typed((ROOT / "README.md").read_text(encoding="utf-8")):
        if kind.endswith(".toml"):
            (tmp_path / kind).write_text(body, encoding="utf-8")
        else:
            shell = [sys.executable, "-c", body] if kind == "python" else ["bash", "-c", body]
            printed[body] = run(shell, tmp_path)
    text = "\n".join(printed.values())
    assert "2000 impacts: 2000 separated" in text and "impact.fmu: passed" in text
    for name in re.findall(r"^wrote (\S+)$", text, re.MULTILINE):
        assert (tmp_path / name).stat().st_size > 0
    assert {"rod.nc", "map.png", "history.nc", "sweep.png"} <= {path.name for path in tmp_path.iterdir()}
