"""Steps of impacts on modes in datasets: their motion from a file, in sweeps, their size, and damaged files."""

from dataclasses import replace

import numpy as np
import pytest
from sweep_cases import cli, same
from test_modal_component import BALL, FADING, FLYING, RINGING, SCENES, on
from test_modal_engine import FEW, OLSSON, STEEL, struck

import film_datasets as fd
import film_model as fm
from film_datasets import history_dataset
from film_datasets.files import size_of
from film_datasets.sweeps import Sweep, disk_space, run_sweep
from film_datasets.sweeps.blocks import Blocks
from film_model.solve.history import MOTION

SPEEDS = {"impactor.velocity": {"from": "0.2 m/s", "to": "1 m/s", "count": 41}}
MASSES = {"impactor.mass": ["20 g", "50 g", "0.2 kg"], "impactor.velocity": ["0.3 m/s", "0.7 m/s"]}
PRESSED = on(FADING, **{"effects.gravity": True, "impactor.velocity": "1 mm/s", "solver.accuracy": 1e-3})


YIELDING = on(FADING, contact={"law": "big-alabo", "yield_strength": "300 MPa"})
CASES = {
    "it yields": YIELDING,
    "at rest under its weight": PRESSED,
    "a damped law": on(FLYING, contact={"law": "hunt-crossley", "restitution": 0.7}),
    "stages": struck(FEW, "12 mm", "1 m/s", mass="0.2 kg").replace(
        {"contact": {"law": "stronge", "yield_strength": "1 GPa"}, "solver.accuracy": 1e-2}
    ),
    "the plate of the paper": OLSSON,
    "a heavy ball": SCENES["a heavy ball"],
    "three contacts": SCENES["a beam, three contacts"],
}
FAST = ("it yields", "at rest under its weight")


@pytest.fixture(scope="module")
def history():
    """Damped modes and a law that yields."""
    return fm.simulate(YIELDING)


def times_of(history, count=300):
    """From first touch until after the last event, in contacts and between them, in no order."""
    return np.random.default_rng(1).uniform(0.0, 1.5 * history.duration, count)


def same_motion(found, history, times):
    for name in MOTION:
        assert np.asarray(found[name]).tolist() == getattr(history.sample_si(times), name).tolist(), name


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=name, marks=[] if name in FAST else pytest.mark.slow) for name, case in CASES.items()],
)
def test_a_file_has_the_motion_to_the_last_bit(case, tmp_path, monkeypatch):
    """Without another march, at random times in and between contacts; energies to the last digit."""
    history = fm.simulate(case)
    path = fd.write(fd.to_dataset(history, samples=2), tmp_path / "impact.nc")
    monkeypatch.setattr(history_dataset, "simulate_chosen", None)
    ds, times = fd.read(path), times_of(history)
    assert fd.validate(ds) == []
    same_motion(ds.film.sample(times), history, times)
    back = ds.film.history()
    assert replace(back, remarks=history.remarks) == history and back.accuracy == history.accuracy
    assert set(back.warnings) == set(history.warnings)
    assert back.sample_si(times).stage.tolist() == history.sample_si(times).stage.tolist()
    assert back.vibration.frequency.tolist() == history.vibration.frequency.tolist()
    assert back.vibration_energy_by_mode == pytest.approx(history.vibration_energy_by_mode, rel=1e-15)
    assert fd.to_dataset(back, samples=2).attrs["content_sha256"] == ds.attrs["content_sha256"]


def moved_as_the_comment_says(ds, number, t):
    """Displacement of the impactor, and depth, `t` after the beginning of a step, from the variables alone."""
    step, theta = ds.isel(step=number), t / float(ds.step_h[number])
    x = step.step_x.item() + step.step_v.item() * t + 0.5 * step.step_load.item() * (t / float(ds.scale_time)) ** 2
    if int(step.step_flight) >= 0:
        first = int(step.step_flight) * ds.sizes["mode"]
        own = ds.isel(flight_mode=slice(first, first + ds.sizes["mode"]))
        w, u = own.flight_mode_displacement.values, own.flight_mode_velocity.values
        decay = ds.mode_damping_ratio.values * ds.mode_frequency.values
        omega = np.sqrt(ds.mode_frequency.values**2 - decay**2)
        waves = np.exp(-decay * t) * (w * np.cos(omega * t) + (u + decay * w) / omega * np.sin(omega * t))
        return x, x - waves.sum()
    nodes, _ = np.polynomial.legendre.leggauss(4)
    powers = np.linalg.solve(np.vander((nodes + 1.0) / 2.0, 4, increasing=True), step.step_force.values)
    x -= np.polynomial.Polynomial(powers).integ(2)(theta) * (float(step.step_h) / float(ds.scale_time)) ** 2
    line = step.step_depth.item() + np.arange(8) * step.step_depth_rate.item() * float(step.step_h) / 7.0
    line[2:] += step.step_bend.values
    bernstein = np.array([1, 7, 21, 35, 35, 21, 7, 1]) * theta ** np.arange(8) * (1 - theta) ** np.arange(7, -1, -1)
    return x, bernstein @ line


