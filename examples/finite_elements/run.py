"""Finite-element impacts of a rigid ball on a half-space that yields: `python examples/finite_elements/run.py FOLDER`.

Compiles impact.c and elements.c with gcc and runs the design: one JSON file per impact, FOLDER/0000.json and so on.
Runs that are there are kept, so that the command can be stopped at any time and started again; the first part of the
design spans all of it. 212 impacts take half an hour on one core; publish.py makes the dataset.

Depth, force and radius are in units of first yield: the largest pressure there is p = C(ν) Y, C = 1.295 exp(0.736 ν)
(Jackson & Green 2005, J. Tribol. 127:343), and by Hertz δ_Y = (π p/(2 E*))² R, F_Y = (4/3) E* √R δ_Y^1.5,
a_Y = √(R δ_Y), m V_Y²/2 = (2/5) F_Y δ_Y; E* = E/(1 − ν²).
"""

import argparse
import json
import math
import subprocess
import tempfile
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.stats import qmc

HERE = Path(__file__).parent
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Ofast", "-march=native"]
TABLE = (
    2.0,
    5.0,
    10.0,
    20.0,
    50.0,
    100.0,
    200.0,
    500.0,
    1000.0,
)  # V/V_Y of the first impacts: E/Y = 200, ν = 0.3, n = 0
DESIGNED = 187  # impacts after these
FAST = 16  # impacts of soft metals after these, beyond 600 V_Y
WIDEST = 0.45  # a/R that is expected at most
EVERY_COARSE = 10  # every tenth impact is computed on a coarser mesh, too
LATE = 0.33  # elements by which a node is touched late: 0.42 elastic, 0.22 at 100 V_Y


@dataclass(frozen=True)
class Impact:
    """What decides the outcome: V/V_Y, E/Y, n of σ_y = Y (1 + E ε_p/Y)^n, ν; False: no yielding."""

    velocity: float
    stiffness: float
    hardening: float = 0.0
    poisson: float = 0.3
    yields: bool = True

    @property
    def yield_strain(self) -> float:
        """e_y = Y/E*."""
        return (1.0 - self.poisson**2) / self.stiffness

    @property
    def yield_depth(self) -> float:
        """δ_Y/R."""
        return (0.5 * math.pi * 1.295 * math.exp(0.736 * self.poisson) * self.yield_strain) ** 2

    @property
    def yield_force(self) -> float:
        """F_Y/(Y R²)."""
        return 4.0 / 3.0 / self.yield_strain * self.yield_depth**1.5

    @property
    def energy(self) -> float:
        """m V²/2 over Y R³."""
        return 0.4 * self.yield_force * self.yield_depth * self.velocity**2


@dataclass(frozen=True)
class Mesh:
    """Elements over the expected contact radius, growth of their size outside, extent over that radius, hourglass
    stiffness over that of bending, and the time of loading over that of a pressure wave through one contact radius."""

    elements: int = 32
    growth: float = 1.2
    extent: float = 200.0
    hourglass: float = 0.25
    slowness: float = 60.0


FINE = Mesh()


@cache
def program() -> str:
    """The compiled program."""
    made = Path(tempfile.mkdtemp()) / "impact"
    sources = [str(HERE / "impact.c"), str(HERE / "elements.c")]
    subprocess.run(["gcc", *FLAGS, *sources, "-lm", "-o", str(made)], check=True)
    return str(made)


def expected(impact: Impact) -> tuple[float, float]:
    """Largest depth and contact radius over R, to about 10 %: they scale the mesh and the ball's mass only."""
    w = np.geomspace(1e-4, 1e4, 4000)
    plastic = np.maximum(w, 1.0) if impact.yields else np.ones_like(w)
    radius = np.sqrt(w * plastic**0.14)
    force = np.where(plastic == 1.0, w**1.5, radius**2 * (1.0 + 1.7 * (1.0 - plastic**-0.25)))
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(w))])
    a, depth = 0.0, 0.0
    for _ in range(40):  # Tabor's strain 0.2 a/R decides the yield stress of a material that hardens
        flow = (1.0 + impact.stiffness * 0.2 * a) ** impact.hardening
        unit = impact.yield_depth * flow**2
        reached = float(np.interp(0.4 * (impact.velocity * flow**-2.5) ** 2, work, w))
        a = 0.5 * (a + float(np.interp(reached, w, radius)) * math.sqrt(unit))
        depth = reached * unit
    return depth, a


def smooth(x: np.ndarray, y: np.ndarray, at: np.ndarray, width: float) -> np.ndarray:
    """Local straight lines through y(x), over ± width."""
    found = []
    for x0 in at:
        near = np.abs(x - x0) <= max(width, float(np.sort(np.abs(x - x0))[8]))
        found.append(np.polyval(np.polyfit(x[near] - x0, y[near], 1), 0.0))
    return np.array(found)


