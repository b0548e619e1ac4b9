"""The contact force from accelerations of a bracket with noise: force, impulse and intervals; what must be refused."""

import json
import math
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.identification.deconvolution import deconvolve
from film_model.base.errors import SceneError
from film_model.cli.main import main

GUIDE = Path(__file__).parents[1] / "docs" / "how_to" / "hammer_test.md"
RATE, REST, TIMES, NOISE = 2e5, 2e-4, 600, 40.0  # Hz, s, number, m/s²: 2 % of the largest acceleration
NAMES = ("corner", "half way", "wall")


@pytest.fixture(scope="module")
def bracket(tmp_path_factory):
    """The scene of the guide, its impact, and the accelerations from 0.2 ms before contact on."""
    folder = tmp_path_factory.mktemp("bracket")
    for name, text in re.findall(r"^```\w+\n# (modes\.csv|nylon\.toml)\n(.*?)^```$", GUIDE.read_text(), re.M | re.S):
        (folder / name).write_text(text.replace('"modes.csv"', json.dumps(str(folder / "modes.csv"))))
    history = fm.simulate(fm.Scene.from_toml(folder / "nylon.toml"), accuracy=1e-4)
    times = np.arange(TIMES) / RATE - REST
    moved = np.zeros((3, TIMES))
    moved[:, times >= 0.0] = history.sensed_si(times[times >= 0.0]).acceleration
    return folder, history, times, moved


def measured(path, times, moved, names=NAMES):
    rows = np.column_stack([times * 1e6 + 500.0, moved.T])
    lines = [f"time [us],{','.join(f'{name} [m/s^2]' for name in names)}"]
    path.write_text("\n".join([*lines, *(",".join(f"{x:.8g}" for x in row) for row in rows.tolist())]) + "\n")
    return path


def noisy(moved, seed):
    return moved + NOISE * np.random.default_rng(seed).standard_normal(moved.shape)


@pytest.mark.parametrize("names", [NAMES, NAMES[:1]])
def test_force_behind_noisy_accelerations(bracket, tmp_path, names):
    """Within 1 % of the largest force, which the intervals of that size hold; the contact's times to 2 samples."""
    _, history, times, moved = bracket
    force = np.where(times > 0.0, history.sample_si(np.maximum(times, 0.0)).contact_force, 0.0)
    force[times > history.duration] = 0.0
    for seed in range(2):
        path = measured(tmp_path / "m.csv", times, noisy(moved, seed)[: len(names)], names)
        found = fd.identify_force(path, history.scene)
        assert found.warnings == () and pickle.loads(pickle.dumps(found)) == found
        true = np.interp(found.time - 500e-6, times, force)
        inside = (found.low <= true) & (true <= found.high)
        assert inside[1:-1].mean() > 0.9
        largest, low, high = found.largest
        assert largest == pytest.approx(history.summary["maximum_force"], rel=0.012)
        assert low < history.summary["maximum_force"] < high and (high - low) / largest < 0.025
        impulse, low, high = found.impulse
        assert impulse == pytest.approx(history.summary["impulse"], rel=0.012)
        assert low < history.summary["impulse"] < high
        assert found.time[[0, -1]] - 500e-6 == pytest.approx([0.0, history.duration], abs=2.0 / RATE)
        assert found.residual["corner"] == pytest.approx(NOISE, rel=0.1)


@pytest.mark.slow
def test_interval_holds_as_often_as_it_says(bracket):
    """The largest force and the impulse of 40 records, at 90 %: 36 and the deviation 1.9 expected."""
    from film_model.solve.sensed import responses

    _, history, _, moved = bracket
    response = responses(history.scene.target.modes(math.pi * RATE), 1.0 / RATE, 300)[2, :1]
    held = np.zeros(2)
    for seed in range(40):
        found = deconvolve(list(response), list(noisy(moved[:1, :300], seed)))
        at = int(np.argmax(found.force))
        off = found.force[at] - history.summary["maximum_force"], found.total / RATE - history.summary["impulse"]
        held += np.abs(off) < 1.645 * np.array([found.deviation[at], found.total_deviation / RATE])
    assert (held >= 31).all()


