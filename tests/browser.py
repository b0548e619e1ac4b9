"""Chromium for the tests of the explorer's page, and random scenes in the form of the page's addresses."""

import math
import random
import shutil
from contextlib import contextmanager
from urllib.parse import urlencode

from film_model.explorer.content import Content
from film_model.explorer.page import examples

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
)
SUMMARIES = """fragments => fragments.map(fragment => {
    const found = filmModel.impact(fragment);
    for (const [name, value] of Object.entries(found.summary ?? {}))
        if (Number.isNaN(value)) found.summary[name] = null;
    let text = null;
    try { text = filmModel.sceneFile(fragment); } catch { }
    return [found, text];
})"""
"""JavaScript: the results of addresses, and their scene files."""

MATERIALS = ("youngs_modulus", "density", "yield_strength", "poissons_ratio")


@contextmanager
def chromium():
    """A browser that talks to nobody."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        yield browser
        browser.close()


def random_addresses(count, seed):
    """Addresses of scenes whose entries lie anywhere on their sliders, materials within a factor of three."""
    table, chance = Content(examples()).table(), random.Random(seed)
    return [_address(table, chance) for _ in range(count)]


def _address(table, chance):
    base = chance.choice(table["scenes"])
    found = {"scene": base["name"]}
    for entry in base["inputs"]:
        name, (low, high), value = entry["path"].rsplit(".", 1)[1], entry["slider"], entry["value"]
        if chance.random() < 0.4 or (value is None and chance.random() < 0.7) or name == "D12":
            continue
        if name in MATERIALS and value is not None:
            low, high = (0.1, 0.45) if name == "poissons_ratio" else (value / 3, value * 3)
        share = chance.random()
        if entry["logarithmic"] and name != "poissons_ratio":
            found[entry["path"]] = repr(low * math.exp(share * math.log(high / low)))
        else:
            found[entry["path"]] = repr(low + share * (high - low))
    found["law"] = chance.choice(["auto", "auto", *(table["laws"][k]["name"] for k in base["laws"])])
    law = next((table["laws"][k] for k in base["laws"] if table["laws"][k]["name"] == found["law"]), {"live": []})
    for entry in law["live"]:
        if chance.random() < 0.7:
            low, high = entry["slider"]
            found[entry["path"]] = repr(low * math.exp(chance.random() * math.log(high / low)))
    for switch in ("plasticity", "target_motion", "gravity"):
        found[switch] = chance.choice(["auto", "auto", "auto", "true", "false"])
    found["accuracy"] = chance.choice(["0.0001", "0.001", "0.000001", "1e-8"])
    if chance.random() < 0.2:
        found |= {"linearisation": "chord", "accuracy": "0.001"}
    return urlencode(found)
