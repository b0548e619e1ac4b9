"""Sweeps from 10⁴ to 10⁷ impacts: `python -m benchmarks.sweep [--largest 1e7] [--variables NAMES]`.

Each sweep runs on all cores in a separate process, which measures its largest resident memory, and the wall and CPU
seconds of the call without imports. A sweep of two impacts measures the overhead that does not depend on the number of
impacts (checks, dataset, file); the last column excludes it. For comparison, from `benchmarks.speed` at errors below
1e-4: the same impacts by scipy's solve_ivp and by a numba-compiled Dormand–Prince pair, on one core and without a file,
extrapolated from their microseconds per impact.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import film_datasets
import film_model as fm

SCENES = Path(__file__).parents[1] / "examples" / "scenes"

CASES: dict[str, tuple[str, dict[str, Any], str, str]] = {
    "Big-Alabo, half-space": ("tungsten_carbide_on_steel", {"contact.law": "big-alabo"}, "0.1 m/s", "5 m/s"),
    "Hertz, plate": ("olsson_plate", {"effects.boundary_reflections": False}, "1 m/s", "5 m/s"),
}

RIVALS = "Big-Alabo, half-space, 0.05-2 m/s", "Hertz, plate, 1-5 m/s"


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sweep", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--largest", type=float, default=1e7, help="impacts of the largest sweep")
    parser.add_argument("--workers", type=int, help="threads; all cores by default")
    parser.add_argument("--variables", default="", help="keep only these summary values, with commas between")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the rows there")
    parser.add_argument("--child", nargs=6, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.child:
        return child(*options.child)
    cores = options.workers or len(os.sched_getaffinity(0))
    print(f"{cores} cores; summary of every impact, accuracy 1e-4")
    print(
        f"  {'':24}{'impacts':>10}{'file':>8}{'seconds':>10}{'core·s':>10}{'MB':>8}{'core·µs each':>14}{'beyond 2':>10}"
    )
    rows, fixed = [], dict[tuple[str, str], float]()
    for name, count, suffix in planned(int(options.largest)):
        row = measure(name, count, suffix, options.workers, options.variables)
        least = fixed.setdefault((name, suffix), row["busy"])
        each, beyond = 1e6 * row["busy"] / count, 1e6 * (row["busy"] - least) / count
        rows.append({**row, "cores": cores, "each": each, "beyond_two": beyond})
        print(
            f"  {name:24}{count:>10}{suffix:>8}{row['seconds']:>10.4f}{row['busy']:>10.4f}{row['megabytes']:>8.0f}"
            + (f"{each:>14.3f}{beyond:>10.3f}" if count > 2 else "")
        )
    print("\n  The same impacts on one core, no file")
    for row in rivals():
        rows.append(row)
        each = row["microseconds"]
        print(f"  {row['case']:36}{row['contender']:28}{each:>10.3f} µs each, 10⁶ in {each:.1f} s")
    if options.json is not None:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0


def planned(largest: int) -> list[tuple[str, int, str]]:
    """Case, impacts and kind of file."""
    ball, plate = CASES
    counts = [2, *(count for count in (10**4, 10**5, 10**6, 10**7, 10**8) if count <= largest)]
    kinds = {"memory": 10**7, "nc": 10**6} | ({"zarr": 10**9} if find_spec("zarr") is not None else {})
    rows = [(ball, count, kind) for kind, most in kinds.items() for count in counts if count <= most]
    return [*rows, (plate, 2, "nc"), (plate, 10**5, "nc")]


def measure(name: str, count: int, suffix: str, workers: int | None, variables: str) -> dict[str, Any]:
    """Seconds and megabytes of a sweep, in the best of three processes for the small ones."""
    runs = []
    for _ in range(3 if count <= 10**6 else 1):
        with tempfile.TemporaryDirectory() as folder:
            own = [name, str(count), folder, suffix, str(workers or 0), variables]
            command = [sys.executable, "-m", "benchmarks.sweep", "--child", *own]
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            runs.append(json.loads(done.stdout))
    best = min(runs, key=lambda run: run["busy"])
    return {"case": name, "impacts": count, "file": suffix, **best}


def child(name: str, count: str, folder: str, suffix: str, workers: str, variables: str) -> int:
    """One sweep in this process, after one of two impacts that makes the imports; the best of ten of a small one."""
    stem, changes, low, high = CASES[name]
    scene = fm.Scene.from_toml(SCENES / f"{stem}.toml").replace(changes)
    ends = {"from": low, "to": high, "spacing": "log"}
    best, failed = (math.inf, math.inf), False
    for number, size in enumerate([2, *[int(count)] * (10 if int(count) <= 10**5 else 1)]):
        output = None if suffix == "memory" else Path(folder) / f"{number}.{suffix}"
        begin, busy = time.perf_counter(), time.process_time()
        over = {"impactor.velocity": {**ends, "count": size}}
        kept = variables.split(",") if variables else ()
        with film_datasets.sweep(scene, over, variables=kept, output=output, workers=int(workers) or None) as ds:
            failed |= "failed" in ds.attrs["warnings"]
        if number > 0:
            best = min(best, (time.process_time() - busy, time.perf_counter() - begin))
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(json.dumps({"seconds": best[1], "busy": best[0], "megabytes": megabytes, "failed": failed}))
    return 0


def rivals() -> list[dict[str, Any]]:
    """Microseconds an impact of the other contenders, at errors below 1e-4."""
    from benchmarks import speed
    from benchmarks.cases import all_cases

    rows = []
    for case in all_cases(200):
        if case.name in RIVALS:
            some = case.spread(12)
            few = case.spread(5)
            found = speed.dormand_prince_rows(case, some, some.exact(), 3) + speed.scipy_rows(few, "RK45", few.exact())
            rows += [row for row in found if row["target"] == 1e-4]
    return rows


if __name__ == "__main__":
    sys.exit(main())
