"""The page of the explorer in Chromium: its numbers are Python's, every control works, and anyone can use it."""

import importlib.util
import math
import re
from collections import Counter
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
import pytest
import xarray as xr
from browser import CHROMIUM, SUMMARIES, chromium, page_of_everything, random_addresses
from cases import creeps
from law_cases import scene_text

import film_model as fm
from film_model.base.errors import SceneError
from film_model.core import native
from film_model.core.refining import step_tolerance
from film_model.effects import rate_hardening
from film_model.effects.effect import SIMULATED
from film_model.explorer.inputs import ALONG as PATHS
from film_model.explorer.page import WASM, page, write_page
from film_model.oblique import springs
from film_model.problem.summary import rounding
from film_model.scene.friction_table import FrictionTable
from film_model.studies.regimes import regimes

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed (apt-get install chromium)"),
    pytest.mark.skipif(
        importlib.util.find_spec("playwright") is None, reason="needs playwright: pip install -e '.[dev]'"
    ),
    pytest.mark.skipif(not WASM.exists(), reason="the core was built without zig"),
]

EXAMPLES = sorted((Path(__file__).parent.parent / "examples" / "scenes").glob("*.toml"))
SAME = 1e-12
"""Largest relative difference between the page and Python: the rounding of two libraries of elementary functions."""

SAME_STRENGTH = 1e-4
"""The same of the strength at the strain rate, which depends on impacts on a coarse mesh: of lines on the page, in
Python by shorter ways. Errors of both are about 1e-5 on thin plates, 1e-9 on fixed targets."""

SETTLED = rate_hardening.settled

ON_MODES = 1e-9
"""The same on the modes of a target, where each contact amplifies the rounding of those before."""

ON_RITZ = 1e-9
"""The same on the static stiffness of a plate by Ritz's method, whose matrices amplify rounding."""

ALONG = 1e-9
"""The largest difference of the motion along the surface, over the sliding velocity before."""

SEEDS = 2
"""Parts of the comparison with Python, so that several processes share it."""

FEW_UNSURE = 0.004
"""At most so many of the random scenes may have errors of 1 and more, which bound little: under a damped law, whose
omitted modes are one stiff mode more, the ball rattles on the few modes of a structure, up to hundreds of times."""


