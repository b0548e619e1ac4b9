"""The suite of reference impacts: its values against their second computation, its files, and scores."""

import csv
import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_datasets.reference_impacts.cases import cases, chain_of, scene_of
from film_datasets.reference_impacts.second import ERRORS, second
from film_datasets.reference_impacts.suite import FILES, compute
from film_model.cli.main import main
from film_model.laws import LAWS
from film_model.solve.simulate import simulate_quietly
from film_model.studies import high_precision
from film_model.studies.impact_ode import impact_of

FEW = ("big-alabo-plate-0.4", "tsuji-body-1.2", "weight-hertz-half-space", "relaxing-0.001s-1", "bouncing-5mm-20mm")
ELASTIC = "hertz-half-space-0.4"


def agrees(name):
    made = compute(cases()[name])
    assert len(made.values) >= 5
    for key, one in made.values.items():
        assert one.difference <= one.bound, (name, key, one)
    return made


def test_the_table_has_every_law_and_target():
    names, groups = cases(), {case.group for case in cases().values()}
    assert len(names) >= 250 and {case.scene["contact"]["law"] for case in names.values()} == set(LAWS)
    kinds = {case.target for case in names.values()}
    assert kinds == {"half-space", "body", "plate", "rod", "beam", "structure", "chain"}
    assert {
        "oblique",
        "bouncing",
        "chain",
        "viscoelastic",
        "under weight",
        "vibrating target",
        "adhesive",
        "published",
    } <= groups


@pytest.mark.slow
@pytest.mark.parametrize("name", [*FEW, "cradle-0.4", "vibrating-structure-thornton-0.2", "oblique-70deg-spin0"])
def test_the_second_computation_is_within_the_bound(name):
    agrees(name)


@pytest.mark.slow
@pytest.mark.parametrize("group", sorted({case.group for case in cases().values()}))
def test_every_second_computation_is_within_the_bound(group):
    digits = []
    for name in (name for name, case in cases().items() if case.group == group):
        digits += [value["digits"] for value in agrees(name).to_dict()["values"].values()]
    least = {"vibrating target": 4, "oblique": 2, "viscoelastic": 8, "bouncing": 8, "published": 0}
    assert min(digits) >= least.get(group, 7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hertz-half-space-0.4", "tsuji-half-space-0.4", "big-alabo-rod-1.2"])
def test_the_second_computation_is_that_of_extended_precision(name):
    history = simulate_quietly(scene_of(cases()[name]))
    problem = history.problem
    exact = high_precision.impact(problem.law, problem.mass, history.scene.approach_velocity, problem.given.impedance)
    for key, value in second(history).values.items():
        assert value == pytest.approx(exact[key], rel=ERRORS["stages"]), key


def on_the_way_in(history, count=300):
    """Times, indentations and forces up to the turn, by DOP853."""
    problem, scales = history.problem, history.problem.scales
    impact = impact_of(problem.law, problem.approach, problem.gamma, problem.load, problem.damping)
    turn, begin, state = history.summary["time_of_maximum_indentation"] / scales.time, 0.0, (0.0, problem.approach)
    for run in impact.loading():

        def rates(_, z, run=run):
            rate, force = impact.motion(run, float(z[0]), float(z[1]))
            return rate, impact.load - force

        def edge(_, z, run=run):
            return z[0] - run.to if math.isfinite(run.to) else -1.0

        edge.terminal = True
        options = {"rtol": 3e-14, "atol": 1e-16, "max_step": turn / count}
        found = solve_ivp(rates, (begin, turn), state, "DOP853", events=edge, **options)
        for time, one in zip(found.t[1:-1], found.y[:, 1:-1].T, strict=True):
            yield time * scales.time, one[0] * scales.length, impact.motion(run, *one.tolist())[1] * scales.force
        begin, state = found.t[-1], found.y[:, -1]
        if begin >= turn:
            return


@pytest.mark.parametrize(
    "name",
    [
        "thornton-plate-0.4",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("tsuji-half-space-0.4", "stronge-rod-1.2")),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("kuwabara-kono-plate-0.4", "jkr-plate-0.5")),
    ],
)
def test_histories_are_exact_to_1e_9(name):
    history = simulate_quietly(scene_of(cases()[name]))
    times, depths, forces = np.array(list(on_the_way_in(history))).T
    seen, summary = history.sample_si(times), history.summary
    assert np.abs(seen.indentation - depths).max() < 1e-9 * summary["maximum_indentation"]
    assert np.abs(seen.contact_force - forces).max() < 1e-9 * summary["maximum_force"]


