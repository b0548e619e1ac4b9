"""Impacts over frequency: closed forms of the force's spectrum, and responses against systems of equations."""

import csv
import json
import math

import numpy as np
import pytest
from scipy.optimize import brentq

import film_model as fm
from film_model.base.errors import SimulationError
from film_model.cli.main import main
from film_model.solve.spectrum import STRAINS, responses, transform
from film_model.targets.modes_of_programs import read_matrices

STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")


def ball(law, target=None, **options):
    return fm.Scene(
        fm.Sphere("10 mm", "0.1 m/s", material=STEEL),
        target or fm.HalfSpace(STEEL),
        law,
        fm.Effects(gravity=False, target_motion=target is not None, **options),
    )


def test_force_of_a_linear_spring():
    """A half-sine: cos(π f T)/(1 − (2 f T)²) of the impulse; the bandwidth is where that is 10^(−1/2)."""
    law = fm.Contact(fm.Meyer(stiffness=1e6, exponent=1.0))
    history = fm.simulate(ball(law), accuracy=1e-6)
    found, duration = history.spectrum([1e3, "2 kHz", 5e3]), history.summary["contact_duration"]
    x = found.frequency * duration
    assert np.abs(found.force) == pytest.approx(
        history.summary["impulse"] * np.abs(np.cos(math.pi * x) / (1 - 4 * x**2)), rel=1e-6
    )
    exact = brentq(lambda x: math.cos(math.pi * x) / (1 - 4 * x**2) - 10**-0.5, 0.6, 1.4)
    assert found.bandwidth * duration == pytest.approx(exact, rel=1e-6)
    assert found.points == () and found.receptance.shape == (0, 3)


def test_a_soft_tip_excites_low_frequencies():
    """The bandwidth falls as the contact lasts longer."""
    widths = [
        fm.simulate(ball(fm.Contact("hertz", effective_modulus=modulus))).spectrum().bandwidth
        for modulus in ("100 GPa", "1 GPa")
    ]
    assert widths[0] / widths[1] == pytest.approx(100**0.4, rel=1e-4)  # 1/T is proportional to E^(2/5)


def chain(tmp_path):
    """30 masses and springs, damped in proportion to the stiffness, as matrices and as a structure with a sensor, with
    the strain of the spring before it, 50 mm long."""
    count, spring = 30, 4e6
    stiffness = spring * (np.diag(np.full(count, 2.0)) - np.eye(count, k=1) - np.eye(count, k=-1))
    stiffness[-1, -1] = spring
    matrices = {"K": stiffness, "M": 0.2 * np.eye(count), "C": 2e-4 * stiffness}
    np.savez(tmp_path / "chain.npz", **matrices)
    found = read_matrices(tmp_path / "chain.npz", None, None, count, [10, 9], None)
    found.write(tmp_path / "modes.csv")
    *above, heading = (tmp_path / "modes.csv").read_text().splitlines()[: -found.frequency.size]
    rows = zip((tmp_path / "modes.csv").read_text().splitlines()[-found.frequency.size :], found.shape.T, strict=True)
    lines = [f"{row}, {float(tenth - ninth) / 0.05!r}" for row, (_, tenth, ninth) in rows]
    (tmp_path / "modes.csv").write_text("\n".join([*above, f"{heading}, strain_10 [1/m]", *lines]))
    sensors = [{"name": "tenth", "shape": "shape_10", "strain": "strain_10"}]
    return matrices, fm.Structure(str(tmp_path / "modes.csv"), STEEL, sensors=sensors)


@pytest.mark.slow
def test_responses(tmp_path):
    """(K − ω² M + i ω C) x = f, and the spectrum of the acceleration against that of the motion itself."""
    matrices, target = chain(tmp_path)
    frequency = np.array([20.0, 75.0, 300.0, 1000.0])
    found = responses(target, frequency)
    force = np.eye(30)[-1]
    for k, omega in enumerate(2 * math.pi * frequency):
        exact = np.linalg.solve(matrices["K"] - omega**2 * matrices["M"] + 1j * omega * matrices["C"], force)
        assert found[:, k] == pytest.approx([exact[29], exact[9], (exact[9] - exact[8]) / 0.05], rel=1e-8)
    scene = ball(fm.Contact("hertz", effective_modulus="10 MPa"), target)
    history = fm.simulate(scene, accuracy=1e-4)
    times = np.linspace(0.0, 3.0, 2**16 + 1)  # until the motion is gone: ζ ω is 5 1/s at the first vibration
    moved = transform(times, history.sensed_si(times).acceleration[0], frequency[:3])
    spectrum = history.spectrum(frequency[:3])
    assert spectrum.acceleration[1] == pytest.approx(moved, rel=3e-3)
    assert spectrum.gauges == ("tenth",) and list(spectrum.strain) == ["strain_x"]
    bent = transform(times, history.sensed_si(times).strain_x[0], frequency[:3])
    assert spectrum.strain["strain_x"][0] * spectrum.force == pytest.approx(bent, rel=3e-3)


