"""Every mistake in a scene is reported with its line; any text gives a scene or a SceneError."""

from __future__ import annotations

import pickle
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import scene_fuzz
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import film_model as fm
from film_model.base.errors import SceneError
from film_model.scene import Scene, Sphere
from film_model.targets import TARGETS, HalfSpace

GOOD = """\
title = "A ball"
[impactor]
radius = "10 mm"
mass = "60.74 g"
velocity = "0.25 m/s"
material = "WC, Big-Alabo 2017"
[target]
kind = "half-space"
[target.material]
youngs_modulus = "210 GPa"
poissons_ratio = 0.30
density = "7850 kg/m^3"
yield_strength = "1.0 GPa"
[contact]
law = "auto"
[effects]
gravity = "auto"
[solver]
accuracy = 1e-4
"""
STEEL_HALF_SPACE = '[target]\nkind = "half-space"\nmaterial = "mild steel"\n'
BALL = '[impactor]\nradius = "10 mm"\nvelocity = "1 m/s"\nmaterial = "bearing steel"\n'
BRITTLE = (BALL + STEEL_HALF_SPACE).replace("bearing steel", "alumina").replace("mild steel", "zirconia")


def mistakes(text: str) -> str:
    with pytest.raises(SceneError) as caught:
        Scene.from_text(text, "s.toml")
    assert len(str(caught.value).splitlines()) == len(caught.value.mistakes) > 0
    return str(caught.value)