def hashes(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.slow
def test_the_files(tmp_path, capsys):
    jsonschema = pytest.importorskip("jsonschema")
    names = ["bouncing-5mm-20mm", "oblique-70deg-spin0", "tabulated-half-space-0.4"]
    names.append("ball-on-ball-0.2")
    assert main(["reference-impacts", "--output", str(tmp_path / "a"), "--cases", ",".join(names)]) == 0
    assert "4 cases" in capsys.readouterr().out
    schema = json.loads((FILES / "summary.schema.json").read_text("utf-8"))
    for name in names:
        folder = tmp_path / "a" / name
        summary = json.loads((folder / "summary.json").read_text("utf-8"))
        jsonschema.validate(summary, schema)
        chain = cases()[name].group == "chain"
        scene = (fm.Chain if chain else fm.Scene).from_toml(folder / "case.toml")
        assert scene == (chain_of if chain else scene_of)(cases()[name])
        rows = list(csv.reader((folder / "reference.csv").read_text("utf-8").splitlines()))
        assert 200 <= len(rows) <= 301 and rows[0][0] == "t [s]"
        if not chain and not name.startswith("bouncing"):
            peak = summary["values"]["maximum_force"]
            found = simulate_quietly(scene).summary["maximum_force"]
            assert peak["value"] == pytest.approx(found, rel=10.0 ** (1 - peak["digits"]))
    assert (tmp_path / "a" / ".zenodo.json").exists() and "CC0" in (tmp_path / "a" / "LICENSE").read_text("utf-8")
    assert main(["reference-impacts", "--output", str(tmp_path / "a")]) == 3
    assert "is not an empty folder" in capsys.readouterr().err


@pytest.mark.slow
def test_the_bytes_do_not_depend_on_workers(tmp_path):
    names = [*FEW, "jkr-plate-0.5", "vibrating-rod-hertz-0.2"]
    for folder, workers in (("a", 1), ("b", 2)):
        fd.write_suite(tmp_path / folder, names, workers)
    assert hashes(tmp_path / "a") == hashes(tmp_path / "b")


def written(path, header, *columns):
    path.write_text("\n".join([header, *(",".join(map(repr, row)) for row in zip(*columns, strict=True))]), "utf-8")
    return path


@pytest.fixture
def history():
    return simulate_quietly(scene_of(cases()[ELASTIC]))


def test_a_score_finds_the_error_that_was_put_in(history, tmp_path, capsys):
    times = np.linspace(0.0, 1.05 * history.duration, 90)
    seen = history.sample_si(times)
    columns = (1e6 * times).tolist(), (1.02e-3 * seen.contact_force).tolist(), seen.impactor_velocity.tolist()
    written(tmp_path / f"{ELASTIC}.csv", "time [us], contact_force [kN], impactor_velocity [m/s]", *columns)
    (found,) = fd.score(tmp_path)
    assert found.case == ELASTIC and found.rows == 90
    assert found.errors["contact_force"] == pytest.approx(0.02, rel=1e-3)
    assert found.errors["maximum_force"] == pytest.approx(0.02, rel=0.05)
    assert found.errors["impactor_velocity"] < 1e-9 > found.errors["rebound_velocity"]
    assert found.errors["contact_duration"] < 0.02
    assert main(["score", str(tmp_path), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    of_force = table["quantities"]["contact_force"]
    assert of_force["case"] == ELASTIC and of_force["cases"] == 1
    assert of_force["median"] == of_force["largest"] == found.errors["contact_force"]
    assert main(["score", str(tmp_path / f"{ELASTIC}.csv")]) == 0
    assert ELASTIC in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("name", [ELASTIC, "bouncing-5mm-20mm", "fork-0.4"])
def test_a_reference_scores_as_it_is(name, tmp_path):
    (folder,) = fd.write_suite(tmp_path / "suite", [name])
    assert folder == tmp_path / "suite" / name
    lines = (folder / "reference.csv").read_text("utf-8").splitlines()
    if name == ELASTIC:  # the stage
        lines = [line.rsplit(",", 1)[0] for line in lines]
    (tmp_path / "own.csv").write_text("\n".join(lines), "utf-8")
    (found,) = fd.score(tmp_path / "own.csv", name)
    sampled = ("contact_duration", "maximum_force") if name == "fork-0.4" else ("contact_duration",)
    assert max(error for name, error in found.errors.items() if name not in sampled) < 1e-8


def test_a_score_of_a_chain_is_that_of_its_worst_body(tmp_path):
    motion = fm.simulate_chain(chain_of(cases()["cradle-0.4"]))
    times = np.linspace(0.0, motion.span[1], 400)
    velocity, force = (motion.sample_si(times)[name] for name in ("velocity", "contact_force"))
    columns = (1e6 * times).tolist(), velocity[0].tolist(), (velocity[2] * 1.03).tolist(), (0.9e-3 * force[1]).tolist()
    path = tmp_path / "cradle-0.4.csv"
    written(path, "time [us], velocity_1 [m/s], velocity_3 [m/s], contact_force_2 [kN]", *columns)
    (found,) = fd.score(path)
    final, peaks = motion.final_velocity.m, motion.largest_force.m
    late = [*columns[0], 2e6 * motion.end], [*columns[1], float(final[0])]
    assert found.errors["velocity"] == pytest.approx(0.03 * velocity[2].max() / 0.4, rel=1e-3)
    assert found.errors["final_velocity"] == pytest.approx(0.03, rel=1e-2)
    assert found.errors["contact_force"] == pytest.approx(0.1 * peaks[1] / peaks[0], rel=1e-3)
    assert found.errors["maximum_force"] == pytest.approx(0.1 * peaks[1] / peaks[0], rel=1e-2)
    written(path, "time [us], velocity_1 [m/s]", *late)
    (found,) = fd.score(path)
    assert found.rows == 401 and max(found.errors.values()) < 1e-9


def test_an_interrupted_suite_leaves_nothing(tmp_path):
    def stop(name):
        raise KeyboardInterrupt

    (tmp_path / "suite").mkdir()
    with pytest.raises(KeyboardInterrupt):
        fd.write_suite(tmp_path / "suite", [ELASTIC], progress=stop)
    assert list(tmp_path.rglob("*")) == [tmp_path / "suite"]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("other.csv", "time [s], force [N]\n0,0\n1,2\n", 'case "other" is not in the suite'),
        ("hertz-half-space-4.csv", "time [s], force [N]\n0,0\n1,2\n", 'did you mean "hertz-half-space-0.4"'),
        (f"{ELASTIC}.csv", "time [s], force [m]\n0,0\n1,2\n", "force [m]"),
        (f"{ELASTIC}.csv", "time [s], colour\n0,0\n1,2\n", "colour"),
        (f"{ELASTIC}.csv", "time [s], force [N]\n-1,0\n1,2\n", "before first touch"),
        (f"{ELASTIC}.csv", "velocity [m/s], restitution\n0.1,0.5\n0.2,0.4\n", 'a column "time" is needed'),
        ("bouncing-5mm-20mm.csv", "time [s], force [N]\n0,0\n1,2\n", "before first touch, which is 0.0638"),
        ("cradle-0.4.csv", "time [s], force [N]\n0,0\n1,2\n", '"force [N]" is not known; did you mean "contact_force_'),
        ("cradle-0.4.csv", "time [s], velocity_4 [m/s]\n0,0\n1,2\n", 'did you mean "velocity_'),
        ("cradle-0.4.csv", "time [s], velocity_3 [m/s]\n-1,0\n1,2\n", "is before the start, which is 0 s"),
    ],
)
def test_wrong_results(name, text, said, tmp_path, capsys):
    (tmp_path / name).write_text(text, "utf-8")
    assert main(["score", str(tmp_path / name)]) in (2, 3)
    error = capsys.readouterr().err
    assert said in error and "Traceback" not in error


def test_a_thornton_ning_dent_close_to_yield_is_refused():
    law = simulate_quietly(scene_of(cases()["thornton-ning-half-space-2"])).problem.law
    with pytest.raises(ValueError, match="close to yield"):
        impact_of(law, 1.0, 0.0).unloading(2, law.stages()[-1].begin, 1e9)
