"""Derivatives of the summary: closed forms, extended precision, kinks, and what is refused."""

import math

import numpy as np
import pytest
from cases import DAMPED, EFFECTIVE_MODULUS, LAWS, MASS, RADIUS, VELOCITY, YIELD, scene, zener_scene

import film_datasets as fd
import film_model as fm
from film_model.base.units import quotient_unit
from film_model.effects.choose import choose
from film_model.effects.decided import decisions_of
from film_model.laws.yielding import yield_velocity
from film_model.solve.chain import chain_rule
from film_model.solve.derivatives import entries_of, pairs_of
from film_model.solve.slopes import SMOOTH, TARGET, Slopes, differences
from film_model.studies import high_precision

EXACT = 1e-8


def ball(law, velocity="0.25 m/s", **parameters):
    contact = fm.Contact(law, effective_modulus=f"{EFFECTIVE_MODULUS!r} Pa", yield_strength="1 GPa", **parameters)
    return fm.Scene(fm.Sphere("10 mm", velocity, mass="60.74 g"), fm.HalfSpace(), contact, fm.Effects(gravity=False))


def relative(history, name, path):
    """(x/y) dy/dx."""
    found = history.derivatives
    return found.values[name][path] * found.entries[path].value / history.summary[name]


def test_hertz_impacts_have_the_exponents_of_their_closed_forms():
    exponents = {  # of m, V, E*, R: δ_m = (15 m V²/(16 E* √R))^(2/5), T = 2.943 δ_m/V, F_m = 4/3 E* √R δ_m^(3/2)
        "maximum_indentation": (0.4, 0.8, -0.4, -0.2),
        "contact_duration": (0.4, -0.2, -0.4, -0.2),
        "time_of_maximum_indentation": (0.4, -0.2, -0.4, -0.2),
        "maximum_force": (0.6, 1.2, 0.4, 0.2),
        "impulse": (1.0, 1.0, 0.0, 0.0),
        "coefficient_of_restitution": (0.0, 0.0, 0.0, 0.0),
        "peak_pressure": (0.2, 0.4, 0.8, -0.6),
    }
    paths = ["impactor.mass", "impactor.velocity", "contact.effective_modulus", "impactor.radius"]
    history = fm.simulate(ball("hertz"), accuracy=1e-10, derivatives=paths)
    for name, wanted in exponents.items():
        found = [relative(history, name, path) for path in paths]
        assert found == pytest.approx(wanted, abs=EXACT), name
    assert history.derivatives.warnings == ()


@pytest.mark.parametrize("name", [name for name in LAWS if name not in DAMPED])
def test_maximum_indentation_follows_from_the_balance_of_energy(name):
    """W(δ_m) = ½ m V², so F(δ_m) dδ_m = m V dV, under every law without damping."""
    history = fm.simulate(scene(name), derivatives=["impactor.velocity"], accuracy=1e-10)
    problem = history.problem
    depth, slope = history.summary["maximum_indentation"], history.derivatives.values["maximum_indentation"]
    force = problem.curve.force(depth / problem.scales.length) * problem.scales.force
    assert slope["impactor.velocity"] * force == pytest.approx(problem.mass * VELOCITY, rel=EXACT)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "impedance"),
    [
        (LAWS["hertz"], 2000.0),
        (LAWS["big-alabo"], 3000.0),
        (LAWS["big-alabo"], math.inf),
    ],
)
def test_derivatives_agree_with_extended_precision(law, impedance):
    """Sixth-order differences, with another step, of impacts in 30 digits that share no code with the core."""
    step, weights = 2e-3, np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
    runs = [high_precision.impact(law, MASS, VELOCITY * (1.0 + k * step), impedance) for k in range(-3, 4)]
    target = fm.HalfSpace()
    if math.isfinite(impedance):
        area, density = 1e-4, impedance**2 / (1e-8 * 1e11)
        target = fm.Rod(fm.Material("bar", "100 GPa", 0.3, f"{density!r} kg/m^3"), area=f"{area} m^2")
    one = fm.Scene(
        fm.Sphere("10 mm", "0.25 m/s", mass=f"{MASS} kg"),
        target,
        fm.Contact(law),
        fm.Effects(gravity=False, target_motion=math.isfinite(impedance)),
    )
    history = fm.simulate(one, derivatives=["impactor.velocity"])
    for name, value in runs[3].items():
        if math.isnan(value) or (name == "permanent_indentation" and value == 0.0):
            continue
        exact = sum(w * run[name] for w, run in zip(weights, runs, strict=True)) / (step * VELOCITY)
        scale = max(abs(exact), abs(value) / VELOCITY)
        assert history.derivatives.values[name]["impactor.velocity"] == pytest.approx(exact, abs=EXACT * scale), name
        assert history.derivatives.errors[name]["impactor.velocity"] < EXACT


