"""Sensors on structures: their motion against that of the struck point, closed forms and integration, and refusals."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_model.base.errors import SceneError
from film_model.targets import Modes
from film_model.targets.ritz import panel_modes

STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
QUIET = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
SIZE, STRUCK, OTHER = ["60 mm", "50 mm"], ["24 mm", "20 mm"], ["10 mm", "50 mm"]


def on(target, accuracy=1e-4):
    ball = fm.Sphere("5 mm", "1 m/s", material=STEEL)
    return fm.simulate(fm.Scene(ball, target, fm.Contact("hertz"), QUIET), accuracy=accuracy)


def plate(edges, *places, **options):
    sensors = [{"name": f"s{k}", "position": place} for k, place in enumerate(places)]
    return fm.Plate(STEEL, "4 mm", size=SIZE, position=STRUCK, edges=edges, sensors=sensors, **options)


def beam(theory):
    sensors = [{"name": "struck", "position": "60 mm"}, {"name": "end", "position": "100 mm"}]
    return fm.Beam(STEEL, "100 mm", "20 mm", "4 mm", "free", "60 mm", theory=theory, sensors=sensors)


TARGETS = {
    "simply supported": lambda: plate("simply supported", STRUCK),
    "two edges free": lambda: plate(["simply supported"] * 2 + ["free"] * 2, STRUCK, OTHER),
    "damped": lambda: plate(["clamped", "free", "free", "free"], STRUCK, OTHER, damping_ratio=0.01),
    "euler-bernoulli": lambda: beam("euler-bernoulli"),
    "timoshenko": lambda: beam("timoshenko"),
    "rod": lambda: fm.Rod(STEEL, "10 mm", length="200 mm", sensors=[{"name": "struck", "position": "0 mm"}]),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_a_sensor_at_the_struck_point_moves_as_the_target(name):
    """The core's displacement is that of the modes and what others add statically."""
    history = on(TARGETS[name](), 3e-3)
    times = np.linspace(0.0, history.duration, 101)
    found, motion = history.sensed_si(times), history.sample_si(times)
    scales, rest = history.problem.scales, history.vibration.start.rest
    moved = motion.target_displacement - rest * scales.length / scales.force * motion.contact_force
    assert np.abs(found.displacement[0] - moved).max() < 1e-5 * np.abs(motion.target_displacement).max()


