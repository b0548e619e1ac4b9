"""Effects that are neglected: each is judged right, and what the scene lacks is named."""

import math

import numpy as np
import pytest
from scipy import integrate, optimize

import film_datasets
import film_model as fm
from film_model.base.materials import catalogue
from film_model.base.units import format_si
from film_model.cli.main import main
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_JUDGED, NOT_MODELLED, NOT_NEEDED, SIMULATED
from film_model.effects.large_slope import COMPUTED
from film_model.effects.surroundings import terminal_velocity
from film_model.laws.large_slope import BALL, HALF_SPACE
from film_model.problem.brittle import RING_CRACK

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
RIGID = {"youngs_modulus": "99 TPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
GLASS = {"youngs_modulus": "70 GPa", "poissons_ratio": 0.22, "density": "2500 kg/m^3", "tensile_strength": "45 MPa"}


def scene(material=STEEL, target=None, velocity="1 m/s", contact=None, **ball):
    sphere = fm.Sphere(ball.pop("radius", "5 mm"), velocity=velocity, material=material, **ball)
    return fm.Scene(sphere, target or fm.HalfSpace(STEEL), contact=contact or fm.Contact("hertz"))


RESTITUTION = 0.8846
"""Of tan δ = 0.1, by the integration in test_material_damping.py."""


def effect_of(of, name):
    return next(effect for effect in choose(of).effects if effect.name == name)


def test_the_loss_factor_of_one_body_counts():
    rubber = {**STEEL, "youngs_modulus": "2 MPa", "loss_factor": 0.1}
    effect = effect_of(scene(rubber), "material_damping")
    assert effect.state == NOT_MODELLED
    assert effect.value == pytest.approx(0.1, rel=1e-4)  # the rubber has nearly all the compliance
    assert effect.change == pytest.approx(1 - RESTITUTION**2, rel=1e-3)
    assert "loss factor of the target is not given and taken as 0" in effect.warning
    assert f"restitution about {RESTITUTION:.2g}" in effect.warning
    assert effect_of(scene("nylon"), "material_damping").state == NOT_MODELLED  # without loss factor: never silent
    lossy = {**STEEL, "loss_factor": 0.01}
    bare = effect_of(scene({**STEEL, "youngs_modulus": "2 MPa"}, fm.HalfSpace(lossy)), "material_damping")
    assert bare.state == NOT_MODELLED and "restitution is too high" in bare.warning  # rubber is never without loss
    stiff = effect_of(scene({**STEEL, "youngs_modulus": "6 GPa"}, fm.HalfSpace(lossy)), "material_damping")
    assert stiff.state == NOT_JUDGED and stiff.reason.startswith("missing: impactor.material.loss_factor")
    damped = scene({**STEEL, "youngs_modulus": "2 MPa"}, contact=fm.Contact("hunt-crossley", restitution=0.8))
    assert effect_of(damped, "material_damping").state == NOT_NEEDED
    by_modulus = fm.Scene(
        fm.Sphere("5 mm", velocity="1 m/s", material=rubber),
        fm.HalfSpace(),
        fm.Contact("hertz", effective_modulus="1 MPa"),
    )
    share = 1e6 * (1 - 0.3**2) / 2e6
    assert effect_of(by_modulus, "material_damping").value == pytest.approx(0.1 * share)


def test_a_plate_thicker_than_the_way_of_its_waves_radiates_as_a_half_space():
    half_space = effect_of(scene(velocity="5 m/s"), "wave_losses")
    thick, between, thin = (
        effect_of(scene(target=fm.Plate(STEEL, thickness=h), velocity="5 m/s"), "wave_losses")
        for h in ("200 mm", "30 mm", "4 mm")
    )
    assert half_space.state == thick.state == NOT_MODELLED
    assert thick.change == pytest.approx(half_space.value, rel=1e-3)
    assert "before a wave returns" in thick.reason
    assert "too thin for a half-space" in between.reason and 0.0 < between.change < half_space.change
    assert (thin.state, thin.change) == (NOT_NEEDED, 0.0)


@pytest.mark.parametrize(("thick", "rebound"), [(1, 0.688), (2, 0.903), (3, 0.953), (4, 0.971)])
def test_the_losses_that_a_thick_plate_lacks_against_finite_elements(thick, rebound):
    """rebound: of a rigid ball of steel's density at 1 m/s from a steel plate of `thick` radii, by finite elements."""
    of = scene(RIGID, fm.Plate(STEEL, thickness=f"{5 * thick} mm"))
    lacking = fm.simulate(of).summary["coefficient_of_restitution"] ** 2 - rebound**2
    shear, waves = effect_of(of, "thickness").change, effect_of(of, "wave_losses").change
    assert shear + waves == pytest.approx(lacking, rel=0.08)
    assert waves < 0.013


@pytest.mark.parametrize(("slope", "change"), [(0.05, 0.022), (0.13, 0.057), (0.27, 0.121), (0.42, 0.171)])
def test_large_slope_of_an_elastic_ball_on_a_rigid_target(slope, change):
    """change: of the force, by the finite elements of a ball with its inertia (test_large_slope.py); the first by c."""
    soft = {**STEEL, "youngs_modulus": "1 GPa"}
    speed = math.sqrt(16 / 15 * 1e9 / (1 - 0.3**2) * slope**5 / (7850 * 4 / 3 * math.pi))
    effect = effect_of(scene(soft, fm.HalfSpace(RIGID), f"{speed!r} m/s"), "small_slope")
    assert effect.value == pytest.approx(slope, rel=0.02)
    assert effect.change == pytest.approx(change, rel=0.25)
    assert effect.state == NOT_MODELLED and "law large-slope simulates it" in effect.warning
    hard = effect_of(scene(RIGID, fm.HalfSpace(soft), "1 m/s"), "small_slope")
    assert hard.change == pytest.approx(change_by(HALF_SPACE * hard.value), rel=1e-2)


def change_by(steepness):
    """Of the largest force by law large-slope. steepness: c √(δ/R)."""
    return steepness / (2.0 + steepness)


def test_two_balls_are_each_compressed_by_their_share():
    soft = {**STEEL, "youngs_modulus": "1 GPa"}
    twins = effect_of(scene(soft, fm.Body(soft, radius="5 mm"), "5 m/s"), "small_slope")
    slope = twins.value / 2  # a/R of each ball; the effective radius is half of theirs
    assert twins.change == pytest.approx(change_by(BALL * slope), rel=1e-2)


def test_a_contact_wider_than_computed_says_so():
    soft = {**STEEL, "youngs_modulus": "1 GPa"}
    effect = effect_of(scene(soft, fm.HalfSpace(RIGID), "100 m/s"), "small_slope")
    assert effect.value > COMPUTED
    assert "computed was up to 0.5 R" in effect.warning


def test_large_slope_without_the_materials_is_judged_only_if_it_cannot_matter():
    def of(velocity):
        ball = fm.Sphere("5 mm", velocity=velocity, mass="4 g")
        return effect_of(fm.Scene(ball, fm.HalfSpace(), fm.Contact("hertz", effective_modulus="1 GPa")), "small_slope")

    assert of("1 mm/s").state == NOT_NEEDED
    assert of("1 m/s").state == NOT_JUDGED and "impactor.material" in of("1 m/s").reason


def test_no_law_is_valid_deeper_than_the_radius():
    heavy = scene({**STEEL, "yield_strength": "250 MPa"}, contact=fm.Contact("big-alabo"), mass="4 t")
    effect = effect_of(heavy, "small_slope")
    depth = fm.simulate(heavy).summary["maximum_indentation"] / 5e-3
    assert effect.state == NOT_MODELLED
    assert f"{depth:.2g}" in effect.warning and depth > 1.0
    with pytest.raises(fm.SimulationError, match="ends where a = R"):
        fm.simulate(heavy.replace({"contact.law": "auto"}))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"density": "2.7 kg/m^3"}, "density: 2.7 kg/m^3, but a light foam has 10 kg/m^3"),
        ({"youngs_modulus": "70 kPa"}, "youngs_modulus: 70 kPa, but a soft rubber has 100 kPa"),
        ({"density": "78500 kg/m^3"}, "but osmium has"),
        ({"youngs_modulus": "70 kPa", "name": "aluminum 6061-T6"}, "youngs_modulus: 70 kPa, but aluminium 6061-T6 has"),
        (
            {"density": "27 kg/m^3", "youngs_modulus": "70 GPa", "name": "aluminum 6061-T6"},
            "density: 27 kg/m^3, but aluminium 6061-T6 has",
        ),
        (
            {"youngs_modulus": "210 MPa", "yield_strength": "250 MPa"},
            "210 MPa is less than the yield strength, 250 MPa",
        ),
    ],
)
def test_unlikely_numbers_of_a_material_are_remarked(changes, said):
    (remark,) = [w for w in choose(scene({**STEEL, **changes})).warnings if w.startswith("impactor.material")]
    assert said in remark and remark.endswith("check units")
    assert not [w for w in choose(scene()).warnings if "material" in w]