def test_a_stage_that_is_just_reached_gives_one_sided_derivatives():
    limit = yield_velocity(EFFECTIVE_MODULUS, RADIUS, YIELD, 0.06074)
    for factor, word, exponent in ((1.0 - 1e-5, "smaller", 0.8), (1.0 + 1e-5, "larger", None)):
        one = ball("stronge", f"{factor * limit!r} m/s")
        history = fm.simulate(one, accuracy=1e-9, derivatives=["impactor.velocity"])
        said = history.derivatives.warnings[-1]
        assert f"for {word} values: contact reaches another stage" in said
        assert said in history.warnings
        power = relative(history, "maximum_indentation", "impactor.velocity")
        energy = one.mass * (factor * limit) ** 2 / history.summary["maximum_force"]
        assert power == pytest.approx(exponent or energy / history.summary["maximum_indentation"], rel=1e-7)


def test_given_segments_give_the_derivative_of_their_own_result():
    one = ball("stronge").replace({"solver.segments": 5})
    history = fm.simulate(one, derivatives=["impactor.velocity"])
    low, high = (
        fm.simulate(one.replace({"impactor.velocity": f"{v!r} m/s"})).summary["contact_duration"]
        for v in (0.25 * (1.0 - 1e-4), 0.25 * (1.0 + 1e-4))
    )
    found = history.derivatives
    assert found.values["contact_duration"]["impactor.velocity"] == pytest.approx((high - low) / 5e-5, rel=1e-6)
    assert found.errors["contact_duration"]["impactor.velocity"] > 1e-6
    assert "estimated relative error up to" in found.warnings[0]


def test_a_kink_at_the_impact_itself_has_no_derivative():
    steel = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3", "500 MPa")  # of two alike, the softer one yields
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material=steel), fm.HalfSpace(steel), fm.Contact("stronge"))
    history = fm.simulate(one, derivatives=["target.material.yield_strength", "impactor.velocity"])
    found = history.derivatives
    assert found.values["maximum_force"]["target.material.yield_strength"] is None
    assert found.values["maximum_force"]["impactor.velocity"] > 0.0
    (said,) = found.warnings
    assert "there is a kink or jump within 0.2 % of 5e+08 Pa" in said
    assert "maximum force" in said


def test_the_end_of_a_range_gives_a_one_sided_derivative():
    one = fm.Scene(
        fm.Sphere("10 mm", "0.1 m/s", mass="30 g", angle="0 deg"),
        fm.HalfSpace(),
        fm.Contact("meyer", stiffness="1e9 N/m^1.5", exponent=1.5),
    )
    history = fm.simulate(one, derivatives=["impactor.angle"])
    assert history.derivatives.values["maximum_force"]["impactor.angle"] == pytest.approx(0.0, abs=1e-6)
    assert "the stencil leaves the range" in history.derivatives.warnings[0]


