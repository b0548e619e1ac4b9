"""All bounces of a ball: against closed forms, single impacts and balances of energy; the command and its files."""

from __future__ import annotations

import itertools
import json
import math
import warnings

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.bounce_dataset import bounces_of
from film_model.cli.main import main
from film_model.effects.choose import choose
from film_model.problem.summary import SUMMARY
from film_model.solve import bounce as module
from film_model.solve.bounce import COLUMNS

G = 9.80665
BALL = fm.Sphere(radius="5 mm", drop_height="20 mm", material="bearing steel")
SLAB = fm.HalfSpace("mild steel")
SPRINGY = fm.Contact("tsuji", restitution=0.8)
SLOW = fm.Sphere(radius="10 um", velocity="1 mm/s", material="glass")
FILE = (
    'title = "Steel ball"\n[impactor]\nradius = "5 mm"\ndrop_height = "20 mm"\nmaterial = "bearing steel"\n[target]\n'
    'kind = "plate"\nthickness = "12 mm"\nmaterial = "mild steel"\n[contact]\nlaw = "tsuji"\nrestitution = 0.8\n'
)


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fm.ImpactWarning)
        yield


def test_constant_restitution_gives_a_geometric_series():
    """The weight changes the restitution by about the time of contact over that of the flight."""
    bounces = fm.bounce(fm.Scene(BALL, SLAB, SPRINGY), resolution="1 um")
    fall, heights, touched = 0.02, bounces.height.m, bounces.time.m
    pressed = G * bounces.contact_duration.m / bounces.velocity_before.m
    restitution = -bounces.velocity_after.m / bounces.velocity_before.m
    assert (np.abs(restitution - 0.8) < 0.8 * pressed).all() and pressed[0] < 1e-3
    series = fall * 0.8 ** (2 * np.arange(1, heights.size + 1))
    assert (np.abs(np.log(heights / series)) < 2.0 * np.cumsum(pressed)).all()
    count = len(bounces.bounces)
    assert count == pytest.approx(math.log(1e-6 / fall) / (2 * math.log(0.8)), abs=1.0)
    assert heights[-1] < 1e-6 < heights[-2] and bounces.rest_time == touched[-1]
    total = math.sqrt(2 * fall / G) * (1 + 2 * sum(0.8**k for k in range(1, count)))
    assert touched[-1] == pytest.approx(total, rel=2e-3)


def test_flights_are_in_closed_form():
    """A damped contact ends before the surface is back: the next one begins higher, and the flight is shorter."""
    bounces = fm.bounce(fm.Scene(BALL, SLAB, SPRINGY), accuracy=1e-8)
    whole = bounces.bounces[:-1]
    for before, after in itertools.pairwise(whole):
        ends = before.time + before.contact_duration
        assert after.time - ends == pytest.approx((after.velocity_before - before.velocity_after) / G, rel=1e-9)
        assert 0.0 < before.velocity_after**2 - after.velocity_before**2 < 2.0 * G * 2e-6
        assert before.height == before.velocity_after**2 / (2.0 * G)