@pytest.mark.parametrize("factor", [4.0, 0.25])
def test_a_mass_far_from_that_of_a_ball_is_remarked(factor):
    ball = 7850 * 4 / 3 * math.pi * 5e-3**3
    (remark,) = [w for w in fm.simulate(scene(mass=f"{factor * ball!r} kg")).warnings if w.startswith("impactor.mass")]
    assert f"{factor:.3g} times density × volume" in remark
    assert not [
        w for w in fm.simulate(scene(mass=f"{factor**0.5 * ball!r} kg")).warnings if w.startswith("impactor.mass")
    ]
    speeds = {"impactor.velocity": ["1 m/s", "2 m/s"]}
    swept = film_datasets.sweep(scene(mass=f"{factor * ball!r} kg"), speeds)
    assert "times density × volume" in swept.attrs["warnings"]


def test_the_sentence_about_gravity_agrees_with_its_number():
    rng, seen = np.random.default_rng(3), set()
    for _ in range(60):
        material = {**STEEL, "youngs_modulus": f"{10 ** rng.uniform(7, 11.3)!r} Pa", "yield_strength": "300 MPa"}
        target = fm.Plate(material, thickness="20 mm") if rng.integers(2) else fm.HalfSpace(material)
        speed = f"{10 ** rng.uniform(-2.5, 0.5)!r} m/s"
        for effect in choose(scene(material, target, speed, fm.Contact("auto"), radius="10 mm")).effects:
            if None in (effect.value, effect.threshold, effect.change) or effect.name == "adhesion":
                continue
            if effect.name in ("gravity", "target_motion", "small_slope", "wave_losses", "material_damping"):
                assert (effect.value > effect.threshold) == (effect.change > 0.01), effect
            if effect.name == "gravity" and effect.state in (SIMULATED, NOT_NEEDED):
                seen.add(effect.state)
                assert effect.simulated == (effect.change > 0.01)
                assert "not small" not in effect.reason
    assert seen == {SIMULATED, NOT_NEEDED}