def printed(impact: Impact, mesh: Mesh = FINE, later: tuple[float, ...] = ()) -> list[list[str]]:
    """The lines that the program prints, as words. later: velocities of impacts on the same dent, over that of the
    first, 0: that of the rebound before."""
    depth, a = expected(impact)
    wave = math.sqrt(impact.stiffness * (1 - impact.poisson) / (1 + impact.poisson) / (1 - 2 * impact.poisson))
    speed = depth / (mesh.slowness * a / wave)
    mass = 2.0 * impact.energy / speed**2 / (2.0 * math.pi)  # of one radian
    words = [impact.stiffness, impact.poisson, impact.hardening, mass, speed, a / mesh.elements,
             int(1.2 * mesh.elements), mesh.growth, mesh.extent * a, mesh.hourglass, int(impact.yields),
             *(part * speed for part in later)]  # fmt: skip
    lines = subprocess.run(
        [program(), *(repr(float(word)) for word in words)], capture_output=True, text=True, check=True, timeout=600
    )
    return [line.split() for line in lines.stdout.splitlines()]


def strike(impact: Impact, mesh: Mesh = FINE) -> dict:
    """Run one impact, and reduce its history."""
    parts = printed(impact, mesh)
    history = np.array([part[1:] for part in parts if part[0] == "history"], dtype=float)
    touched = np.array([part[1:] for part in parts if part[0] == "contact"], dtype=float)
    end = [float(word) for word in parts[-1][1:]]
    element = expected(impact)[1] / mesh.elements
    return {"impact": asdict(impact), "mesh": asdict(mesh), **reduced(impact, history, touched, element, end)}


def reduced(impact: Impact, history: np.ndarray, touched: np.ndarray, element: float, end: list[float]) -> dict:
    """Numbers and curves of one impact from what the program printed."""
    depth, force = history[:, 1] / impact.yield_depth, history[:, 2] * 2.0 * math.pi / impact.yield_force
    turn = int(np.argmax(depth))
    most = float(depth[turn])
    x, y = depth[:turn], force[:turn]
    late = x > 0.9 * most
    peak = float(np.polyval(np.polyfit(x[late] / most - 1.0, y[late], 2), 0.0))
    edge, at = (touched[4:, 0] - LATE * element) / math.sqrt(impact.yield_depth), touched[4:, 1] / impact.yield_depth
    log_a = np.polyfit(np.log(at[-6:] / most), np.log(edge[-6:]), 1)
    grid = np.geomspace(float(at[0]), most, 60)
    known = np.append(np.log(edge), log_a[1])
    radius = np.exp(smooth(np.append(np.log(at), math.log(most)), known, np.log(grid), 0.1))
    radius[-1] = math.exp(log_a[1])
    loading = np.exp(
        smooth(np.log(x[x > 0.5 * at[0]]), np.log(np.maximum(y[x > 0.5 * at[0]], 1e-9)), np.log(grid), 0.05)
    )
    loading[-1] = peak
    out, back = depth[turn:], force[turn:] / peak
    low = (back > 0.02) & (back < 0.15)
    residual = float(np.polyval(np.polyfit(back[low] ** (2.0 / 3.0), out[low], 1), 0.0))
    part = np.linspace(0.05, 0.95, 30)
    unloading = smooth((out - residual) / (most - residual), back, part, 0.03)
    return {
        "restitution": end[0], "depth": most, "force": peak, "radius": float(radius[-1]), "residual": residual,
        "depth_over_R": most * impact.yield_depth, "radius_over_R": float(radius[-1]) * math.sqrt(impact.yield_depth),
        "residual_over_R": residual * impact.yield_depth, "last_contact_over_R": end[1], "dent_over_R": end[2],
        "mean_pressure_over_Y": peak * impact.yield_force / (math.pi * float(radius[-1]) ** 2 * impact.yield_depth),
        "energy": dict(zip(("kinetic", "internal", "plastic", "hourglass", "viscous"), end[3:8], strict=True)),
        "balance": end[0] ** 2 + end[3] + end[4] - 1.0, "elements": len(touched),
        "loading": {"depth": grid.tolist(), "force": loading.tolist(), "radius": radius.tolist()},
        "unloading": {"depth": ((residual + part * (most - residual)) / most).tolist(), "force": unloading.tolist()},
    }  # fmt: skip


def design() -> list[Impact]:
    """The impacts of the table, then points of two of Sobol's sequences; the velocity is limited by a/R <= 0.45."""
    made = [Impact(velocity, 200.0) for velocity in TABLE]
    for seed, count, slow, fast, least, most in (
        (7, DESIGNED, 1.5, 1000.0, 50.0, 1000.0),
        (11, FAST, 600.0, 6000.0, 400.0, 4000.0),
    ):
        for v, stiff, hard, poisson in qmc.Sobol(4, scramble=True, rng=seed).random(256)[:count].tolist():
            stiffness, n, nu = least * (most / least) ** stiff, 0.4 * max(0.0, hard - 0.3) / 0.7, 0.2 + 0.25 * poisson
            top = fast
            while expected(Impact(top, stiffness, n, nu))[1] > WIDEST:
                top *= 0.95
            made.append(Impact(slow * (top / slow) ** v, stiffness, n, nu))
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path("finite_element_impacts"))
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for index, impact in enumerate(design()):
        meshes = {"": FINE} | ({"_coarse": Mesh(elements=20)} if index % EVERY_COARSE == 0 else {})
        for suffix, mesh in meshes.items():
            path = folder / f"{index:04d}{suffix}.json"
            if not path.exists():
                part = path.with_suffix(".part")
                part.write_text(json.dumps({"index": index, **strike(impact, mesh)}))
                part.rename(path)


if __name__ == "__main__":
    main()
