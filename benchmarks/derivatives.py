"""The cost of derivatives: `python -m benchmarks.derivatives`.

One impact: `simulate`, the same with derivatives by one, by six and by eight numbers, and those by six by a loop of
`simulate` over four other values of each number at accuracy 1e-10, which is as exact. A sweep of 8192 impacts: without,
with one, with six and with eight. An impact on a vibrating beam: without, with one and with two. The variants run in
turn; CPU times are the minimum over the rounds, printed and never asserted. The last column is the ratio of that with
eight numbers to that without.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Mapping, Sequence

import film_datasets as fd
import film_model as fm

NUMBERS = (
    *("impactor.velocity", "impactor.radius", "target.material.youngs_modulus", "target.material.yield_strength"),
    *("impactor.material.density", "impactor.material.youngs_modulus"),
    *("impactor.material.poissons_ratio", "target.material.poissons_ratio"),
)
"""Of the last, the curve of law "jackson-green" depends."""
IMPACTS = 8192


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.derivatives")
    parser.add_argument("--rounds", type=int, default=40, help="of one impact (default: 40); of sweeps a tenth")
    rounds: int = parser.parse_args(arguments).rounds
    warnings.simplefilter("ignore")
    steel = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    scenes = {law: steel.replace({"contact.law": law}) for law in ("hertz", "big-alabo", "auto")}
    scenes["auto, plate"] = plate = fm.Scene(steel.impactor, fm.Plate("mild steel", thickness="10 mm"))
    scenes["stronge, plate"] = plate.replace({"contact.law": "stronge"})
    heads = "".join(f"{head:>12}" for head in ("1 number", "6 numbers", "8 numbers"))
    print(f"{'one impact':16}{'simulate':>12}{'loop, 6':>12}{heads}{'ratio':>7}")
    for name, scene in scenes.items():
        found = [*least(of_one(scene), rounds).values()]
        print(f"{name:16}" + "".join(f"{1e3 * cpu:9.2f} ms" for cpu in found) + f"{found[-1] / found[0]:7.1f}")
    print(f"\n{f'{IMPACTS} impacts':16}{'sweep':>12}{heads}{'ratio':>7}")
    for name, scene in scenes.items():
        found = [*least(of_sweep(scene), max(rounds // 10, 1)).values()]
        print(f"{name:16}" + "".join(f"{cpu:10.2f} s" for cpu in found) + f"{found[-1] / found[0]:7.1f}")
    beam = fm.Beam("mild steel", width="10 mm", thickness="5 mm", length="100 mm")
    found = least(of_beam(fm.Scene(steel.impactor, beam, fm.Contact("hertz"))), rounds)
    print(f"\n{'vibrating beam':16}{'simulate':>12}{'1, impactor':>12}{'1, target':>12}")
    print(f"{'':16}" + "".join(f"{1e3 * seconds:9.2f} ms" for seconds in found.values()))
    return 0


def of_one(scene: fm.Scene) -> dict[str, Callable[[], object]]:
    """The variants of one impact."""
    found = fm.simulate(scene, derivatives=NUMBERS[:6]).derivatives
    assert found is not None
    moved = [
        scene.replace({path: f"{entry.value * (1.0 + offset)!r} {entry.unit}"})
        for path, entry in found.entries.items()
        for offset in (-2e-3, -1e-3, 1e-3, 2e-3)
    ]
    return {
        "simulate": lambda: fm.simulate(scene),
        "loop": lambda: [fm.simulate(one, accuracy=1e-10) for one in (scene, *moved)],
        "one": lambda: fm.simulate(scene, derivatives=NUMBERS[:1]),
        "six": lambda: fm.simulate(scene, derivatives=NUMBERS[:6]),
        "eight": lambda: fm.simulate(scene, derivatives=NUMBERS),
    }


def of_sweep(scene: fm.Scene) -> dict[str, Callable[[], object]]:
    """The variants of a sweep, in one thread."""
    over = {
        "impactor.velocity": {"uniform": ["0.05 m/s", "5 m/s"]},
        "target.material.yield_strength": {"uniform": ["200 MPa", "400 MPa"]},
    }

    def run(count: int) -> object:
        return fd.sweep(scene, over, "sobol", samples=IMPACTS, workers=1, derivatives=NUMBERS[:count])

    return {"none": lambda: run(0), "one": lambda: run(1), "six": lambda: run(6), "eight": lambda: run(8)}


def of_beam(scene: fm.Scene) -> dict[str, Callable[[], object]]:
    """The variants of an impact on a vibrating beam."""
    return {
        "simulate": lambda: fm.simulate(scene),
        "impactor": lambda: fm.simulate(scene, derivatives=["impactor.velocity"]),
        "target": lambda: fm.simulate(scene, derivatives=["target.thickness"]),
    }


def least(variants: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """The least CPU time of each variant, s; they run in turn."""
    best = dict.fromkeys(variants, float("inf"))
    for variant in variants.values():
        variant()
    for _ in range(rounds):
        for name, variant in variants.items():
            begin = time.process_time()
            variant()
            best[name] = min(best[name], time.process_time() - begin)
    return best


if __name__ == "__main__":
    raise SystemExit(main())
