"""What a prompt, a notebook and a script need of results: one line, a table, a picture, text and datasets."""

import base64
import json
import os
import re
import subprocess
import sys
import tomllib
import warnings
from xml.etree import ElementTree

import pytest

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model.cli.main import main
from film_model.studies import explain

SCENE = fm.Scene(
    fm.Sphere("10 mm", "0.25 m/s", material="WC, Big-Alabo 2017"),
    fm.HalfSpace("mild steel"),
    fm.Contact("stronge", yield_strength="250 MPa"),
    fm.Effects(rate_hardening=False),
)
HISTORY = fm.simulate(SCENE)


def test_a_history_becomes_a_dict_and_a_text():
    assert json.loads(HISTORY.to_json()) == json.loads(json.dumps(HISTORY.to_dict()))
    assert HISTORY.to_dict()["law"] == "stronge"


def test_warnings_of_a_history_are_python_warnings():
    scene = SCENE.replace({"target.material": "soda-lime glass", "contact.law": "hertz", "impactor.velocity": "30 m/s"})
    with pytest.warns(fm.ImpactWarning) as caught:
        history = fm.simulate(scene)
    assert [str(warning.message) for warning in caught] == list(history.warnings)
    assert {warning.filename for warning in caught} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error", fm.ImpactWarning)
        with pytest.raises(fm.ImpactWarning):
            fm.simulate(scene)
        explain.explain(scene, laws=True)  # reports its warnings as data only


def test_warnings_that_python_ignores_cost_nothing(monkeypatch):
    monkeypatch.setattr(fm.History, "warnings", property(lambda history: pytest.fail("the warnings are made")))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fm.ImpactWarning)
        warnings.filterwarnings("ignore", "of another library")
        fm.simulate(SCENE)


def test_parts_of_a_scene_are_shown_in_units():
    block = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3", "hardness": "1 GPa"}
    shown = {
        "Sphere(radius='10 mm', velocity='0.25 m/s', material='bearing steel')": fm.Sphere(
            diameter="20 mm", velocity="25 cm/s", material="bearing steel"
        ),
        "HalfSpace(material=Material(youngs_modulus='210 GPa', poissons_ratio=0.3, density='7850 kg/m^3', "
        "hardness='1 GPa'))": fm.HalfSpace(material=block),
        "Plate(material='mild steel', thickness='5 mm', size=('200 mm', '300 mm'))": fm.Plate(
            material="mild steel", thickness="0.5 cm", size=["0.2 m", "0.3 m"]
        ),
        "Contact(law='meyer', exponent=1.5, stiffness=\"1000000000.0 N/m^1.5\")": fm.Contact(
            "meyer", exponent=1.5, stiffness="1 GN/m^1.5"
        ),
        "Effects(gravity=True)": fm.Effects(gravity=True),
        "Event(contact_begins at 0 s: indentation 0 m, relative velocity 0.25 m/s, contact force 0 N)": HISTORY.events[
            0
        ],
        f"Effect({HISTORY.effects[0].line})": HISTORY.effects[0],
    }
    for text, found in shown.items():
        assert repr(found) == text
    twice = eval(repr(fm.Sphere("1 mm", "2 m/s", mass="1 g", material="soda-lime glass")), {"Sphere": fm.Sphere})
    assert twice == fm.Sphere("1 mm", "2 m/s", mass="1 g", material="soda-lime glass")


def test_everything_fits_a_line_at_the_prompt():
    titled = SCENE.replace({"title": "A ball"})
    many = fm.simulate_batch(SCENE, velocity=["1 m/s", "2 m/s"])
    scene = "ball of radius 10 mm, 60.74 g, 0.25 m/s, on mild steel half-space; law stronge)"
    expected = {
        f"Scene({scene}": SCENE,
        f'Scene("A ball": {scene}': titled,
        "History(stronge: peak 416.6 N, contact 83.24 µs, restitution 0.3453; contact ended)": HISTORY,
        "BatchResult(2 impacts over velocity, stronge; 0 failed, estimated relative error ≤ 1.3e-07)": many,
        "ImpactComponent(law stronge, approaching at 0 s)": fm.ImpactComponent(SCENE),
    }
    assert [repr(shown) for shown in expected.values()] == list(expected)
    assert max(map(len, expected)) <= 120
    assert "\n" not in repr(SCENE.replace({"title": "A" * 500 + "\n"})) and many.varied["velocity"].tolist() == [1, 2]