def test_the_closed_form_is_that_of_the_comment(history):
    """A reader needs no more than the variables and the attribute `comment`."""
    ds = fd.to_dataset(history)
    units = {"step_time": "s", "step_h": "s", "step_x": "1", "step_v": "s-1", "mode_frequency": "rad s-1"}
    assert {name: ds[name].attrs["units"] for name in units} == units
    flight = int(np.flatnonzero(ds.step_flight >= 0)[0])
    for number, t in ((3, 0.3 * float(ds.step_h[3])), (20, 0.7 * float(ds.step_h[20])), (flight, 2e-5)):
        x, depth = moved_as_the_comment_says(ds, number, t)
        motion = ds.film.sample([float(ds.step_time[number]) + t]).isel(t=0)
        length, force = float(ds.scale_length), float(ds.scale_force)
        rest = float(ds.target_compliance) * motion.contact_force.item() / force
        assert x * length == pytest.approx(motion.impactor_displacement.item(), rel=1e-10)
        assert depth * length == pytest.approx(motion.indentation.item() + rest * length, rel=1e-9)


def test_files_written_before_are_simulated_again(history):
    ds = fd.to_dataset(history)
    old = ds.drop_vars([name for name in ds.variables if str(name).startswith(("step_", "flight_mode_", "mode_"))])
    old.attrs["film_model_schema_version"] = "1.3"
    assert fd.history_of(old) == history and len(fd.history_of(old).vibration.met) > 0
    assert [what for what in fd.validate(old) if "content" not in what] == []
    old.attrs["film_model_schema_version"] = "1.4"
    with pytest.raises(ValueError, match="has no segments"):
        fd.history_of(old)