def test_a_decision_that_is_near_its_threshold_is_said():
    one = zener_scene(0.1)
    size = next(effect.change for effect in fm.simulate(one).effects if effect.name == "target_motion")
    for tolerance, said in ((1.01 * size, 1), (2.0 * size, 0)):
        near = one.replace({"effects.tolerance": tolerance})
        warnings = fm.simulate(near, derivatives=["impactor.velocity"]).derivatives.warnings
        assert len(warnings) == said
        assert all("target motion is not needed, and decided otherwise" in sentence for sentence in warnings)


def test_decisions_are_those_of_the_impact():
    steel = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    beam = fm.Beam("mild steel", width="10 mm", thickness="5 mm", length="100 mm")
    heavy = fm.Sphere("20 mm", "0.2 m/s", mass="20 kg", material="bearing steel")
    static = fm.Scene(heavy, beam, fm.Contact("hertz"), fm.Effects(target_inertia=False))
    for one in (static, steel, steel.replace({"impactor.velocity": "0.02 m/s"}), zener_scene(0.3), zener_scene(1e-5)):
        law = fm.simulate(one, accuracy=1e-9, derivatives=["impactor.velocity"])
        velocity = one.approach_velocity
        near = [
            fm.simulate(one.replace({"impactor.velocity": f"{velocity * (1.0 + sign * 1e-4)!r} m/s"}), accuracy=1e-9)
            for sign in (-1.0, 1.0)
        ]
        for name in ("maximum_force", "contact_duration", "rebound_velocity"):
            low, high = (history.summary[name] for history in near)
            rough = (high - low) / (2e-4 * velocity)
            assert law.derivatives.values[name]["impactor.velocity"] == pytest.approx(rough, rel=1e-4), (one, name)


def test_keys_that_are_no_numbers_are_refused_at_once():
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    strength = "target.material.yield_strength"
    keys = ["impactor.velocty", "impactor.mass", strength, "contact.law", "solver.accuracy", 3, "impactor.velocity"]
    with pytest.raises(fm.SceneError) as refused:
        fm.simulate(one, derivatives=keys)
    assert str(refused.value).splitlines() == [
        'derivatives.impactor.velocty: unknown key; did you mean "velocity"?',
        "derivatives.impactor.mass: is not given in the scene: give it there first",
        f"derivatives.{strength}: has no effect beside the hardness of the material: differentiate by that, or set it "
        "first",
        "derivatives.contact.law: is not a number: there is no derivative by it",
        "derivatives.solver.accuracy: is not a number: there is no derivative by it",
        'derivatives.3: 3 is not the key of a scene such as "impactor.velocity"',
    ]


def test_the_other_way_to_give_the_velocity_is_named():
    fall = fm.Scene(fm.Sphere("10 mm", drop_height="5 cm", material="bearing steel"), fm.HalfSpace("mild steel"))
    speed = fall.replace({"impactor.drop_height": None, "impactor.velocity": "1 m/s"})
    for one, name, other in ((fall, "velocity", "drop_height"), (speed, "drop_height", "velocity")):
        said = rf"impactor\.{name}: the scene gives impactor\.{other}: give {name} there in its place"
        with pytest.raises(fm.SceneError, match=said):
            fm.simulate(one, derivatives=[f"impactor.{name}"])
        with pytest.raises(fm.SceneError, match=said):
            fd.sweep(one, {f"impactor.{name}": ["1 m/s" if name == "velocity" else "1 m"]})


def test_derivatives_have_units_and_do_not_depend_on_each_other():
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    paths = ["impactor.velocity", "target.material.youngs_modulus"]
    history = fm.simulate(one, derivatives=paths)
    table = history.to_dict()["derivatives"]["maximum_force"]
    assert table["impactor.velocity"]["units"] == "N s m-1"
    assert table[paths[1]]["units"] == "N Pa-1"
    value = history.derivatives.of("maximum_force", "impactor.velocity").to("kN/(mm/s)")
    assert value.magnitude == pytest.approx(1e-6 * table["impactor.velocity"]["value"], rel=1e-12)
    assert history.derivatives.of("peak_pressure", "impactor.velocity") is None
    alone = fm.simulate(one, accuracy=1e-7, derivatives="impactor.velocity")
    for name, row in alone.derivatives.values.items():
        both = history.derivatives.values[name]["impactor.velocity"]
        assert row["impactor.velocity"] == (None if both is None else pytest.approx(both, rel=1e-11)), name
    assert quotient_unit("length", "length") == "1"
    assert quotient_unit("velocity", "angle") == "m s-1 rad-1"


