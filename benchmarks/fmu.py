"""Times of an FMU's steps: `python -m benchmarks.fmu [--json FILE]`. Needs a C compiler.

The driver `fmu_driver.c` is compiled with the sources of the FMU's binary and the flags of the build, and runs whole
contacts in one step and in a thousand, and the core's march alone. Times are the minimum over many rounds. They are
printed, never asserted. On a vibrating target the processor time of a step of 1 µs is measured under FMPy.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shlex
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import film_model as fm
from fmu_wrapper import export, platforms, resource
from fmu_wrapper.instance import opened, started

DRIVER = Path(__file__).with_name("fmu_driver.c")
PLATE = Path(__file__).parents[1] / "examples" / "scenes" / "olsson_plate.toml"
GOALS = {"beyond": 3000.0, "step": 500.0}
"""Nanoseconds: one step over a contact beyond the march itself; a step without an event."""

_COLUMNS = ("case", "version", "lines", "march", "record", "contact", "restore", "step", "march_step", "outputs")


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print the table, and write the rows as JSON if asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fmu", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the rows there")
    options = parser.parse_args(arguments)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    rows = measure(scenes())
    print(f"{platform.machine()}, one core; nanoseconds")
    heads = ("lines", "march", "one step", "beyond", "ratio", "a step", "of it march", "4 outputs")
    print(f"{'':34}" + "".join(f"{head:>12}" for head in heads))
    for row in rows:
        cells = (row["march"], row["contact"], row["beyond"])
        text = "".join(f"{cell:12.0f}" for cell in cells) + f"{row['contact'] / row['march']:12.3f}"
        text += "".join(f"{row[name]:12.0f}" for name in ("step", "march_step", "outputs"))
        print(f"{row['case'] + ', FMI ' + str(row['version']):34}{row['lines']:12d}{text}")
    for name, goal in GOALS.items():
        worst = max(row[name] for row in rows)
        what = "one step over a contact, beyond the march" if name == "beyond" else "a step without an event"
        print(f"{what}: at most {worst:.0f} ns; goal {goal:.0f} ns: {'met' if worst <= goal else 'MISSED'}")
    for name, seconds in vibrating().items():
        print(f"a step of 1 us on a vibrating plate, {name}: {1e6 * seconds:.0f} us; goal 200 us")
    if options.json is not None:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0


def vibrating(steps: int = 200, size: float = 1e-6) -> dict[str, float]:
    """Processor time of a step on the plate of the paper, s: without inputs, and with a new external force in each."""
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = export(fm.Scene.from_toml(PLATE), Path(folder) / "plate.fmu")
        for name, force in (("without inputs", 0.0), ("new force in each step", 1.0)):
            with opened(path) as fmu, started(fmu, False, {}) as slave:
                begun = time.process_time()
                for k in range(steps):
                    if force:
                        slave.set("external_force", force * k)
                    slave.step(k * size, size)
                found[name] = (time.process_time() - begun) / steps
    return found


def scenes() -> dict[str, fm.Scene]:
    """Laws and targets that march in different ways."""
    ball = fm.Sphere(radius="10 mm", mass="60.74 g", material="WC, Big-Alabo 2017", velocity="0.25 m/s")
    steel = fm.Material("steel", "210 GPa", 0.30, "7850 kg/m^3", "1 GPa")
    half_space, plate = fm.HalfSpace(steel), fm.Plate(steel, thickness="14 mm")
    return {
        "Hertz, half-space": fm.Scene(ball, half_space, contact=fm.Contact(law="hertz")),
        "Big-Alabo, half-space": fm.Scene(ball, half_space, contact=fm.Contact(law="big-alabo")),
        "Hertz, plate": fm.Scene(ball, plate, contact=fm.Contact(law="hertz")),
        "Stronge, plate": fm.Scene(ball, plate, contact=fm.Contact(law="stronge")),
    }


def measure(cases: dict[str, fm.Scene]) -> list[dict[str, Any]]:
    """A row for each case and FMI version; times in nanoseconds."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for k, scene in enumerate(cases.values()):
            with zipfile.ZipFile(export(scene, folder / f"{k}.fmu")) as archive:
                (folder / str(k)).mkdir()
                (folder / str(k) / resource.NAME).write_bytes(archive.read(f"resources/{resource.NAME}"))
        compiler = shlex.split(os.environ.get("CC", "cc"))
        built = [*compiler, *platforms.FLAGS, "-fPIC", str(DRIVER), *platforms.arguments(platforms.ROOT), "-lm"]
        platforms.run("the benchmark", [*built, "-o", str(folder / "driver")])
        command = [str(folder / "driver"), *(str(folder / str(k)) for k in range(len(cases)))]
        lines = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    rows: list[dict[str, Any]] = []
    for line in lines.splitlines():
        row: dict[str, Any] = dict(zip(_COLUMNS, map(float, line.split()), strict=True))
        row |= {"case": list(cases)[int(row["case"])], "version": int(row["version"]), "lines": int(row["lines"])}
        rows.append({**row, "beyond": row["contact"] - row["march"]})
    return rows


if __name__ == "__main__":
    raise SystemExit(main())
