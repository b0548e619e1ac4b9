"""Rivals in C, compiled with the core's flags: a Taylor series in √ξ on plates, Gauss quadrature on half-spaces.

`rivals.c` holds both, for lanes side by side and, with one lane, for one impact at a time. A C compiler is needed.
"""

from __future__ import annotations

import ctypes as c
import math
import os
import shlex
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import film
from benchmarks.cases import Array, Case, worst_error
from film_model.core import native
from film_model.laws import BigAlabo, Hertz, Power
from film_model.problem.curve import curve_of
from fmu_wrapper import platforms

LANES = 32
ORDERS = (6, 8, 10, 12, 14, 16, 18, 20, 24)
POINTS = tuple(range(2, 25))
TOLERANCES = 10.0 ** -np.arange(1.0, 14.01, 0.25)

_WIDE = ((), ("-mavx2",), ("-mavx512f", "-mavx512dq", "-mavx512vl", "-mprefer-vector-width=512"))
"""As film_avx2.c and film_avx512.c, by index in native.INSTRUCTIONS."""

Call = Callable[[], object]
Found = tuple[str, float, Call]
"""The setting, the largest error over the checked impacts, and a call that computes all impacts."""


class _BigAlabo(c.Structure):
    """big_alabo of rivals.c."""

    _fields_ = [
        *((name, c.c_double * 4) for name in ("begin", "f", "k", "ratio", "rise", "squares")),
        ("turn", c.c_double),
        ("rest", c.c_double),
    ]


@lru_cache
def library(lanes: int) -> Any:
    """rivals.c for so many lanes, with the processor's widest instructions; None without a C compiler."""
    with tempfile.TemporaryDirectory() as folder:
        built = Path(folder, "rivals.so")
        compiler = shlex.split(os.environ.get("CC", "cc"))
        flags = [*platforms.FLAGS, "-fvisibility=default", *_WIDE[native.instructions()], "-shared", "-fPIC"]
        flags += ["-Wno-psabi", "-I", str(platforms.ROOT / platforms.CORE)]
        source = str(Path(__file__).with_suffix(".c"))
        try:
            subprocess.run([*compiler, *flags, f"-DRIVAL_LANES={lanes}", source, "-o", str(built), "-lm"], check=True)
        except FileNotFoundError:
            return None
        made = c.CDLL(str(built))
    pointer, i64 = c.c_void_p, c.c_int64
    made.taylor.argtypes = [i64, pointer, pointer, c.c_double, c.c_int, pointer]
    made.taylor.restype = i64
    made.gauss.argtypes = [i64, pointer, pointer, c.c_int, pointer, pointer, pointer]
    made.gauss.restype = None
    made.one_by_one.argtypes = [pointer, pointer, pointer, i64, pointer, pointer, pointer]
    made.one_by_one.restype = None
    return made


def taylor(case: Case, some: Case, exact: Array, target: float, lanes: int) -> Iterator[Found]:
    """For each order the loosest tolerance that keeps errors below the target. Hertz's law on plates only."""
    lib = library(lanes)
    if lib is None or not isinstance(case.law, Hertz):
        return

    def run(nu: Array, gamma: Array, out: Array, order: int, tolerance: float) -> int:
        at = (array.ctypes.data for array in (nu, gamma))
        return lib.taylor(nu.size, *at, tolerance, order, out.ctypes.data)

    few, many = (some.nu, some.gamma), (case.nu, case.gamma)
    found, out = np.empty(exact.shape), np.empty((case.nu.size, exact.shape[1]))
    for order in ORDERS:
        for tolerance in TOLERANCES:
            found[:] = np.nan
            steps = run(*few, found, order, tolerance) / some.nu.size
            error = worst_error(found, exact)
            if error <= target:
                yield f"order {order}, {steps:.0f} steps", error, lambda o=order, t=tolerance: run(*many, out, o, t)
                break


def gauss(case: Case, some: Case, exact: Array, target: float, lanes: int) -> Iterator[Found]:
    """The fewest points that keep errors below the target. Big-Alabo's law on half-spaces only."""
    lib = library(lanes)
    if lib is None or not isinstance(case.law, BigAlabo):
        return
    law = _parameters(case.law)
    found, out = np.empty(exact.shape), np.empty((case.nu.size, exact.shape[1]))
    few, many = some.nu, case.nu

    def run(nu: Array, out: Array, points: int, rule: tuple[Array, Array]) -> None:
        nodes, weights = (array.ctypes.data for array in rule)
        lib.gauss(nu.size, nu.ctypes.data, c.byref(law), points, nodes, weights, out.ctypes.data)

    for points in POINTS:
        x, w = np.polynomial.legendre.leggauss(points)
        rule = 0.5 * (x + 1.0), 0.5 * w
        run(few, found, points, rule)
        error = worst_error(found, exact)
        if error <= target:
            yield f"{points} points a stage", error, lambda p=points, r=rule: run(many, out, p, r)
            return


def _parameters(law: BigAlabo) -> _BigAlabo:
    """The law as rivals.c takes it; the durations of Hertz's law are Γ functions."""
    made, square = _BigAlabo(), 0.0
    for k, stage in enumerate(law.stages()):
        force, radius = stage.force, None if stage.unloading is None else stage.unloading.radius_ratio
        assert isinstance(force, Power) and (radius is None or isinstance(radius, Power))
        made.begin[k], made.f[k], made.k[k] = stage.begin, force.constant, force.slope
        made.ratio[k] = 1.0 if radius is None else radius.constant
        made.rise[k] = 0.0 if radius is None else radius.slope + radius.coefficient
        h = min(stage.end - stage.begin, 1e9)
        square += 2.0 * h * (force.constant + 0.5 * force.slope * h + 0.4 * force.coefficient * h**1.5)
        made.squares[k] = square
    made.turn = math.sqrt(math.pi) * math.gamma(7 / 5) / math.gamma(9 / 10)
    made.rest = made.turn / math.sqrt(0.8)
    return made


def film_alone(case: Case, segments: tuple[int, int]) -> Callable[[], Any]:
    """A call that computes all impacts by film_impact, one after another, from C: statuses and summaries."""
    start = film.starts(case)
    curve, mesh = curve_of(case.law).native, native.mesh(native.WORK_PRESERVING, *segments)
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    impact = c.cast(native.library().film_impact, c.c_void_p)
    at = c.byref(curve), c.byref(mesh), start.size, start.ctypes.data, summary.ctypes.data, status.ctypes.data

    def run() -> Any:
        assert start.size == summary.size  # keeps the memory of start
        library(1).one_by_one(impact, *at)
        return status, summary

    return run
