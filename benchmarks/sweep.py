"""Sweeps from 10⁴ to 10⁷ impacts: `python -m benchmarks.sweep [--largest 1e7] [--variables NAMES]`.

Each sweep runs on all cores in a separate process, which measures its largest resident memory, and the wall and CPU
seconds of the call without imports. A sweep of two impacts measures the overhead that does not depend on the number of
impacts (checks, dataset, file); the last column excludes it.

For comparison, in the same process: the machine's own write of the same values, one array of uncompressed numbers after
the other into one file, with fsync; and how many times as long a file takes, beyond the same sweep in memory. The gain
by a second worker is compared with two bounds, measured between the sweeps: two processes that make half of the impacts
each, into files of their own, share the machine's memory and disk only; hashing in two threads shares nothing.
From `benchmarks.speed` at errors below 1e-4: the same impacts by scipy's solve_ivp and by a numba-compiled
Dormand–Prince pair, on one core and without a file, extrapolated from their microseconds per impact.

Where other programs run, CPU seconds say more than seconds.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

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
    parser.add_argument("--gain", type=float, default=10**6, help="impacts of the sweeps with one and two workers")
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
    print_writes(rows)
    rows += print_gains(int(options.gain), options.variables)
    print("\n  The same impacts on one core, no file")
    for row in rivals():
        rows.append(row)
        each = row["microseconds"]
        print(f"  {row['case']:36}{row['contender']:28}{each:>10.3f} µs each, 10⁶ in {each:.1f} s")
    if options.json is not None:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0


def print_writes(rows: Sequence[dict[str, Any]]) -> None:
    """What files take beyond memory, as multiples of the machine's own write of the same values."""
    memory = {(row["case"], row["impacts"]): row for row in rows if row["file"] == "memory"}
    print("\n  Beyond the sweep in memory: µs an impact, and times the machine's own write of the same values")
    print(f"  {'':24}{'impacts':>10}{'file':>8}{'core·µs':>10}{'own':>8}{'times':>8}{'µs':>10}{'own':>8}{'times':>8}")
    for row in rows:
        base = memory.get((row["case"], row["impacts"]))
        if row["file"] == "memory" or base is None or row["impacts"] < 10**5:
            continue
        line, each = f"  {row['case']:24}{row['impacts']:>10}{row['file']:>8}", 1e6 / row["impacts"]
        for what in ("busy", "seconds"):
            beyond, own = each * (row[what] - base[what]), each * row[f"own_{what}"]
            line += f"{beyond:>10.3f}{own:>8.3f}{beyond / own:>8.2f}"
        print(line)


def print_gains(count: int, variables: str) -> list[dict[str, Any]]:
    """How many times as fast two workers are as one, in seconds; the best of three each, one after the other."""
    rows = list[dict[str, Any]]()
    print(f"\n  {count} impacts, times as fast as by one worker; hashing in two threads, times as fast as in one")
    print(f"  {'':>8}{'two workers':>14}{'two processes':>16}{'hashing':>10}")
    for suffix in ("memory", "nc", "zarr") if find_spec("zarr") is not None else ("memory", "nc"):
        one, two, processes, alone, together = np.min(
            [gain_seconds(count, suffix, variables) for _ in range(3)], axis=0
        )
        rows.append({"file": suffix, "gain": one / two, "processes": one / processes, "hashing": alone / together})
        print(f"  {suffix:>8}{one / two:>14.2f}{one / processes:>16.2f}{alone / together:>10.2f}")
    return rows


def gain_seconds(count: int, suffix: str, variables: str) -> tuple[float, ...]:
    """Seconds of a sweep by one worker, by two, and by two processes with half of it each; of hashing in one thread and
    in two."""
    name = next(iter(CASES))
    one, two = (run_child(name, count, suffix, workers, variables)["seconds"] for workers in (1, 2))
    return one, two, halves(name, count, suffix, variables), hashing(1), hashing(2)


def halves(name: str, count: int, suffix: str, variables: str) -> float:
    """Seconds in which two processes at the same time, each with one worker, make a sweep of half the impacts each."""
    with ThreadPoolExecutor(2) as pool:
        runs = pool.map(lambda _: run_child(name, count // 2, suffix, 1, variables), range(2))
        return max(run["seconds"] for run in runs)


def hashing(threads: int) -> float:
    """Seconds in which some threads hash 1 GB."""
    data = bytes(1 << 20)
    begin = time.perf_counter()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda _: hashlib.sha256(data).digest(), range(1000)))
    return time.perf_counter() - begin


def planned(largest: int) -> list[tuple[str, int, str]]:
    """Case, impacts and kind of file."""
    ball, plate = CASES
    counts = [2, *(count for count in (10**4, 10**5, 10**6, 10**7, 10**8) if count <= largest)]
    kinds = {"memory": 10**7, "nc": 10**6} | ({"zarr": 10**9} if find_spec("zarr") is not None else {})
    rows = [(ball, count, kind) for kind, most in kinds.items() for count in counts if count <= most]
    return [*rows, (plate, 2, "nc"), (plate, 10**5, "nc")]


def measure(name: str, count: int, suffix: str, workers: int | None, variables: str) -> dict[str, Any]:
    """Seconds and megabytes of a sweep, in the best of three processes for the small ones."""
    runs = [run_child(name, count, suffix, workers or 0, variables) for _ in range(3 if count <= 10**6 else 1)]
    best = min(runs, key=lambda run: run["busy"])
    return {"case": name, "impacts": count, "file": suffix, **best}


def run_child(name: str, count: int, suffix: str, workers: int, variables: str) -> dict[str, Any]:
    """`child` in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        own = [name, str(count), folder, suffix, str(workers), variables]
        command = [sys.executable, "-m", "benchmarks.sweep", "--child", *own]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


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
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    row = {"seconds": best[1], "busy": best[0], "failed": failed, "megabytes": peak}
    if output is not None:
        row |= own_write(output, Path(folder) / "own")
    print(json.dumps(row))
    return 0


def own_write(output: Path, path: Path) -> dict[str, float]:
    """The machine's own write of the values in an output, uncompressed, in one file: seconds, CPU seconds and bytes."""
    busy = seconds = size = 0.0
    with film_datasets.open(output) as ds, open(path, "wb", buffering=0) as file:
        for name in [*ds.variables, None]:
            values = b"" if name is None else memoryview(np.ascontiguousarray(ds[name].values)).cast("B")
            begin, own = time.perf_counter(), time.process_time()
            file.write(values)
            if name is None:
                os.fsync(file.fileno())
            seconds, busy = seconds + time.perf_counter() - begin, busy + time.process_time() - own
            size += len(values)
    written = [output] if output.is_file() else [part for part in output.rglob("*") if part.is_file()]
    sizes = {"bytes": sum(part.stat().st_size for part in written), "value_bytes": size}
    return {"own_seconds": seconds, "own_busy": busy, **sizes}


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
