"""Random bits of files flipped one at a time: what a reader refuses, and what changes in silence.

    python -m benchmarks.bit_flips [--count 1000] [--seed 0] [--kinds history.nc ...]

For each kind of file (a history and two layouts of sweeps, in netCDF and Zarr) a file is written, and copies of it with
one flipped bit are read by `film_datasets.open`. Counted are copies that are refused, that give the same dataset, and
those in which a text or a number differs. It ends with status 1 if a number differed.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import film_datasets as fd
import film_model as fm
from film_datasets.schema import holds_text

LAYOUTS: dict[str, dict[str, Any]] = {
    "grid": {"design": "grid"},
    "samples": {"design": "sobol", "samples": 600, "keep": "samples=11"},
}
KINDS = [f"{what}{suffix}" for suffix in (".nc", ".zarr") for what in ("history", *LAYOUTS)]

OUTCOMES = ("refused", "no effect", "text changed", "number changed")


def main(arguments: Sequence[str] | None = None) -> int:
    """Flip bits and print the counts."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.bit_flips", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("--count", type=int, default=1000, help="flips of each kind of file")
    parser.add_argument("--seed", type=int, default=0, help="of the places of the bits")
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=KINDS, help="of files")
    options = parser.parse_args(arguments)
    print(f"{'file':14}" + "".join(f"{word:>16}" for word in OUTCOMES))
    silent = 0
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for kind in options.kinds:
            found = outcomes(sample(Path(folder, kind)), options.count, options.seed)
            silent += found["number changed"]
            print(f"{kind:14}" + "".join(f"{found[word]:16}" for word in OUTCOMES), flush=True)
    return int(silent > 0)


def sample(path: Path) -> Path:
    """Write the file whose name says its kind."""
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    if path.stem == "history":
        return fd.write(fm.simulate(scene), path)
    over: dict[str, Any] = {"impactor.velocity": {"uniform": ["0.1 m/s", "5 m/s"]}}
    if path.stem == "grid":
        over = {
            "impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 30},
            "impactor.radius": {"from": "5 mm", "to": "20 mm", "count": 30},
        }
    fd.sweep(scene, over, output=path, **LAYOUTS[path.stem]).close()
    return path


def outcomes(path: Path, count: int, seed: int) -> Counter[str]:
    """What `count` flips, one at a time, of bits of a file or of a folder's files do."""
    files = sorted(file for file in path.rglob("*") if file.is_file()) if path.is_dir() else [path]
    good, contents = fd.read(path), [file.read_bytes() for file in files]
    chance, found = random.Random(seed), Counter[str]()
    for number in range(count):
        (at,) = chance.choices(range(len(files)), [len(content) for content in contents])
        bit, changed = chance.randrange(8 * len(contents[at])), bytearray(contents[at])
        changed[bit // 8] ^= 1 << bit % 8
        # HDF5 keeps files that it could not read open, and refuses later ones of that name
        place = files[at] if path.is_dir() else path.with_name(f"damaged{number}{path.suffix}")
        place.write_bytes(changed)
        found[outcome(path if path.is_dir() else place, good)] += 1
        if path.is_dir():
            place.write_bytes(contents[at])
        else:
            place.unlink()
    return found


def outcome(path: Path, good: Any) -> str:
    """One of `OUTCOMES`, for a file of which one bit may have been flipped."""
    try:
        found = fd.read(path)
    except (OSError, ValueError):
        return "refused"
    numbers = [str(name) for name in good.variables if not holds_text(good[name])]
    if any(name not in found.variables or not _same(found[name], good[name]) for name in numbers):
        return "number changed"
    return "no effect" if found.identical(good) else "text changed"


def _same(one: Any, other: Any) -> bool:
    """Whether two variables have the same dimensions, unit and bits."""
    return (one.dims, one.dtype, one.attrs.get("units")) == (other.dims, other.dtype, other.attrs.get("units")) and (
        np.ascontiguousarray(one.values).tobytes() == np.ascontiguousarray(other.values).tobytes()
    )


if __name__ == "__main__":
    sys.exit(main())