# A line of the valid scene, its replacement, and the message.
BAD_LINES = [
    ('title = "A ball"', "title = 5", "s.toml:1: title: 5 is not a text"),
    ('title = "A ball"', 'titel = "A ball"', 's.toml:1: titel: unknown key; did you mean "title"?'),
    ("[impactor]", "[impacter]", 's.toml:2: impacter: unknown key; did you mean "impactor"?'),
    ('radius = "10 mm"', 'radius = "5 kg"', 's.toml:3: impactor.radius: "5 kg" is a mass, a length is needed (e.g.'),
    ('radius = "10 mm"', "radius = 10", "s.toml:3: impactor.radius: 10 has no unit, a length is needed"),
    ('radius = "10 mm"', "radius = true", "s.toml:3: impactor.radius: true is not a number with a unit"),
    ('radius = "10 mm"', 'radius = ["10 mm"]', "s.toml:3: impactor.radius: a list is not a number with a unit"),
    ('radius = "10 mm"', "radius = {a = 1}", "s.toml:3: impactor.radius: a table is not a number with a unit"),
    ('radius = "10 mm"', "radius = 1979-05-27", "s.toml:3: impactor.radius: datetime.date(1979, 5, 27) is not"),
    ('radius = "10 mm"', 'radius = "-3 mm"', 's.toml:3: impactor.radius: "-3 mm" must be > 0'),
    ('radius = "10 mm"', 'radius = "0 mm"', 's.toml:3: impactor.radius: "0 mm" must be > 0'),
    (
        'radius = "10 mm"',
        'radius = "10 km"',
        's.toml:3: impactor.radius: "10 km" is out of range: from 1e-10 to 1000 m',
    ),
    ('radius = "10 mm"', "radius = nan", "s.toml:3: impactor.radius: nan has no unit"),
    ('radius = "10 mm"', "", "s.toml:2: impactor.radius: missing: a length is needed"),
    ('radius = "10 mm"', '"ra\\u001bdius" = 1', "s.toml:2: impactor.'ra\\x1bdius': unknown key"),
    ('velocity = "0.25 m/s"', 'velocty = "1 m/s"', 's.toml:5: impactor.velocty: unknown key; did you mean "velocity"?'),
    ('velocity = "0.25 m/s"', 'speed = "1 m/s"', 's.toml:5: impactor.speed: unknown key; did you mean "velocity"?'),
    (
        'mass = "60.74 g"',
        'density = "7800 kg/m^3"',
        "s.toml:4: impactor.density: unknown key; it is an entry of material: material = { density = ..., ... }",
    ),
    ('mass = "60.74 g"', 'diameter = "20 mm"', "s.toml:4: impactor.diameter: give radius or diameter, not both"),
    ('radius = "10 mm"', 'diameter = "20 kg"', 's.toml:3: impactor.diameter: "20 kg" is a mass, a length is needed'),
    ('radius = "10 mm"', 'diametre = "20 mm"', 's.toml:3: impactor.diametre: unknown key; did you mean "diameter"?'),
    ('radius = "10 mm"', 'radius = "10 milimeter"', '(did you mean "millimeter"?), a length is needed'),
    ('velocity = "0.25 m/s"', 'velocity = "-1 m/s"', 's.toml:5: impactor.velocity: "-1 m/s" must be >= 0'),
    (
        'velocity = "0.25 m/s"',
        'velocity = "9 m/s"\nangle = "95 deg"',
        's.toml:6: impactor.angle: "95 deg" is out of range: from 0 to 89.9544 deg',
    ),
    ('law = "auto"', 'friction = "rough"', 's.toml:15: contact.friction: "rough" is not a number'),
    ('velocity = "0.25 m/s"', 'velocity = "90 km/s"', 's.toml:5: impactor.velocity: "90 km/s" is out of range'),
    (
        'velocity = "0.25 m/s"',
        'velocity = "1e-160 m/s"',
        "s.toml:5: impactor.velocity: 1e-160 m/s must be 0 or at least 1e-100 m/s",
    ),
    (
        'velocity = "0.25 m/s"',
        'drop_height = "1e-300 m"',
        "s.toml:5: impactor.drop_height: 4.42869e-150 m/s must be 0 or at least 1e-100 m/s",
    ),
    ('velocity = "0.25 m/s"', "", "s.toml:2: impactor.velocity: missing: velocity or drop_height is needed"),
    (
        'mass = "60.74 g"',
        'drop_height = "1 mm"',
        "s.toml:4: impactor.drop_height: give velocity or drop_height, not both",
    ),
    (
        'material = "WC, Big-Alabo 2017"',
        'material = "steal"',
        "s.toml:6: impactor.material: no material of the catalogue",
    ),
    (
        'material = "WC, Big-Alabo 2017"',
        "material = 5",
        "s.toml:6: impactor.material: 5 is not allowed: a name from",
    ),
    (
        'material = "WC, Big-Alabo 2017"',
        "",
        "contact.effective_modulus: missing: give impactor.material",
    ),
    ('kind = "half-space"', 'kind = "halfspace"', 's.toml:8: target.kind: "halfspace" is not allowed'),
    (
        'kind = "half-space"',
        "",
        "s.toml:7: target.kind: missing: " + ", ".join(f'"{kind}"' for kind in TARGETS) + " is needed",
    ),
    ('kind = "half-space"', 'kind = "plate"', "s.toml:7: target.thickness: missing: give thickness (isotropic), or"),
    ('kind = "half-space"', 'kind = "rod"', "s.toml:7: target.diameter: missing: diameter or area is needed"),
    ('kind = "half-space"', 'kind = "body"', "s.toml:7: target.radius: missing: a length is needed"),
    ('youngs_modulus = "210 GPa"', 'youngs_modulus = "1 N"', "s.toml:10: target.material.youngs_modulus: "),
    ('youngs_modulus = "210 GPa"', "", "s.toml:9: target.material.youngs_modulus: missing: a pressure is needed"),
    ("poissons_ratio = 0.30", "poissons_ratio = 0.5", "s.toml:11: target.material.poissons_ratio: 0.5 is out of range"),
    ('law = "auto"', 'law = "herz"', 's.toml:15: contact.law: no contact law is called "herz"; did you mean "hertz"?'),
    ('law = "auto"', "law = 1", "s.toml:15: contact.law: 1 is not a contact law"),
    ('law = "auto"', 'lw = "hertz"', 's.toml:15: contact.lw: unknown key; did you mean "law"?'),
    (
        "accuracy = 1e-4",
        "digits = 4",
        "solver.digits: unknown key; known are accuracy, segments, linearisation",
    ),
    ('law = "auto"', "exponent = 1.5", 's.toml:15: contact.exponent: unknown key; it belongs to law "meyer"'),
    ('law = "auto"', 'self = "x"', "s.toml:15: contact.self: unknown key"),
    ('law = "auto"', 'law = "meyer"', 's.toml:14: contact.stiffness: missing: law "meyer" needs it'),
    (
        'gravity = "auto"',
        "gravity = 1",
        's.toml:17: effects.gravity: 1 is not allowed: "auto" or true or false is needed',
    ),
    ("accuracy = 1e-4", "accuracy = 0", "s.toml:19: solver.accuracy: 0 must be > 0"),
    ("accuracy = 1e-4", "accuracy = inf", "s.toml:19: solver.accuracy: inf is not finite"),
    ("accuracy = 1e-4", "accuracy = 1e-4\nsegments = 5", "s.toml:20: solver.segments: give accuracy or segments"),
    ("accuracy = 1e-4", "segments = 0", "s.toml:19: solver.segments: 0 is not allowed: a whole number from 1 to"),
    ("accuracy = 1e-4", "segments = true", "s.toml:19: solver.segments: true is not allowed"),
    ("accuracy = 1e-4", 'linearisation = "cord"', 's.toml:19: solver.linearisation: "cord" is not allowed'),
    ("accuracy = 1e-4", "accuracy = ", "s.toml:19: not TOML: Invalid value"),
    ("accuracy = 1e-4", 'accuracy = """', "s.toml:20: not TOML: "),
]


