"""Random scenes in every way: what ends in an undocumented exception, disagrees, or takes long.

    python -m benchmarks.random_scenes FILE [--count 1000] [--seed 0] [--seconds 600]

Each scene (the generator of tests/test_one_and_many.py: every law and kind of target; a tenth is put on a structure of
random vibrations, a third is oblique with friction) is simulated alone, in a batch and in a sweep, and stepped; on a
target that vibrates alone and in a sweep. Reported are exceptions other than SceneError and SimulationError,
differences beyond the estimates, runs of more than `SLOW` seconds of CPU, and impacts of sweeps that cost `COSTLY`
times as much as alone. All scenes share one process; datasets stay in memory, their files have tests of their own.
FILE has a line of JSON for each finding and each scene that is done; run again with it, the script goes on from there.
`python -m benchmarks.random_scenes FILE --only 4711` repeats one scene and prints it.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import film_datasets as fd
import film_model as fm
from film_model.effects.choose import choose
from film_model.solve.simulate import simulate_quietly

TESTS = Path(__file__).parents[1] / "tests"

SLOW = 2.0
"""CPU seconds of one run."""

ON_STRUCTURE, OBLIQUE = 0.1, 1.0 / 3.0
"""Shares of the scenes."""

ACCURACIES = 1e-6, 1e-4, 1e-5, 1e-3
"""Accuracies asked for, in turn after each round of the laws."""

ENDLESS = "friction needs a contact that ends"
"""What `simulate` raises where a batch and a sweep have the normal motion, and no tangential results."""

COSTLY, FEW = 10.0, 0.25
"""A row of a sweep takes at most this many times the CPU time of one impact, or `FEW` seconds, as a sweep of one impact
may take for the curves of a family and the dataset."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Go on with FILE until `count` scenes are done or `seconds` of CPU are spent; 1 if anything was found."""
    purpose = (__doc__ or "").split("\n")[0]
    parser = argparse.ArgumentParser(prog="python -m benchmarks.random_scenes", description=purpose)
    parser.add_argument("file", type=Path, help="what was found, one line of JSON each")
    parser.add_argument("--count", type=int, default=1000, help="scenes")
    parser.add_argument("--seed", type=int, default=0, help="of the first scene")
    parser.add_argument("--seconds", type=float, default=600.0, help="of CPU time, after which it stops")
    parser.add_argument("--only", type=int, help="the seed of the one scene to repeat")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore")
    if options.only is not None:
        print(scene_of(options.only).to_toml())
        print(*map(json.dumps, findings(options.only)), sep="\n")
        return 0
    lines = options.file.read_text("utf-8").splitlines() if options.file.exists() else []
    known = [json.loads(line) for line in lines if line.endswith("}")]  # not what a kill has cut
    first = max((row["done"] for row in known if "done" in row), default=options.seed)
    fd.sweep(scene_of(0), {"impactor.velocity": ["1 m/s"]})  # what is imported when it is first used
    for name in ("scipy.interpolate", "scipy.linalg", "scipy.optimize"):  # a second, which no scene takes
        import_module(name)
    with options.file.open("a", encoding="utf-8") as out:
        for seed in range(first, options.seed + options.count):
            if time.process_time() > options.seconds:
                break
            rows = list(findings(seed))
            known += rows
            print(*map(json.dumps, [*rows, {"done": seed + 1}]), sep="\n", file=out, flush=True)
            first = seed + 1
    found = [row for row in known if "found" in row]
    print(f"{first - options.seed} scenes, {time.process_time():.0f} s of CPU, {len(found)} findings")
    for row in found:
        print(f"{row['seed']}: {row['found']}: {row['text']}")
    return int(bool(found))