@pytest.fixture(scope="module")
def browser():
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "explorer.html"
    path.write_text(page(), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def shown(browser):
    """Opens a page; at the end, nothing may have been written to the console."""
    said, contexts = [], []

    def opened(address, **options):
        context = browser.new_context(**({"viewport": {"width": 1280, "height": 900}} | options))
        contexts.append(context)
        made = context.new_page()
        made.on("console", lambda message: said.append(message.text))
        made.on("pageerror", lambda error: said.append(str(error)))
        made.goto(address)
        made.wait_for_selector("html[data-ready]")
        return made

    yield opened
    for context in contexts:
        context.close()
    assert said == []


def off(history, found):
    """The largest relative difference of two summaries; 1 where only one of them has a value."""
    summary, scene = history.summary, history.scene
    depth = summary["maximum_indentation"] or 0.0
    least = dict.fromkeys(("energy_absorbed", "energy_radiated"), scene.kinetic_energy)
    least |= {"rebound_velocity": 1e-3 * scene.approach_velocity, "coefficient_of_restitution": 1e-3}
    least |= {"permanent_indentation": depth}  # a difference of two depths
    worst = 0.0
    creeping = creeps(*(result["coefficient_of_restitution"] for result in (summary, found["summary"])))
    for name, value in summary.items():
        other = found["summary"][name]
        if value is None or other is None:
            worst = worst if value is other or creeping else max(worst, 1.0)
        elif value != other:
            worst = max(worst, abs(value - other) / max(abs(value), abs(other), least.get(name, 0.0)))
    return worst


def amplified(history):
    """How much rounding may change the summary: most where contact ends slowly."""
    accuracy, line = history.accuracy, history.scene.solver.linearisation
    kind = native.CHORD if line == "chord" else native.WORK_PRESERVING
    _, summary = history.problem.march(native.mesh(kind, accuracy.segments, accuracy.unloading_segments))
    return rounding(history.problem, summary)


def shaken(history):
    """How much the last digit of the velocity changes the summary."""
    ball = history.scene.impactor
    path, value = ("velocity", ball.velocity) if ball.velocity is not None else ("drop_height", ball.drop_height)
    unit = "m/s" if path == "velocity" else "m"
    others = [f"{math.nextafter(value, to)!r} {unit}" for to in (0.0, math.inf)]
    changed = [fm.simulate(history.scene.replace({f"impactor.{path}": text})).summary for text in others]
    return max(off(history, {"summary": summary}) for summary in changed)


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    """Address and data of a page with every kind of target and every law."""
    text, table = page_of_everything()
    path = tmp_path_factory.mktemp("page") / "everything.html"
    path.write_text(text, encoding="utf-8")
    return path.as_uri(), table


@pytest.mark.parametrize("seed", range(SEEDS))
def test_random_scenes_equal_python(shown, everything, seed):
    address, table = everything
    addresses = random_addresses(table, 2_500, seed)
    results = shown(address).evaluate(SUMMARIES, addresses)
    compared, unsure = Counter(), []
    for fragment, (found, text) in zip(addresses, results, strict=True):
        assert found["ignored"] == [], fragment
        try:
            history, factor = simulated(fm.Scene.from_text(text), found) if text else (None, None)
        except (SceneError, fm.SimulationError):
            history = None
        warned = found.get("edges") and found["edges"]["matter"]  # the page says that it has no edges
        if history is None:
            missed = "summary" in found and (
                found["error"] >= 1.0 or any("is not reached" in text for text in found["warnings"])
            )
            assert warned or "summary" not in found or missed, fragment
        elif "summary" not in found:
            unreached = history.accuracy.modes and history.accuracy.estimated > history.accuracy.requested
            here = "on this page" in found["reason"] or "is available here" in found["reason"]
            assert here or unreached, (fragment, found)  # rounding may decide where contacts are too many
        elif not (warned and (history.accuracy.modes or history.problem.given.compliance)):
            compared[found["law"]] += 1
            if check(history, factor, found, fragment):
                unsure.append(fragment)
    assert len(unsure) <= FEW_UNSURE * len(addresses), unsure
    assert compared.total() > 0.85 * len(addresses)
    assert compared.keys() == {law["name"] for law in table["laws"]}


def check(history, factor, found, fragment):
    """The same law, the same effects and the same summary.

    To 1e-12, or to the estimated rounding error where contact ends slowly, or to what the last digit of the velocity
    changes, where the march decides by it. Contacts on a target that vibrates follow
    each other and amplify rounding. Where contact does not end, the accuracy is not reached, or other digits of it end
    the page's search earlier, the two errors bound the difference. Returns whether these
    are 1 and more: the page says then that the accuracy is not reached.
    """
    assert found["law"] == history.problem.law.name, fragment
    assert found["strength_factor"] is None or found["strength_factor"] == pytest.approx(factor, rel=SAME_STRENGTH)
    worst = off(history, found)
    if found["modes"]:
        reached = not any("is not reached" in text for text in found["warnings"])
        same = reached and found["modes"] == history.accuracy.modes
        # a run of Python's that misses the accuracy ended by another bound, with steps of another tolerance
        same = same and history.accuracy.estimated <= history.accuracy.requested
        allowed = ON_MODES if same else found["error"] + history.accuracy.estimated
    else:
        same = found["segments"] == history.accuracy.lines and history.outcome is fm.Outcome.SEPARATED
        allowed = SAME + 4.0 * history.problem.curve.fit_error  # the page fits a law with a shape itself: two fits
        if history.problem.given.compliance and getattr(history.scene.target, "edges", None) != "simply supported":
            allowed += ON_RITZ
        if worst > allowed:
            allowed = amplified(history) if same else found["error"] + history.accuracy.estimated
        if worst > allowed:
            allowed = SAME + 2.0 * shaken(history)  # the page and Python may lie on either side
    assert worst <= allowed, fragment
    unsure = allowed >= 1.0
    assert not unsure or any("is not reached" in text for text in found["warnings"]), fragment
    decided = {effect.name: effect.simulated for effect in history.effects}
    for name, effect in found["effects"].items():
        assert effect["simulated"] == decided[name], (fragment, name)
    if worst <= ON_MODES:
        same_intervals(history, found["intervals"], fragment)
        if history.oblique is not None or found["oblique"] is not None:
            along = ALONG + 1e3 * worst
            if not same:  # springs of friction beside two motions, each with an error of its own
                along = max(allowed, along) + (history.oblique.estimated if history.oblique else 0.0)
            assert oblique_off(history, found) <= along, fragment
    return unsure


def oblique_off(history, found):
    """The largest difference of the motion along the surface, over the speeds before; of other values, relative."""
    ours, summary = history.oblique, found["oblique"]["summary"]
    assert found["oblique"]["sliding_regime"] == ours.sliding_regime
    assert [event["name"] for event in found["oblique"]["events"]] == [name for _, name in ours.events]
    times = [event["time"] for event in found["oblique"]["events"]]
    assert times == pytest.approx([time for time, _ in ours.events], rel=1e-6, abs=1e-6 * history.duration)
    ball, before = history.scene.impactor, ours.motion["sliding_velocity"][0]
    least = {"rebound_spin": abs(before) / ball.radius, "friction_work": ours.summary["tangential_impulse"] * before}
    least |= {name: abs(before) for name in ("tangential_rebound_velocity", "contact_point_rebound_velocity")}
    least |= {"tangential_restitution": abs(before) / (ball.tangential_speed or 1.0), "rebound_angle": 1.0}
    worst = abs(found["oblique"]["estimated_error"] - ours.estimated)
    assert [name for name in ours.summary if name not in summary] == []
    for name, value in ours.summary.items():
        if value != summary[name] and not (math.isnan(value) and summary[name] is None):
            worst = max(worst, abs(value - summary[name]) / max(abs(value), least.get(name, 0.0)))
    return worst


def rounded(evidence):
    """Without the last digits of a number of yield velocities that is far beyond all measurements."""
    return re.sub(r"[\d.e+]{7,} yield", "many yield", evidence)


def same_intervals(history, shown, fragment):
    """The intervals of measured values, and what they come from."""
    expected = history.intervals
    said = {each["name"]: rounded(each["evidence"]) for each in shown}
    assert said == {name: rounded(words) for name, words in history.evidence.items()}, fragment
    ends = {each["name"]: [each["low"], each["high"]] for each in shown if "low" in each}
    assert ends.keys() == expected.keys(), fragment
    for name, interval in expected.items():
        assert ends[name] == pytest.approx([interval.low, interval.high], rel=1e-8), fragment


def simulated(scene, found):
    """Python's history with the page's strength at the strain rate, and the strength that Python finds itself."""
    factors = []

    def settled(*given):
        factors.append(SETTLED(*given))
        return found.get("strength_factor") or factors[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rate_hardening, "settled", settled)
        return fm.simulate(scene), factors[0] if factors else None


BALL = {"radius": "5 mm", "velocity": "1 m/s", "material": "bearing steel"}
STEEL = {"material": "bearing steel"}
HELD = {
    "plate": {"kind": "plate", "thickness": "1.5 mm", "size": ["100 mm", "100 mm"], "material": "mild steel"},
    "beam": {"kind": "beam", "length": "200 mm", "width": "20 mm", "thickness": "5 mm", "material": "mild steel"},
    "rod": {"kind": "rod", "length": "40 mm", "diameter": "10 mm", "material": "mild steel"},
    "sheet": {"kind": "plate", "thickness": "0.3 mm", "size": ["80 mm", "60 mm"], "material": "mild steel"}
    | {"in_plane": "fixed"},
    "strip": {"kind": "beam", "length": "200 mm", "width": "5 mm", "thickness": "1 mm", "material": "mild steel"}
    | {"ends": "clamped", "in_plane": "fixed"},
    "wide": {"kind": "beam", "length": "1.2 m", "width": "60 mm", "thickness": "4 mm", "material": "mild steel"}
    | {"ends": "clamped"},
    "static": {"kind": "plate", "thickness": "2 mm", "material": "mild steel", "static_stiffness": "1e6 N/m"},
}
CHANGES = (
    "",
    "&impactor.velocity=3",
    "&impactor.mass=0.02&impactor.velocity=0.3&target.damping_ratio=0.1",
    "&law=tsuji&contact.restitution=0.8",
    "&law=hertz&accuracy=0.001",
    "&gravity=true&impactor.radius=0.01",
    "&target_motion=false",
    "&impactor.angle=0.6&impactor.spin=-100&contact.friction=0.1",
)
SCALED = (
    "&target.thickness=0.002&target.material.youngs_modulus=7e10&target.material.density=2700",
    "&target.thickness=0.0012&accuracy=0.001",
)
"""Changes of a plate with which its vibrations scale."""


@pytest.mark.parametrize("kind", HELD)
def test_targets_that_vibrate_equal_python(shown, tmp_path, kind):
    damped = {} if kind == "static" else {"damping_ratio": 0.02}
    scene = fm.Scene.from_table({"impactor": BALL, "target": HELD[kind] | damped})
    stretches = {"effects.stretching": True} if "in_plane" in HELD[kind] else {}
    write_page(tmp_path / "impact.html", scene.replace(stretches))
    fragments = ["scene=scene" + change for change in (*CHANGES, *(SCALED if kind in ("plate", "sheet") else ()))]
    window = shown((tmp_path / "impact.html").as_uri())
    compared = errors = 0
    for fragment, (found, text) in zip(fragments, window.evaluate(SUMMARIES, fragments), strict=True):
        if "summary" not in found:
            assert "cannot be in series" in found["reason"], (fragment, found)
            continue
        compared += 1
        history, factor = simulated(fm.Scene.from_text(text), found)
        check(history, factor, found, fragment)
        if stretches and found["modes"] and found["segments"] == len(history.vibration.segments):  # the same run
            errors += 1
            assert found["error"] == pytest.approx(history.accuracy.estimated, abs=step_tolerance(1e-3)), fragment
        assert (found["modes"] > 0) is (kind != "static" and "target_motion=false" not in fragment)
    assert compared >= 6 and errors >= (3 if stretches else 0)
    window.click("#part-laws > summary")
    window.wait_for_selector("#chart-laws path")
    window.click("#part-restitution > summary")
    window.wait_for_selector("#chart-restitution path")
    assert window.is_hidden("#part-accuracy") is (kind != "static")


def plates(count):
    """Addresses of plates between edges: isotropic and orthotropic, anywhere struck, slow and fast, heavy and light."""
    chance = np.random.default_rng(11)
    for _ in range(count):
        name = chance.choice(["ball-on-plate", "ball-on-composite-plate", "drop-test-on-glass"])
        sides = 10.0 ** chance.uniform(-1.5, -0.3, 2)
        found = {f"target.size.{k}": side for k, side in enumerate(sides)}
        if chance.random() < 0.7:
            found |= {f"target.position.{k}": side * chance.uniform(0.05, 0.95) for k, side in enumerate(sides)}
        if name != "ball-on-composite-plate":
            found["target.thickness"] = 10.0 ** chance.uniform(-3.0, -2.0)
        if chance.random() < 0.3:
            found["impactor.mass"] = 10.0 ** chance.uniform(-3.0, 0.5)
        if chance.random() < 0.3:
            found["target.damping_ratio"] = chance.uniform(0.0, 0.2)
        for switch in ("boundary_reflections", "target_inertia", "target_motion", "gravity"):
            found[switch] = chance.choice(["auto", "auto", "auto", "true", "false"])
        law = chance.choice(["auto", "auto", "hertz", "tsuji"])
        yield urlencode({"scene": name, "law": law, "accuracy": chance.choice(["0.001", "0.0001"])} | found)


def test_plates_between_edges_equal_python(shown, address):
    """Infinite, by static stiffness or by vibrations: whatever Python decides."""
    addresses, compared = list(plates(120)), Counter()
    for fragment, (found, text) in zip(addresses, shown(address).evaluate(SUMMARIES, addresses), strict=True):
        assert found["ignored"] == [], fragment
        if "summary" not in found:
            with pytest.raises(fm.SimulationError):
                fm.simulate(fm.Scene.from_text(text))
            continue
        history, factor = simulated(fm.Scene.from_text(text), found)
        check(history, factor, found, fragment)
        same = found["modes"] == history.accuracy.modes and not any("not reached" in text for text in found["warnings"])
        decided = {effect.name: effect.simulated for effect in history.effects}
        compared[decided["boundary_reflections"], decided.get("target_inertia", False), same] += 1
    assert min(compared[True, True, True], compared[False, False, True], compared[True, False, True]) >= 5, compared


WORDS = "simply supported", "clamped", "free"
SQUARE = "target.size.0=0.1&target.size.1=0.1"


def test_plates_with_any_edges_equal_python(shown, address):
    """All that the page computes; it names film-model run where Python takes more functions, or does not reach the
    accuracy either."""
    chance, compared = np.random.default_rng(5), Counter()
    edges = [chance.choice(WORDS, 4 if chance.random() < 0.7 else 1).tolist() for _ in range(90)]
    addresses = [
        f"{plate}&{urlencode({'target.edges': ','.join(own)})}" for plate, own in zip(plates(90), edges, strict=True)
    ]
    for fragment, (found, text) in zip(addresses, shown(address).evaluate(SUMMARIES, addresses), strict=True):
        assert found["ignored"] == [], fragment
        if "summary" not in found:
            compared["refused" if "needs more functions" in found["reason"] else "failed"] += 1
            continue
        history, factor = simulated(fm.Scene.from_text(text), found)
        check(history, factor, found, fragment)
        if found["modes"] and found["modes"] == history.accuracy.modes:
            compared["vibrates"] += 1
            assert found["error"] == pytest.approx(history.accuracy.estimated, rel=1e-5), fragment
    assert compared["vibrates"] >= 8 and compared["refused"] <= 30 and compared["failed"] <= 5, compared


@pytest.mark.parametrize(
    ("entries", "reason", "python"),
    [
        ("target.size.0=0.1", "target.size needs both values", "2 values"),
        ("target.position.0=0.1&target.position.1=0.1", "target.position needs a size", "needs a size"),
        ("target.damping_ratio=0.1", "target.damping_ratio needs a size", "needs a size"),
        ("target.edges=clamped", "target.edges needs a size", "needs a size"),
        ("boundary_reflections=true", "the plate has no size", "the plate has no size"),
        ("target.size.0=0.1&target.size.1=0.1&target.position.0=0.2&target.position.1=0.05", "between", "< 0.1 m"),
        (f"{SQUARE}&target.edges=free&boundary_reflections=true&target_inertia=false", *["nothing holds"] * 2),
        (f"{SQUARE}&target.edges=clamped&boundary_reflections=true&accuracy=1e-7", "use film-model run", None),
    ],
)
def test_a_plate_that_the_page_does_not_compute(shown, address, entries, reason, python):
    window = shown(f"{address}#scene=ball-on-plate&{entries}")
    assert reason in window.inner_text("#failure")
    assert window.evaluate("location.hash") == f"#scene=ball-on-plate&{entries}"
    text = window.evaluate("filmModel.sceneFile(location.hash.slice(1))")
    if python is None:
        assert fm.Scene.from_text(text).target.edges == "clamped"
    else:
        with pytest.raises((SceneError, fm.SimulationError), match=python):
            fm.simulate(fm.Scene.from_text(text))


def test_a_plate_gets_edges_by_its_fields(shown, address):
    window = shown(f"{address}#scene=ball-on-plate")
    for field, text in (("size-0", "120 mm"), ("size-1", "80 mm"), ("position-0", "4 cm"), ("position-1", "20 mm")):
        window.fill(f"#entry-target-{field}", text)
        window.keyboard.press("Tab")
    window.wait_for_timeout(350)
    assert "natural vibrations" in window.inner_text("#error")
    again = shown(window.evaluate("location.href"))
    assert again.inner_text("#summary") == window.inner_text("#summary")
    plate = fm.Scene.from_text(again.evaluate("filmModel.sceneFile(location.hash.slice(1))")).target
    assert plate.size == (0.12, 0.08) and plate.position == (0.04, 0.02) and plate.edges == "simply supported"
    window.select_option("#edge-0", "clamped")
    window.select_option("#edge-3", "free")
    window.wait_for_url(re.compile("2Cfree"))
    again = shown(window.evaluate("location.href"))
    plate = fm.Scene.from_text(again.evaluate("filmModel.sceneFile(location.hash.slice(1))")).target
    assert plate.edges == ("clamped", "simply supported", "simply supported", "free")
    assert again.input_value("#edge-3") == "free" and again.inner_text("#summary") == window.inner_text("#summary")
    for edge in ("#edge-0", "#edge-3"):
        window.select_option(edge, "simply supported")
    for field in ("size-0", "size-1", "position-0", "position-1"):
        window.fill(f"#entry-target-{field}", "")
        window.keyboard.press("Tab")
    window.wait_for_selector("#error:has-text('segments')")
    assert window.is_visible("#results")


def test_oblique_impacts_equal_python(shown, everything):
    """The exact solution, springs under laws that yield or are damped, moving and vibrating targets, and refusals."""
    address, table = everything
    chance, fragments = np.random.default_rng(7), []
    vibrates = {"target_inertia": SIMULATED}
    states = [{effect["name"]: effect["state"] for effect in scene["judged"]} for scene in table["scenes"]]
    scenes = [
        scene
        for scene, known in zip(table["scenes"], states, strict=True)
        if scene["along"] and not vibrates.items() <= known.items()
    ]
    for scene in (scenes[k] for k in chance.integers(len(scenes), size=400)):
        entries = {entry["path"]: entry for entry in scene["inputs"]}
        along = [f"{path}={chance.uniform(*entries[path]['slider'])}" for path in PATHS]
        law = chance.choice(["auto", "hertz", "hertz", "tsuji", "elastoplastic"])
        fragments.append("&".join([f"scene={scene['name']}", f"law={law}", *along]))
    compared = Counter()
    for fragment, (found, text) in zip(fragments, shown(address).evaluate(SUMMARIES, fragments), strict=True):
        assert found["ignored"] == [], fragment
        if "summary" not in found:
            if text is not None:
                with pytest.raises((SceneError, fm.SimulationError)):
                    fm.simulate(fm.Scene.from_text(text))
            continue
        history, factor = simulated(fm.Scene.from_text(text), found)
        check(history, factor, found, fragment)
        exact = len(history.oblique.motion["time"]) != springs.STEPS + 1
        assert oblique_off(history, found) <= ALONG, fragment
        compared[exact] += 1
    assert min(compared[True], compared[False]) > 100


def rubbing(friction, **target):
    """A ball that comes in at an angle."""
    contact = {"law": "hertz", "friction": friction}
    ball = BALL | {"velocity": "3 m/s", "angle": "40 deg"}
    return fm.Scene.from_table({"impactor": ball, "target": target | STEEL, "contact": contact})


TABLE = [["0 m/s", 0.5], ["1 m/s", 0.2], ["3 m/s", 0.1]]
IN_WORDS = "0.5 at 0 m/s, 0.2 at 1 m/s, 0.1 at 3 m/s"


@pytest.mark.parametrize("target", ["half-space", "beam"])
@pytest.mark.parametrize("given", [TABLE, 0.3])
def test_a_table_of_friction_equals_python(shown, tmp_path, target, given):
    """Of the scene and, in place of a coefficient, of the address; a coefficient in place of the table."""
    path, chance = tmp_path / "page.html", np.random.default_rng(3)
    write_page(path, rubbing(given, **HELD.get(target, {"kind": target})))
    words = {} if given is TABLE else {"contact.friction": IN_WORDS}
    changes = [{"law": law, **words} for law in ("hertz", "elastoplastic", "tsuji")]
    for slides in (0.2, 0.7, 1.2) if target == "beam" else chance.uniform(0.0, 1.5, 12):
        changes.append({"impactor.angle": slides, "impactor.spin": chance.uniform(-1e3, 1e3), **words})
    changes += [{"contact.friction": "2e-1 at 1e-1 mm/s,.4 at 2", "impactor.velocity": 0.5}]
    fragments = [urlencode({"scene": "scene", **each}) for each in changes]
    window, regimes = shown(path.as_uri()), set()
    for fragment, (found, text) in zip(fragments, window.evaluate(SUMMARIES, fragments), strict=True):
        assert found["ignored"] == [], fragment
        history, factor = simulated(fm.Scene.from_text(text), found)
        assert isinstance(history.scene.contact.friction, FrictionTable)
        check(history, factor, found, fragment)
        assert found["modes"] or oblique_off(history, found) <= ALONG, fragment
        regimes.add(found["oblique"]["sliding_regime"])
    assert history.scene.contact.friction.rows == ((1e-4, 0.2), (2.0, 0.4))
    assert len(regimes) > 1
    found, text = window.evaluate(SUMMARIES, ["scene=scene&contact.friction=0.25"])[0]
    assert oblique_off(fm.simulate(fm.Scene.from_text(text)), found) <= ALONG


def test_a_table_of_friction_is_shown_typed_and_shared(shown, tmp_path):
    path, field = tmp_path / "page.html", "#entry-contact-friction"
    write_page(path, rubbing(TABLE, kind="half-space"))
    window = shown(path.as_uri())
    assert window.input_value(field) == IN_WORDS
    window.wait_for_url(re.compile("#scene=scene$"))
    given = window.inner_text("#oblique")
    for text in ("0.5 at 0 m/s", "0.5 at 0 m/s, 0.2", "0.5 at 1 m/s, 0.2 at 1 m/s", "101 at 0 m/s, 0.2 at 1 m/s"):
        window.fill(field, text)
        window.keyboard.press("Tab")
        assert window.get_attribute(field, "aria-invalid") == "true", text
        said = "write a number, or pairs of a number and a rising speed, as in 0.5 at 0 m/s, 0.2 at 1 m/s"
        assert window.inner_text(f"{field}-error") == said, text
    window.fill(field, "0.6 at 0, 0.1 at 200 mm/s")
    window.keyboard.press("Tab")
    window.wait_for_url(re.compile("friction=0.6"))
    again = shown(window.evaluate("location.href"))
    assert again.input_value(field) == window.input_value(field) == "0.6 at 0 m/s, 0.1 at 0.2 m/s"
    assert again.inner_text("#oblique") == window.inner_text("#oblique") != given
    scene = fm.Scene.from_text(again.evaluate("filmModel.sceneFile(location.hash.slice(1))"))
    assert scene.contact.friction.rows == ((0.0, 0.6), (0.2, 0.1))
    window.fill(field, "0.2")
    window.keyboard.press("Tab")
    window.wait_for_url(re.compile("friction=0.2$"))


def test_losses_of_materials_equal_python(shown, tmp_path):
    ball = {"radius": "5 mm", "velocity": "0.2 m/s", "material": "PMMA"}
    write_page(
        tmp_path / "impact.html", fm.Scene.from_table({"impactor": ball, "target": {"kind": "half-space"} | STEEL})
    )
    changes = ("", "impactor.velocity=1", "impactor.velocity=5", "impactor.material.loss_factor=0.2")
    changes += (
        "material_damping=false",
        "impactor.velocity=5&material_damping=true",
        "gravity=true",
        "plasticity=false",
    )
    fragments = ["scene=scene&" + change for change in changes]
    window, laws = shown((tmp_path / "impact.html").as_uri()), []
    for fragment, (found, text) in zip(fragments, window.evaluate(SUMMARIES, fragments), strict=True):
        check(*simulated(fm.Scene.from_text(text), found), found, fragment)
        laws.append(found["law"])
    usual = [name.replace("damped-large-slope", "tsuji").replace("large-slope", "hertz") for name in laws]
    assert usual == ["tsuji", "tsuji", "elastoplastic", "tsuji", "hertz", "tsuji", "tsuji", "tsuji"]


def test_a_ball_deeper_than_the_end_of_the_law_fails_as_in_python(shown, tmp_path):
    ball = {"radius": "10 mm", "velocity": "30 m/s", "material": "bearing steel"}
    scene = fm.Scene.from_table({"impactor": ball, "target": {"kind": "half-space", "material": "lead"}})
    write_page(tmp_path / "impact.html", scene)
    fragments = [f"scene=scene&impactor.velocity={speed}" for speed in (30, 200, 600)]
    window = shown((tmp_path / "impact.html").as_uri())
    found = [each for each, _ in window.evaluate(SUMMARIES, fragments)]
    assert found[0]["law"] == "elastoplastic"
    assert all("passed the end of the law's last stage" in each["reason"] for each in found[1:])


def test_a_rule_of_unloading_holds_for_the_law_of_the_scene_only(shown, tmp_path):
    write_page(
        tmp_path / "impact.html", fm.Scene.from_text(scene_text("elastoplastic", contact='unloading = "retrace"'))
    )
    fragments = [f"scene=scene&impactor.velocity=2{law}" for law in ("", "&law=auto", "&law=hertz")]
    restitutions = []
    for fragment, (found, text) in zip(
        fragments, shown((tmp_path / "impact.html").as_uri()).evaluate(SUMMARIES, fragments), strict=True
    ):
        check(*simulated(fm.Scene.from_text(text), found), found, fragment)
        restitutions.append(found["summary"]["coefficient_of_restitution"])
    assert restitutions[1] < 0.9 and restitutions[::2] == pytest.approx([1.0, 1.0])


def test_intervals_of_glass_that_may_crack_equal_python(shown, tmp_path):
    ball = {"radius": "5 mm", "velocity": "1 m/s", "material": "bearing steel"}
    kinds = set[bool]()
    for target in ("soda-lime glass", "fused silica", "ice"):
        write_page(
            tmp_path / "impact.html",
            fm.Scene.from_table({"impactor": ball, "target": {"kind": "half-space", "material": target}}),
        )
        fragments = [f"scene=scene&impactor.velocity={speed}" for speed in (0.0001, 0.01, 0.3, 1, 20)]
        fragments.append(f"{fragments[-1]}&target.material=another")
        window = shown((tmp_path / "impact.html").as_uri())
        for found, text in window.evaluate(SUMMARIES, fragments):
            said = {interval["name"]: interval["evidence"] for interval in found["intervals"]}
            assert said == simulated(fm.Scene.from_text(text), found)[0].evidence
            kinds |= {"brittle" in evidence for evidence in said.values()}
    assert kinds == {True, False}


def test_restitution_above_one_by_the_weight_says_so(shown, tmp_path):
    ball = {"radius": "5 mm", "velocity": "1 um/s", "mass": "100 g", "material": "bearing steel"}
    contact = {"law": "stronge", "yield_strength": "250 MPa"}
    target = {"kind": "half-space", "material": "mild steel"}
    scene = fm.Scene.from_table({"impactor": ball, "target": target, "contact": contact})
    write_page(tmp_path / "impact.html", scene)
    ((found, _),) = shown((tmp_path / "impact.html").as_uri()).evaluate(SUMMARIES, ["scene=scene&"])
    (said,) = (text for text in fm.simulate(scene).warnings if text.startswith("restitution is "))
    assert said.startswith("restitution is 816:") and "8.01e+05 times" in said
    (on_page,) = (text for text in found["warnings"] if text.startswith("restitution is "))
    assert "restitution is 816.0:" in on_page and "8.01e+5 times the impact energy" in on_page


def test_waves_in_a_half_space_equal_python(shown, tmp_path):
    ball = {"radius": "5 mm", "velocity": "4 m/s", "material": "bearing steel"}
    write_page(
        tmp_path / "impact.html", fm.Scene.from_table({"impactor": ball, "target": {"kind": "half-space"} | STEEL})
    )
    changes = ("", "impactor.velocity=0.3", "plasticity=false", "wave_losses=false", "law=hertz", "law=big-alabo")
    changes += ("impactor.velocity=0.3&wave_losses=true", "law=hertz&wave_losses=true", "impactor.velocity=300")
    changes += ("gravity=true&target.material.density=2e4", "target.material.poissons_ratio=-0.3")
    fragments = ["scene=scene&" + change for change in changes]
    window, radiates = shown((tmp_path / "impact.html").as_uri()), []
    for fragment, (found, text) in zip(fragments, window.evaluate(SUMMARIES, fragments), strict=True):
        check(*simulated(fm.Scene.from_text(text), found), found, fragment)
        radiates.append(found["summary"]["energy_radiated"] > 0.0)
    assert radiates == [True, False, True, False, False, False, True, True, True, True, True]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_scene_is_exported(shown, tmp_path, path):
    scene = fm.Scene.from_toml(path)
    write_page(tmp_path / "impact.html", scene)
    window = shown((tmp_path / "impact.html").as_uri())
    force = fm.simulate(scene).summary["maximum_force"]
    text = window.inner_text("#summary tbody tr:first-child td")
    number, unit = text.split()
    assert float(number) * {"N": 1.0, "kN": 1e3}[unit] == pytest.approx(force, rel=1e-5)
    assert window.inner_text("#heading") == scene.title
    moved(window, "#entry-impactor-radius ~ input[type=range]", 700)
    assert window.is_visible("#results") and window.is_visible("#banner")


def moved(window, slider, place):
    """Move a slider and wait until the address has followed."""
    window.evaluate(
        "([slider, place]) => { const s = document.querySelector(slider); s.value = place;"
        " s.dispatchEvent(new Event('input', { bubbles: true })); }",
        [slider, place],
    )
    window.wait_for_timeout(350)


def test_typed_values_with_units(shown, address):
    window = shown(address)
    for field, text, value in (
        ("impactor-radius", "0.5 in", 0.0127),
        ("impactor-velocity", "10 mph", 4.4704),
        ("impactor-mass", "2 lb", 0.90718474),
        ("impactor-velocity", "3", 3 * 0.44704),
    ):
        window.fill(f"#entry-{field}", text)
        window.keyboard.press("Tab")
        window.wait_for_timeout(350)
        fragment = window.evaluate("location.hash")
        assert float(re.search(rf"{field.replace('-', '.')}=([^&]+)", fragment)[1]) == pytest.approx(value, rel=1e-15)
    before = window.inner_text("#summary")
    for text in ("ten", "10 kg", "-1 mm", "10,5 mm", "5 furlong", "1e9 m", ""):
        window.fill("#entry-impactor-radius", text)
        window.keyboard.press("Tab")
        assert window.get_attribute("#entry-impactor-radius", "aria-invalid") == "true"
        assert window.inner_text("#entry-impactor-radius-error")
    assert window.inner_text("#summary") == before


def test_entries_begin_at_what_they_are(shown, address):
    """A mass from the density follows the radius; another kind of target keeps what is made and said of the scene."""
    window = shown(f"{address}#scene=ball-on-plate")
    window.fill("#entry-impactor-radius", "20 mm")
    window.keyboard.press("Tab")
    place = int(window.input_value("#entry-impactor-mass ~ input[type=range]"))
    moved(window, "#entry-impactor-mass ~ input[type=range]", place + 1)
    mass = fm.Sphere("20 mm", "1 m/s", material="bearing steel").own_mass
    assert float(window.input_value("#entry-impactor-mass").split()[0]) == pytest.approx(1e3 * mass, rel=0.01)
    window.select_option("#material-target", "copper")
    window.fill("#title", "mine")
    window.keyboard.press("Tab")
    window.select_option("#kind", "half-space")
    kept = [window.input_value(entry) for entry in ("#material-target", "#title", "#law")]
    assert kept == ["copper", "mine", "auto"]
    window.fill("#entry-impactor-radius", "ten")
    window.keyboard.press("Tab")
    assert window.is_visible("#outdated")
    window.goto(f"{address}#scene=two-balls&impactor.velocity=0.05")
    window.wait_for_selector("#failure:not([hidden])")
    assert window.is_disabled("#csv") and window.is_disabled("#png")


def test_every_choice_changes_the_scene(shown, address):
    window = shown(address)
    for selector in ("#kind", "#law", "#material-impactor", "#accuracy", "#linearisation"):
        count = window.locator(f"{selector} option").count()
        for k in range(count):
            window.select_option(selector, index=k)
            assert window.is_visible("#results") or window.inner_text("#failure").startswith("Not simulated: ")
        window.goto(address)
        window.wait_for_selector("html[data-ready]")
    for name in ("plasticity", "target_motion", "gravity"):
        for value in ("true", "false", "auto"):
            window.select_option(f"#effect-{name}", value)
            assert window.is_visible("#results")
    window.wait_for_timeout(350)
    assert window.evaluate("location.hash") == "#scene=tungsten-carbide-ball"


def test_comparison_studies_and_files(shown, address):
    window = shown(address)
    window.click("#keep")
    moved(window, "#entry-impactor-velocity ~ input[type=range]", 800)
    assert window.locator("#summary thead th").count() == 3
    assert "compare=" in window.evaluate("location.hash")
    window.click("#forget")
    assert window.locator("#summary thead th").count() == 1
    for part in ("laws", "restitution", "accuracy", "map"):
        window.click(f"#part-{part} > summary")
        window.wait_for_selector(f"#chart-{part} path")
    assert window.locator("#laws tbody tr").count() == 15
    before = window.inner_text("#readout")
    moved(window, "#cursor", 100)
    assert window.inner_text("#readout") != before
    window.click("#theme")
    assert window.evaluate("document.documentElement.dataset.theme") == "dark"
    window.click("#part-map > summary")
    for button, start in (("csv", b"time (s),"), ("svg", b"<svg"), ("png", b"\x89PNG")):
        if button == "svg":
            window.select_option("#picture", "chart-map")
        with window.expect_download() as download:
            window.click(f"#{button}")
        assert Path(download.value.path()).read_bytes().startswith(start)
    for button, start in (("copy-scene", "title = "), ("copy-python", "import film_model"), ("copy-link", "file:///")):
        window.click(f"#{button}")
        assert window.input_value("#copied").startswith(start)


def test_the_parameters_of_a_law(shown, address):
    """They follow from the example until one is typed; the restitution of a contact on a fixed target is that typed."""
    window = shown(address)
    window.select_option("#law", "tsuji")
    assert window.evaluate("document.activeElement.id") in ("law", "")
    assert window.input_value("#entry-contact-restitution") == ""
    window.fill("#entry-contact-restitution", "0.35")
    window.keyboard.press("Tab")
    window.wait_for_timeout(350)
    again = shown(window.evaluate("location.href"))
    assert again.input_value("#entry-contact-restitution") == "0.35"
    scene = fm.Scene.from_text(again.evaluate("filmModel.sceneFile(location.hash.slice(1))"))
    assert scene.contact.parameters == {"restitution": 0.35}
    assert "coefficient of restitution\t0.35\n" in again.inner_text("#summary")


def test_the_netcdf_file_holds_the_motion_of_the_csv(shown, address, tmp_path):
    window, saved = shown(f"{address}#scene=ball-on-plate&impactor.angle=0.6&contact.friction=0.2"), {}
    for button in ("csv", "netcdf"):
        with window.expect_download() as download:
            window.click(f"#{button}")
        saved[button] = tmp_path / download.value.suggested_filename
        download.value.save_as(saved[button])
    rows = np.genfromtxt(saved["csv"], delimiter=",", names=True, usecols=range(13), deletechars="")
    with xr.open_dataset(saved["netcdf"], decode_times=False) as ds:
        assert ds.t.dims == ("t",) and ds.contact_force.attrs["units"] == "N"
        assert len(ds.data_vars) == len(rows.dtype.names) - 1
        for name, column in zip(("t", *ds.data_vars), rows.dtype.names, strict=True):
            assert ds[name].values.tolist() == rows[column].tolist(), name
        scene = fm.Scene.from_text(ds.attrs["scene_toml"])
    assert scene.target.kind == "plate"
    motion = fm.simulate(scene).oblique.motion
    for name, size in (("sliding_velocity_(m/s)", 1e-3), ("friction_force_(N)", 5e-3)):
        column = motion[name.partition("_(")[0]]
        exact = np.interp(rows["time_(s)"], motion["time"], column)
        assert rows[name] == pytest.approx(exact, abs=size * abs(column).max())
    assert fm.simulate(scene).summary["maximum_force"] > 0.999 * rows["contact_force_(N)"].max()


def test_the_dot_on_the_map_moves(shown, address):
    window = shown(f"{address}#scene=ball-on-plate")
    window.click("#part-map > summary")
    places = []
    for velocity in ("0.2 m/s", "20 m/s"):
        window.fill("#entry-impactor-velocity", velocity)
        window.keyboard.press("Tab")
        window.wait_for_timeout(350)
        found = regimes(fm.Scene.from_text(window.evaluate("filmModel.sceneFile(location.hash.slice(1))")))
        said = [float(text) for text in re.findall(r"= ([0-9.e+-]+[0-9])", window.inner_text("#place"))]
        assert said == pytest.approx([found.value, found.ratio], rel=5e-3)
        places.append([float(window.get_attribute("#chart-map circle", at)) for at in ("cx", "cy")])
    assert places[1][0] > places[0][0] and places[1][1] < places[0][1]  # both numbers grow; y points down


def test_an_address_is_read_as_it_was_written(shown, address):
    window = shown(address)
    window.select_option("#kind", "plate")
    window.select_option("#law", "stronge")
    window.select_option("#material-target", "copper")
    window.fill("#title", "a & b = <c>")
    moved(window, "#entry-target-thickness ~ input[type=range]", 650)
    text, summary = window.evaluate("location.href"), window.inner_text("#summary")
    again = shown(text)
    assert again.inner_text("#summary") == summary
    assert again.evaluate("location.href") == text
    assert again.input_value("#material-target") == "copper"
    strange = shown(f"{address}#scene=no&impactor.radius=-1&law=x&impactor.mass=&__proto__=1")
    assert "scene, impactor.radius, law" in strange.inner_text("#said")


@pytest.mark.parametrize("name", ["nickel 200", "Armco iron", "tool steel S-7, 50 HRC", "mild steel", "polycarbonate"])
def test_a_material_by_name_gives_what_run_gives(shown, tmp_path, name):
    """With hardness and hardening, also in the file and the address; a yield strength replaces a hardness."""
    scene = fm.Scene.from_table({"impactor": BALL, "target": {"kind": "half-space", "material": "aluminium"}})
    write_page(tmp_path / "impact.html", scene)
    window = shown((tmp_path / "impact.html").as_uri())
    window.select_option("#material-target", name)
    window.wait_for_timeout(350)
    fragment = window.evaluate("location.hash").removeprefix("#")
    ((found, text),) = window.evaluate(SUMMARIES, [fragment])
    expected, used = scene.replace({"target.material": name}), fm.Scene.from_text(text)
    history, _ = simulated(expected, found)
    assert found["law"] == "elastoplastic" and off(history, found) < ON_MODES
    for entry in ("hardness", "yield_strength", "strain_hardening_exponent"):
        assert getattr(used.target.material, entry) == getattr(expected.target.material, entry), entry
    window.click("summary:has-text('material values') >> nth=1")
    for path, value in (("strain_hardening_exponent", "0.15"), ("hardness", "1 GPa"), ("yield_strength", "300 MPa")):
        window.fill(f"#entry-target-material-{path}", value)
        window.keyboard.press("Tab")
    assert window.input_value("#entry-target-material-hardness") == ""
    window.wait_for_timeout(350)
    fragment = window.evaluate("location.hash").removeprefix("#")
    ((found, text),) = window.evaluate(SUMMARIES, [fragment])
    history, _ = simulated(fm.Scene.from_text(text), found)
    changed = history.scene.target.material
    assert (changed.hardness, changed.yield_strength, changed.strain_hardening_exponent) == (None, 300e6, 0.15)
    assert off(history, found) < ON_MODES


def test_a_hardness_that_contradicts_a_yield_strength_is_refused(shown, address):
    fragment = "scene=ball-on-half-space-of-no-name&target.material.hardness=1e10&target.material.yield_strength=2e8"
    ((found, text),) = shown(address).evaluate(SUMMARIES, [fragment])
    assert "hardness and yield strength of the target contradict each other" in found["reason"]
    assert text is None, "no file, which film-model would refuse"


def test_the_python_script_of_the_page_runs(shown, address):
    window = shown(address)
    window.fill("#title", 'a "b" \\ """ \n é')
    window.keyboard.press("Tab")
    script = window.evaluate(
        "document.getElementById('copy-python').click() || document.getElementById('copied').value"
    )
    found = {}
    exec(script.replace("print(", "dict("), found)
    assert found["history"].summary["maximum_force"] == pytest.approx(
        found["fm"].simulate(found["scene"]).summary["maximum_force"]
    )


def test_a_title_never_becomes_html(shown, tmp_path, address):
    title = '<img src=x onerror="document.title=1"></script><b>'
    ball = {"radius": "5 mm", "velocity": "1 m/s", "material": "mild steel"}
    scene = fm.Scene.from_table(
        {"title": title, "impactor": ball, "target": {"kind": "half-space", "material": "PMMA"}}
    )
    write_page(tmp_path / "impact.html", scene)
    for window in (shown((tmp_path / "impact.html").as_uri()), shown(f"{address}#title=%3Cimg%20src%3Dx%3E")):
        assert "<img" in window.inner_text("#heading")
        assert window.locator("img").count() == window.locator("#heading *").count() == 0


@pytest.mark.parametrize("width", [360, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible_at_every_width(shown, address, width, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    window = shown(f"{address}#scene=shot-peening", viewport={"width": width, "height": 740}, color_scheme=scheme)
    for part in ("laws", "restitution", "accuracy", "map"):
        window.click(f"#part-{part} > summary")
    window.wait_for_timeout(500)
    assert window.evaluate("document.documentElement.scrollWidth") <= width
    found = axe.Axe().run(window)
    assert found.violations_count == 0, found.generate_report()


def test_keyboard_alone(shown, address):
    window = shown(address)
    window.focus("#entry-impactor-velocity ~ input[type=range]")
    before = window.inner_text("#summary")
    window.keyboard.press("ArrowRight")
    assert window.inner_text("#summary") != before
    reached = set()
    for _ in range(60):
        window.keyboard.press("Tab")
        reached.add(window.evaluate("document.activeElement.id"))
    assert {"law", "accuracy", "keep", "cursor", "copy-link", "csv", "png"} <= reached
