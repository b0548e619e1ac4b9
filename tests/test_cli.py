"""The command line: what it prints, writes and returns, and what it says of mistakes."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
from cases import combinations

from film_model.base.materials import catalogue
from film_model.cli.main import COMMANDS, GROUPS, main, parser
from film_model.laws import LAWS
from film_model.solve.history import SUMMARY

SCENES = Path(__file__).parent.parent / "examples" / "scenes"
BALL = SCENES / "tungsten_carbide_on_steel.toml"


def run(capsys, *arguments):
    status = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_table(capsys):
    status, out, err = run(capsys, "run", BALL)
    assert status == 0
    assert "516.088 N" in out
    assert "9.48384 µm" in out
    assert "law big-alabo" in out
    (line,) = err.splitlines()
    assert line.startswith("warning: law big-alabo: its restitution rises with velocity: from 0.823")


def test_six_results_and_what_is_simulated_unless_all_is_asked_for(capsys):
    short, long = (run(capsys, "run", BALL, *more)[1] for more in ((), ("--verbose",)))
    assert set(short.splitlines()) < set(long.splitlines())
    assert len(short.splitlines()) < 14 and "contact begins" not in short and "not needed" not in short
    names = [name for name in SUMMARY if f"\n  {name.replace('_', ' '):30}" in short]
    assert len(names) == 6 and "coefficient_of_restitution" in names
    assert all(f"\n  {name.replace('_', ' '):30}" in long for name in SUMMARY)
    assert "contact begins" in long and "gravity: not needed" in long


def test_every_command_is_in_the_help_once_and_a_similar_one_is_suggested(capsys):
    commands = sorted(command for commands in COMMANDS.values() for command in commands)
    assert sorted(command for commands in GROUPS.values() for command in commands) == commands
    with pytest.raises(SystemExit):
        main(["runn", "scene.toml"])
    assert 'film-model: error: "runn" is no command; did you mean "run"?' in capsys.readouterr().err


def test_a_similar_option_is_suggested(capsys):
    for given, said in (
        (
            ["--acuracy", "1e-4"],
            'film-model run: error: unrecognized arguments: --acuracy 1e-4; did you mean "--accuracy"?',
        ),
        (["--acuracy=1e-4"], 'unrecognized arguments: --acuracy=1e-4; did you mean "--accuracy"?'),
        (["another.toml"], "unrecognized arguments: another.toml\n"),
    ):
        with pytest.raises(SystemExit) as stopped:
            main(["run", str(BALL), *given])
        assert stopped.value.code == 2 and said in capsys.readouterr().err


def test_json(capsys):
    status, out, _ = run(capsys, "run", BALL, "--json", "--accuracy", "1e-8")
    table = json.loads(out)
    assert status == 0
    assert set(table) == {"title", "law", "outcome", "summary", "events", "effects", "accuracy", "warnings"}
    assert list(table["summary"]) == list(SUMMARY)
    assert table["summary"]["maximum_force"] == {"value": pytest.approx(516.0877429, rel=1e-8), "units": "N"}
    assert table["accuracy"]["requested"] == 1e-8
    assert 0 < table["accuracy"]["estimated"] <= 1e-8
    assert table["accuracy"]["segments"] >= 12
    names = [event["name"] for event in table["events"]]
    assert names == ["contact_begins", "stage_changes", "maximum_indentation", "impactor_stops", "contact_ends"]
    assert {"name", "time", "indentation", "force"} <= set(table["events"][0])


def test_long_lists_of_events_are_shortened(capsys, tmp_path):
    scene = tmp_path / "laid.toml"
    text = BALL.read_text(encoding="utf-8").replace("0.25 m/s", "1 um/s")
    text = text.replace('"half-space"', '"rod"\ndiameter = "20 mm"').replace('"big-alabo"', '"hertz"')
    scene.write_text(text + "\n[effects]\ngravity = true\n", encoding="utf-8")
    status, out, _ = run(capsys, "run", scene, "--verbose")
    assert status == 0 and len(out.splitlines()) <= 61  # 11 of effects, one for each that a scene can switch
    events = json.loads(run(capsys, "run", scene, "--json")[1])["events"]
    assert f"and {len(events) - 24} more" in out


def test_segments_and_chords(capsys):
    status, out, _ = run(capsys, "run", BALL, "--json", "--segments", "5", "--linearisation", "chord")
    table = json.loads(out)
    assert status == 0
    assert table["summary"]["contact_duration"]["value"] == pytest.approx(105.15e-6, rel=1e-4)
    assert table["accuracy"]["segments"] == 5
    assert table["accuracy"]["requested"] is None


@pytest.mark.slow
def test_output_and_plot(capsys, tmp_path):
    data, picture = tmp_path / "impact.nc", tmp_path / "impact.svg"
    status, _, err = run(capsys, "run", BALL, "--output", data, "--plot", picture)
    assert status == 0
    assert str(data) in err
    assert picture.read_text(encoding="utf-8").lstrip().startswith("<?xml")
    with xr.open_dataset(data) as dataset:
        assert float(dataset["maximum_force"]) == pytest.approx(516.0877, rel=1e-6)
    status, _, err = run(capsys, "run", BALL, "--output", data)
    assert status == 3
    assert "--force" in err
    assert run(capsys, "run", BALL, "--output", data, "--force")[0] == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["impact.nc", "impact.svg"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", str(BALL), "--output", "x.txt"], 'must end in ".nc"'),
        (["cost", str(BALL), "--output", "x.txt"], 'must end in ".nc"'),
        (["run", str(BALL), "--output", "folder.nc", "--force"], "is a folder"),
        (["cost", str(BALL), "--plot", "folder.svg", "--force"], "is a folder"),
        (["hard-cases", "--markdown", "folder.nc", "--force"], "is a folder"),
    ],
)
def test_impossible_outputs_are_refused_before_the_simulation(arguments, said, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("folder.nc", "folder.svg"):
        (tmp_path / folder).mkdir()
    for work in ("solve.simulate.simulate_quietly", "studies.cost.study", "studies.hard_cases.report"):
        monkeypatch.setattr(f"film_model.{work}", lambda *_, **__: pytest.fail("the work had begun"))
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (3, "") and said in err


@pytest.mark.slow
@combinations(encoding=["ascii", "cp1252", "utf-8"], fast=1)
def test_output_works_in_every_encoding(encoding):
    def printed(*arguments):
        environment = {**os.environ, "PYTHONIOENCODING": encoding}
        command = [sys.executable, "-m", "film_model", *arguments]
        return subprocess.run(command, capture_output=True, check=True, env=environment).stdout.decode(encoding)

    assert ("F = K δ^1.5" if encoding == "utf-8" else "F = K ?^1.5") in printed("laws")
    assert "F = K δ^1.5" in json.loads(printed("laws", "--json"))["laws"][0]["summary"]


@pytest.mark.parametrize("command", ["laws", "materials"])
def test_lists(capsys, command):
    status, out, _ = run(capsys, command)
    assert status == 0
    assert ("big-alabo" if command == "laws" else "WC, Big-Alabo 2017") in out
    status, out, _ = run(capsys, command, "--json")
    rows = json.loads(out)[command]
    assert len(rows) == (len(LAWS) if command == "laws" else len(catalogue()))
    assert all(row["name"] and row["source"] for row in rows)


@pytest.mark.slow
def test_laws_are_drawn(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "laws.svg"
    assert main(["laws", "--plot", str(picture)]) == 0
    assert f"wrote {picture}" in capsys.readouterr().err
    assert main(["laws", "--plot", str(picture)]) == 3
    assert "use --force" in capsys.readouterr().err
    assert main(["laws", "--plot", str(tmp_path / "laws.txt"), "--force"]) == 3
    assert "must end in .png" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["laws", "--help"], ["--version"]])
def test_help(capsys, arguments):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 0
    assert "film-model" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["fly"],
        ["run"],
        ["run", str(BALL), "--accuracy", "1e-4", "--segments", "5"],
        ["run", str(BALL), "--segments", "x"],
    ],
)
def test_wrong_command_lines(capsys, arguments):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert capsys.readouterr().out == ""


TEXT = BALL.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ('"10 mm"', '"5 kg"', "a length is needed"),
        ('"10 mm"', '"10,5 mm"', "impactor.radius"),
        ('"10 mm"', '"-10 mm"', "impactor.radius"),
        ('"10 mm"', '"0 mm"', "impactor.radius"),
        ('"10 mm"', '"nan mm"', "impactor.radius"),
        ('"10 mm"', '"1e30 mm"', "impactor.radius"),
        ('"10 mm"', '"10 furlongz"', "impactor.radius"),
        ('"10 mm"', "10", "impactor.radius"),
        ("velocity", "velocty", 'did you mean "velocity"'),
        ('"600 GPa"', '"600 kg"', "impactor.material.youngs_modulus"),
        ("[impactor]", "[impactor", "scene.toml"),
        ("[target]", "[goal]", "goal"),
    ],
)
def test_an_invalid_scene_gives_one_message(capsys, tmp_path, before, after, says):
    assert before in TEXT
    path, output = tmp_path / "scene.toml", tmp_path / "impact.nc"
    path.write_text(TEXT.replace(before, after, 1), encoding="utf-8")
    status, out, err = run(capsys, "run", path, "--output", output)
    assert status == 2
    assert out == ""
    assert says in err
    assert "scene.toml" in err
    assert "Traceback" not in err
    assert not output.exists()


def test_files_that_cannot_be_read(capsys, tmp_path):
    binary, large = tmp_path / "binary.toml", tmp_path / "large.toml"
    binary.write_bytes(bytes(range(256)))
    large.write_bytes(b"# much\n" * 400_000)
    for path in (tmp_path / "missing.toml", tmp_path, binary, large):
        status, out, err = run(capsys, "run", path)
        assert status == 2
        assert out == ""
        assert path.name in err
        assert len(err.splitlines()) == 1


def test_output_that_cannot_be_written(capsys, tmp_path):
    for output in (tmp_path / "none" / "impact.nc", tmp_path):
        status, out, err = run(capsys, "run", BALL, "--output", output)
        assert status == 3
        assert out == ""
        assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
    status, _, err = run(capsys, "run", BALL, "--plot", tmp_path / "impact.xyz")
    assert status == 3
    assert "xyz" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("option", "value", "says"),
    [("--accuracy", "7", "accuracy"), ("--accuracy", "nan", "accuracy"), ("--segments", "0", "segments")],
)
def test_options_out_of_range(capsys, option, value, says):
    status, out, err = run(capsys, "run", BALL, option, value)
    assert status == 2
    assert out == ""
    assert says in err


def command(*arguments, **options):
    code = "import sys; from film_model.cli.main import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False, **options
    )


@pytest.mark.slow
def test_a_closed_pipe_is_no_error():
    read, write = os.pipe()
    os.close(read)
    code = "import sys; from film_model.cli.main import main; sys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", code, "run", str(BALL)], stdout=write, stderr=subprocess.PIPE, check=False
    )
    os.close(write)
    assert b"Traceback" not in done.stderr


def test_the_package_is_a_command():
    done = subprocess.run([sys.executable, "-m", "film_model", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("film-model ")


def commands_of(made):
    return next(action.choices for action in made._actions if isinstance(action, argparse._SubParsersAction))


def test_a_command_is_parsed_alike_with_and_without_the_others():
    every = commands_of(parser())
    assert list(every) == [command for commands in COMMANDS.values() for command in commands]
    for commands in COMMANDS.values():
        for command in commands:
            own = commands_of(parser(command))
            assert tuple(own) == commands
            assert own[command].format_help() == every[command].format_help()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "unneeded"),
    [
        (
            "from film_model.cli.main import parser; parser().format_help()",
            {"numpy", "pathlib", "csv", "film_model.scene"},
        ),
        (
            f"from film_model.cli.main import main; main(['run', {str(BALL)!r}, '--json'])",
            {"pint", "scipy", "xarray", "matplotlib", "film_datasets", "pathlib", "film_model.face"}
            | {"film_model.laws.tsuji", "film_model.laws.jkr", "film_model.targets.plate", "film_model.solve.vibration"}
            | {"film_model.core.modal", "film_model.cli.datasets", "film_model.solve.sensed", "film_model.targets.ritz"}
            | {"film_model.core.panels", "film_model.core.relaxing", "film_model.scene.chain"},
        ),
        (
            "import tempfile; from film_model.cli.main import main; "
            f"main(['run', {str(BALL)!r}, '--output', tempfile.mkdtemp() + '/x.nc'])",
            {"pint", "scipy", "xarray", "matplotlib"},
        ),
        (
            "import film_datasets",
            {"xarray", "pandas", "pint", "scipy", "matplotlib", "netCDF4", "zarr", "importlib.metadata"},
        ),
    ],
    ids=["help", "run", "a dataset", "film_datasets"],
)
def test_what_is_not_needed_is_not_imported(code, unneeded):
    code += f"; import sys; print(sorted({unneeded} & set(sys.modules)), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.splitlines()[-1] == "[]"


@pytest.mark.slow
def test_exit_status_of_the_process():
    assert command("run", "no such file.toml").returncode == 2
    done = command("laws", "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["laws"]


def test_one_material_with_its_sources(capsys):
    status, out, _ = run(capsys, "materials", "window glass")
    assert status == 0
    assert "float glass, annealed" in out and "45 MPa" in out and "EN 572-1" in out
    status, out, _ = run(capsys, "materials", "--search", "rubber", "--json")
    rows = json.loads(out)["materials"]
    assert [row["name"] for row in rows] == [f"natural rubber {hardness} Shore A" for hardness in (40, 50, 60, 70)]
    assert rows[0]["surface_energy"] == 0.0355 and rows[0]["synonyms"]
    status, _, err = run(capsys, "materials", "--search", "vibranium")
    assert status != 0 and "no material's name contains" in err
    status, _, err = run(capsys, "materials", "alumunium")
    assert status != 0 and 'did you mean "aluminium"?' in err


@pytest.mark.parametrize(
    ("command", "file", "said"),
    [
        ("run", "m.csv", "m.csv: is a table; a scene or a sweep (TOML) is needed"),
        (
            "sweep",
            "x.nc",
            'x.nc: is a dataset: "film-model plot" and "film-model check" read it; a scene or a sweep (TOML)',
        ),
        (
            "run",
            "impact.fmu",
            'impact.fmu: is an FMU: "film-model check-fmu" reads it; a scene or a sweep (TOML) is needed',
        ),
        ("check", "impact.fmu", 'impact.fmu: is an FMU: "film-model check-fmu" reads it'),
        ("check", "empty.nc", "empty.nc: is empty"),
        (
            "plot",
            "scene.toml",
            'scene.toml: is a scene or a sweep, no dataset: "film-model run" and "film-model sweep"',
        ),
    ],
)
def test_a_file_of_another_kind_is_named(command, file, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / file).write_text("velocity\n" * (file != "empty.nc"), "utf-8")
    options = {"plot": ["--quantity", "y"], "check": []}.get(command, ["--output", "y.nc"])
    assert main([command, file, *options]) in (2, 3)
    assert capsys.readouterr().err.startswith(said)


def test_of_many_contacts_only_beginnings_and_ends_are_listed(capsys, tmp_path):
    """A ball on a pane; what the infinite plate's march says is called that."""
    scene = tmp_path / "rattles.toml"
    scene.write_text(
        '[impactor]\nradius = "12.5 mm"\nvelocity = "3 m/s"\nmaterial = "bearing steel"\n[target]\n'
        'kind = "plate"\nsize = ["300 mm", "300 mm"]\nthickness = "6 mm"\n'
        'theory = "kirchhoff"\nmaterial = "float glass, annealed"\n'
        '[contact]\nlaw = "hertz"\n[effects]\ngravity = true\n[solver]\naccuracy = 1e-2\n',
        encoding="utf-8",
    )
    status, out, _ = run(capsys, "run", scene, "--verbose")
    assert status == 0 and "impulse                       -  not known while the weight" in out
    events = json.loads(run(capsys, "run", scene, "--json")[1])["events"]
    ends = [event for event in events if event["name"] in ("contact_begins", "contact_ends")]
    assert len(ends) > 10 and f"and {len(events) - min(len(ends), 24)} more: --json and files have all" in out
    assert "reloading begins" not in out and "contact without them ends after" in out