@pytest.mark.slow
@pytest.mark.parametrize(("theory", "state"), [("euler-bernoulli", NOT_JUDGED), ("timoshenko", NOT_NEEDED)])
def test_shear_is_not_judged_where_contact_comes_back(theory, state):
    beam = fm.Beam(STEEL, length="300 mm", width="20 mm", thickness="8 mm", theory=theory)
    history = fm.simulate(scene(target=beam, radius="12 mm"), accuracy=1e-2)
    effect = next(effect for effect in history.effects if effect.name == "thickness")
    assert effect.state == state
    assert ("contact may be lost and come back" in effect.reason) is (state == NOT_JUDGED)
    (warning,) = [warning for warning in history.warnings if "contacts:" in warning]
    assert ("shear of the beam" in warning) is (state == NOT_JUDGED)


def test_a_catalogue_material_without_a_rate_coefficient_is_a_warning():
    yielding = scene("titanium grade 2", fm.HalfSpace("titanium grade 2"), contact=fm.Contact("auto"))
    effect = effect_of(yielding, "rate_hardening")
    assert effect.state == NOT_MODELLED
    assert f"{effect.value:.3g} 1/s" in effect.warning and "titanium grade 2" in effect.warning
    assert 0.03 < effect.change < 0.06 and f"by about {100 * effect.change:.2g} %" in effect.warning
    own = {**STEEL, "yield_strength": "215 MPa"}  # the scene's own strength may hold at this rate
    assert effect_of(scene(own, fm.HalfSpace(own), contact=fm.Contact("auto")), "rate_hardening").state == NOT_JUDGED
    mild = effect_of(scene("mild steel", fm.HalfSpace("mild steel"), contact=fm.Contact("auto")), "rate_hardening")
    assert mild.state == SIMULATED and mild.change > 0.01