@pytest.mark.parametrize("place", [0.02, 0.07])
def test_strain_of_a_beam(place):
    """Euler and Bernoulli's beam between supports, in closed form: β⁴ = ω² ρA/(E I), and at x ≤ a
    w = F (sin βb sin βx/sin βL − sinh βb sinh βx/sinh βL)/(2 E I β³), b = L − a."""
    length, struck, h = 0.1, 0.04, 0.004
    gauge = [{"name": "gauge", "position": f"{place!r} m", "strain": True}]
    target = fm.Beam(STEEL, "100 mm", "10 mm", "4 mm", theory="euler-bernoulli", position="40 mm", sensors=gauge)
    history = fm.simulate(ball(fm.Contact("hertz"), target, boundary_reflections=True, target_inertia=True))
    found = history.spectrum([100.0, 3e3, 1e4, 2e4])
    bending, mass = 210e9 * 0.01 * h**3 / 12.0, 7850.0 * 0.01 * h
    for k, omega in enumerate(2.0 * math.pi * found.frequency):
        beta = (omega**2 * mass / bending) ** 0.25
        x, b = (place, length - struck) if place <= struck else (length - place, struck)
        parts = [f(beta * b) * f(beta * x) / f(beta * length) for f in (math.sin, math.sinh)]
        strain = h / 2.0 * (parts[0] + parts[1]) / (2.0 * bending * beta)  # −h/2 w″
        assert found.strain["strain_x"][0, k] == pytest.approx(strain, rel=1e-2)
    assert found.strain["strain_y"] == pytest.approx(-0.3 * found.strain["strain_x"], rel=1e-12)
    assert found.strain["stress_x"] == pytest.approx(210e9 * found.strain["strain_x"], rel=1e-12)
    assert not found.strain["stress_y"].any() and not found.strain["shear_stress"].any()


def test_strain_of_a_plate():
    """Plane stress of the strains, and how much is left out at two distances from the force, the second 1.5 times the
    thickness."""
    places = ["10 mm", "30 mm"], ["28 mm", "25 mm"]
    gauges = [{"name": f"{k}", "position": place, "strain": True} for k, place in enumerate(places)]
    struck = {"position": ["24 mm", "20 mm"], "damping_ratio": 0.01}
    target = fm.Plate(STEEL, "4 mm", size=["60 mm", "50 mm"], sensors=gauges, **struck)
    scene = ball(fm.Contact("hertz"), target, boundary_reflections=True, target_inertia=True)
    history = fm.simulate(scene, accuracy=1e-2)
    frequency = np.array([100.0, 3e3, 1e4, 2e4])
    found = history.spectrum(frequency)
    x, y, along, across, shear = (found.strain[name] for name in STRAINS)
    assert x == pytest.approx((along - 0.3 * across) / 210e9, rel=1e-9)
    assert y == pytest.approx((across - 0.3 * along) / 210e9, rel=1e-9)
    modes = target.modes(2.0 * math.pi * 6e7)  # 9000 vibrations
    omega = 2.0 * math.pi * frequency[:, None]
    dynamic = 1.0 / (modes.frequency**2 - omega**2 + 2j * modes.damping_ratio * modes.frequency * omega)
    exact = target.strains(modes.strain @ dynamic.T)
    for rows, many in zip((x, y, along, across, shear), exact, strict=True):
        off = np.abs(rows - many).max(axis=1) / np.abs(many).max(axis=1)
        assert (off < 0.015).all()


def test_struck_plate():
    """Where the frequencies are low, the static compliance; what cannot be computed is refused."""
    plate = fm.Plate(STEEL, "4 mm", size=["60 mm", "50 mm"], damping_ratio=0.01)
    assert responses(plate, np.array([1.0]))[0].real == pytest.approx(plate.compliance, rel=1e-6)
    sensed = fm.Plate(
        STEEL,
        "4 mm",
        size=["60 mm", "50 mm"],
        position=["20 mm", "22 mm"],
        sensors=[{"name": "far", "position": ["40 mm", "30 mm"]}, {"name": "near", "position": ["21 mm", "22 mm"]}],
    )
    static = sensed.modes(3e7).factor @ sensed.modes(3e7).frequency ** -2.0
    assert np.abs(responses(sensed, np.array([1.0]))[1:, 0] / static - 1) == pytest.approx([0.0, 0.0], abs=0.02)
    clamped = fm.Plate(STEEL, "1 mm", size=["2 m", "2 m"], edges="clamped")
    with pytest.raises(SimulationError, match="up to 1e\\+07 Hz: the vibrations"):
        responses(clamped, np.array([1e7]))


@pytest.mark.slow
def test_command(tmp_path, capsys):
    _, target = chain(tmp_path)
    path, picture, table = (tmp_path / name for name in ("scene.toml", "spectrum.png", "spectrum.csv"))
    path.write_text(ball(fm.Contact("hertz"), target).to_toml())
    command = ["spectrum", str(path), "--plot", str(picture), "--output", str(table), "--highest", "5 kHz"]
    assert main(command) == 0 and "force down by 10 dB at" in capsys.readouterr().out
    head, *rows = table.read_text().splitlines()
    assert head.startswith('frequency [Hz],"force, real [N*s]"') and "receptance tenth" in head and len(rows) == 1000
    first = dict(zip(next(csv.reader([head])), map(float, rows[0].split(",")), strict=True))
    square = (2.0 * math.pi * first["frequency [Hz]"]) ** 2
    for part in ("real", "imaginary"):
        expected = -square * first[f"receptance tenth, {part} [m/N]"]
        assert first[f"accelerance tenth, {part} [1/kg]"] == pytest.approx(expected, rel=1e-12)
    assert head.endswith('"strain_x tenth, imaginary [1/N]"') and not {"", "nan"} & set(rows[0].split(","))
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert main(["spectrum", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found["accelerance"]) == {"struck point", "tenth"} and len(found["force"]) == 1000
    assert set(found["strain_x"]) == {"tenth"} and len(found["strain_x"]["tenth"]) == 1000
    assert main(["spectrum", str(path), "--highest", "5 N"]) == 3 and "--highest: " in capsys.readouterr().err


def test_refusals():
    history = fm.simulate(ball(fm.Contact("hertz")))
    with pytest.raises(ValueError, match="ascends from more than 0 Hz"):
        history.spectrum([0.0, 1.0])