@pytest.mark.slow
def test_several_contacts(bracket, tmp_path):
    """A heavy hammer hits five times; velocities do as well."""
    _, history, times, _ = bracket
    heavy = history.scene.replace({"impactor.mass": "20 g", "impactor.material": "mild steel"})
    impact = fm.simulate(heavy, accuracy=1e-3)
    motion = np.zeros((1, TIMES))
    motion[:, times >= 0.0] = impact.sensed_si(times[times >= 0.0]).velocity[:1]
    motion += 0.002 * np.abs(motion).max() * np.random.default_rng(0).standard_normal(motion.shape)
    path = measured(tmp_path / "m.csv", times, motion, ["corner"])
    path.write_text(path.read_text().replace("m/s^2", "m/s"))
    found = fd.identify_force(path, heavy)
    assert found.largest[0] == pytest.approx(impact.summary["maximum_force"], rel=0.05)
    assert found.impulse[0] == pytest.approx(0.020 * (0.3 - impact.summary["rebound_velocity"]), rel=0.05)


@pytest.mark.slow
def test_wrong_vibrations_are_doubted(bracket, tmp_path):
    """Frequencies that are 1 % off, and exchanged sensors: the residual is far above the noise and no noise."""
    _, history, times, moved = bracket
    scene = history.scene
    off = scene.replace({"target.frequency": [f"{1.01 * f!r} Hz" for f in scene.target.frequency]})
    (said, *_) = fd.identify_force(measured(tmp_path / "m.csv", times, noisy(moved[:1], 0), NAMES[:1]), off).warnings
    assert re.match(r'the residual is no noise \("corner" [\d.]+ % of the motion, most at [\d.]+ kHz\)', said)
    exchanged = measured(tmp_path / "x.csv", times, noisy(moved, 0), ("half way", "corner", "wall"))
    found = fd.identify_force(exchanged, scene)
    assert '"half way"' in found.warnings[0] and found.residual["corner"] > 5.0 * NOISE


@pytest.mark.slow
def test_command(bracket, tmp_path, capsys, monkeypatch):
    folder, history, times, moved = bracket
    monkeypatch.chdir(tmp_path)
    path = str(measured(tmp_path / "m.csv", times, noisy(moved, 0)))
    command = ["identify", "--force-from", path, str(folder / "nylon.toml")]
    assert main([*command, "--output", "force.nc", "--plot", "force.png"]) == 0
    assert "largest force" in (out := capsys.readouterr().out) and "600 times; intervals at 99 %" in out
    ds = fd.read("force.nc")
    assert fd.validate(ds) == [] and list(ds.data_vars) == ["contact_force"]
    assert (tmp_path / "force.png").read_bytes().startswith(b"\x89PNG")
    assert main([*command, "--output", "force.csv", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    low, high = found["largest_force"]["interval"]
    assert low < history.summary["maximum_force"] < high and found["residual"]["wall"]["units"] == "m s-2"
    again = fd.from_csv("force.csv")
    assert np.array_equal(again["contact_force"], ds["contact_force"]) and "contact_force_low" in again.coords
    assert main([*command, "--output", "force.csv"]) == 3  # it is there
    assert main(["identify", path, path, str(folder / "nylon.toml"), "--force-from"]) == 3
    assert main(["identify", "force.csv", str(folder / "nylon.toml"), "--fit", "x", "--output", "f.nc"]) == 3


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("corner [m/s^2]", "cornr [m/s^2]"), 'did you mean "corner"\\?$'),
        (lambda text: text.replace("corner [m/s^2]", "corner [N]"), "that of a displacement or velocity or acceler"),
        (lambda text: text.replace("half way", "corner"), "is given twice"),
        (lambda text: re.sub(r"\n505,.*", "", text), "evenly spaced"),
        (lambda text: re.sub(r"(\n505,)[^,]*", r"\1", text), '"corner" has no value'),
        (lambda text: text[: text.index("\n350,")], "10 times: 20 to 20000 are allowed"),
        (lambda text: text.replace("time [us]", "wall [g]"), 'a column "time'),
        (lambda text: text[: text.index("\n")] + re.sub(r",.*", ",0,0,0", text[text.index("\n") :]), "zero"),
    ],
)  # fmt: skip
def test_refused_files(bracket, tmp_path, change, said):
    _, history, times, moved = bracket
    path = measured(tmp_path / "m.csv", times, moved)
    path.write_text(change(path.read_text()))
    with pytest.raises((SceneError, ValueError), match=said):
        fd.identify_force(path, history.scene)


def test_refused_targets(bracket, tmp_path):
    _, history, times, moved = bracket
    path = measured(tmp_path / "m.csv", times, moved)
    half_space = fm.Scene(fm.Sphere("4 mm", "0.3 m/s", material="mild steel"), fm.HalfSpace("mild steel"))
    with pytest.raises(ValueError, match="has no sensors"):
        fd.identify_force(path, half_space)
    with pytest.raises(ValueError, match="confidence"):
        fd.identify_force(path, history.scene, confidence=1.0)