@pytest.mark.parametrize(("line", "instead", "said"), BAD_LINES)
def test_a_mistake_is_named_with_its_line(line: str, instead: str, said: str) -> None:
    assert line in GOOD
    assert any(said in found for found in mistakes(GOOD.replace(line, instead, 1)).splitlines())


BAD_SCENES = [
    ("", ["s.toml: impactor: missing", "s.toml: target: missing"]),
    (
        "impactor = 5\ntarget = []\n",
        ["s.toml:1: impactor: 5 is not allowed", "s.toml:2: target: a list is not allowed"],
    ),
    ("[impactor]\n[[target]]\n", ["s.toml:1: impactor.radius: missing", "s.toml:2: target: a list is not allowed"]),
    (BALL + '[target]\nkind = "half-space"\n', ["contact.effective_modulus: missing: give target.material"]),
    (
        BALL.replace("bearing steel", "alumina") + '[target]\nkind="half-space"\nmaterial="PMMA"\nradius="inf m"\n',
        ['s.toml:8: target.radius: "inf m" is not finite'],
    ),
    (
        '[impactor]\nradius = "1 mm"\nvelocity = "1 m/s"\n'
        + STEEL_HALF_SPACE
        + '[contact]\neffective_modulus = "1 GPa"',
        ["s.toml:1: impactor.mass: missing: give mass, or a material"],
    ),
    (
        BRITTLE + '[contact]\nlaw = "stronge"\n',
        ['s.toml:9: contact.law: law "stronge" needs a yield strength: give hardness or yield_strength'],
    ),
    (
        BRITTLE + "[effects]\nplasticity = true\n",
        ["s.toml:9: effects.plasticity: plasticity needs a yield strength"],
    ),
    (
        BALL + '[target]\nkind = "body"\nradius = "1 mm"\nmaterial = "brass"\nvelocity = "1 m/s"\n',
        ["s.toml:9: target.velocity: 1 m/s must be < the impactor's 1 m/s"],
    ),
    (
        BALL + '[target]\nkind = "plate"\nmass_per_area = "4 kg/m^2"\nsize = ["1 m"]\n'
        'bending_stiffness = { D11 = "1 N*m", D12 = "2 N*m", D22 = "1 N*m", D66 = "1 N*m" }\n',
        [
            "s.toml:8: target.size: a list has 1 values: a list of 2 values is needed",
            "s.toml:9: target.bending_stiffness.D12: must be smaller than",
        ],
    ),
    (
        BALL + '[target]\nkind = "plate"\nthickness = "4 mm"\nmass_per_area = "4 kg/m^2"\n',
        ["s.toml:5: target.material: missing", "s.toml:8: target.mass_per_area: give thickness (isotropic), or"],
    ),
    (
        BALL + STEEL_HALF_SPACE + '[contact]\nlaw = "meyer"\nexponent = 2\nstiffness = "1e9 N/m^1.5"\n',
        ['s.toml:11: contact.stiffness: "1e9 N/m^1.5" has the unit "N/m^1.5", N/m^2 is needed'],
    ),
    (
        BALL
        + STEEL_HALF_SPACE
        + '[contact]\nlaw = "meyer"\nexponent = 0\nstifness = "1e9 N/m"\ninitial_force = "-1 N"\n',
        [
            "s.toml:10: contact.exponent: 0 must be > 0",
            's.toml:11: contact.stifness: unknown key; did you mean "stiffness"?',
            's.toml:12: contact.initial_force: "-1 N" must be >= 0',
        ],
    ),
    (
        'impactor.radius = "1 kg"\nimpactor."velocity" = 3\n[ "target" ] # here\nkind = "half-space"\n'
        "material.density = 5\n"
        'note = """\nkind = 1\n"""\n',
        [
            "s.toml:1: impactor.radius:",
            "s.toml:2: impactor.velocity:",
            "s.toml:5: target.material.density:",
            "s.toml:6: target.note: unknown key",
        ],
    ),
    ("a = " + "[" * 5000, ["s.toml: not TOML: "]),
    ("a = 1" + "0" * 5000, ["s.toml: not TOML: "]),
    (".".join("a" * 3000) + " = 1", ["s.toml:1: a key of more than 20 parts"]),
    ("[impactor]\nradius." + ".".join("a" * 3000) + " = 1", ["s.toml:2: a key of more than 20 parts"]),
]


