"""Microseconds per impact at equal accuracy: `python -m benchmarks.speed [--quick] [--json FILE] [--page]`.

Every method computes the same impacts in one run, on one core. Its fastest setting is searched for which the largest
relative error of six summary values over all checked impacts is below a target, and then timed. Times are the minimum
over many short repeats. They are printed, never asserted.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import conventional, film, python_level, rivals, root_steps, speed_table
from benchmarks.cases import Array, Case, all_cases, worst_error
from benchmarks.python_level import best_time
from film_model.core import native
from film_model.laws import Hertz
from film_model.studies.dormand_prince import compile_solver

TARGETS = (1e-4, 1e-6, 1e-8)
ROUGH = TARGETS[:2]  # for methods of low order
TOLERANCES = 10.0 ** -np.arange(2.0, 13.01, 0.25)
FLOORS = (1.0, 0.1, 0.01)
STRETCHES = (0.0, 0.25, 0.5, 1.0, 2.0)
ALONE = "  one impact alone"

Row = dict[str, Any]


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print the tables, and write the rows as JSON if asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.speed", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="fewer impacts, checks and repeats")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the rows there")
    parser.add_argument("--page", action="store_true", help="write the table of docs/understand/accuracy_and_cost.md")
    options = parser.parse_args(arguments)
    impacts, checked, repeats = (200, 12, 3) if options.quick else (1000, 60, 9)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    print(f"{platform.machine()}, Python {platform.python_version()}, one core; {impacts} impacts, {checked} checked")
    if find_spec("numba") is None:
        print("numba is not installed: Dormand–Prince is skipped (pip install numba).")
    rows: list[Row] = []
    for case in all_cases(impacts):
        measured = measure_case(case, checked, repeats)
        rows += measured
        print_case(case, measured)
    if options.page:
        speed_table.write(rows)
    level = python_level.measure(repeats)
    python_level.show(level)
    if options.json is not None:
        options.json.write_text(json.dumps({"batch": rows, "python": level}, indent=1) + "\n")
    return 0


def measure_case(case: Case, checked: int, repeats: int) -> list[Row]:
    """Rows of all methods and targets for one case."""
    some = case.spread(checked)
    exact = some.exact()
    rows: list[Row] = []
    for target in TARGETS:
        rows += _film(case, some, exact, target, repeats, "work")
        if target in ROUGH:
            rows += _film(case, some, exact, target, repeats, "chord")
    rows += _in_c(case, some, exact, repeats)
    rows += dormand_prince_rows(case, some, exact, repeats)
    rows += _root_steps(case, some, exact, repeats)
    few = case.spread(max(5, checked // 5))
    for method in conventional.METHODS:
        rows += scipy_rows(few, method, few.exact())
    return rows


def _row(case: Case, target: float, contender: str, setting: str, error: float | None, seconds: float | None) -> Row:
    """None: the target was not reached."""
    return {
        "case": case.name,
        "target": target,
        "contender": contender,
        "setting": setting,
        "error": error,
        "microseconds": None if seconds is None else 1e6 * seconds,
    }


def _fastest(call: Callable[[], object], repeats: int) -> float:
    """Seconds of the fastest of 20 × `repeats` calls, within about one second: other processes disturb many short
    measurements less than a few long ones."""
    call()
    begun, best = time.perf_counter(), float("inf")
    for _ in range(20 * repeats):
        now = time.perf_counter()
        if now - begun > 1.0 and best < float("inf"):
            break
        call()
        best = min(best, time.perf_counter() - now)
    return best


def _film(case: Case, some: Case, exact: Array, target: float, repeats: int, kind: str) -> list[Row]:
    """With the processor's widest vector instructions and, for work-preserving lines, with the narrower ones too."""
    line, name = {
        "work": (native.WORK_PRESERVING, "FILM, work-preserving"),
        "chord": (native.CHORD, "FILM, the paper's chords"),
    }[kind]
    pairs = film.sufficient_segments(some, exact, line, target)
    if not pairs:
        return [_row(case, target, name, f"> {film.MOST_SEGMENTS} segments", None, None)]
    pair = min(pairs, key=lambda p: _fastest(film.batch(case, line, p), 1)) if len(pairs) > 1 else pairs[0]
    error = worst_error(film.values(film.batch(some, line, pair)()), exact)
    rows = []
    for using in range(native.instructions(), -1, -1) if kind == "work" else (native.instructions(),):
        seconds = _fastest(film.batch(case, line, pair, using), repeats) / case.nu.size
        said = name if not rows else f"  with {native.INSTRUCTIONS[using]} instructions"
        rows.append(_row(case, target, said, f"{pair[0]} + {pair[1]} segments", error, seconds))
    if kind == "work" and rivals.library(1) is not None:
        error = worst_error(film.values(rivals.film_alone(some, pair)()), exact)
        seconds = _fastest(rivals.film_alone(case, pair), repeats) / case.nu.size
        rows.append(_row(case, target, ALONE, f"{pair[0]} + {pair[1]} segments", error, seconds))
    return rows


