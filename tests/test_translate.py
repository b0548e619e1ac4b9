"""Contact laws of other engines: exact values of their formulas, the march, and the fits."""

import json
import math

import numpy as np
import pytest
from cases import BALL, STEEL

import film_model as fm
from film_model.cli.main import main
from film_model.translate import ENGINES, contact_for, engine_named
from film_model.translate.adams import step
from film_model.translate.drake import dissipation_for
from film_model.translate.fit import pair_of
from film_model.translate.law import Middle
from film_model.translate.march import march
from film_model.translate.mujoco import IMPEDANCE, impedance

SPEEDS = np.geomspace(0.05, 5.0, 5)
LAWS = [(engine, law) for engine in ENGINES.values() for law in engine.laws]
NAMES = [f"{engine.name}-{law.name}" for engine, law in LAWS]


def scene(law="hertz", target=None, **contact):
    target = target or fm.HalfSpace(material=STEEL)
    return fm.Scene(fm.Sphere(velocity="0.5 m/s", **BALL), target, contact=fm.Contact(law=law, **contact))


PAIR = pair_of(scene(), 0.5, 2e-5)
MODULUS = scene().effective_modulus
MIDDLE = Middle(velocity=0.5, force=1e3, duration=1e-4, restitution=0.8, depth=2e-5)


def law_of(engine, name):
    return ENGINES[engine].law(name)


def damped(engine, name, restitution):
    """Impacts of a law that is given by a modulus, or a stiffness, and a restitution."""
    values = {"youngs_modulus": PAIR.youngs_modulus(MODULUS), "k_n": 8e7, "restitution": restitution}
    return march(law_of(engine, name), PAIR, values, SPEEDS)


def test_undamped_hertz_is_the_closed_form():
    found = damped("chrono", "hertz", 1.0)
    k = 4 / 3 * MODULUS * math.sqrt(PAIR.radius)
    depth = (1.25 * PAIR.mass * SPEEDS**2 / k) ** 0.4
    beta = math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
    np.testing.assert_allclose(found.force, k * depth**1.5, rtol=2e-5)
    np.testing.assert_allclose(found.depth, depth, rtol=2e-5)
    np.testing.assert_allclose(found.duration, 2 * beta * depth / SPEEDS, rtol=2e-4)
    np.testing.assert_allclose(found.restitution, 1.0, rtol=2e-5)


@pytest.mark.parametrize(("engine", "name"), [("lammps", "hertz"), ("lammps", "hooke"), ("liggghts", "hertz")])
@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.95])
def test_damping_by_restitution_gives_that_restitution(engine, name, restitution):
    """Exactly, at every velocity, where the engine keeps the attraction at the end of contact."""
    np.testing.assert_allclose(damped(engine, name, restitution).restitution, restitution, rtol=3e-4)


def test_a_cut_off_linear_contact_ends_where_the_force_does():
    """Schwager & Pöschel 2007: it lasts (π − 2 atan(β/ω))/ω, and the restitution is exp(−β t)."""
    k, c, m = 8e7, 900.0, PAIR.mass
    found = march(law_of("yade", "viscoelastic"), PAIR, {"kn": k, "cn": c}, SPEEDS)
    beta = c / (2 * m)
    omega = math.sqrt(k / m - beta**2)
    duration = math.atan2(2 * beta * omega, beta**2 - omega**2) / omega
    np.testing.assert_allclose(found.duration, duration, rtol=1e-5)
    np.testing.assert_allclose(found.restitution, math.exp(-beta * duration), rtol=1e-5)


@pytest.mark.parametrize("name", ["point", "hydroelastic"])
@pytest.mark.parametrize("restitution", [0.2, 0.7, 0.99])
def test_dissipation_of_hunt_and_crossley_gives_the_restitution(name, restitution):
    values = {"stiffness": 8e7, "hydroelastic_modulus": 1e12}
    for speed in (0.1, 2.0):
        dissipation = dissipation_for(restitution, speed)
        found = march(law_of("drake", name), PAIR, {**values, "dissipation": dissipation}, np.array([speed]))
        assert found.restitution[0] == pytest.approx(restitution, rel=2e-4)


def test_hydroelastic_force_is_the_integral_of_the_pressure():
    depth, modulus, radius = 2e-3, 3e6, PAIR.ball_radius
    h = radius - depth
    exact = 2 * math.pi * modulus * ((radius**2 - h**2) / 2 - (radius**3 - h**3) / (3 * radius))
    values = {"hydroelastic_modulus": modulus, "dissipation": 0.0}
    assert law_of("drake", "hydroelastic").force(PAIR, values, depth, 0.0) == pytest.approx(exact, rel=1e-12)