@pytest.mark.parametrize(("text", "said"), BAD_SCENES)
def test_all_mistakes_are_reported_together(text: str, said: list[str]) -> None:
    found = mistakes(text)
    assert [fragment for fragment in said if fragment not in found] == []


def _write(data: bytes) -> Callable[[Path], None]:
    return lambda path: path.write_bytes(data) and None


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: None, ": cannot be read: No such file"),
        (Path.mkdir, ": is a folder, a regular file is needed"),
        (_write(b"\x7fELF\x00\xff\xfe"), ":1: is not UTF-8 text: byte 0xff at offset 5"),
        (_write(GOOD.encode("utf-16")), ":1: is not UTF-8 text: byte 0xff at offset 0"),
        (_write(b"title = '\xe9'"), ":1: is not UTF-8 text: byte 0xe9"),
        (_write(b"#" * 1_000_001), ": is larger than 1 MB"),
    ],
)
def test_files_that_are_no_scenes(tmp_path: Path, make: Callable[[Path], None], said: str) -> None:
    path = tmp_path / "scene.toml"
    make(path)
    with pytest.raises(SceneError) as caught:
        Scene.from_toml(path)
    assert str(caught.value).startswith(f"{path}{said}")


def test_a_ball_given_by_its_mass_is_told_its_diameter() -> None:
    with pytest.raises(SceneError, match=r'a ball of 500 g of structural steel S235 has "49\.55 mm"'):
        Sphere(mass="500 g", velocity="1 m/s", material="S235")
    assert Sphere(diameter="49.55 mm", velocity="1 m/s", material="S235").own_mass == pytest.approx(0.5, rel=1e-3)


def test_windows_files_are_read(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert Scene.from_toml(path) == Scene.from_text(GOOD)


def test_python_objects_make_the_same_mistakes() -> None:
    with pytest.raises(SceneError) as caught:
        Sphere("-3 mm", 5, mass="1 m")  # type: ignore[arg-type]
    assert str(caught.value).splitlines() == [
        'Sphere.radius: "-3 mm" must be > 0',
        'Sphere.velocity: 5 has no unit, a velocity is needed (e.g. "0.25 m/s")',
        'Sphere.mass: "1 m" is a length, a mass is needed (e.g. "60 g")',
    ]
    with pytest.raises(SceneError, match=r"^Scene.impactor: 1 is not allowed: Sphere is needed\nScene.target: None"):
        Scene(1, None)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"^Sphere.material.density: "):
        Sphere("1 m", "1 m/s", material={"youngs_modulus": "1 Pa", "poissons_ratio": 0, "density": "1 m"})
    with pytest.raises(SceneError, match=r"^Scene.contact.effective_modulus: "):
        Scene(Sphere("1 mm", "1 m/s", mass="1 g"), HalfSpace())
    assert pickle.loads(pickle.dumps(caught.value)).mistakes == caught.value.mistakes