def test_a_scene_explains_itself_as_the_command_does(capsys, tmp_path):
    (tmp_path / "s.toml").write_text(SCENE.to_toml(), "utf-8")
    assert main(["explain", str(tmp_path / "s.toml")]) == 0
    assert capsys.readouterr().out == f"{SCENE.explain()}\n" and repr(SCENE.explain()) == str(SCENE.explain())
    assert "source: " in SCENE.explain(verbose=True)


def test_notebooks_show_tables(monkeypatch):
    monkeypatch.setattr("film_model.methods.find_spec", lambda name: None)  # as without matplotlib
    scene = SCENE.replace({"title": "a <b> ball"})
    shown = fm.simulate(scene)._repr_html_()
    assert "a &lt;b&gt; ball" in shown and "<th>maximum force</th><td>416.594 N</td>" in shown and "<img" not in shown
    assert "<li>not modelled: rate hardening" in shown
    assert "<th>impactor.radius</th><td>0.01 m</td>" in scene._repr_html_()
    many = fm.simulate_batch(SCENE, velocity=["1 m/s", "2 m/s"])._repr_html_()
    assert "<th>velocity</th><td>1 m/s to 2 m/s</td>" in many
    slopes = fm.simulate(scene, derivatives=["impactor.velocity"]).derivatives
    force, slopes = slopes.text_of("maximum_force", "impactor.velocity"), slopes._repr_html_()
    assert "<td>by impactor.velocity = 0.25 m/s</td>" in slopes and f"<th>maximum force</th><td>{force}</td>" in slopes
    component = fm.ImpactComponent(SCENE)._repr_html_()
    assert "<th>indentation</th><td>0 m</td>" in component
    assert ElementTree.fromstring(f"<div>{shown}{scene._repr_html_()}{many}{slopes}{component}</div>") is not None


@pytest.mark.slow
def test_notebooks_show_the_picture(tmp_path):
    picture = ElementTree.fromstring(f"<div>{HISTORY._repr_html_()}</div>").find("img")
    kind, _, data = picture.attrib["src"].partition(",")
    assert kind == "data:image/svg+xml;base64" and b"</svg>" in base64.b64decode(data)
    HISTORY.plot(tmp_path / "a.svg")
    assert (tmp_path / "a.svg").stat().st_size > 0


def test_a_history_becomes_a_dataset():
    stored = HISTORY.to_dataset().film.history()
    assert (stored.summary, stored.events) == (HISTORY.summary, HISTORY.events)
    assert HISTORY.to_dataset(samples=5).sizes["t"] < 5 + len(HISTORY.events)


