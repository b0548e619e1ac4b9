"""FMUs in a browser: the binary for wasm32-wasi under examples/fmu_in_browser.js, in Chromium."""

import base64
import importlib.util
from pathlib import Path

import pytest
from browser import CHROMIUM, chromium
from cases import scene
from fmu_resources import SENSORS, on_structure

from fmu_wrapper import platforms
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import VARIABLES

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium"),
    pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="needs ziglang"),
]
SCRIPT = Path(__file__).parents[1] / "examples" / "fmu_in_browser.js"
RUN = """async ([code, fmu, start, step, count, names]) => {
    const { load } = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
    const bytes = Uint8Array.from(atob(fmu), letter => letter.charCodeAt(0));
    const [one, other] = [await load(bytes), await load(bytes)];
    one.start(start);
    other.start({});
    const rows = [];
    for (let k = 0; k < count; k++) {
        one.step(k * step, step);
        rows.push(names.map(name => one.get(name)));
    }
    let refused = null;
    try { one.step(0, step); } catch (error) { refused = error.message; }
    one.free();
    other.step(0, step);
    return [rows, refused];
}"""
"""JavaScript: values after each step, and what a step at a wrong time gives."""

STEPS = 50
TOLERANCE = 1e-12
"""Allowed difference, over the largest value; on vibrations rounding grows from contact to contact."""


def in_browser(path, start, step, names):
    with chromium() as browser:
        page = browser.new_page()
        content = base64.b64encode(path.read_bytes()).decode()
        return page.evaluate(RUN, [SCRIPT.read_text("utf-8"), content, start, step, STEPS, list(names)])


@pytest.mark.parametrize("case", ["elastoplastic", "vibrations"])
def test_chromium_gives_the_numbers_of_fmpy(made, case):
    vibrates = case == "vibrations"
    on = (
        on_structure("hertz", static_compliance="3e-6 m/N", sensors=SENSORS)
        if vibrates
        else scene("big-alabo", "plate")
    )
    path = made(on, 3, platform=(platforms.this_platform(), "wasm32-wasi"))
    start = {"initial_gap": 1e-6, "mass": 0.05}
    with opened(path) as fmu, started(fmu, False, start) as slave:
        step = 1.2 * float(fmu.description.defaultExperiment.stopTime) / STEPS
        names = [v.name for v in fmu.description.modelVariables if v.causality == "output"]
        whole = [v.name for v in VARIABLES if v.type != "Real"]
        expected = []
        for k in range(STEPS):
            slave.step(k * step, step)
            expected.append([float(value) for value in slave.get(names).values()])
    rows, refused = in_browser(path, start, step, names)
    assert refused == "step: status 3"
    for name, ours, theirs in zip(names, zip(*expected, strict=True), zip(*rows, strict=True), strict=True):
        size = 0.0 if name in whole else max(map(abs, ours))
        assert theirs == pytest.approx(ours, rel=0.0, abs=TOLERANCE * size), name
    assert max(row[names.index("contact_count")] for row in rows) >= 1