MORE = """ [ ] = . " ' { } \"\"\" # plate body rod thickness nan -1 1e999 true "5mm" "5decibel" D11 size meyer stiffness
bending_stiffness \x00"""
WORDS = st.sampled_from([*(GOOD + MORE).split(), "\n"])
EDITS = st.lists(st.tuples(st.integers(0, len(GOOD)), st.integers(0, 12), st.one_of(WORDS, st.text(max_size=5))))


def read_or_refused(read: Callable[[], Scene]) -> None:
    """Any exception other than SceneError fails the test."""
    try:
        scene = read()
    except SceneError as error:
        refused = error
    else:
        assert Scene.from_text(scene.to_toml()) == scene
        return
    assert len(str(refused).splitlines()) == len(refused.mistakes) > 0


@pytest.mark.random
@settings(suppress_health_check=[HealthCheck.too_slow])
@given(EDITS)
@example([(3, 0, "\ufeff")])
def test_any_edit_of_a_scene_is_read_or_refused(edits: list[tuple[int, int, str]]) -> None:
    text = GOOD
    for start, length, new in edits:
        text = text[:start] + new + text[start + length :]
    read_or_refused(lambda: Scene.from_text(text))


@pytest.mark.random
@given(st.lists(WORDS, max_size=40).map(" ".join) | st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    read_or_refused(lambda: Scene.from_text(text))


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(["5 mm", "hertz", "1 Pa"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


@pytest.mark.random
@given(st.sampled_from(BAD_LINES), st.sampled_from(["impactor", "target", "contact", "effects", "solver"]), VALUES)
def test_any_value_is_read_or_refused(bad: tuple[str, str, str], section: str, value: Any) -> None:
    key = bad[0].split()[0]
    read_or_refused(lambda: Scene.from_text(GOOD).replace({f"{section}.{key}": value}))


@pytest.mark.slow
def test_mutated_files_are_read_or_refused() -> None:
    chance, known = random.Random(20170417), scene_fuzz.seeds()
    assert sum(scene_fuzz.read(text) for text in known) == len(known)
    read = [scene_fuzz.read(scene_fuzz.mutated(chance, known)) for _ in range(400)]
    assert 0 < sum(read) < len(read)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda: Scene(
                Sphere("1 mm", "1 m/s", material="mild steel"),
                fm.Body(radius="2 mm"),
                fm.Contact("meyer", stiffness="1 N/m", exponent=1),
            ),
            "Scene.target.mass: missing: give mass, or a material (the mass is then density × sphere volume)",
        ),
        (
            lambda: fm.Plate("mild steel", thickness="1 mm", size="150 mm"),
            'Plate.size: "150 mm" is not a list: a list of 2 values is needed',
        ),
        (
            lambda: fm.Contact("tabulated", indentation="5 um", force=["0 N", "1 N"]),
            'Contact.indentation: "5 um" is not a list, a length is needed (e.g. "10 mm") in each place',
        ),
    ],
)
def test_incomplete_parts_and_wrong_lists_are_refused(make: Callable[[], object], says: str) -> None:
    with pytest.raises(SceneError) as caught:
        make()
    assert str(caught.value) == says


def test_a_wrong_cell_of_a_table_gives_one_message(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("indentation (um), force (N)\n0,0\n1," + "9" * 200_000 + "\n", encoding="utf-8")
    with pytest.raises(SceneError, match=r"Contact\.file: .*curve\.csv.*, line 3: field larger than field limit"):
        fm.Contact("tabulated", file=str(path))
