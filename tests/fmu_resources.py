"""Folders of FMU resources for tests/fmu_check.c and tests/fmu_fuzz.c: `python tests/fmu_resources.py FOLDER`.

One folder a case: laws of all forms, targets that stay and targets that give way, a start away from the target with
and without gravity, and the contact alone.
"""

from __future__ import annotations

import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from cases import STEEL, TARGETS, scene

import film_model as fm
from fmu_wrapper import export
from fmu_wrapper.platforms import this_platform

SENSORS = [{"name": "tip", "shape": [1.0, -0.5, 2.0]}, {"name": "side", "shape": [0.5, 0.0, 1.0]}]


def on_structure(law: str, **options: Any) -> fm.Scene:
    """The ball on a structure of three vibrations, of which the first is a motion as a whole if they are not damped."""
    frequency = ["300 Hz" if options else "0 Hz", "1.7 kHz", "9 kHz"]
    mass = ["0.3 kg", "0.2 kg", "0.4 kg"]
    target = fm.Structure(frequency=frequency, modal_mass=mass, material=STEEL, **options)
    return replace(scene(law), target=target)


def on_spring(law: str) -> fm.Scene:
    """The ball on a beam that follows by its static stiffness."""
    beam = fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness="2e7 N/m")
    return replace(scene(law), target=beam, effects=fm.Effects(gravity=True, target_inertia=False))


def viscoelastic(target: str = "half-space") -> fm.Scene:
    """A ball of a viscoelastic material."""
    series = [[0.4, "0.2 ms"], [0.2, "3 ms"]]
    rubber = fm.Material(youngs_modulus="50 MPa", poissons_ratio=0.49, density="1100 kg/m^3", prony=series)
    return fm.Scene(
        fm.Sphere("10 mm", "0.25 m/s", material=rubber),
        TARGETS[target],
        effects=fm.Effects(target_motion=target != "half-space"),
    )


def rubbing(law: str, **contact: Any) -> fm.Scene:
    """The ball comes in at an angle, with friction."""
    on = scene(law)
    entries = {"contact.friction": 0.3, "contact.effective_modulus": None}
    entries |= {"impactor.angle": "30 deg", "impactor.spin": "9 rad/s"}
    on = on.replace({**entries, "impactor.material": "bearing steel", "target.material": "bearing steel"})
    return on.replace({f"contact.{name}": value for name, value in contact.items()})


CASES = {
    "hertz": ("impact", scene("hertz"), 0.0),
    "hertz on a plate": ("impact", scene("hertz", "plate"), "2 um"),
    "big-alabo": ("impact", scene("big-alabo"), 0.0),
    "stronge on a thin plate": ("impact", scene("stronge", "thin plate"), "1 um"),
    "fitted on a rod": ("impact", scene("saturating", "rod"), 0.0),
    "a force at first touch": ("impact", scene("meyer-shifted"), "1 um"),
    "chords": ("impact", scene("big-alabo", "plate", linearisation="chord"), 0.0),
    "friction": ("impact", rubbing("hertz"), "1 um"),
    "a table of friction": ("impact", rubbing("hertz", friction=[["0 m/s", 0.4], ["1 m/s", 0.1]]), "1 um"),
    "dropped": ("impact", replace(scene("big-alabo"), effects=fm.Effects(gravity=True)), "0.05 mm"),
    "spring and dashpot": ("impact", scene("linear-dashpot"), "1 um"),
    "tsuji on a plate": ("impact", scene("tsuji", "plate"), 0.0),
    "hunt-crossley on a rod": ("impact", scene("hunt-crossley", "rod"), "2 um"),
    "kuwabara-kono, dropped": ("impact", replace(scene("kuwabara-kono"), effects=fm.Effects(gravity=True)), "0.05 mm"),
    "vibrations": ("impact", on_structure("hertz", static_compliance="3e-6 m/N", sensors=SENSORS), "1 um"),
    "vibrations that fade, big-alabo, dropped": (
        "impact",
        replace(on_structure("big-alabo", damping_ratio=0.05), effects=fm.Effects(gravity=True)),
        "2 um",
    ),
    "viscoelastic, on a rod": ("impact", viscoelastic("rod"), "2 um"),
    "viscoelastic, dropped": ("impact", viscoelastic(), "0.05 mm"),
    "vibrations, hunt-crossley": ("impact", on_structure("hunt-crossley"), 0.0),
    "static stiffness, hertz": ("impact", on_spring("hertz"), "1 um"),
    "static stiffness, stronge": ("impact", on_spring("stronge"), 0.0),
    "static stiffness, a shape": ("impact", on_spring("jackson-green"), 0.0),
    "contact, spring and dashpot": ("contact", scene("linear-dashpot"), 0.0),
    "contact, kuwabara-kono": ("contact", scene("kuwabara-kono"), 0.0),
    "contact, hertz": ("contact", scene("hertz"), 0.0),
    "contact, big-alabo": ("contact", scene("big-alabo"), 0.0),
    "contact, fitted": ("contact", scene("saturating"), 0.0),
}


def write(folder: Path) -> None:
    """Export every case and leave its resources in `folder/<case>`."""
    for k, (name, (kind, case, gap)) in enumerate(CASES.items()):
        with tempfile.TemporaryDirectory() as where:
            path, own = Path(where) / "case.fmu", this_platform()
            fmu = export(case, path, 2 + k % 2, kind=kind, initial_gap=gap, platform=own)
            with zipfile.ZipFile(fmu) as archive:
                (folder / name).mkdir(parents=True, exist_ok=True)
                (folder / name / "model.film").write_bytes(archive.read("resources/model.film"))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