def test_influence_of_a_simply_supported_plate():
    """4/(m a b) sin sin sin sin; by Ritz's method on two edges too, with the same signs in each."""
    target, t = plate("simply supported", ["10 mm", "30 mm"], theory="kirchhoff"), 1e-5
    ritz = panel_modes(target._panel, (0.024, 0.02), 3e6, ((0.01, 0.03),))
    by_two_ways = [float(np.sum(m.factor * np.sin(m.frequency * t) / m.frequency)) for m in (target.modes(3e6), ritz)]
    i, j = np.arange(1.0, 60.0)[:, None], np.arange(1.0, 60.0)
    d, density, (a, b) = target.stiffness[0], target.surface_density, target.size
    omega = math.pi**2 * math.sqrt(d / density) * ((i / a) ** 2 + (j / b) ** 2)
    here = np.sin(i * math.pi * 0.4) * np.sin(j * math.pi * 0.4)
    there = np.sin(i * math.pi / 6.0) * np.sin(j * math.pi * 0.6)
    terms = 4.0 / (density * a * b) * here * there * np.sin(omega * t) / omega
    assert by_two_ways[0] == pytest.approx(float(terms[omega <= 3e6].sum()), rel=1e-9)
    assert by_two_ways[1] == pytest.approx(by_two_ways[0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["damped", "timoshenko", "two modes"])
def test_largest_motions(name):
    """Those of even times under a force that is linear between them, against the exact motion at many times."""
    named = [{"name": "tip", "shape": [-0.5, 2.0]}]
    history = on(
        two_modes(static_compliance="3e-6 m/N", sensors=named) if name == "two modes" else TARGETS[name](), 3e-3
    )
    found = history.sensed_si(np.linspace(0.0, history.duration, 8001))
    for k, peaks in enumerate(history.sensor_peaks.values()):
        for what, bound in (("displacement", 1e-6), ("velocity", 3e-6), ("acceleration", 3e-5)):
            exact = np.abs(getattr(found, what)[k]).max()
            assert peaks[f"maximum_{what}"] == pytest.approx(exact, rel=bound)


def two_modes(**options):
    return fm.Structure(
        frequency=["900 Hz", "300 Hz"],
        modal_mass=["0.2 kg", "0.3 kg"],
        damping_ratio=[0.02, 0.05],
        material=STEEL,
        **options,
    )


def test_two_modes_against_integration():
    """Shapes in the order of the given frequencies; the contact force drives each mode."""
    history = on(two_modes(static_compliance="3e-6 m/N", sensors=[{"name": "tip", "shape": [-0.5, 2.0]}]))
    times = np.linspace(0.0, history.duration, 41)
    omega, ratio = 2 * math.pi * np.array([300.0, 900.0]), np.array([0.02, 0.05])
    factor = np.array([2.0 / 0.3, -0.5 / 0.2])

    def rates(t, y):
        force = float(history.sample_si(np.array([t])).contact_force[0])
        return np.concatenate([y[2:], force - 2 * ratio * omega * y[2:] - omega**2 * y[:2]])

    exact = solve_ivp(rates, (0.0, times[-1]), np.zeros(4), t_eval=times, rtol=1e-7, atol=1e-14, max_step=2e-6).y
    found = history.sensed_si(times)
    assert found.displacement[0] == pytest.approx(factor @ exact[:2], rel=1e-4, abs=1e-4 * np.abs(exact).max())
    assert found.velocity[0] == pytest.approx(factor @ exact[2:], rel=1e-4, abs=1e-4 * np.abs(factor @ exact[2:]).max())
    peaks = history.to_dict()["sensors"]["tip"]
    assert peaks["maximum_velocity"] == pytest.approx(np.abs(found.velocity).max(), rel=1e-6)  # at the end
    assert peaks["maximum_acceleration"] > 0.0


def test_shapes_come_from_the_modes_file(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency [Hz], modal_mass [kg], shape, shape_17\n900, 0.2, 1, -0.5\n300, 1.2, 2, 4\n")
    found = fm.Structure(file=str(path), material=STEEL, sensors=[{"name": "tip", "shape": "shape_17"}])
    assert found.sensors[0].shape == (2.0, -0.5)
    assert isinstance(found.modes(1e5), Modes)
    scene = fm.Scene(fm.Sphere("5 mm", "1 m/s", material=STEEL), found, fm.Contact("hertz"), QUIET)
    assert fm.Scene.from_text(scene.to_toml()) == scene
    with pytest.raises(SceneError, match='no column "shape_18", which a sensor names'):
        fm.Structure(file=str(path), sensors=[{"name": "tip", "shape": "shape_18"}])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: plate("clamped", ["10 mm", "51 mm"]), "0.051 m is beyond the edge at 0.05 m"),
        (lambda: plate("clamped", ["10 mm"]), "2 distances are needed as position, not 1"),
        (lambda: fm.Plate(STEEL, "4 mm", sensors=[{"name": "a", "position": STRUCK}]), "need a target with edges"),
        (lambda: fm.Plate(STEEL, "4 mm", size=SIZE, sensors=[{"name": "a", "shape": "b"}]), "a position is needed"),
        (
            lambda: fm.Plate(STEEL, "4 mm", size=SIZE, sensors=[{"name": "a", "position": STRUCK, "strain": 3}]),
            "strain: 3 is not allowed: true, or on a structure the name of a column",
        ),
        (lambda: two_modes(sensors=[{"name": "a", "shap": [1.0, 1.0]}]), '^[^\\n]*; did you mean "shape"\\?$'),
        (lambda: fm.Plate(STEEL, "4 mm", size=SIZE, sensors=[{"name": "a"}]), "give position, or shape"),
        (lambda: two_modes(sensors=[{"name": "a", "shape": "b"}]), "names a column, which needs a file"),
        (lambda: two_modes(sensors=[{"name": "a", "shape": [1.0]}]), "1 values for 2 frequencies"),
        (lambda: two_modes(sensors=[{"name": "a", "position": "1 mm"}]), "a shape is needed"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_sensors_without_vibrations_are_left_out():
    target = fm.Plate(STEEL, "20 mm", size=["2 m", "2 m"], sensors=[{"name": "a", "position": ["1 m", "1 m"]}])
    scene = fm.Scene(fm.Sphere("5 mm", "1 m/s", material=STEEL), target, fm.Contact("hertz"))
    with pytest.warns(fm.ImpactWarning, match="sensors are left out"):
        history = fm.simulate(scene)
    assert history.sensor_peaks == {} and "sensors" not in history.to_dict()
    with pytest.raises(ValueError, match="whose vibrations are simulated"):
        history.sensed_si([0.0])


@pytest.fixture(scope="module")
def sensed():
    """A simply supported plate with two sensors."""
    return on(plate("simply supported", ["10 mm", "30 mm"], ["50 mm", "10 mm"]), 3e-3)


@pytest.mark.slow
def test_sensors_in_files(sensed, tmp_path, monkeypatch):
    """Coordinates and units in netCDF, the same bytes without xarray; columns in CSV; and back."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    ds = fd.to_dataset(sensed)
    assert fd.validate(ds) == [] and ds["sensor_acceleration"].attrs["units"] == "m s-2"
    motion = sensed.sensed_si(ds["t"].values)
    assert np.array_equal(ds["sensor_velocity"].sel(sensor="s1"), motion.velocity[1])
    assert float(ds["sensor_maximum_velocity"][1]) == sensed.sensor_peaks["s1"]["maximum_velocity"]
    one, other = fd.write(ds, tmp_path / "one.nc"), fd.write(sensed, tmp_path / "other.nc")
    assert one.read_bytes() == other.read_bytes()
    assert fd.history_of(fd.open(one)).sensor_peaks == sensed.sensor_peaks
    frame = fd.to_frame(ds)
    assert np.array_equal(frame["sensor_s1_acceleration [m/s^2]"], motion.acceleration[1])


def test_sensors_in_sweeps(sensed, tmp_path):
    """Impacts that share a structure, and one by one: the largest motions are those of `simulate`, to the accuracy."""
    velocities = np.linspace(1.0, 2.0, 40)
    for over in (
        {"impactor.velocity": [f"{v!r} m/s" for v in velocities.tolist()]},
        {"target.thickness": ["4 mm", "5 mm"]},
    ):
        ds = fd.sweep(sensed.scene, over)
        assert fd.validate(ds) == [] and ds.attrs["sensors"] == "s0 s1"
        path, (_, *_, last) = next(iter(over.items()))
        own = fm.simulate(sensed.scene.replace({path: last})).sensor_peaks["s1"]
        for what, value in own.items():
            assert float(ds[f"sensor_s1_{what}"][-1]) == pytest.approx(value, rel=1e-3)


def test_sensors_of_targets_that_do_not_vibrate_have_no_motion_in_a_sweep():
    ball = fm.Sphere("5 mm", "1 m/s", material=STEEL)
    target = fm.Plate(STEEL, "20 mm", size=["2 m", "2 m"], sensors=[{"name": "a", "position": ["1 m", "1 m"]}])
    ds = fd.sweep(fm.Scene(ball, target, fm.Contact("hertz")), {"impactor.velocity": ["1 m/s", "2 m/s"]})
    assert np.isnan(ds["sensor_a_maximum_velocity"]).all() and fd.validate(ds) == []