def test_impact_of_adams_is_the_formula_of_the_manual():
    """IMPACT at x = x1 − δ, x' = −δ': k (x1 − x)^e − cmax STEP(x, x1 − d, 1, x1, 0) x'."""
    k, e, c, d = 1e8, 1.3, 50.0, 1e-5
    values = {"k": k, "e": e, "cmax": c, "d": d}
    for depth, rate in ((0.4e-5, 0.3), (2e-5, -0.2)):
        u = min(max((1.0 - depth - (1.0 - d)) / d, 0.0), 1.0)
        fading = 1.0 + (0.0 - 1.0) * u * u * (3.0 - 2.0 * u)
        force = law_of("adams", "impact").force(PAIR, values, depth, rate)
        assert force == pytest.approx(k * depth**e - c * fading * -rate, rel=1e-6)
    assert step(0.0, d) == 0.0 and step(d / 2, d) == 0.5 and step(2 * d, d) == 1.0


def test_impedance_of_mujoco_is_continuous_and_has_the_given_ends():
    values = {"d0": 0.2, "width": 1e-4, "midpoint": 0.3, "power": 3.0}
    assert impedance(values, 0.0) == 0.2
    assert impedance(values, 1e-4) == impedance(values, 1.0) == IMPEDANCE
    half = 0.2 + (IMPEDANCE - 0.2) * 0.3  # y(midpoint) = midpoint
    for near in (0.3e-4 - 1e-12, 0.3e-4 + 1e-12):
        assert impedance(values, near) == pytest.approx(half, rel=1e-6)


@pytest.mark.parametrize(("engine", "law"), LAWS, ids=NAMES)
def test_every_law_keeps_the_contract(engine, law):
    start = law.start(PAIR, MIDDLE)
    assert set(start) == {p.name for p in law.parameters}
    for p in law.parameters:
        size = MIDDLE.depth if p.per_depth else 1.0
        assert p.low * size <= start[p.name] <= p.high * size and p.meaning
    zero, one = (law.force(PAIR, start, np.array([0.0, depth]), np.array([0.0, 0.0])) for depth in (0.0, 1e-5))
    assert (zero == 0.0).all() and one[1] > 0.0
    assert law.formula and law.source
    text = law.paste(PAIR, start)
    assert "nan" not in text and "inf" not in text.replace("infinite", "")
    impacts = march(law, PAIR, start, np.array([0.5]))
    assert impacts.force[0] == pytest.approx(1e3, rel=0.9)
    assert 0.4 < impacts.restitution[0] < 1.0


@pytest.mark.slow
def test_a_law_that_an_engine_has_is_found_exactly():
    speeds = ("0.1 m/s", "2 m/s")
    hertz = contact_for(ENGINES["chrono"], scene("hertz"), speeds, law="hertz", count=3)[0]
    assert hertz.values["youngs_modulus"] == pytest.approx(PAIR.youngs_modulus(MODULUS), rel=1e-4)
    assert hertz.values["restitution"] == pytest.approx(1.0, abs=1e-4)
    assert hertz.rms < 2e-4


def test_a_damped_law_that_an_engine_has_is_found_exactly():
    speeds = ("0.1 m/s", "2 m/s")
    tsuji = contact_for(ENGINES["yade"], scene("tsuji", restitution=0.6), speeds, law="mindlin", count=3)[0]
    assert tsuji.rms < 2e-4


def test_restitution_over_velocity_is_compared_impact_by_impact():
    made = contact_for(ENGINES["lammps"], scene("stronge"), (0.1, 2), law="hertz", count=4)[0]
    columns = (made.velocities, made.wanted["force"], made.wanted["restitution"])
    for speed, force, restitution in np.transpose(columns).tolist():
        changes = {"impactor.velocity": f"{speed!r} m/s", "effects.gravity": False}
        history = fm.simulate(scene("stronge").replace(changes))
        assert history.summary["maximum_force"] == pytest.approx(force, rel=2e-4)
        assert history.summary["coefficient_of_restitution"] == pytest.approx(restitution, rel=2e-4)
    again = march(made.law, made.pair, made.values, made.velocities)
    relative = again.restitution / made.wanted["restitution"] - 1
    error = made.errors["restitution"]
    assert error.rms == pytest.approx(math.sqrt(np.mean(relative**2)))
    assert abs(error.worst) == abs(relative).max() and error.velocity in made.velocities


def test_the_fit_is_a_minimum():
    made = contact_for(ENGINES["drake"], scene("stronge"), (0.1, 2), law="point", count=4)[0]

    def squares(values):
        found = march(made.law, made.pair, values, made.velocities)
        return sum(((getattr(found, name) / made.wanted[name] - 1) ** 2).sum() for name in made.wanted)

    least = squares(made.values)
    for name, value in made.values.items():
        for factor in (0.97, 1.03):
            assert squares({**made.values, name: factor * value}) > least


