"""Recompute the datasets of datasets/published: `python -m examples.published_datasets [FOLDER]`.

paper_big_alabo, paper_stronge, paper_plate: the impacts of Big-Alabo, Cartmell & Harrison 2017. zener: the coefficient
of restitution over Zener's inelasticity parameter, on plates of any thickness. restitution: over velocity, for the laws
of `CONTACTS`. measured_impacts: published values, from the tables in CSV beside it. oblique_impacts: those of Kharaz,
Gorham & Salman 2001, from examples/measurements. finite_element_impacts and finite_element_pairs: copied; the runs take
an hour (run.py, pair.py and publish.py of examples/finite_elements).
Published data stay as they are: a law that is added later does not change them.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr

import film_datasets as fd
import film_model as fm
from examples.reference.evidence_table import evidence_from_csv

SCENES = Path(__file__).parent / "scenes"
FOLDER = Path(__file__).parent.parent / "datasets" / "published"
OBLIQUE = Path(__file__).parent / "measurements" / "kharaz_2001.csv"

CONTACTS = {  # laws of the restitution dataset, with the parameters that the scene does not give
    "hertz": {},
    "meyer": {"stiffness": "2.27e10 N/m^1.5", "exponent": 1.5},  # Hertz's stiffness of this pair
    "big-alabo": {},
    "stronge": {},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "kogut-etsion": {"hardness": "2.8 GPa"},
    "jackson-green": {},
    "yigit-christoforou": {},
    "rigid-plastic": {"yield_pressure": "3 GPa"},
    "walton-braun": {"loading_stiffness": "5e7 N/m", "unloading_stiffness": "8e7 N/m"},
    "luding": {"loading_stiffness": "5e7 N/m", "plastic_stiffness": "8e7 N/m", "plasticity_depth": 0.05},
    "tan-sun": {"stiffness": "2.27e10 N/m^1.5", "critical_indentation": "1 um"},
    "tabulated": {"indentation": ["0 um", "2 um", "20 um", "200 um"], "force": ["0 N", "50 N", "1200 N", "15000 N"]},
    "linear-dashpot": {"stiffness": "5e7 N/m", "restitution": 0.8},
    "tsuji": {"restitution": 0.8},
    "hunt-crossley": {"restitution": 0.8},
    "kuwabara-kono": {"dissipation_time": "1 us"},
}


def paper() -> dict[str, xr.Dataset]:
    """Histories of the paper's three impacts."""
    scenes = {
        "paper_big_alabo": fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml"),
        "paper_stronge": fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel_stronge.toml"),
        "paper_plate": fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace(
            {"target.impedance_formula": "paper", "effects.boundary_reflections": False}
        ),
    }
    return {name: fd.to_dataset(fm.simulate(scene, accuracy=1e-8)) for name, scene in scenes.items()}


def zener() -> xr.Dataset:
    """Restitution of a steel ball on steel plates, from thin ones with almost no rebound to nearly rigid ones.

    Hertz's law, so that the coefficient of restitution depends on `zener_number` alone (Zener 1941).
    """
    base = fm.Scene(
        fm.Sphere("5 mm", velocity="1 m/s", material="bearing steel"),
        fm.Plate("mild steel", thickness="10 mm"),
        fm.Contact("hertz"),
        effects=fm.Effects(target_motion=True, gravity=False),  # even if the change is small
        solver=fm.Solver(accuracy=1e-8),
        title="Zener's curve",
    )
    thickness = {"from": "2 mm", "to": "200 mm", "count": 121, "spacing": "log"}
    return fd.sweep(base, {"target.thickness": thickness})


def restitution() -> xr.Dataset:
    """Restitution of the paper's ball on its steel, over velocity, for the laws in `CONTACTS`."""
    base = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml").replace({"solver.accuracy": 1e-8})
    contacts = [{"law": name, **parameters} for name, parameters in CONTACTS.items()]
    velocity = {"from": "0.01 m/s", "to": "10 m/s", "count": 121, "spacing": "log"}
    return fd.sweep(base, {"contact": contacts, "impactor.velocity": velocity})


def main(folder: str | Path = FOLDER) -> dict[str, xr.Dataset]:
    """Write all datasets into a folder, and return them by name."""
    made = {**paper(), "zener": zener(), "restitution": restitution()}
    made["measured_impacts"] = evidence_from_csv(
        FOLDER / "measured_impacts.csv", FOLDER / "measured_impacts_sources.csv"
    )
    made["oblique_impacts"] = fd.from_csv(OBLIQUE, "Alumina balls on glass at an angle (Kharaz, Gorham & Salman 2001)")
    made |= {name: fd.load(name) for name in ("finite_element_impacts", "finite_element_pairs")}
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, dataset in made.items():
        fd.write(dataset, Path(folder) / f"{name}.nc", overwrite=True)
    return made


if __name__ == "__main__":
    for dataset_name, found in main(*sys.argv[1:2]).items():
        sizes = ", ".join(f"{size} {dim}" for dim, size in found.sizes.items())
        print(f"{dataset_name}: {sizes}")
    lambdas, ratios = fd.load("zener")["zener_number"], fd.load("zener")["coefficient_of_restitution"]
    print(f"restitution falls from {float(ratios.max()):.4f} to {float(ratios.min()):.4f} over λ "
          f"{float(np.min(lambdas)):.3g} to {float(np.max(lambdas)):.3g}")  # fmt: skip
