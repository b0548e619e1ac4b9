"""Times from Python: a whole simulation, one step of the component, and a new process of the command line.

`python -m benchmarks.python_level` prints them; processes find modules compiled, as those of an installed package are.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parent.parent
SCENE = ROOT / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"


def best_time(call: Callable[[], object], repeats: int, calls: int = 1) -> float:
    """Seconds per call: the minimum over `repeats` loops of `calls`, which other processes disturb least."""
    call()
    best = float("inf")
    for _ in range(repeats):
        begun = time.perf_counter()
        for _ in range(calls):
            call()
        best = min(best, time.perf_counter() - begun)
    return best / calls


def measure(repeats: int) -> list[dict[str, object]]:
    """Rows of what is measured and its seconds, or a sentence where a part is missing."""
    import film_model as fm

    rows: list[dict[str, object]] = []

    def row(what: str, call: Callable[[], object], calls: int) -> None:
        try:
            rows.append({"what": what, "seconds": best_time(call, repeats, calls)})
        except (AttributeError, ImportError, subprocess.CalledProcessError) as error:
            rows.append({"what": what, "missing": f"not available: {error}"})

    scene = fm.Scene.from_toml(SCENE)
    row("Scene.from_toml", lambda: fm.Scene.from_toml(SCENE), 5)
    row("simulate(scene), accuracy 1e-4 of the scene, with its warnings", lambda: fm.simulate(scene), 20)
    warnings.simplefilter("ignore", fm.ImpactWarning)
    row("simulate(scene), warnings ignored", lambda: fm.simulate(scene), 20)
    row("simulate(scene, accuracy=1e-6)", lambda: fm.simulate(scene, accuracy=1e-6), 20)
    row("simulate(scene, segments=5)", lambda: fm.simulate(scene, segments=5), 20)
    row("simulate_batch of one impact", lambda: fm.simulate_batch(scene, velocity=["0.25 m/s"]), 20)
    metal = scene.replace({"contact.law": "auto", "target.material.strain_rate_coefficient": 0.02})
    speeds = (f"{0.2 + 1e-5 * k!r} m/s" for k in itertools.count())  # each with a strength and a curve of its own
    cases = [metal.replace({"impactor.velocity": next(speeds)}) for _ in range(20 * repeats + 1)]
    row("simulate on a metal that hardens with the rate", lambda: fm.simulate(cases.pop()), 20)
    row("simulate_batch of one impact on it", lambda: fm.simulate_batch(metal, velocity=[next(speeds)]), 20)
    history = fm.simulate(scene)
    row("History.sample_si at one time", lambda: history.sample_si(20e-6), 20)
    row("ImpactComponent(scene)", lambda: fm.ImpactComponent(scene), 5)
    try:
        row("ImpactComponent.step(1 µs)", _stepper(fm, scene), 100)
    except (AttributeError, ImportError) as error:
        rows.append({"what": "ImpactComponent.step(1 µs)", "missing": f"not available: {error}"})
    main = "import sys; from film_model.cli.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", main, "run", str(SCENE), "--json"]
    with tempfile.TemporaryDirectory() as compiled:
        row("film-model run scene.toml --json, whole process", lambda: _quiet(command, compiled), 1)
        row("film-model --help, whole process", lambda: _quiet([*command[:3], "--help"], compiled), 1)
        for code in ("import film_datasets", "import film_model; film_model.simulate", "import numpy", "pass"):
            own = [sys.executable, "-c", code]
            row(f"python -c '{code}', whole process", lambda own=own: _quiet(own, compiled), 1)
    return rows


def _stepper(fm: object, scene: object) -> Callable[[], object]:
    """One step of 1 µs; a new component replaces one whose contact has ended, about every hundredth step."""
    made = [fm.ImpactComponent(scene)]  # type: ignore[attr-defined]

    def step() -> None:
        if made[0].step(1e-6).outputs.phase == "separated":
            made[0] = fm.ImpactComponent(scene)  # type: ignore[attr-defined]

    return step


def _quiet(command: list[str], compiled: str) -> None:
    """Run a process that finds compiled modules in the folder `compiled`, or writes them there."""
    known = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    own, nowhere = {**known, "PYTHONPYCACHEPREFIX": compiled}, subprocess.DEVNULL
    subprocess.run(command, check=True, cwd=ROOT, env=own, stdout=nowhere, stderr=nowhere)


def show(rows: list[dict[str, object]]) -> None:
    """Print the rows of `measure`."""
    print("\nFrom Python, one call")
    for row in rows:
        seconds = row.get("seconds")
        said = f"{1e6 * seconds:>12.1f} µs" if isinstance(seconds, float) else f"   {row['missing']}"
        print(f"    {row['what']:<66}{said}")


if __name__ == "__main__":
    show(measure(repeats=20))
