"""The runs of run.py and pair.py as published datasets: `python examples/finite_elements/publish.py FOLDER [PAIRS]`."""

import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr

import film_datasets as fd
from film_datasets.provenance import provenance
from film_datasets.schema import MEASUREMENT, TABLE, content_sha256

PUBLISHED = Path(__file__).parents[2] / "datasets" / "published"
DEPTHS = np.geomspace(0.2, 1.0, 25)  # over the largest; below, fewer than 14 elements are in contact
HELD_OUT_EVERY = 3  # runs 2, 5, 8, ... stay out of the fit
SCALARS = {
    "coefficient_of_restitution": "restitution",
    "largest_depth": "depth",
    "largest_force": "force",
    "largest_radius": "radius",
    "residual_depth": "residual",
    "energy_balance": "balance",
}
OF_PAIRS = {
    "velocity_ratio": "velocity",
    "stiffness_ratio": "stiffness",
    "hardening_exponent": "hardening",
    "poissons_ratio": "poisson",
    "strength_ratio": "strengths",
    "modulus_ratio": "moduli",
    "softer": "soft_ball",
}
UNITS = (
    "Units of first yield: pressure C Y, C = 1.295 exp(0.736 nu), and Hertz's depth, force, contact radius "
    "and velocity for it. Without friction, rate or waves."
)


def on_grid(curve: dict, name: str, largest: float) -> np.ndarray:
    """A loading curve at `DEPTHS`, straight lines between logarithms."""
    return np.exp(np.interp(np.log(DEPTHS * largest), np.log(curve["depth"]), np.log(curve[name])))


def runs_in(folder: Path) -> tuple[list[dict], list[dict]]:
    """The runs in a folder, and those on the coarser mesh."""
    fine, coarse = "[0-9][0-9][0-9][0-9].json", "*_coarse.json"
    return tuple([json.loads(path.read_text()) for path in sorted(folder.glob(names))] for names in (fine, coarse))


def mesh_errors(runs: list[dict], coarse: list[dict], key: str = "impact") -> list[float]:
    """Relative differences of the restitution between two meshes, each of the run with the nearest velocity."""
    fine = {run["index"]: run for run in runs}
    velocity = np.log([run[key]["velocity"] for run in coarse])
    found = [abs(run["restitution"] / fine[run["index"]]["restitution"] - 1.0) for run in coarse]
    return [found[int(np.argmin(np.abs(velocity - np.log(run[key]["velocity"]))))] for run in runs]


def dataset(folder: Path) -> xr.Dataset:
    """The dataset of all runs in a folder."""
    runs, coarse = runs_in(folder)
    columns = {name: [run[key] for run in runs] for name, key in SCALARS.items()}
    columns |= {
        "velocity_ratio": [run["impact"]["velocity"] for run in runs],
        "stiffness_ratio": [run["impact"]["stiffness"] for run in runs],
        "hardening_exponent": [run["impact"]["hardening"] for run in runs],
        "poissons_ratio": [run["impact"]["poisson"] for run in runs],
        "mesh_error": mesh_errors(runs, coarse),
        "depth_fraction": DEPTHS,
        "loading_force": [on_grid(run["loading"], "force", run["depth"]) for run in runs],
        "loading_radius": [on_grid(run["loading"], "radius", run["depth"]) for run in runs],
        "recovery_fraction": np.linspace(0.05, 0.95, 30),
        "unloading_force": [run["unloading"]["force"] for run in runs],
        "held_out": [run["index"] % HELD_OUT_EVERY == HELD_OUT_EVERY - 1 for run in runs],
    }
    return published(
        "finite_elements",
        columns,
        title="Finite-element impacts of a rigid ball on a half-space that yields",
        summary=f"{len(runs)} impacts: restitution, largest values, loading and unloading curves.",
        comment=UNITS,
    )


def pairs(folder: Path) -> xr.Dataset:
    """The dataset of all pairs in a folder."""
    runs, coarse = runs_in(folder)
    columns = {name: [run[key] for run in runs] for name, key in SCALARS.items()}
    columns |= {name: [run["pair"][key] for run in runs] for name, key in OF_PAIRS.items()}
    columns |= {
        "mesh_error": mesh_errors(runs, coarse, "pair"),
        "harder_share": [run["harder"] for run in runs],
        "held_out": [run["index"] % HELD_OUT_EVERY == HELD_OUT_EVERY - 1 for run in runs],
    }
    return published(
        "finite_element_pairs",
        columns,
        title="Finite-element impacts of a ball on a half-space that both yield",
        summary=f"{len(runs)} impacts: restitution and largest values.",
        comment=f"{UNITS} They are those of the softer body's strength and of the effective modulus.",
    )


def published(kind: str, columns: dict, **words: str) -> xr.Dataset:
    """A dataset of a kind of finite-element impacts."""
    table = TABLE[f"{MEASUREMENT} {kind}"]
    ds = xr.Dataset({v.name: (v.dims, np.asarray(columns[v.name], v.dtype), v.attributes()) for v in table})
    source = "axisymmetric explicit finite elements, examples/finite_elements"
    command = "examples/finite_elements/publish.py"
    ds.attrs = provenance(MEASUREMENT, source=source, command=command, **words) | {"measured": kind}
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def main() -> None:
    for name, made in zip(("impacts", "pairs"), sys.argv[1:], strict=False):
        ds = (dataset if name == "impacts" else pairs)(Path(made))
        print(fd.write(ds, PUBLISHED / f"finite_element_{name}.nc", overwrite=True), dict(ds.sizes))


if __name__ == "__main__":
    main()
