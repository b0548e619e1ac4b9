"""Finite-element impacts of an elastic ball on a rigid plane: `python examples/finite_elements/ball.py`.

Compiles ball.c and elements.c with gcc; prints largest force and approach, contact time and restitution over Hertz's at
the same velocity and mass. A cap at the far pole, 5 to 6 % of the mass, is left out.
"""

import math
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).parent
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Ofast", "-march=native"]
IMPACTS = ((0.3, 0.13, 14), (0.3, 0.27, 16), (0.3, 0.42, 20), (0.49, 0.42, 20))
"""Poisson's ratio, √(δ/R) by Hertz's law, and elements over √(R δ)."""

FINE, GROWTH, EXTENT = 4, 1.25, 6.0
HERTZ_TIME = 2.9432  # of contact, over δ/V


class Impact(NamedTuple):
    """Largest force and approach, and contact time, over Hertz's; restitution; energy at the end over that at first."""

    force: float
    depth: float
    duration: float
    restitution: float
    energy: float


@cache
def program() -> str:
    """The compiled program."""
    made = Path(tempfile.mkdtemp()) / "ball"
    subprocess.run(["gcc", *FLAGS, str(HERE / "ball.c"), str(HERE / "elements.c"), "-lm", "-o", str(made)], check=True)
    return str(made)


def strike(ratio: float, slope: float, elements: int) -> Impact:
    """One impact, at the velocity for which a whole ball has √(δ/R) = slope by Hertz's law; elements: over √(R δ)."""
    velocity = math.sqrt(0.8 / math.pi) * slope**2.5
    words = (ratio, velocity, slope / elements, FINE, GROWTH, EXTENT)
    lines = subprocess.run(
        [program(), *(repr(float(word)) for word in words)], capture_output=True, text=True, check=True, timeout=600
    )
    parts = [line.split() for line in lines.stdout.splitlines()]
    time, depth, force = np.array([part[1:] for part in parts if part[0] == "history"], dtype=float).T
    mass, restitution, duration, energy = (float(word) for word in parts[-1][1:])
    late = force > 0.9 * force.max()
    middle = time[late].mean()
    curve = np.polyfit(time[late] - middle, force[late], 4)
    peak = np.polyval(curve, np.linspace(time[late][0], time[late][-1], 1000) - middle).max()
    part = 1.5 * mass  # of a whole ball's
    hertz = slope**2 * part**0.4
    return Impact(
        2.0 * math.pi * float(peak) / (4.0 / 3.0 * hertz**1.5), float(depth.max()) / hertz,
        duration * velocity / (HERTZ_TIME * hertz), restitution, energy,
    )  # fmt: skip


def main() -> None:
    print("poissons_ratio slope", *Impact._fields)
    for ratio, slope, elements in IMPACTS:
        print(ratio, slope, *(f"{value:.4f}" for value in strike(ratio, slope, elements)))


if __name__ == "__main__":
    main()