@pytest.mark.slow
def test_methods_from_above_import_nothing_until_they_are_called():
    code = (
        "import sys, film_model; film_model.simulate; "
        "print({'xarray', 'matplotlib', 'film_datasets', 'film_model.plot'} & {*sys.modules})"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "set()\n"


@pytest.mark.parametrize("kind", fm.targets.TARGETS)
def test_new_writes_a_valid_scene_of_every_kind(kind, capsys, tmp_path):
    path = tmp_path / "scene.toml"
    assert main(["new", "--kind", kind]) == 0
    text = capsys.readouterr().out
    assert fm.Scene.from_text(text).target.kind == kind
    first, second = (fm.Scene.from_table(_with_comments(text, section)) for section in ("impactor", "target"))
    assert first.impactor.angle is not None and second.target != fm.Scene.from_text(text).target
    assert main(["new", "--kind", kind, "--output", str(path)]) == 0 and path.read_text("utf-8") == text
    assert main(["new", "--output", str(path)]) == 3 and "--force" in capsys.readouterr().err


def _with_comments(text, section):
    """The table of a scene in which the entries that are comments in a section are given."""
    lines = re.search(rf"^\[{section}\]$(.*?)^\[", text, re.MULTILINE | re.DOTALL)[1].splitlines()
    table = fm.Scene.from_text(text).to_table()
    for line in lines:
        if re.match(r"# \w+ *= ", line):
            table[section] |= tomllib.loads(line.removeprefix("# "))
    return table


def test_a_missing_library_is_named(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "mpmath", None)
    monkeypatch.setitem(sys.modules, "fmpy", None)
    assert main(["hard-cases", "--match", "Hertz"]) == 3
    assert capsys.readouterr() == ("", "extended precision needs mpmath: pip install mpmath\n")
    assert main(["check-fmu", "a.fmu"]) == 3
    assert capsys.readouterr() == ("", 'running FMUs needs FMPy: pip install "film-model[fmu]"\n')


def test_a_ball_is_given_by_its_radius_or_its_diameter():
    ball = fm.Sphere(diameter="20 mm", velocity="0.25 m/s", material="WC, Big-Alabo 2017")
    assert ball == SCENE.impactor and fm.Body("brass", diameter="1 in") == fm.Body("brass", radius="0.5 in")
    assert SCENE.replace({"impactor.diameter": "8 mm"}).impactor.radius == 0.004
    text = fm.Scene(ball, fm.Body("brass", "30 mm")).to_toml().replace('radius = "0.03 m"', 'diameter = "60 mm"')
    assert "diameter" in text and fm.Scene.from_text(text).target.radius == 0.03


def test_no_writer_replaces_a_link_or_a_pipe(tmp_path, capsys):
    """Renaming a finished file to the name of a link would leave what it points to as it was."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.to_toml(), "utf-8")
    kept = {suffix: tmp_path / f"kept{suffix}" for suffix in (".nc", ".png", ".toml", ".html", ".fmu")}
    links = {suffix: tmp_path / f"link{suffix}" for suffix in kept}
    for suffix, link in links.items():
        kept[suffix].write_bytes(b"as it was")
        link.symlink_to(kept[suffix])
    links[".dangling.toml"] = tmp_path / "dangling.toml"
    links[".dangling.toml"].symlink_to(tmp_path / "nowhere.toml")
    commands = (
        ("run", scene, "--output", links[".nc"]),
        ("run", scene, "--plot", links[".png"]),
        ("new", "--output", links[".toml"]),
        ("new", "--output", links[".dangling.toml"]),
        ("export-page", scene, "--output", links[".html"]),
        ("export-fmu", scene, "--output", links[".fmu"]),
    )
    for command in commands:
        assert main([str(word) for word in (*command, "--force")]) == 3
        assert re.search(r"link\S*: is a link, which writing|dangling\S*: is a link", capsys.readouterr().err), command
    with pytest.raises(FileExistsError, match="is a link, which writing would replace"):
        fd.write(HISTORY.to_dataset(), links[".nc"], overwrite=True)
    with pytest.raises(FileExistsError, match="is a link, which writing would replace"):
        fmu_wrapper.export(SCENE, links[".fmu"], overwrite=True)
    assert all(link.is_symlink() for link in links.values())
    assert all(path.read_bytes() == b"as it was" for path in kept.values()) and not (tmp_path / "nowhere.toml").exists()
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.nc")
        with pytest.raises(FileExistsError, match="is a device or a pipe"):
            fd.write(HISTORY.to_dataset(), tmp_path / "pipe.nc", overwrite=True)


def test_a_file_of_the_other_kind_is_named_in_one_sentence(tmp_path, capsys):
    scene, sweep = tmp_path / "drop.toml", tmp_path / "heights.toml"
    scene.write_text(SCENE.to_toml(), encoding="utf-8")
    sweep.write_text('scene = "drop.toml"\n[over]\n"impactor.velocity" = ["1 m/s", "2 m/s"]\n', encoding="utf-8")
    assert main(["run", str(sweep)]) == 2
    said = capsys.readouterr().err
    assert said == f'{sweep}:2: over: this is a sweep: give it to "film-model sweep" or "film-model tolerance"\n'
    for command in (["sweep", str(scene), "--output", str(tmp_path / "x.nc")], ["tolerance", str(scene)]):
        assert main(command) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "impactor: this is a scene; a sweep names the file of its scene" in line


def test_only_names_for_users_are_listed():
    tools = {"Any", "TYPE_CHECKING", "annotations", "import_module", "find_spec"}
    for package, names in ((fm, {"simulate", "LAWS"}), (fd, {"sweep", "open"})):
        assert not tools & {*dir(package)} and names <= {*dir(package)}
    assert repr(fm.LAWS).startswith("<film_model.laws: hertz, ") and "jackson-green" in repr(fm.LAWS)
