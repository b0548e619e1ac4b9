"""Finite-element impacts of a ball on a half-space that both yield: `python examples/finite_elements/pair.py FOLDER`.

Compiles pair.c and elements.c with gcc and runs the design, as run.py does and in its units: E* is that of both bodies,
Y, n and ν those of the softer.
"""

import argparse
import json
import math
import subprocess
import tempfile
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from run import FLAGS, HERE, Impact, Mesh, expected, reduced
from scipy.stats import qmc

DESIGNED = 80
EVERY_COARSE, COARSE = 8, (0, 6)  # of eight impacts, those on a coarser mesh, too: slow ones, fast ones
WIDEST = 0.25  # a/R that is expected at most
FINE = Mesh(elements=48, slowness=80.0)
COARSER = 0.75  # elements of the coarser mesh


@dataclass(frozen=True)
class Pair:
    """V/V_Y; E*(1 − ν²)/Y; n and ν of both; strength and modulus of the harder over those of the softer; which is the
    ball; n of the harder if it differs; R over the radius of the other body, of two balls."""

    velocity: float
    stiffness: float
    hardening: float = 0.0
    strengths: float = 1.0
    moduli: float = 1.0
    soft_ball: bool = False
    poisson: float = 0.3
    hardening_of_harder: float | None = None
    curvature: float = 0.0

    @property
    def single(self) -> Impact:
        """The impact of a rigid ball with the same E*, Y, n, ν."""
        return Impact(self.velocity, self.stiffness, self.hardening, self.poisson)


@cache
def program() -> str:
    """The compiled program."""
    made = Path(tempfile.mkdtemp()) / "pair"
    sources = [str(HERE / "pair.c"), str(HERE / "elements.c")]
    subprocess.run(["gcc", *FLAGS, *sources, "-lm", "-o", str(made)], check=True)
    return str(made)


def strike(pair: Pair, mesh: Mesh) -> dict:
    """Run one impact, and reduce its history."""
    impact = pair.single
    depth, a = expected(impact)
    soft = pair.stiffness * (1.0 + 1.0 / pair.moduli)
    harder = pair.hardening if pair.hardening_of_harder is None else pair.hardening_of_harder
    bodies = [[soft, pair.poisson, pair.hardening, 1.0],
              [soft * pair.moduli, pair.poisson, harder, pair.strengths]]  # fmt: skip
    ball, flat = bodies if pair.soft_ball else bodies[::-1]
    least = min(soft, soft * pair.moduli / pair.strengths)
    wave = math.sqrt(least * (1 - pair.poisson) / (1 + pair.poisson) / (1 - 2 * pair.poisson))
    speed = depth / (mesh.slowness * a / wave)
    mass = 2.0 * impact.energy / speed**2 / (2.0 * math.pi)
    words = [*ball, *flat, mass, speed, a / mesh.elements, int(1.2 * mesh.elements), mesh.growth, mesh.extent * a,
             mesh.hourglass, pair.curvature]  # fmt: skip
    lines = subprocess.run(
        [program(), *(repr(float(word)) for word in words)], capture_output=True, text=True, check=True, timeout=600
    )
    parts = [line.split() for line in lines.stdout.splitlines()]
    history = np.array([part[1:] for part in parts if part[0] == "history"], dtype=float)
    touched = np.array([part[1:] for part in parts if part[0] == "contact"], dtype=float)
    end = [float(word) for word in parts[-1][1:]]
    found = reduced(impact, history, touched, a / mesh.elements, end)
    share = end[8] / end[5] if end[5] > 0.0 else 0.0  # of plastic work, in the half-space
    harder = share if pair.soft_ball else 1.0 - share
    return {"pair": asdict(pair), "mesh": asdict(mesh), "harder": harder, **found}


def design() -> list[Pair]:
    """Points of Sobol's sequence; the velocity is limited by a/R <= 0.25."""
    made = list[Pair]()
    for k, (v, stiff, hard, strong, modulus) in enumerate(
        qmc.Sobol(5, scramble=True, rng=5).random(128)[:DESIGNED].tolist()
    ):
        stiffness, n, top = 50.0 * 16.0**stiff, 0.4 * max(0.0, hard - 0.3) / 0.7, 1000.0
        while expected(Impact(top, stiffness, n))[1] > WIDEST:
            top *= 0.95
        made.append(Pair(1.5 * (top / 1.5) ** v, stiffness, n, 4.0**strong, 0.5 * 16.0**modulus, k % 2 == 1))
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path("finite_element_pairs"))
    parser.add_argument("--elements", type=int, default=FINE.elements, help="over the contact radius")
    parser.add_argument("--slowness", type=float, default=FINE.slowness, help="as in run.Mesh")
    options = parser.parse_args()
    folder = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    fine = replace(FINE, elements=options.elements, slowness=options.slowness)
    coarse = replace(fine, elements=int(COARSER * fine.elements))
    for index, pair in enumerate(design()):
        for suffix, mesh in {"": fine, **({"_coarse": coarse} if index % EVERY_COARSE in COARSE else {})}.items():
            path = folder / f"{index:04d}{suffix}.json"
            if not path.exists():
                part = path.with_suffix(".part")
                part.write_text(json.dumps({"index": index, **strike(pair, mesh)}))
                part.rename(path)


if __name__ == "__main__":
    main()