def _in_c(case: Case, some: Case, exact: Array, repeats: int) -> list[Row]:
    """The rivals of rivals.c, in lanes and one impact at a time; the fastest of all settings, for each target."""
    rows = []
    for name, method in (("Taylor series in √ξ", rivals.taylor), ("Gauss quadrature", rivals.gauss)):
        for target in TARGETS:
            for lanes, said in ((rivals.LANES, f"{name}, lanes"), (1, f"{name}, one impact")):
                found = list(method(case, some, exact, target, lanes))
                if found:
                    setting, error, call = min(found, key=lambda f: _fastest(f[2], 1))
                    seconds = _fastest(call, repeats) / case.nu.size
                    rows.append(_row(case, target, said, setting, error, seconds))
    return rows


def dormand_prince_rows(case: Case, some: Case, exact: Array, repeats: int) -> list[Row]:
    """The fastest of both forms and all settings, for each target."""
    if find_spec("numba") is None:
        return []
    solvers = {form: compile_solver(case.scalar, form) for form in ("time", "root")}
    rows = []
    found, out = np.empty(exact.shape), np.empty((case.nu.size, exact.shape[1]))
    for target in TARGETS:
        fitting = []
        for form, solver in solvers.items():
            for floor in FLOORS:
                for tolerance in TOLERANCES:
                    found[:] = np.nan
                    cost = solver(some.nu, some.gamma, tolerance, floor, found)
                    error = worst_error(found, exact)
                    if error <= target:
                        fitting.append((cost, error, form, tolerance, floor))
                        break
        if not fitting:
            continue
        _, error, form, tolerance, floor = min(fitting)
        nu, gamma, solver = case.nu, case.gamma, solvers[form]
        seconds = _fastest(lambda: solver(nu, gamma, tolerance, floor, out), repeats) / nu.size  # noqa: B023
        setting = f"{form} form, rtol {tolerance:.1e}, floor {floor:g}"
        rows.append(_row(case, target, "Dormand–Prince 5(4), numba", setting, error, seconds))
    return rows


def _root_steps(case: Case, some: Case, exact: Array, repeats: int) -> list[Row]:
    """Hertz's law on plates only; the fastest of all settings, for each target."""
    if find_spec("numba") is None or not isinstance(case.law, Hertz):
        return []
    solver, found, out = root_steps.compile_solver(), np.empty(exact.shape), np.empty((case.nu.size, exact.shape[1]))
    rows = []
    for target in ROUGH:
        fitting = []
        for stretch in STRETCHES:
            steps, error = 4, float("inf")
            while error > target:
                steps = max(steps + 1, round(1.04 * steps))
                found[:] = np.nan
                solver(some.nu, some.gamma, float(steps), stretch, found)
                error = worst_error(found, exact)
            seconds = _fastest(lambda: solver(case.nu, case.gamma, float(steps), stretch, out), repeats)  # noqa: B023
            fitting.append((seconds / case.nu.size, error, steps, stretch))
        seconds, error, steps, stretch = min(fitting)
        setting = f"{steps} steps, stretch {stretch:g}"
        rows.append(_row(case, target, "Runge–Kutta 4 in √ξ, numba", setting, error, seconds))
    return rows


def scipy_rows(few: Case, method: str, exact: Array) -> list[Row]:
    rows, tolerances = [], iter(TOLERANCES[2::2])
    error, rtol = float("inf"), float("nan")
    for target in ROUGH:
        while error > target:
            rtol = next(tolerances, float("nan"))
            if rtol != rtol:
                return rows
            error = worst_error(conventional.run(few, method, rtol), exact)
        seconds = best_time(lambda: conventional.run(few, method, rtol), 2) / few.nu.size  # noqa: B023
        rows.append(_row(few, target, f"scipy solve_ivp, {method}", f"rtol {rtol:.1e}", error, seconds))
    return rows


def print_case(case: Case, rows: list[Row]) -> None:
    """One table per case: both targets, the time of each method and its ratio to FILM's."""
    print(f"\n{case.name}")
    for target in TARGETS:
        here = [row for row in rows if row["target"] == target]
        film_time = next(row["microseconds"] for row in here if row["contender"] == "FILM, work-preserving")
        print(f"  {f'errors below {target:g}':<34}{'setting':<38}{'error':>9}{'µs':>11}{'× FILM':>10}")
        for row in here:
            head = f"    {row['contender']:<32}{row['setting']:<38}"
            if row["microseconds"] is None or film_time is None:
                print(f"{head}{'-':>9}{'-':>11}{'-':>10}")
                continue
            ratio = row["microseconds"] / film_time
            print(f"{head}{row['error']:>9.1e}{row['microseconds']:>11.3f}{ratio:>10.{1 if ratio < 100 else 0}f}")


if __name__ == "__main__":
    sys.exit(main())