DAMAGES = {
    "a variable less": (lambda ds: ds.drop_vars("step_bend"), "variable step_bend missing"),
    "energies less": (lambda ds: ds.drop_vars("mode_energy"), "variable mode_energy missing"),
    "cut off": (lambda ds: ds.isel(step=slice(0, 30), flight_mode=slice(0, 0)), "steps of this history are missing"),
    "its beginning cut off": (lambda ds: ds.isel(step=slice(1, None)), "times of its steps do not increase from 0"),
    "a flight less": (lambda ds: ds.isel(flight_mode=slice(3, None)), "do not have"),
    "a mode less": (lambda ds: ds.isel(mode=slice(1, None)), "do not have"),
    "a node less": (lambda ds: ds.isel(node=slice(1, None)), r"step_force has the shape \(\d+, 3\), not \(\d+, 4\)"),
    "a flight that is none": (lambda ds: ds.assign(step_flight=ds.step_flight * 0 + 7), "not numbered from 0"),
    "a stage too many": (lambda ds: ds.assign(step_branch=ds.step_branch * 0 + 100), "stage that the contact law"),
    "a frequency below 0": (lambda ds: ds.assign(mode_frequency=-ds.mode_frequency), "mode 1: frequency"),
    "times that are none": (lambda ds: ds.assign(step_time=ds.step_time * np.nan), "do not increase from 0"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("damage", "said"), DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_gets_one_sentence(history, damage, said):
    ds = damage(fd.to_dataset(history))
    with pytest.raises(ValueError, match=said):
        fd.history_of(ds)
    assert fd.validate(ds)


# ---------------------------------------------------------------- sweeps


def test_impacts_with_modes_of_their_own():
    """Each is followed as `simulate` follows it; the modes are stored once."""
    ds = fd.sweep(on(RINGING), MASSES, keep="segments")
    assert fd.validate(ds) == [] and ds.attrs["kept"] == "summary segments steps"
    assert ds.sizes["mode"] == 3 and ds.sizes["segment"] == 0 and (ds["step_count"] > 20).all()
    for mass in ds["impactor_mass"].values.tolist():
        where = {"impactor_mass": mass, "impactor_velocity": 0.7}
        history = ds.film.history(**where)
        same_motion(ds.film.sample(times_of(history), **where), history, times_of(history))
    last = ds.isel(impactor_mass=2, impactor_velocity=1)
    same_motion(last.film.sample(times_of(history)), history, times_of(history))


@pytest.mark.slow
def test_impacts_that_are_followed_together():
    """Their steps are those of the runs that the summary is from, and as exact."""
    scene = struck(FEW, "12 mm", "0.3 m/s", mass="0.2 kg").replace({"solver.accuracy": 1e-4})
    ds = fd.sweep(scene, SPEEDS, keep="segments")
    assert fd.validate(ds) == [] and ds["maximum_force"].identical(fd.sweep(scene, SPEEDS)["maximum_force"])
    for k in (0, 20, 40):
        where = {"impactor_velocity": float(ds["impactor_velocity"][k])}
        peak = ds.film.sample([float(ds["time_of_maximum_indentation"][k])], **where)["indentation"].item()
        assert peak == pytest.approx(float(ds["maximum_indentation"][k]), rel=1e-12)
        history = ds.film.history(**where)
        times = times_of(history)
        for name in ("impactor_displacement", "target_displacement"):
            exact = getattr(history.sample_si(times), name)
            found = ds.film.sample(times, **where)[name].values
            assert found == pytest.approx(exact, abs=2e-4 * np.abs(exact).max()), name


@pytest.mark.slow
def test_a_sweep_in_which_only_some_targets_vibrate():
    scene = on(RINGING, **{"solver.accuracy": 1e-3})
    targets = [{"kind": "half-space", "material": "mild steel"}, scene.to_table()["target"]]
    over = {"target": targets, "impactor.velocity": {"normal": ["0.3 m/s", "0.5 m/s"]}}
    ds = fd.sweep(scene, over, "random", samples=24, keep="segments")
    assert fd.validate(ds) == []
    failed, vibrates = fd.schema.has_failed(ds["status"].values), ds["target"].values == 1
    assert failed.any() and ((ds["step_count"] > 0).values == (vibrates & ~failed)).all()
    assert ((ds["segment_count"] > 0).values == (~vibrates & ~failed)).all()
    for impact in np.flatnonzero(~failed)[:6].tolist():
        time = float(ds["time_of_maximum_indentation"][impact])
        peak = ds.film.sample([time], impact=impact)["indentation"].item()
        assert peak == pytest.approx(float(ds["maximum_indentation"][impact]), rel=1e-9)
    with pytest.raises(ValueError, match="this impact failed: it has no segments"):
        ds.film.sample([0.0], impact=int(np.argmax(failed)))
    one = int(np.flatnonzero(vibrates & ~failed)[1])
    with pytest.raises(ValueError, match="segments of this impact are missing"):
        ds.isel(step=slice(0, 3)).film.sample([0.0], impact=one)
    with pytest.raises(ValueError, match="variable step_force missing"):
        ds.drop_vars("step_force").film.sample([0.0], impact=one)
    assert "step_begin is not the sum of the step_count before" in fd.validate(ds.assign(step_begin=ds.step_begin + 1))


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", pytest.param("zarr", marks=pytest.mark.slow)])
def test_blocks_workers_files_and_resumed_runs_give_the_same(tmp_path, monkeypatch, suffix):
    if suffix == "zarr":
        pytest.importorskip("zarr")
    monkeypatch.setattr("film_datasets.sweeps.blocks.OWN_CURVES", 2)
    over = {**MASSES, "target.damping_ratio": [0.0, 0.01]}
    asked, path = Sweep.of(on(RINGING), over, keep="segments"), tmp_path / f"out.{suffix}"
    assert len(Blocks(asked)) == 6
    found = [fd.sweep(on(RINGING), over, keep="segments", workers=n) for n in (1, 2)]
    same(*found)
    assert found[0].sizes["mode"] == 6 and set(np.ravel(found[0]["mode_begin"])) == {0, 3}

    def stop(done, size):
        if done >= 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(asked, path, command="test", workers=1, progress=stop)
    with run_sweep(asked, path, command="test", resume=True) as ds:
        assert fd.validate(ds) == []
        same(ds, found[0])


def stored(ds, *dims):
    """Bytes of the variables along some dimensions."""
    return sum(array.nbytes for array in ds.variables.values() if array.dims[:1] and array.dims[0] in dims)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_the_size_is_known_before(tmp_path, suffix):
    """Within a factor of 1.3, on a structure of many modes, where the modes' states at flights take the most."""
    if suffix == ".zarr":
        pytest.importorskip("zarr")
    scene = fm.Scene(BALL, fm.Beam(STEEL, "150 mm", "10 mm", "5 mm"), fm.Contact("hertz"))
    asked, path = Sweep.of(scene, SPEEDS | {"impactor.mass": ["20 g", "50 g", "80 g"]}, keep="segments"), tmp_path / "x"
    blocks, path = Blocks(asked), path.with_suffix(suffix)
    output, _ = disk_space.disk_space(asked, blocks, suffix)
    with run_sweep(asked, path, command="test") as ds:
        history = stored(ds, "step", "flight_mode")
    assert 1 / 1.3 < size_of(path) / output < 1.3
    assert 1 / 1.3 < history / (asked.size * blocks.size.history) < 1.3


@pytest.mark.slow
def test_the_command_says_how_large_segments_are(tmp_path, capsys):
    (tmp_path / "scene.toml").write_text(on(RINGING).to_toml())
    speeds = '"impactor.velocity" = { from = "0.2 m/s", to = "1 m/s", count = 8 }'
    (tmp_path / "sweep.toml").write_text(f'scene = "scene.toml"\n[over]\n{speeds}\n')
    arguments = ("sweep", tmp_path / "sweep.toml", "--output", tmp_path / "x.nc", "--keep", "segments")
    status, _, err = cli(capsys, *arguments)
    lines = [line for line in err.splitlines() if "kB of segments per impact" in line]
    assert status == 0 and [line.partition(":")[0] for line in lines] == ["expected", "written"]
    expected, written = (float(line.split()[1]) for line in lines)
    assert written == pytest.approx(expected, rel=0.3)
    with fd.open(tmp_path / "x.nc") as ds:
        assert written == pytest.approx(stored(ds, "step", "flight_mode", "mode") / 8e3, rel=0.01)
