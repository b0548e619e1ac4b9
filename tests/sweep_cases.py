"""Scenes, ranges and helpers of the tests of sweeps."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

import film_model as fm
from film_model.cli.main import main

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
BALL = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
PLATE = fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace({"effects.boundary_reflections": False})
SPEEDS = {"impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 40, "spacing": "log"}}
STRENGTHS = {"target.material.yield_strength": {"normal": ["1 GPa", "0.15 GPa"]}}

RANGE = {"from": "1 m/s", "to": "2 m/s", "count": 3}

FILE = f"""scene = "{SCENES.as_posix()}/tungsten_carbide_on_steel.toml"
design = "grid"                     # random/sobol/latin-hypercube take samples = 1000000 and seed = 1
[over]
"impactor.velocity" = {{ from = "0.1 m/s", to = "5 m/s", count = 30, spacing = "log" }}
"target.material.yield_strength" = ["250 MPa", "310 MPa"]
"""


def same(one: xr.Dataset, other: xr.Dataset) -> None:
    assert one.attrs["content_sha256"] == other.attrs["content_sha256"]
    for name in one.variables:
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


def bytes_of(output: Path) -> list[tuple[Path, bytes]]:
    """Every file of an output, with its bytes."""
    files = sorted(path for path in (output.rglob("*") if output.is_dir() else [output]) if path.is_file())
    return [(path.relative_to(output), path.read_bytes()) for path in files]


def cli(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    status = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err