def test_brittle_bodies_beyond_their_strength_may_crack():
    effect = effect_of(scene(GLASS, fm.HalfSpace(GLASS)), "fracture")
    summary = fm.simulate(scene(GLASS, fm.HalfSpace(GLASS))).summary
    peak = 1.5 * summary["maximum_force"] / (math.pi * 5e-3 * summary["maximum_indentation"])
    assert effect.value == pytest.approx((1 - 2 * 0.22) * peak / 3 / 45e6, rel=1e-3)
    assert effect.state == NOT_MODELLED
    assert "small contacts bear more" in effect.warning and f"{effect.value:.3g} times" in effect.warning
    assert effect_of(scene(GLASS, fm.HalfSpace(GLASS), "0.5 mm/s"), "fracture").state == NOT_NEEDED
    assert "tensile_strength" in effect_of(scene(), "fracture").reason
    assert catalogue()["float glass, toughened"].tensile_strength == 120e6


def ring_crack(ratio, radius, depth):
    """(K/(p_m √a))² of a ring crack around a contact of unit radius and mean pressure p_m, by Huber's radial stress."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    angle = (nodes + 1) * math.pi / 4
    z = depth * np.sin(angle)
    s = radius**2 + z**2 - 1
    q = np.sqrt((s + np.sqrt(s * s + 4 * z * z)) / 2)
    t = z / q
    edge = (1 - 2 * ratio) / 3 / radius**2 * (1 - t**3) + t**3 * q**2 / (q**4 + z**2)
    stress = 1.5 * (edge + t * (q**2 * (1 - ratio) / (1 + q**2) + (1 + ratio) * q * np.arctan(1 / q) - 2))
    k = 2 * math.sqrt(depth / math.pi) * (weights * stress * (1.3 - 0.3 * np.sin(angle) ** 1.25)).sum() * math.pi / 4
    return max(k, 0.0) ** 2


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.3, 0.4])
def test_the_ring_crack_that_a_contact_drives_most(ratio):
    found = optimize.minimize(
        lambda x: -ring_crack(ratio, 1 + math.exp(x[0]), math.exp(x[1])), (-1.7, -3.0), method="Nelder-Mead"
    )
    assert -found.fun == pytest.approx(math.exp(np.interp(ratio, *RING_CRACK)), rel=1e-3)


def test_glass_cracks_by_auerbachs_law():
    def cracks(radius, velocity, material="soda-lime glass"):
        ball = fm.Sphere(radius, velocity=velocity, material=material)
        return fm.Scene(ball, fm.HalfSpace("soda-lime glass"), effects=fm.Effects(small_slope=False))

    assert effect_of(cracks("8 mm", "5 mm/s"), "fracture").state == NOT_NEEDED  # a marble, laid down
    least = []
    for radius in ("2.5 mm", "5 mm"):
        of = cracks(radius, "2 m/s", "bearing steel")
        effect = effect_of(of, "fracture")
        assert effect.state == NOT_MODELLED and "Auerbach's law" in effect.warning
        least.append(fm.simulate(of).summary["maximum_force"] / effect.value)
    assert least[1] == pytest.approx(2 * least[0], rel=1e-3)  # proportional to the radius
    modulus = cracks("5 mm", "1 m/s", "bearing steel").effective_modulus
    by_law = 3 * math.pi**2 / (4 * math.exp(np.interp(0.22, *RING_CRACK))) * 0.71e6**2 * 5e-3 / modulus
    assert least[1] == pytest.approx(by_law, rel=1e-2)
    assert 100.0 < by_law < 300.0


def crushed_force(radius, strength, mass, velocity, weight):
    """Largest force of a ball that stops in material of that pressure over the circle that it cuts, by integration."""
    stiffness = 2 * math.pi * radius * strength
    time = math.pi / math.sqrt(stiffness / mass)
    motion = integrate.solve_ivp(
        lambda _, y: (y[1], (weight - stiffness * y[0]) / mass),
        (0, time),
        (0, velocity),
        rtol=1e-9,
        max_step=time / 500,
    )
    return stiffness * motion.y[0].max()


@pytest.mark.parametrize(
    ("ball", "target", "strength", "velocity"),
    [("ice", "bearing steel", 12.6e6, 20.0), ("bearing steel", "concrete", 38e6, 0.1)],
)
def test_ice_and_concrete_crush_by_the_mean_pressure(ball, target, strength, velocity):
    of = fm.Scene(fm.Sphere("10 mm", velocity=f"{velocity} m/s", material=ball), fm.HalfSpace(target))
    effect, summary = effect_of(of, "fracture"), fm.simulate(of).summary
    pressure = summary["maximum_force"] / (math.pi * summary["contact_radius"] ** 2)
    assert effect.state == NOT_MODELLED and effect.indicator == "mean pressure/crushing strength"
    assert effect.value == pytest.approx(pressure / strength, rel=0.01)
    assert "it crushes" in effect.warning and "tensile" not in effect.warning
    bound = crushed_force(0.01, 3 * strength, of.mass, velocity, of.mass * 9.80665)
    assert f"at most about {format_si(bound, 'force', 3)} if" in effect.warning
    assert bound < summary["maximum_force"]


def test_what_a_crushing_strength_replaces():
    def judged(velocity, **strength):
        return effect_of(scene({**GLASS, **strength}, fm.HalfSpace(STEEL), velocity), "fracture")

    assert judged("1 m/s").state == NOT_MODELLED and "tensile stress" in judged("1 m/s").reason
    strong = judged("1 m/s", crushing_strength="2 GPa", fracture_toughness="0.1 MPa*m^0.5")
    assert strong.state == NOT_NEEDED and strong.warning is None and strong.value < 1
    begins, crushes, bound = (
        judged("1 m/s", crushing_strength=f"{2e9 * strong.value / times!r} Pa") for times in (2.9, 4.3, 5.3)
    )
    assert begins.value == pytest.approx(2.9, rel=1e-6)
    assert begins.reason.endswith("it begins to crush")
    assert crushes.reason.endswith("it crushes")  # crushed, it would bear √(4.8/4.3) times Hertz's force
    assert "it crushes, and the force is at most about" in bound.reason  # √(4.8/5.3) times
    assert "crushing_strength" in effect_of(scene(), "fracture").reason


def test_rubber_on_concrete_crushes_nothing():
    ball = fm.Sphere("30 mm", velocity="3 m/s", material="natural rubber 40 Shore A")
    assert effect_of(fm.Scene(ball, fm.HalfSpace("concrete")), "fracture").state == NOT_NEEDED


def test_the_drag_of_a_fall():
    def falls(height, radius="10 mm", material="ice"):
        return fm.Scene(fm.Sphere(radius, drop_height=height, material=material), fm.HalfSpace(STEEL))

    hail = effect_of(falls("500 m"), "air_drag")
    assert hail.state == NOT_MODELLED and "not 99 m/s" in hail.warning
    assert effect_of(falls("1 m", material="bearing steel"), "air_drag").state == NOT_NEEDED
    assert effect_of(scene(), "air_drag").reason == "the velocity at the impact is given"
    final = terminal_velocity(falls("500 m").mass, 0.01)
    assert final == pytest.approx(21.3, rel=0.01) and hail.change == pytest.approx(1 - (final / 99) ** 2, rel=1e-2)
    tiny = 4 / 3 * math.pi * 1e-5**3 * 2500  # Stokes: 2/9 (ρ g R²/µ)
    assert terminal_velocity(tiny, 1e-5) == pytest.approx(2 / 9 * 2500 * 9.80665 * 1e-10 / 1.813e-5, rel=0.03)
    middle = falls("20 m", material="nylon")
    speed, weight = terminal_velocity(middle.mass, 0.01), 9.80665

    def slowed(_, state):
        return [state[1], weight * (1 - (state[1] / speed) ** 2)]

    def lands(_, state):
        return state[0] - 20.0

    lands.terminal = True
    end = integrate.solve_ivp(slowed, (0, 10), [0.0, 0.0], events=lands, rtol=1e-9, atol=1e-9).y[1, -1]
    assert effect_of(middle, "air_drag").change == pytest.approx(1 - end**2 / (2 * weight * 20), rel=1e-5)


@pytest.mark.parametrize(("radius", "off"), [(0.5e-3, 0.04), (2e-3, 3e-3), (10e-3, 1e-6)])
def test_a_fall_with_the_drag_at_each_velocity_is_as_fast(radius, off):
    """Integrated over the height, with the drag coefficient of the Reynolds number on the way; and hail with 0.6."""
    for density in (917.0, 7850.0):
        mass = density * 4 / 3 * math.pi * radius**3

        def at_end(height, coefficient, mass=mass):
            def slowed(_, energy):
                speed = math.sqrt(2 * max(energy[0], 1e-12))
                drag = 0.5 * 1.204 * coefficient(2 * 1.204 * radius * speed / 1.813e-5) * math.pi * radius**2 * speed**2
                return [9.80665 - drag / mass]

            way = integrate.solve_ivp(slowed, (0, height), [1e-8], method="LSODA", rtol=1e-9, atol=1e-12)
            return math.sqrt(2 * way.y[0, -1])

        final = terminal_velocity(mass, radius)
        for height in (1.0, 10.0, 500.0):
            found = final * math.sqrt(-math.expm1(-2 * 9.80665 * height / final**2))
            newton = at_end(height, lambda re: max(24 / re * (1 + 0.15 * re**0.687), 0.44))
            assert found == pytest.approx(newton, rel=off)
        if density == 917.0 and radius == 10e-3:
            assert found == pytest.approx(21.3, abs=0.05) and at_end(500.0, lambda _: 0.6) == pytest.approx(
                18.2, abs=0.05
            )


def test_surface_energies_bound_the_adhesion_of_small_balls():
    ball = scene("PMMA", fm.HalfSpace("PMMA"), "10 mm/s", radius="20 um")
    work = fm.Contact("hertz", work_of_adhesion="0.082 J/m^2")
    given = scene("PMMA", fm.HalfSpace("PMMA"), "10 mm/s", work, radius="20 um")
    found, same = effect_of(ball, "adhesion"), effect_of(given, "adhesion")
    assert found.value == pytest.approx(same.value, rel=1e-12)
    assert (found.value < found.threshold) == (found.change > 0.01)
    assert "surface energies" in found.reason


def test_an_oblique_impact_simulates_the_normal_component_and_says_what_it_leaves_out(tmp_path, capsys):
    oblique = scene(velocity="2 m/s", angle="60 deg")
    normal = scene(velocity=f"{2 * math.cos(math.radians(60))!r} m/s")
    history = fm.simulate(oblique)
    assert history.summary == pytest.approx(fm.simulate(normal).summary, rel=1e-12)
    effect = effect_of(oblique, "obliqueness")
    assert (effect.state, effect.value) == (NOT_MODELLED, pytest.approx(60.0))
    assert "only the normal component, 1 m/s" in effect.warning and "give friction in [contact]" in effect.warning
    assert effect.warning in history.warnings and effect.warning in film_datasets.to_dataset(history).attrs["warnings"]
    assert (effect_of(normal, "obliqueness").state, effect_of(normal, "obliqueness").change) == (NOT_NEEDED, 0.0)
    assert fm.Scene.from_text(oblique.to_toml()) == oblique
    path = tmp_path / "scene.toml"
    path.write_text(oblique.to_toml(), encoding="utf-8")
    assert main(["run", str(path)]) == 0
    assert effect.warning in capsys.readouterr().err


def test_angles_of_many_impacts():
    angles = np.radians([0.0, 30.0, 60.0])
    swept = film_datasets.sweep(scene(angle="10 deg"), {"impactor.angle": ["0 deg", "30 deg", "60 deg"]})
    for angle, force in zip(angles, swept.maximum_force.values, strict=True):
        alone = fm.simulate(scene(velocity=f"{math.cos(angle)!r} m/s")).summary["maximum_force"]
        assert force == pytest.approx(alone, rel=1e-4)
    assert "obliqueness" in swept.attrs["warnings"]
    with pytest.raises(fm.SceneError, match=r"Sphere\.angle: 30 has no unit, an angle is needed"):
        scene(angle=30)
    with pytest.raises(fm.SceneError, match=r"from 0 to 89\.9544 deg"):
        scene(angle="90 deg")


def test_an_oblique_impact_that_does_not_end_still_says_so():
    soft = {**STEEL, "youngs_modulus": "1 MPa"}
    laid = scene(soft, fm.HalfSpace(soft), "0.1 mm/s", fm.Contact("hertz"), angle="45 deg")
    assert effect_of(laid, "obliqueness").state == NOT_MODELLED


def test_an_impact_that_a_fixed_target_would_drive_beyond_the_law_is_judged():
    """A static stiffness stops a heavy body that would crush a target that does not move."""
    body = {"radius": "5 mm", "mass": "6.941 kg", "velocity": "3.454 m/s", "material": "bearing steel"}
    soft = {
        "kind": "plate",
        "thickness": "2 mm",
        "static_stiffness": "1e6 N/m",
        "material": {**STEEL, "yield_strength": "114 MPa"},
    }
    laid = fm.Scene.from_table({"impactor": body, "target": soft})
    assert effect_of(laid, "boundary_reflections").state == SIMULATED


def test_waves_of_a_half_space_follow_hunter_and_tell_what_the_weight_adds():
    def waves(velocity, gravity):
        ball = fm.Sphere("5 mm", velocity=f"{velocity} m/s", material="bearing steel")
        return effect_of(
            fm.Scene(ball, fm.HalfSpace("bearing steel"), effects=fm.Effects(gravity=gravity, small_slope=False)),
            "wave_losses",
        )

    fast = waves(1.0, False).value
    for velocity in (1e-6, 1e-4, 1e-2):
        assert waves(velocity, False).value == pytest.approx(fast * velocity**0.6, rel=1e-3)
    assert fast == pytest.approx(0.0067, rel=0.01)
    pressed = waves(1e-6, "auto")
    assert pressed.value > 1.0 and pressed.change == 1.0 and "the weight presses so much" in pressed.warning
    assert waves(1e-2, "auto").value == pytest.approx(waves(1e-2, False).value, rel=0.1)
