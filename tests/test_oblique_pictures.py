"""Pictures of oblique impacts: the friction force between its limits, and the ball as a strobe sees it."""

import itertools
import math

import numpy as np
import pytest

import film_model as fm
from film_model.cli.main import main
from film_model.plot.history import friction_over_time
from film_model.plot.strobe import SPACING, flashes, paths
from film_model.solve.simulate import simulate_quietly

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}


def slanted(angle="40 deg", mu=0.2, **ball):
    sphere = fm.Sphere("5 mm", "3 m/s", material=STEEL, angle=angle, **ball)
    return fm.Scene(sphere, fm.HalfSpace(STEEL), fm.Contact("hertz", friction=mu), fm.Effects(gravity=False))


def test_friction_stays_between_its_limits():
    history = fm.simulate(slanted("20 deg"))
    time, force, limit = friction_over_time(history)
    assert (np.diff(time) >= 0.0).all() and time[-1] == pytest.approx(history.duration, rel=1e-5)
    assert (np.abs(force) <= limit + 1e-6 * limit.max()).all()
    assert limit.max() == pytest.approx(0.2 * history.summary["maximum_force"], rel=1e-3)
    assert friction_over_time(fm.simulate(slanted("0 deg"))) is None


def test_the_ball_moves_and_turns_as_the_results_say():
    history = fm.simulate(slanted(spin="-900 rpm"))
    interval, seen = flashes(history)
    middle = len(seen) // 2
    assert (seen[middle].x, seen[middle].z, seen[middle].turn) == (0.0, 0.005, 0.0)
    first, last = seen[middle - 1], seen[middle + 1]
    found = history.oblique.summary
    assert (last.x / interval, last.turn / interval) == pytest.approx(
        (found["tangential_rebound_velocity"], found["rebound_spin"]), rel=1e-12
    )
    assert (last.z - 0.005) / interval == pytest.approx(-history.summary["rebound_velocity"], rel=1e-12)
    assert first.x == pytest.approx(-3.0 * math.sin(math.radians(40.0)) * interval, rel=1e-12)
    assert first.turn == pytest.approx(30.0 * math.pi * interval, rel=1e-12)
    apart = [math.hypot(b.x - a.x, b.z - a.z) for a, b in itertools.pairwise(seen)]
    assert max(apart) == pytest.approx(SPACING * 0.005, rel=1e-12)


def test_an_impact_without_friction_or_without_rebound_has_no_strobe_picture(tmp_path, capsys):
    normal = fm.simulate(slanted("0 deg", mu=None))
    assert [path.along for path in paths(normal)] == [0.0, 0.0]
    with pytest.raises(ValueError, match="needs friction in"):
        paths(fm.simulate(slanted(mu=None)))
    sheet = fm.Plate(STEEL, thickness="0.1 mm")
    laid = fm.Scene(fm.Sphere("50 mm", "1 mm/s", material=STEEL), sheet, fm.Contact("hertz"), fm.Effects(gravity=True))
    with pytest.raises(ValueError, match="contact does not end"):
        paths(simulate_quietly(laid))
    path = tmp_path / "slanted.toml"
    path.write_text(slanted().to_toml(), encoding="utf-8")
    assert main(["run", str(path), "--strobe", str(tmp_path / "strobe.svg")]) == 0
    assert "<svg" in (tmp_path / "strobe.svg").read_text("utf-8")
    assert main(["run", str(path), "--strobe", str(tmp_path / "strobe.svg")]) != 0
    assert "--force" in capsys.readouterr().err