@pytest.mark.parametrize("target", [SLAB, fm.Plate("mild steel", thickness="12 mm")], ids=["half-space", "plate"])
def test_each_bounce_is_a_single_impact(target):
    """Under a law without memory: the same as `simulate` at the velocity of that bounce, from first to last."""
    scene = fm.Scene(BALL, target, SPRINGY if target is SLAB else fm.Contact("hertz"))
    bounces = fm.bounce(scene, accuracy=1e-6)
    for bounce in (*bounces.bounces[:2], bounces.bounces[len(bounces.bounces) // 2], bounces.bounces[-2]):
        alone = bounces.scene.replace(
            {"impactor.drop_height": None, "impactor.velocity": f"{bounce.velocity_before} m/s"}
        )
        single = fm.simulate(alone, accuracy=1e-8).summary
        assert bounce.velocity_after == pytest.approx(single["rebound_velocity"], rel=2e-5)
        assert bounce.maximum_force == pytest.approx(single["maximum_force"], rel=2e-5)
        assert bounce.contact_duration == pytest.approx(single["contact_duration"], rel=2e-5)


def test_the_dent_stays_and_energy_is_balanced():
    """The first impact leaves the dent of `simulate`; its losses are what was absorbed and radiated."""
    bounces = fm.bounce(fm.Scene(BALL, fm.Plate("mild steel", thickness="12 mm")), accuracy=1e-7)
    first, *others = bounces.bounces
    single = fm.simulate(bounces.scene, accuracy=1e-7).summary
    assert first.permanent_indentation == pytest.approx(single["permanent_indentation"], rel=1e-6)
    mass = bounces.scene.mass
    kinetic = 0.5 * mass * (first.velocity_before**2 - first.velocity_after**2)
    displaced = single["impulse"] / bounces.scene.target_impedance
    pushed = mass * G * (first.permanent_indentation + displaced)
    assert kinetic + pushed == pytest.approx(single["energy_absorbed"] + single["energy_radiated"], rel=1e-6)
    assert {bounce.permanent_indentation for bounce in others} == {first.permanent_indentation}
    assert all(0.9 < bounce.restitution < 1.0 for bounce in others) and first.restitution < 0.9
    assert "at rest after" in bounces.outcome


def test_an_infinite_plate_moves_even_where_the_first_impact_does_not_need_it():
    scene = fm.Scene(fm.Sphere("5 mm", drop_height="0.5 m", material="bearing steel"), fm.Plate("mild steel", "60 mm"))
    assert not choose(scene).decided[1]
    bounces = fm.bounce(scene, resolution="0.1 mm")
    assert bounces.scene.effects.target_motion is True and bounces.rest_time is not None
    fixed = fm.bounce(scene.replace({"effects.target_motion": False}))
    assert fixed.rest_time is None and len(fixed.bounces) == 2


def test_waves_in_a_half_space_bring_the_ball_to_rest_even_where_the_first_impact_does_not_need_them():
    """Their share at the velocity V' of a bounce, known from one impact at V', is (V/V')^{2/5} times that simulated."""
    scene = fm.Scene(BALL, SLAB, fm.Contact(yield_strength="1e5 MPa"))
    assert choose(scene).problem.gamma == 0.0
    bounces = fm.bounce(scene, resolution="0.1 mm")
    assert bounces.scene.effects.wave_losses is True and bounces.rest_time is not None
    last = bounces.bounces[-1]
    speed = last.velocity_before
    one = fm.simulate(scene.replace({"impactor.drop_height": f"{0.5 * speed**2 / G} m", "effects.wave_losses": True}))
    own = 1.0 - one.summary["coefficient_of_restitution"] ** 2
    ratio = (bounces.bounces[0].velocity_before / speed) ** 0.4
    assert 1.0 - last.restitution**2 == pytest.approx(own * ratio, rel=0.02)
    assert fm.bounce(scene.replace({"effects.wave_losses": False})).rest_time is None


def test_a_law_without_losses_never_comes_to_rest():
    """The warning has the restitution that the waves leave, by the effect that `explain` judges."""
    scene = fm.Scene(BALL, SLAB, fm.Contact("hertz"))
    with pytest.warns(fm.ImpactWarning, match="never comes to rest: from contact 1 on"):
        bounces = fm.bounce(scene)
    assert bounces.rest_time is None and len(bounces.bounces) == 1
    waves = next(effect for effect in choose(bounces.scene).effects if effect.name == "wave_losses")
    assert f"leave a restitution of about {math.sqrt(1.0 - waves.change):.4g}" in bounces.warnings[-1]
    dented = fm.bounce(fm.Scene(BALL, SLAB, fm.Contact("elastoplastic")))
    assert dented.outcome == "never comes to rest: from contact 2 on the law loses no energy"
    assert dented.bounces[1].restitution == pytest.approx(1.0, abs=1e-9)


def test_a_force_that_returns_while_the_ball_rises_is_no_other_contact():
    """It still is in the dent of a contact whose force fell to 0 on the way out."""
    soft = {"youngs_modulus": "5 MPa", "poissons_ratio": 0.49, "density": "1100 kg/m^3"}
    ball, contact = fm.Sphere("10 mm", "0.5 m/s", material=soft), fm.Contact("kuwabara-kono", dissipation_time="140 us")
    bounces = fm.bounce(fm.Scene(ball, fm.HalfSpace("mild steel"), contact))
    assert (np.diff(bounces.velocity_before.m) < 0.0).all() and bounces.velocity_before.m[-1] > 0.01
    assert "stays on the target from contact 10 on" in bounces.outcome  # an eleventh began at -1.7 mm/s
    assert bounces.rest_time == bounces.time.m[-1] and bounces.bounces[-1].contact_duration is None


def test_adhesion_holds_the_ball():
    glass = fm.HalfSpace("glass")
    law = fm.Contact("jkr", work_of_adhesion="0.1 J/m^2")
    bounces = fm.bounce(fm.Scene(SLOW, glass, law))
    (only,) = bounces.bounces
    assert only.velocity_after == only.height == 0.0 and only.contact_duration is None
    assert bounces.rest_time == only.time == 0.0 and "stays on the target from contact 1 on" in bounces.outcome
    assert np.isnan(bounces.contact_duration.m).all()
    faster = fm.bounce(fm.Scene(fm.Sphere("10 um", "0.1 m/s", material="glass"), glass, law))
    assert len(faster.bounces) > 1 and "stays on the target" in faster.outcome


def test_a_plate_with_edges_throws_the_ball_up_again():
    """On a thin pane the contacts of one impact follow each other: a low one among them is not rest."""
    pane = fm.Plate("glass", thickness="2 mm", size=["100 mm", "100 mm"])
    bounces = fm.bounce(fm.Scene(BALL, pane), resolution="1 mm")
    assert choose(bounces.scene).problem.vibrates
    force = fm.simulate(bounces.scene).maximum_force.m
    assert max(bounce.maximum_force for bounce in bounces.bounces[:3]) == pytest.approx(force, rel=1e-3)
    low = [bounce.height < 1e-3 for bounce in bounces.bounces]
    ends = low.index(True)
    assert not all(low[ends:]), "a low bounce is followed by a higher one"
    assert bounces.rest_time is None or all(low[-10:])


def test_the_number_of_bounces_is_bounded(monkeypatch):
    monkeypatch.setattr(module, "MOST_BOUNCES", 3)
    bounces = fm.bounce(fm.Scene(BALL, SLAB, SPRINGY))
    assert len(bounces.bounces) == 3 and bounces.rest_time is None
    assert bounces.outcome.startswith("not at rest after 3 bounces") and bounces.outcome in bounces.warnings


def test_a_later_contact_that_fails_ends_the_series():
    soft = fm.Material("soft", "3 GPa", 0.35, "1000 kg/m^3", prony=[[0.3, "10 us"]])
    bounces = fm.bounce(fm.Scene(fm.Sphere("10 mm", "1 m/s", material=soft), SLAB))
    assert bounces.rest_time is None and "followed up to bounce" in bounces.outcome
    force = fm.simulate(bounces.scene).maximum_force.m
    assert bounces.bounces[0].maximum_force == pytest.approx(force, rel=1e-3)
    assert bounces.outcome in bounces.warnings


@pytest.mark.slow
def test_a_free_plate_moves_away():
    """Its first contact ends while the ball still moves in."""
    plate = fm.Plate("mild steel", thickness="1 mm", size=["60 mm", "60 mm"], edges="free")
    bounces = fm.bounce(fm.Scene(BALL, plate))
    first, second = bounces.bounces[:2]
    assert first.velocity_after > 0.0 == first.height and first.restitution < 0.0 < second.restitution
    assert second.time - first.time < 1e-3
    assert bounces.rest_time is None and "the target moves away" in bounces.outcome


@pytest.mark.parametrize(
    ("scene", "options", "error", "message"),
    [
        (
            fm.Scene(BALL, SLAB, effects=fm.Effects(gravity=False)),
            {},
            fm.SceneError,
            "without gravity no ball comes back",
        ),
        (fm.Scene(fm.Sphere("5 mm", "0 m/s", material="glass"), SLAB), {}, fm.SimulationError, "no velocity: give"),
        (fm.Scene(BALL, fm.Body("mild steel", radius="9 mm")), {}, fm.SimulationError, "free body as target cannot"),
        (fm.Scene(BALL, SLAB), {"resolution": "1 m"}, ValueError, "below the height of the fall, 0.02 m"),
        (fm.Scene(BALL, SLAB), {"resolution": 0.0}, ValueError, "must be above 0 m"),
        (fm.Scene(BALL, SLAB), {"resolution": "1 kg"}, ValueError, "a length is needed"),
        ("scene.toml", {}, TypeError, "takes a Scene"),
    ],
)
def test_bad_input(scene, options, error, message):
    with pytest.raises(error, match=message):
        fm.bounce(scene, **options)


@pytest.mark.slow
def test_the_command(tmp_path, capsys, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(FILE, encoding="utf-8")
    expected = fm.bounce(fm.Scene.from_toml("scene.toml"))
    assert main(["bounce", "scene.toml", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == expected.to_dict() == json.loads(json.dumps(printed, allow_nan=False))
    assert set(printed["bounces"][0]) == set(COLUMNS) >= {"time", "velocity_before", "velocity_after", "height"}
    assert main(["bounce", "scene.toml", "--output", "b.nc", "--plot", "b.png"]) == 0
    told = capsys.readouterr()
    assert expected.outcome in told.out and "more" in told.out and "wrote b.nc" in told.err
    assert main(["bounce", "scene.toml", "--verbose"]) == 0
    assert capsys.readouterr().out.count(" m/s") == 2 * len(expected.bounces)
    assert (tmp_path / "b.png").read_bytes().startswith(b"\x89PNG")
    assert main(["plot", "b.nc", "--output", "again.png"]) == 0
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert main(["bounce", "scene.toml", "--output", "b.csv"]) == 0
    rows = (tmp_path / "b.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("time [s],velocity_before [m/s]") and len(rows) == len(expected.bounces) + 1
    capsys.readouterr()
    assert main(["bounce", "scene.toml", "--output", "b.csv"]) == 3  # exists
    assert main(["bounce", "scene.toml", "--plot", "b.txt"]) == 3
    assert main(["bounce", "scene.toml", "--resolution", "1 m"]) == 3
    assert main(["check", "b.nc"]) == 0


def test_dataset_and_notebook():
    bounces = fm.bounce(fm.Scene(BALL, SLAB, SPRINGY))
    ds = bounces.to_dataset()
    assert fd.validate(ds) == [] and ds.film.kind == "impact_bounces" and ds.height.units == "m"
    assert ds.height.values.tolist() == bounces.height.m.tolist()
    assert ds.film.scene() == bounces.scene
    assert "<th>time</th>" in bounces._repr_html_() and repr(bounces).startswith("Bounces(tsuji: ")
    assert set(COLUMNS) & set(SUMMARY) == {"maximum_force", "contact_duration", "permanent_indentation"}


def test_the_picture_is_parabolas_of_the_heights():
    pytest.importorskip("matplotlib")
    from film_model.plot.bounces import PARABOLA, heights

    bounces = fm.bounce(fm.Scene(BALL, SLAB, SPRINGY))
    t, z = heights(bounces)
    flights = z.reshape(-1, PARABOLA)
    assert flights[0, 0] == pytest.approx(0.02) and flights[0, -1] == pytest.approx(0.0, abs=1e-12)
    assert flights[1:].max(axis=1) == pytest.approx(bounces.height.m, rel=1e-3, abs=1e-18)
    assert flights[1:-2, -1] == pytest.approx(0.0, abs=2e-6)
    assert (np.diff(t) >= 0.0).all()
    assert bounces.plot().axes[0].get_xlabel() == "time (ms)"


@pytest.mark.slow
def test_a_ball_with_spin_is_turned_at_every_bounce(tmp_path):
    """The first bounce is the impact's; the angular momentum about the contact, V − 2/5 R spin, stays at every one."""
    ball = fm.Sphere(radius="5 mm", drop_height="20 mm", material="bearing steel", spin="300 rad/s")
    scene = fm.Scene(ball, SLAB, fm.Contact("tsuji", restitution=0.8, friction=0.1))
    bounces = fm.bounce(scene, accuracy=1e-6)
    alone = fm.simulate(scene, accuracy=1e-6).oblique.summary
    first = bounces.bounces[0]
    assert first.spin == pytest.approx(alone["rebound_spin"], rel=1e-3)
    assert first.tangential_velocity == pytest.approx(alone["tangential_rebound_velocity"], rel=1e-3)
    ended = [bounce for bounce in bounces.bounces if bounce.spin is not None]
    assert len(ended) == len(bounces.bounces) - 1 > 5 and abs(ended[-1].spin) < abs(first.spin)
    momenta = [bounce.tangential_velocity - 0.4 * 0.005 * bounce.spin for bounce in ended]
    assert momenta == pytest.approx([-0.4 * 0.005 * 300.0] * len(momenta), rel=1e-9)
    ds = bounces.to_dataset()
    assert fd.validate(ds) == [] and ds.spin.values[0] == first.spin
    fd.write(ds, tmp_path / "spin.nc")
    assert bounces_of(fd.open(tmp_path / "spin.nc")).bounces == bounces.bounces


def test_models_of_friction_that_differ_are_said():
    """A contact that yields: the first impact under both models, as `simulate` says."""
    shot = fm.Sphere(diameter="1 mm", velocity="40 m/s", angle="45 deg", material="bearing steel")
    scene = fm.Scene(shot, fm.HalfSpace("aluminium 6061-T6"), fm.Contact(friction=0.3))
    assert any("two models give a sliding velocity" in sentence for sentence in fm.bounce(scene).warnings)