def test_derivatives_are_shown_as_a_line_and_as_a_small_table():
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    found = fm.simulate(one, derivatives=["impactor.velocity", "impactor.radius"]).derivatives
    assert repr(found).startswith("Derivatives(by impactor.velocity and impactor.radius, estimated relative error ≤ ")
    head, first, second = str(found).splitlines()
    assert head.split() == ["maximum_force", "contact_duration", "coefficient_of_restitution"]
    assert first.startswith("by impactor.velocity = 1 m/s") and "1606.89 N s m-1" in first
    assert second.startswith("by impactor.radius = 0.01 m") and len(str(found)) < 400


def test_a_ball_has_derivatives_by_its_diameter():
    for part, target in (
        ("impactor", fm.HalfSpace("mild steel")),
        ("target", fm.Body("S235", radius="15 mm")),
    ):
        one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), target)
        whole, half = (
            fm.simulate(one, derivatives=[f"{part}.{name}"]).derivatives.values["contact_duration"]
            for name in ("diameter", "radius")
        )
        assert whole[f"{part}.diameter"] == pytest.approx(0.5 * half[f"{part}.radius"], rel=EXACT)
    with pytest.raises(fm.SceneError, match=r"impactor\.radius: impactor\.diameter is given, too"):
        fm.simulate(one, derivatives=["impactor.radius", "impactor.diameter"])


CHAINED = {
    "auto, hard": (("target.material.hardness", "impactor.radius"), fm.HalfSpace("mild steel"), {}),
    "auto, plate": (("target.thickness", "target.material.density"), fm.Plate("mild steel", thickness="10 mm"), {}),
    "auto, Poisson's ratio": (
        ("target.material.poissons_ratio", "impactor.material.poissons_ratio"),
        fm.HalfSpace("mild steel"),
        {},
    ),
    "damped": (
        ("contact.restitution", "impactor.velocity"),
        fm.HalfSpace("S235"),
        {"law": "tsuji", "restitution": 0.8},
    ),
    "two curves": (
        ("contact.unloading_stiffness", "contact.loading_stiffness"),
        fm.Body("S235", radius="15 mm", velocity="-0.1 m/s"),
        {"law": "walton-braun", "loading_stiffness": "40 MN/m", "unloading_stiffness": "80 MN/m"},
    ),
}


@pytest.mark.parametrize("name", CHAINED)
def test_the_chain_rule_agrees_with_differences_of_whole_impacts(name):
    paths, target, contact = CHAINED[name]
    one = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), target, fm.Contact(**contact))
    choice = choose(one)
    (decision,) = decisions_of(choice.problem)
    strength = np.array([choice.problem.impacts.law.strength]) if decision.hard else None
    assert decision.hard == name.startswith("auto")
    pairs = pairs_of(decision.put_into(one), {}, entries_of(one, paths), 1, strength)
    own, whole = Slopes.none(2), Slopes.none(2)
    differences(pairs, one.solver, TARGET, whole)
    chain_rule(pairs, one.solver, TARGET, own)
    assert (own.side == SMOOTH).all()
    values = np.array([value or np.nan for value in fm.simulate(one, accuracy=1e-9).summary.values()])
    scale = np.fmax(abs(whole.values), abs(values / pairs.value[:, None]))
    assert np.array_equal(np.isnan(own.values), np.isnan(whole.values))
    known = ~np.isnan(own.values)
    settled = 1e-8 if decision.hard else 1e-9  # the strength at the strain rate is found to about 1e-9 only
    assert (abs(own.values - whole.values) <= settled * scale)[known].all()
