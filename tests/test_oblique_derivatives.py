"""Derivatives of the results along the surface: closed forms, differences of impacts, springs, sides, JAX."""

import json
import math

import pytest

import film_model as fm
from film_model.cli.main import main

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
FRICTION, SPEED, RADIUS = 0.2, 3.0, 5e-3


def slanted(angle, friction=FRICTION, **ball):
    sphere = fm.Sphere(f"{RADIUS} m", f"{SPEED} m/s", material=STEEL, angle=angle, **ball)
    return fm.Scene(sphere, fm.HalfSpace(STEEL), fm.Contact("hertz", friction=friction), fm.Effects(gravity=False))


def test_of_a_contact_that_slides_throughout():
    """v₂ = v₁ + R ω − 7 µ V_n and R ω' = R ω − 5 µ V_n of an elastic solid ball; also by a spin of 0."""
    found = fm.simulate(slanted("75 deg", spin="0 rad/s"), derivatives=PATHS).derivatives
    angle = math.radians(75.0)
    exact = {
        ("contact_point_rebound_velocity", "impactor.angle"): SPEED * math.cos(angle)
        + 7.0 * FRICTION * SPEED * math.sin(angle),
        ("contact_point_rebound_velocity", "contact.friction"): -7.0 * SPEED * math.cos(angle),
        ("contact_point_rebound_velocity", "impactor.spin"): RADIUS,
        ("rebound_spin", "impactor.velocity"): -5.0 * FRICTION * math.cos(angle) / RADIUS,
        ("rebound_spin", "impactor.spin"): 1.0,
        ("tangential_restitution", "impactor.radius"): 0.0,
        ("maximum_force", "contact.friction"): 0.0,
    }
    for (name, path), expected in exact.items():
        value, error = found.values[name][path], found.errors[name][path]
        assert value == pytest.approx(expected, rel=1e-8, abs=1e-7), (name, path)
        assert error < 1e-6
    assert found.values["target_rebound_spin"]["impactor.radius"] is None
    assert found.of("rebound_spin", "impactor.velocity").check("1/[length]")


def test_without_friction_the_impact_number_has_none(tmp_path, capsys):
    path = tmp_path / "smooth.toml"
    path.write_text(slanted("30 deg", friction=0.0).to_toml(), encoding="utf-8")
    assert main(["run", str(path), "--derivatives", "contact.friction", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["derivatives"]
    assert found["impact_number"]["contact.friction"]["value"] is None
    steepest = -7.0 * SPEED * math.cos(math.radians(30.0))
    assert found["contact_point_rebound_velocity"]["contact.friction"]["value"] == pytest.approx(steepest, rel=1e-7)
    assert main(["run", str(path), "--derivatives", "contact.friction"]) == 0
    assert "0.0000 %" not in capsys.readouterr().out  # of a number that is 0


PATHS = ("impactor.angle", "contact.friction", "impactor.velocity", "impactor.radius", "impactor.spin")


@pytest.mark.parametrize("angle", ["10 deg", "40 deg"])
def test_of_a_contact_that_sticks_is_that_of_impacts_beside_and_of_springs(angle):
    """Wider differences of single impacts; by springs within the errors that both say."""
    scene, paths = slanted(angle), ("impactor.angle", "contact.friction")
    exact = fm.simulate(scene, derivatives=paths).derivatives
    springs = fm.simulate(slanted(angle, [["0 m/s", FRICTION], ["1 m/s", FRICTION]]), derivatives=paths[:1]).derivatives
    for name in ("contact_point_rebound_velocity", "friction_work", "maximum_friction_force"):
        for path, value in (("impactor.angle", scene.impactor.angle), ("contact.friction", FRICTION)):
            unit = " rad" if path == "impactor.angle" else ""
            ends = (scene.replace({path: f"{value * (1.0 + side)!r}{unit}"}) for side in (-0.02, -0.01, 0.01, 0.02))
            low, less, more, high = (fm.simulate(end, accuracy=1e-9).oblique.summary[name] for end in ends)
            beside = (low - 8.0 * less + 8.0 * more - high) / (0.12 * value)
            assert exact.values[name][path] == pytest.approx(beside, rel=1e-4, abs=1e-6), (name, path)
        one, other = (of.values[name]["impactor.angle"] for of in (exact, springs))
        assert springs.errors[name]["impactor.angle"] < 5e-3
        assert other == pytest.approx(one, rel=5e-3, abs=1e-3 * SPEED)


def test_of_a_law_that_yields_and_of_targets_that_vibrate():
    """v₁ − 3.5 µ (1 + e) V_n; none on targets that vibrate."""
    changes = {"contact.law": "elastoplastic", "target.material.yield_strength": "1 GPa"}
    scene = slanted("75 deg").replace(changes)
    history = fm.simulate(scene, derivatives=["contact.friction"])
    restitution = history.summary["coefficient_of_restitution"]
    exact = -3.5 * (1.0 + restitution) * SPEED * math.cos(math.radians(75.0))
    found = history.derivatives
    assert found.values["contact_point_rebound_velocity"]["contact.friction"] == pytest.approx(exact, rel=2e-5)
    beam = fm.Beam(STEEL, length="200 mm", width="20 mm", thickness="5 mm", position="90 mm")
    shaken = fm.simulate(
        fm.Scene(scene.impactor, beam, fm.Contact("hertz", friction=FRICTION)), derivatives=["impactor.angle"]
    )
    assert shaken.derivatives.values["rebound_angle"]["impactor.angle"] is None
    assert any("no derivatives along the surface" in said for said in shaken.derivatives.warnings)


def test_where_the_contact_slides_otherwise_beside(capsys, tmp_path):
    """ψ₁ = 1: one-sided; and the command prints them."""
    limit = math.atan(FRICTION * 1.7 / (2.0 * 0.7))
    found = fm.simulate(slanted(f"{limit * 1.0001!r} rad"), derivatives=["impactor.angle"]).derivatives
    assert any("along the surface by impactor.angle are for larger values" in said for said in found.warnings)
    assert found.values["rebound_angle"]["impactor.angle"] is not None
    (tmp_path / "scene.toml").write_text(slanted("30 deg").to_toml(), encoding="utf-8")
    command = ["run", str(tmp_path / "scene.toml"), "--derivatives", "impactor.angle"]
    assert main(command) == 0 and "rebound angle" in capsys.readouterr().out.partition("derivatives by")[2]
    assert main([*command, "--json"]) == 0
    assert "impactor.angle" in json.loads(capsys.readouterr().out)["derivatives"]["rebound_spin"]