def scene_of(seed: int) -> fm.Scene:
    """The scene of a seed: by the tests' own generator, so that a finding becomes a test."""
    scene, draw = _tests().random_scene(seed, _tests().ALL_LAWS), np.random.default_rng([seed, 1])
    scene = scene.replace({"solver.accuracy": ACCURACIES[seed // len(_tests().ALL_LAWS) % len(ACCURACIES)]})
    if draw.random() < ON_STRUCTURE:
        count = int(draw.integers(1, 30))
        frequencies = 10.0 ** draw.uniform(1.0, 3.0) * np.sort(draw.uniform(1.0, 100.0, count))
        masses = scene.mass * 10.0 ** draw.uniform(-1.0, 3.0, count)
        target = fm.Structure(
            material=scene.target.material,
            frequency=[f"{value!r} Hz" for value in frequencies.tolist()],
            modal_mass=[f"{value!r} kg" for value in masses.tolist()],
            damping_ratio=float(draw.choice([0.0, 0.01, 0.1])),
        )
        scene = fm.Scene(scene.impactor, target, scene.contact, fm.Effects(), scene.solver)
    if draw.random() < OBLIQUE and not getattr(scene.target, "velocity", 0.0) > 0.0:  # at an angle it may not catch up
        friction = {"contact.friction": float(draw.choice([0.0, 0.1, 0.4]))}
        angle = {"impactor.angle": f"{float(draw.choice([0.1, 20.0, 45.0, 80.0, 89.9]))!r} deg"}
        scene = scene.replace({**friction, **angle, "impactor.spin": f"{300.0 * float(draw.normal())!r} rad/s"})
    return scene


def findings(seed: int) -> Iterator[dict[str, Any]]:
    """What is wrong with a scene."""
    try:
        scene = scene_of(seed)
    except fm.SceneError:
        return
    try:
        for found, text in compared(scene):
            yield {"seed": seed, "found": found, "text": text}
    except Exception:  # what the script looks for
        yield {"seed": seed, "found": "exception", "text": traceback.format_exc(limit=-2)}


def compared(scene: fm.Scene) -> Iterator[tuple[str, str]]:
    """What is wrong with a scene, as a kind and a text. One impact serves several checks, and so does the sweep, over
    the velocities of `tests.FACTORS` or, if the target vibrates, over that of the scene alone."""
    tests, swept = _tests(), list[tuple[Any, float]]()
    one, single = _timed(lambda: _simulated(scene))
    if isinstance(one, fm.SceneError):  # found by its law when it is first used
        return

    def sweep(*given: Any) -> Any:
        swept.append(_timed(lambda: fd.sweep(*given)))
        return _result(swept[-1][0])

    texts: list[str] = tests.disagreements(scene, sweep)
    row = len(swept)  # the second of three velocities is that of the scene
    if not swept:
        own = tests.sweep_rows(scene, "impactor.velocity", [scene.impactor.velocity], "m/s", sweep)
        texts += tests.rows_disagree([scene], [{"sweep": own[0]}], [one])
    stepped, steps = _timed(lambda: tests.stepped_disagreements(scene, simulated=lambda _: _result(one)))
    texts += [*_result(stepped), *_sliding(one, swept[0][0], row)]
    yield from (("disagreement", text) for text in texts if ENDLESS not in text)
    spent = swept[0][1] / (2 * row + 1)
    for what, seconds in {"one impact": single, "an impact of a sweep": spent, "a component": steps}.items():
        if seconds > SLOW:
            yield "slow", f"{what} takes {seconds:.1f} s"
    if spent > max(COSTLY * single, FEW):
        yield "costly", f"an impact of a sweep takes {spent:.3f} s, alone {single:.3f} s"


def _simulated(scene: fm.Scene) -> fm.History:
    """As `fm.simulate`, which judges the effects for its warnings; those of a refused impact too, as a dataset does."""
    try:
        history = simulate_quietly(scene)
    except fm.SimulationError:
        assert choose(scene).effects
        raise
    assert all(history.warnings)
    return history


def _sliding(one: Any, swept: Any, row: int) -> Iterator[str]:
    """A work of friction below 0, and the contact point's velocity that differs between one impact and a row of a sweep
    by more than both errors."""
    if not isinstance(one, fm.History) or one.oblique is None:
        return
    name = "contact_point_rebound_velocity"
    before, after = abs(float(one.oblique.motion["sliding_velocity"][0])), one.oblique.summary[name]
    if abs(after) > (1.0 + one.oblique.estimated) * before:
        yield f"friction gives energy: {name} {after!r} m/s, {before!r} m/s before"
    if isinstance(swept, Exception):
        return
    allowed = one.oblique.estimated + float(swept["estimated_friction_error"][row])
    allowed += 2.0 * (one.scene.solver.accuracy or 0.0)
    off = abs(float(swept[name][row]) - one.oblique.summary[name])
    if not off <= allowed * before:
        yield f"{name} alone and in a sweep: {off / before:.1e} of that before apart"


def _timed(run: Callable[[], Any]) -> tuple[Any, float]:
    """What a run gives, which may be a refusal, and its CPU seconds."""
    begin = time.process_time()
    try:
        found = run()
    except (fm.SceneError, fm.SimulationError) as error:
        found = error
    return found, time.process_time() - begin


def _result(found: Any) -> Any:
    """What a run has given; the refusal is raised."""
    if isinstance(found, Exception):
        raise found
    return found


def _tests() -> Any:
    if str(TESTS) not in sys.path:
        sys.path.insert(0, str(TESTS))
    import test_one_and_many  # pyright: ignore[reportMissingImports]

    return test_one_and_many


if __name__ == "__main__":
    sys.exit(main())
