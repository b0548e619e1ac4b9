"""The page of the explorer as a file: what it is made of, what it may load, and the formulas recorded for it."""

import base64
import gzip
import hashlib
import json
import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import film_model as fm
from film_model.base.arrays import either, greater, root
from film_model.cli.main import main
from film_model.explorer import page as page_module
from film_model.explorer.content import Content, regime_map
from film_model.explorer.inputs import PLATE, STRENGTH_ENTRIES
from film_model.explorer.page import page, scripts
from film_model.explorer.trace import Recording
from film_model.laws import LAWS
from film_model.targets import TARGETS

FIRST_LOAD = 217_500
"""Most bytes of the page, compressed with gzip."""

HOSTILE = '</script><script>document.title = "taken"</script><img src=x onerror=alert(1)> & "quoted"'
BALL = {"radius": "5 mm", "velocity": "1 m/s", "material": "mild steel"}
SLAB = {"kind": "half-space", "material": "mild steel"}

pytestmark = pytest.mark.skipif(not page_module.WASM.exists(), reason="the core was built without zig")


class Elements(HTMLParser):
    """The elements of a page: tag, attributes, text."""

    def __init__(self, text):
        super().__init__()
        self.found, self.inside = [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append([tag, dict(attrs), ""])
        self.inside = True

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.found[-1][2] += data

    def named(self, tag):
        return [(attributes, text) for name, attributes, text in self.found if name == tag]


@pytest.fixture(scope="module")
def scene():
    return fm.Scene.from_table({"title": HOSTILE, "impactor": BALL, "target": SLAB})


@pytest.fixture(scope="module")
def text(scene):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(page_module, "EXAMPLES", {})
        page_module.examples.cache_clear()
        made = page(scene)
    page_module.examples.cache_clear()
    return made


def test_the_policy_allows_the_pages_own_script_and_style_only(text):
    elements = Elements(text)
    policy = next(a["content"] for a, _ in elements.named("meta") if a.get("http-equiv") == "Content-Security-Policy")
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    runs = [body for attributes, body in elements.named("script") if "type" not in attributes]
    for rule, bodies in (("script-src", runs), ("style-src", [body for _, body in elements.named("style")])):
        (body,) = bodies
        own = base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()
        assert rules[rule].split()[0] == f"'sha256-{own}'"
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert "unsafe-inline" not in policy and "'unsafe-eval'" not in policy


def test_nothing_comes_from_outside(text):
    elements = Elements(text)
    assert not [a for _, a, _ in elements.found if a.keys() & {"src", "style"} or any(n.startswith("on") for n in a)]
    script = next(body for attributes, body in elements.named("script") if "type" not in attributes)
    assert set(re.findall(r"https?://[^\s\"'`]+", script)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(
        r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function|fetch\(", script
    )


def test_the_users_text_stays_text(text, scene):
    elements = Elements(text)
    data = json.loads(next(body for attributes, body in elements.named("script") if attributes.get("id") == "data"))
    assert data["scenes"][0]["title"] == scene.title
    assert elements.named("title") == [({}, HOSTILE)]
    assert not elements.named("img")
    assert len(elements.named("script")) == 4


def test_names_of_functions_are_used_once():
    found = re.findall(r"^(?:async )?(?:function|class) (\w+)", "\n".join(scripts().values()), re.MULTILINE)
    assert len(found) > 50 and sorted(found) == sorted(set(found))


def test_a_law_is_offered_with_the_values_that_it_needs():
    table = {"impactor": BALL, "target": SLAB}
    content = Content([("a", fm.Scene.from_table(table))]).table()
    names = [law["name"] for law in content["laws"]]
    assert names == [n for n, law in LAWS.items() if law.family in ("elastic", "yields", "damped") and n != "meyer"]
    fixed = {law["name"]: law["fixed"] for law in content["laws"]}
    assert fixed.pop("kogut-etsion") == {"poissons_ratio": 0.3}
    assert not any(fixed.values())
    glass = {"impactor": BALL | {"material": "alumina"}, "target": SLAB | {"material": "soda-lime glass"}}
    offered = [law["name"] for law in Content([("a", fm.Scene.from_table(glass))]).table()["laws"]]
    assert offered == ["hertz", "large-slope", *(n for n, law in LAWS.items() if law.damped)]


def laws_with(contact):
    """The laws of a page for a ball on steel, by name."""
    scene = fm.Scene.from_table({"impactor": BALL, "target": SLAB, "contact": contact})
    return {law["name"]: law for law in Content([("a", scene)]).table()["laws"]}


def test_a_parameter_of_0_stays_as_it_is():
    """A law has another curve where it is above 0."""
    laws = laws_with({"law": "meyer", "stiffness": "2e13 N/m^2", "exponent": 2})
    assert laws["meyer"]["live"] == [] and laws["meyer"]["own"]["initial_indentation"] == 0.0


def test_the_page_has_an_example_of_every_kind_of_target():
    assert {scene.target.kind for _, scene in page_module.examples()} == set(TARGETS)


def test_a_damped_law_may_have_another_damping():
    """A restitution below that of the series is fixed; what shapes the curve is fixed too."""
    contact = {"law": "hunt-crossley", "restitution": 0.05}
    laws = laws_with(contact)
    assert laws["hunt-crossley"]["live"] == []
    assert [entry["path"] for entry in laws["linear-dashpot"]["live"]] == ["contact.stiffness", "contact.restitution"]
    contact = {"law": "tan-sun", "stiffness": "1e10 N/m^1.4", "critical_indentation": "10 um", "exponent": 1.4}
    live = [entry["path"] for entry in laws_with(contact)["tan-sun"]["live"]]
    assert live and "contact.exponent" not in live


def test_a_target_that_the_page_cannot_simulate_is_shown_as_python_computed_it():
    contact = {"law": "jkr", "work_of_adhesion": "0.1 J/m^2"}
    scene = fm.Scene.from_table({"impactor": BALL, "target": SLAB, "contact": contact})
    (found,) = Content([("a", scene)]).table()["scenes"]
    history = fm.simulate(scene)
    assert found["given"]["summary"] == history.summary
    assert found["given"]["reason"] == "the law jkr pulls"
    assert found["given"]["motion"]["contact_force"][0] < 0.0


def test_a_target_that_is_held_brings_its_compliance_and_its_modes():
    plate = {"kind": "plate", "thickness": "2 mm", "material": "mild steel", "static_stiffness": "1e6 N/m"}
    beam = {"kind": "beam", "length": "200 mm", "width": "20 mm", "thickness": "5 mm", "material": "mild steel"}
    scenes = [
        fm.Scene.from_table({"impactor": BALL, "target": target}) for target in (plate, beam | {"damping_ratio": 0.1})
    ]
    static, vibrating = Content([("a", scenes[0]), ("b", scenes[1])]).table()["scenes"]
    assert static["support"]["compliance"] == pytest.approx(1e-6) and static["support"]["modes"] is None
    modes = scenes[1].target.modes(vibrating["support"]["highest"]).merged()
    assert vibrating["support"]["modes"]["share"] == modes.share.tolist()
    paths = [entry["path"] for entry in vibrating["inputs"] if entry["path"].startswith("target.")]
    strengths = [f"target.material.{name}" for name in STRENGTH_ENTRIES]
    assert paths == [*strengths, "target.damping_ratio"]
    for table in (static, vibrating):
        assert table["given"] is None and table["table"]["effects"]["boundary_reflections"] is True


@pytest.mark.parametrize(
    ("more", "computed"),
    [
        ({}, True),
        ({"size": ["0.1 m", "0.1 m"], "position": ["0.03 m", "0.05 m"], "damping_ratio": 0.01}, True),
        ({"size": ["0.1 m", "0.1 m"], "position": ["0.03 m", "0.05 m"], "edges": "clamped"}, True),
        ({"size": ["0.1 m", "0.1 m"], "foundation_stiffness": "1e6 N/m^3"}, False),
        ({"size": ["0.1 m", "0.1 m"], "damping_ratio": [0.01, 0.02]}, False),
        ({"size": ["0.1 m", "0.1 m"], "damping_ratio": [["1 kHz", 0.01], ["2 kHz", 0.02]]}, False),
        ({"static_stiffness": "1e6 N/m"}, False),
    ],
)
def test_the_page_computes_the_modes_of_plates(more, computed):
    target = {"kind": "plate", "thickness": "2 mm", "material": "mild steel"} | more
    (found,) = Content([("a", fm.Scene.from_table({"impactor": BALL, "target": target}))]).table()["scenes"]
    values = {entry["path"]: entry["value"] for entry in found["inputs"] if entry["path"] in PLATE}
    assert (found["plate"] is not None) is computed is bool(values)
    assert (found["support"] is not None) is not computed
    if computed and more:
        assert list(values.values()) == [0.1, 0.1, 0.03, 0.05]
        assert found["effects"]["boundary_reflections"] == found["effects"]["target_inertia"] == "auto"


def test_a_page_has_hardness_and_hardening_as_entries():
    """Johnson and Cook's constants become an exponent; the scene of the page is the one given."""
    cook = {"youngs_modulus": "117 GPa", "poissons_ratio": 0.34, "density": "8940 kg/m^3", "yield_strength": "90 MPa"}
    cook |= {"strength_coefficient": "292 MPa", "strength_exponent": 0.31}
    given = [
        fm.Scene.from_table({"impactor": BALL, "target": {"kind": "half-space", "material": one}})
        for one in ("nickel 200", cook)
    ]
    table = Content([("hard", given[0]), ("cook", given[1])]).table()
    nickel = fm.material("nickel 200")
    for scene, found in zip(given, table["scenes"], strict=True):
        values = {entry["path"].removeprefix("target.material."): entry["value"] for entry in found["inputs"]}
        material = scene.target.material
        assert values["yield_strength"] == material.yield_strength and values["hardness"] == material.hardness
        assert values["strain_hardening_exponent"] == material.hardening_exponent > 0.05
        shown = fm.Scene.from_table(found["table"])
        assert fm.simulate(shown).summary == fm.simulate(scene).summary
        assert found["replaced"]["target.material.yield_strength"] == "target.material.hardness"
    assert table["materials"]["bearing steel"]["hardness"] == fm.material("bearing steel").hardness
    assert table["materials"]["nickel 200"]["strain_hardening_exponent"] == nickel.strain_hardening_exponent


def test_a_scene_without_an_impact_has_no_page():
    scene = fm.Scene.from_table({"impactor": BALL | {"velocity": "0 m/s"}, "target": SLAB})
    with pytest.raises(fm.SimulationError, match="no velocity"):
        Content([("a", scene)])


def test_a_recorded_formula_is_the_general_one():
    recording = Recording()
    x = recording.symbol("x")
    found = either(x > 2.0, greater(0.0, x) ** 0.5, root(x)) + np.array([3.0])
    assert recording.function("f", "x", {"y": found, "root": root(x), "z": 1.0, "n": None}).splitlines() == [
        "function f(x) {",
        "  const t0 = Math.sqrt(x);",
        "  return { y: (((x > 2.0) ? Math.pow((x > 0.0 ? x : 0.0), 0.5) : t0) + 3.0), root: t0, z: 1.0, n: null };",
        "}",
    ]


@pytest.mark.parametrize("question", [lambda x: max(x, 1.0), lambda x: 1.0 if x else 0.0, lambda x: x == 2.0 or None])
def test_a_formula_that_decides_is_refused(question):
    with pytest.raises(TypeError, match="asks whether"):
        question(Recording().symbol("x"))


def test_export_page_writes_one_file(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(page_module, "page", lambda scene: f"<p>{scene.title}")
    path, file = tmp_path / "impact.html", tmp_path / "scene.toml"
    file.write_text(fm.Scene.from_table({"title": "a", "impactor": BALL, "target": SLAB}).to_toml(), encoding="utf-8")
    command = ["export-page", str(file), "--output", str(path)]
    assert main(command) == 0
    assert path.read_text(encoding="utf-8") == "<p>a"
    assert main(command) == 3 and "--force" in capsys.readouterr().err
    assert main([*command[:2], "--output", str(tmp_path / "impact.txt")]) == 3


def test_explore_writes_a_page_and_opens_it(capsys, monkeypatch, tmp_path):
    opened = []
    monkeypatch.setattr(page_module, "page", lambda scene: "<p>")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    assert main(["explore"]) == 0
    assert opened[0].startswith("file:///") and opened[0].endswith(capsys.readouterr().out.strip().rsplit("/", 1)[1])
    assert main(["explore", "--no-browser"]) == 0 and len(opened) == 1


@pytest.mark.slow
def test_the_first_load_is_small():
    assert len(gzip.compress(page().encode(), 9)) <= FIRST_LOAD


def test_the_map_of_regimes():
    """A fixed target: the work up to a depth is the impact energy. Elastic, light: 1 − e² = 3.46 λ."""
    yields, plastic, moves = ([*zip(line["x"], line["y"], strict=True)] for line in regime_map())
    work = []
    for stage in fm.BigAlabo(1.0, 1.0, 1.0).stages()[:3]:
        force, x = stage.force, stage.end - stage.begin
        work.append(force.constant * x + force.slope * x**2 / 2 + force.coefficient * x**2.5 / 2.5)
    assert yields[0][1] == pytest.approx(1.0, rel=2e-3)
    assert plastic[0][1] == pytest.approx(math.sqrt(sum(work) / work[0]), rel=2e-3)
    assert moves[0][0] == pytest.approx(0.01 / 3.46, rel=0.01)