def test_free_bodies_use_effective_mass_and_radius():
    ball = fm.Body(radius="10 mm", mass="60.74 g", material=STEEL)
    made = contact_for(ENGINES["lammps"], scene("hertz", ball), (0.1, 1), law="hertz", count=3)[0]
    assert made.pair.mass == pytest.approx(0.03037) and made.pair.radius == pytest.approx(0.005)
    assert made.values["youngs_modulus"] == pytest.approx(PAIR.youngs_modulus(MODULUS), rel=1e-4)
    assert "pair_coeff * * hertz/material" in made.paste()
    assert "freejoint" in ENGINES["mujoco"].laws[0].paste(made.pair, ENGINES["mujoco"].laws[0].start(made.pair, MIDDLE))


def test_the_range_is_half_to_twice_the_velocity_of_a_fall():
    dropped = scene().replace({"impactor.velocity": None, "impactor.drop_height": "20 mm"})
    made = contact_for(ENGINES["yade"], dropped, law="mindlin", count=2)[0]
    speed = math.sqrt(2 * 9.80665 * 0.02)
    assert made.velocities.tolist() == pytest.approx([0.5 * speed, 2 * speed])
    assert made.rms < 2e-4


@pytest.mark.parametrize(
    ("changes", "velocity", "said"),
    [
        ({}, (2, 1), "must not fall"),
        ({}, (0, 1), "must begin above 0"),
        ({}, (1, 3e4), "must end by 20000 m/s"),
        ({}, ("1 kg", 2), "is a mass"),
        ({"impactor.velocity": "0 m/s"}, (), "give a range"),
    ],
)
def test_bad_ranges_are_refused(changes, velocity, said):
    with pytest.raises(ValueError, match=said):
        contact_for(ENGINES["adams"], scene().replace(changes), velocity)


def test_unknown_names_are_answered_with_the_list():
    with pytest.raises(ValueError, match=r'unknown engine "mujocco": choose mujoco, drake, .*did you mean "mujoco"'):
        engine_named("mujocco")
    with pytest.raises(ValueError, match='Drake has no law "hertz" here: choose point or sap or hydroelastic'):
        contact_for(ENGINES["drake"], scene(), (1, 2), law="hertz")


@pytest.mark.slow
def test_a_vibrating_target_is_refused():
    plate = fm.Plate(thickness="2 mm", size=("100 mm", "100 mm"), material=STEEL)
    with pytest.raises(fm.SimulationError, match="the target vibrates between its edges"):
        contact_for(ENGINES["adams"], scene("hertz", plate), (0.1, 1))


def test_an_impact_without_a_rebound_is_refused():
    rod = fm.Rod(diameter="1 mm", material=STEEL)
    with pytest.raises(fm.SimulationError, match=r"at 0\.1 m/s: the coefficient of restitution is .*, below 0\.05"):
        contact_for(ENGINES["adams"], scene("hertz", rod), (0.1, 1))


def test_energy_that_a_moving_target_takes_is_said():
    plate = fm.Plate(thickness="20 mm", material=STEEL)
    made = contact_for(ENGINES["yade"], scene("hertz", plate), (0.1, 1), law="mindlin", count=2)[0]
    assert any("the energy that it takes" in warning for warning in made.warnings)


@pytest.mark.slow
def test_command_line(capsys, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(scene().to_toml(), encoding="utf-8")
    command = ["contact-for", "yade", str(file), "--velocity", "0.1..2", "--count", "2"]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "Yade, law mindlin" in out and "betan" in out and "restitution" in out
    assert "Law2_ScGeom_MindlinPhys_Mindlin" in out and "viscoelastic" in out
    assert main([*command, "--json", "--law", "viscoelastic"]) == 0
    (law,) = json.loads(capsys.readouterr().out)["laws"]
    assert law["parameters"]["kn"]["units"] == "N/m" and len(law["velocities"]) == 2
    assert law["errors"]["force"]["rms"] > 0.1
    assert main(["contact-for", "havok", str(file)]) == 3
    assert "choose mujoco, drake" in capsys.readouterr().err
    assert main(["contact-for", "yade", str(file), "--velocity", "fast"]) == 3
    assert capsys.readouterr().err.startswith("velocity: ")


@pytest.mark.slow
def test_picture(tmp_path):
    pytest.importorskip("matplotlib")
    from film_model.plot.engines import plot_translation

    made = contact_for(ENGINES["adams"], scene("stronge"), (0.1, 2), count=3)[0]
    figure = plot_translation(scene("stronge"), made, tmp_path / "adams.svg")
    assert len(figure.axes) == 5
    assert "Adams, law impact" in (tmp_path / "adams.svg").read_text(encoding="utf-8")
