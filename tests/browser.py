"""Chromium for the tests of the explorer's page, and random scenes in the form of the page's addresses."""

import math
import random
import shutil
from contextlib import contextmanager
from urllib.parse import urlencode

import pytest
from law_cases import CONTACTS, scene_text

from film_model.explorer import page as page_module
from film_model.explorer.content import EDGES, SWITCHES, Content
from film_model.explorer.inputs import PLATE
from film_model.explorer.page import examples, page
from film_model.scene import Scene

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
)
SUMMARIES = """fragments => fragments.map(fragment => {
    const found = filmModel.impact(fragment);
    for (const [name, value] of Object.entries(found.summary ?? {}))
        if (Number.isNaN(value)) found.summary[name] = null;
    for (const [name, value] of Object.entries(found.oblique?.summary ?? {}))
        if (Number.isNaN(value)) found.oblique.summary[name] = null;
    delete found.oblique?.motion;
    let text = null;
    try { text = filmModel.sceneFile(fragment); } catch { }
    return [found, text];
})"""
"""JavaScript: the results of addresses, and their scene files."""

BALL = (
    '[impactor]\nradius = "5 mm"\nvelocity = "1 m/s"\nmaterial = "bearing steel"\n[target]\nmaterial = "mild steel"\n'
)
BEYOND = {
    "static": (300, 'kind = "plate"\nthickness = "2 mm"\nstatic_stiffness = "1e6 N/m"'),
    "wide-plate": (30, 'kind = "plate"\nthickness = "8 mm"\nsize = ["1 m", "1 m"]'),
    "plate": (1, 'kind = "plate"\nthickness = "1.5 mm"\nsize = ["100 mm", "100 mm"]\ndamping_ratio = 0.02'),
    "beam": (4, 'kind = "beam"\nlength = "200 mm"\nwidth = "20 mm"\nthickness = "5 mm"\ndamping_ratio = 0.02'),
    "rod": (30, 'kind = "rod"\nlength = "40 mm"\ndiameter = "10 mm"\ndamping_ratio = 0.02'),
    "structure": (40, 'kind = "structure"\nfrequency = ["1.8 kHz", "4.1 kHz"]\nmodal_mass = ["0.9 kg", "1.4 kg"]'),
    "free-structure": (
        20,
        'kind = "structure"\nfrequency = ["0 Hz", "180 Hz", "410 Hz", "2 kHz"]\ndamping_ratio = 0.01\n'
        'modal_mass = ["3 kg", "0.9 kg", "1.4 kg", "0.5 kg"]\nstatic_compliance = "2e-6 m/N"',
    ),
}
"""Targets that the page's examples lack, and how often they are drawn: a vibrating one costs up to 300 ms."""

OFTEN = {"ball-on-beam": 4} | {name: often for name, (often, _) in BEYOND.items()}
USUAL = 100
"""How often the other scenes are drawn."""

OF_PLATES = (*PLATE, "target.damping_ratio")
"""Entries of plates that go together."""

MATERIALS = ("youngs_modulus", "density", "yield_strength", "hardness", "poissons_ratio")
OTHER_STRENGTH = {"yield_strength": "hardness", "hardness": "yield_strength"}


@contextmanager
def chromium():
    """A browser that talks to nobody."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        yield browser
        browser.close()


def page_of_everything():
    """A page with the examples, every kind of target, and every law of a scene; and the page's data."""
    texts = {name: BALL + text for name, (_, text) in BEYOND.items()}
    for law in CONTACTS:
        texts |= {f"{law}-{target}": scene_text(law, target) for target in ("half-space", "plate")}
    scenes = (*examples(), *((f"test-{name}", Scene.from_text(text)) for name, text in texts.items()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(page_module, "examples", lambda: scenes)
        return page(), Content(scenes).table()


def random_addresses(table, count, seed):
    """Addresses of scenes whose entries lie anywhere on their sliders, materials within a factor of three.

    First each scene under its own law, for the curves that are for the bodies as given.
    """
    chance, scenes = random.Random(seed), table["scenes"]
    often = [OFTEN.get(scene["name"].removeprefix("test-"), USUAL) for scene in scenes]
    drawn = chance.choices(scenes, often, k=count - len(scenes))
    return [_address(table, base, chance, k < len(scenes)) for k, base in enumerate([*scenes, *drawn])]


def _address(table, base, chance, as_given):
    found = {"scene": base["name"]}
    for entry in base["inputs"]:
        name, (low, high), value = entry["path"].rsplit(".", 1)[1], entry["slider"], entry["value"]
        if entry["path"] in OF_PLATES:
            continue
        if as_given or chance.random() < 0.4 or (value is None and chance.random() < 0.7) or name == "D12":
            continue
        if name in MATERIALS and value is not None:
            low, high = (0.1, 0.45) if name == "poissons_ratio" else (value / 3, value * 3)
        if name == "strain_rate_coefficient":
            low, high = 0.001, 0.1  # metals have up to 0.06
        found[entry["path"]] = _between(low, high, entry["logarithmic"] and name != "poissons_ratio", chance)
        if name in OTHER_STRENGTH:  # both together may contradict each other
            found[entry["path"].replace(name, OTHER_STRENGTH[name])] = "null"
    names = [base["law"]] if as_given else ["auto", "auto", *(table["laws"][k]["name"] for k in base["laws"])]
    found["law"] = chance.choice(names)
    law = next((table["laws"][k] for k in base["laws"] if table["laws"][k]["name"] == found["law"]), {"live": []})
    for entry in law["live"]:
        if not as_given and chance.random() < 0.7:
            found[entry["path"]] = _between(*entry["slider"], entry["slider"][0] > 0.0, chance)
    for switch in SWITCHES:
        if switch == "wave_losses":
            continue
        automatic = 98 if switch == "rate_hardening" else 3  # most scenes refuse it: their materials have no rate law
        found[switch] = chance.choice([*["auto"] * automatic, "true", "false"])
    sides = {} if as_given or not base["plate"] else _sides(base, random.Random(urlencode(found)))
    found |= sides
    vibrates = sides or (base["support"] is not None and base["support"]["modes"])
    found["accuracy"] = chance.choice(["0.0001", "0.001", *([] if vibrates else ["0.000001", "1e-8"])])
    if chance.random() < 0.2:
        found |= {"linearisation": "chord", "accuracy": "0.001"}
    asked = ["true"] if base["kind"] == "half-space" else []  # other targets refuse it
    found["wave_losses"] = random.Random(urlencode(found)).choice(["auto", "auto", "auto", "false", *asked])
    return urlencode(found)


def _sides(base, chance):
    """Now and then size, place and damping of a plate; of one that is given with sides, in most scenes."""
    entries = {entry["path"]: entry for entry in base["inputs"]}
    if chance.random() > (0.03 if entries[PLATE[0]]["value"] is None else 0.7):
        return {}
    middle = chance.random() < 0.3
    found = {path: _between(*entries[path]["slider"], True, chance) for path in PLATE[:2]}
    for size, place in () if middle else zip(PLATE[:2], PLATE[2:], strict=True):
        found[place] = repr(float(found[size]) * chance.uniform(0.02, 0.98))
    if chance.random() < 0.3:
        found["target.damping_ratio"] = repr(chance.uniform(0.0, 0.2))
    for switch in EDGES:
        found[switch] = chance.choice(["auto", "auto", "auto", "true", "false"])
    return found


def _between(low, high, logarithmic, chance):
    share = chance.random()
    return repr(low * math.exp(share * math.log(high / low)) if logarithmic else low + share * (high - low))
