"""Oblique impact: reference values, closed forms, springs that slip, balances, measured values, refusals."""

import json
import math

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model.cli.main import main
from film_model.oblique import elastic, friction, springs

REFERENCE = {
    1.75: {0.5: 0.175136886, 1.5: 0.096408594, 3.0: -1.037584925, 5.0: -1.523272442},
    7 * 0.7 / (2 * 1.7): {
        **{0.1: 0.020590706, 0.25: 0.041611319, 0.5: 0.047831079, 0.75: 0.014148799, 0.9: -0.025552701},
        **{1.25: -0.218829335, 1.5: -0.428016532, 1.75: -0.640030345, 2.0: -0.837210007, 2.25: -1.012375944},
        **{2.5: -1.162290249, 2.75: -1.285177756, 3.0: -1.379683292, 3.5: -1.477326779, 4.0: -1.436512225},
        **{4.5: -1.217617298, 4.7: -1.061610994, 6.0: 0.235294118},
    },
    7 * 0.5 / (2 * 1.5): {0.5: -0.141124471, 1.5: -0.851149520, 2.5: -1.370697632, 3.5: -1.144349637},
    3 * 0.72 / 1.72: {0.5: -0.075596470, 1.5: -0.722478422, 3.0: -1.425568119, 4.0: -1.022812268},
}
"""χ → ψ₁ → ψ₂ of elastically similar spheres under Hertz's law, integrated elsewhere between events to 1e-8."""

CHI = 7 * 0.7 / (2 * 1.7)  # a ball with a Poisson's ratio of 0.3


def power(exponent):
    factor = (exponent + 1.0) / 2.0

    def law(z):
        z = max(z, 0.0)
        return factor * z**exponent, factor * exponent * z ** (exponent - 1.0)

    return elastic.Normal(law, 1.0)


HERTZ = power(1.5)


def after(chi, before, normal=HERTZ):
    return elastic.tangential(normal, 2.0 * chi, before).velocity


@pytest.mark.parametrize("chi", REFERENCE)
def test_thirty_reference_values(chi):
    for before, expected in REFERENCE[chi].items():
        assert after(chi, before) == pytest.approx(expected, abs=3e-9), before
        assert after(chi, -before) == pytest.approx(-expected, abs=3e-9), before


def test_sliding_throughout():
    """ψ₂ = ψ₁ − 4χ from ψ₁ = 4χ − 1 on."""
    for before in (4.0 * CHI - 1.0, 6.0, 50.0):
        assert after(CHI, before) == pytest.approx(before - 4.0 * CHI, abs=1e-8)


@pytest.mark.parametrize("before", [1.2, 2.0, 3.0, 4.0])
def test_where_sliding_stops(before):
    """At the rate η = (2χ − ψ₁)/(2χ − 1) of indentation, and z = (1 − η²)^{2/5}; on the way out for η < 0."""
    phase = elastic.tangential(HERTZ, 2.0 * CHI, before).phases[0]
    z, nu, *_ = phase.solution(phase.end)
    rate = (2.0 * CHI - before) / (2.0 * CHI - 1.0)
    assert phase.kind == "slides"
    assert (nu, z) == pytest.approx((rate, (1.0 - rate**2) ** 0.4), abs=1e-9)


def test_where_sticking_ends():
    """By the hypergeometric functions of Hertz's contact that sticks: z = 0.985617308 for ψ₁ = 0.3."""
    from scipy.special import hyp2f1

    phase = elastic.tangential(HERTZ, 2.0 * CHI, 0.3).phases[0]
    z, _, _, rate, _ = phase.solution(phase.end)
    assert phase.kind == "sticks" and z == pytest.approx(0.985617308, abs=1e-8)
    total, product = 0.1, -0.6 * CHI
    root = math.sqrt(total**2 - 4.0 * product)
    a, b = (total + root) / 2.0, (total - root) / 2.0
    assert rate == pytest.approx(0.3 * hyp2f1(a, b, 0.6, z**2.5), abs=1e-9)


@pytest.mark.parametrize(
    ("before", "expected"), [(0.5, 0.184567753), (1.5, -0.339308323), (3.0, -1.368026457), (4.5, -1.217540206)]
)
def test_a_flat_punch(before, expected):
    """A linear force: one spring and one slider, in sines."""
    assert after(CHI, before, power(1.0)) == pytest.approx(expected, abs=1e-8)


def test_hardly_any_sliding_velocity():
    """ψ₂/ψ₁ for ψ₁ → 0, by Poisson's ratio; below 0.2 the sign of slip changes once more."""
    for ratio, expected in ((0.0, 0.3869), (0.1, 0.3657), (0.2, 0.3173), (0.3, 0.2314), (0.5, -0.1044)):
        chi = 7.0 * (1.0 - ratio) / (2.0 * (2.0 - ratio))
        assert after(chi, 1e-3) / 1e-3 == pytest.approx(expected, abs=3e-3)


def test_friction_never_exceeds_its_limit_and_dissipates():
    rng = np.random.default_rng(3)
    for before, chi in zip(10.0 ** rng.uniform(-1.5, 0.9, 12), rng.uniform(1.17, 3.0, 12), strict=True):
        found = elastic.tangential(HERTZ, 2.0 * chi, before)
        assert found.velocity**2 <= before**2
        for phase in found.phases:
            for t in np.linspace(phase.begin, phase.end, 21).tolist():
                z, _, _, q = phase.at(t)
                assert abs(q) <= HERTZ.law(z)[0] * (1.0 + 1e-9) + 1e-9


def test_springs_converge_to_the_exact_motion():
    """Errors fall as one over the number of springs."""
    exact = fm.simulate(slanted("20 deg"))
    times = np.linspace(0.0, exact.duration, 4097)
    seen, given = exact.sample_si(times), friction.sliding_of(exact.scene)
    radius = np.sqrt(exact.scene.effective_radius * np.maximum(seen.indentation, 0.0))
    whole, errors = springs.Grip(times, np.maximum(seen.contact_force, 0.0), radius), []
    for count, stride in ((64, 8), (128, 4), (256, 2)):
        grip = springs.Grip(*(column[::stride] for column in whole))
        found, _ = springs._run(grip, given.modulus, given.friction, given.mass, given.velocity, count)
        errors.append(abs(found[-1] - exact.oblique.summary["contact_point_rebound_velocity"]) / given.velocity)
    assert errors[2] < 1e-4 and errors[0] > 1.5 * errors[1] > 2.0 * errors[2]
    run = springs.tangential(
        springs.Grip(*(column[::2] for column in whole)), *given[2:3], given.friction, *given[3:4], given.velocity
    )
    assert errors[2] <= run.estimated / given.velocity < 1e-3


STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}


def slanted(angle="30 deg", law="hertz", mu=0.2, speed="3 m/s", target=None, **ball):
    sphere = fm.Sphere("5 mm", speed, material=STEEL, angle=angle, **ball)
    return fm.Scene(sphere, target or fm.HalfSpace(STEEL), fm.Contact(law, friction=mu), fm.Effects(gravity=False))


KHARAZ = (
    *((2.24, 0.7965), (4.22, 0.7463), (9.84, 0.6755), (20.22, 0.5988), (30.36, 0.6903)),
    *((39.54, 0.7743), (49.60, 0.8476), (71.07, 0.9366), (79.23, 0.9695), (85.17, 0.9794)),
)
"""Angle, °, and measured tangential restitution: Kharaz, Gorham & Salman 2001, alumina on glass at 3.9 m/s."""


def test_measured_tangential_restitution():
    """Nothing is fitted; 8 of 10 within 0.01, the two smallest angles and 9.84° within 0.04."""
    alumina = {"youngs_modulus": "380 GPa", "poissons_ratio": 0.23, "density": "4000 kg/m^3"}
    glass = {"youngs_modulus": "70 GPa", "poissons_ratio": 0.25, "density": "2500 kg/m^3"}
    off = []
    for angle, measured in KHARAZ:
        ball = fm.Sphere(diameter="5 mm", velocity="3.9 m/s", material=alumina, angle=f"{angle} deg")
        scene = fm.Scene(ball, fm.HalfSpace(glass), fm.Contact("hertz", friction=0.092), fm.Effects(gravity=False))
        off.append(abs(fm.simulate(scene).oblique.summary["tangential_restitution"] - measured))
    assert sum(one <= 0.01 for one in off) >= 8 and max(off) < 0.04


def test_balances_of_momentum_and_of_angular_momentum():
    body = fm.Body(STEEL, radius="8 mm", velocity="-1 m/s")
    for scene in (
        slanted(),
        slanted(spin="-200 rad/s"),
        slanted(target=body),
        slanted(shape="shell"),
        slanted(law="auto"),
    ):
        history = fm.simulate(scene)
        found, ball = history.oblique.summary, scene.impactor
        along, spin = ball.path_speed * math.sin(ball.angle), ball.spin or 0.0
        impulse, inertia = found["tangential_impulse"], ball.inertia_number * scene.mass * ball.radius**2
        assert scene.mass * (along - found["tangential_rebound_velocity"]) == pytest.approx(impulse, rel=1e-12)
        assert inertia * (spin - found["rebound_spin"]) == pytest.approx(ball.radius * impulse, rel=1e-12)
        assert found["friction_work"] >= 0.0 and abs(impulse) <= 0.2 * history.summary["impulse"] * (1.0 + 1e-6)
        moment = np.trapezoid(history.oblique.motion["friction_force"], history.oblique.motion["time"])
        assert moment == pytest.approx(impulse, rel=2e-3)


def test_the_normal_motion_is_not_changed():
    scene = slanted()
    without = scene.replace({"contact.friction": None})
    assert fm.simulate(scene).summary == fm.simulate(without).summary
    assert fm.simulate(without).oblique is None


def test_regimes_and_hard_cases():
    regimes = [fm.simulate(slanted(angle)).oblique.sliding_regime for angle in ("5 deg", "30 deg", "75 deg")]
    assert regimes == ["sticks first", "slides first", "slides throughout"]
    grazing = fm.simulate(slanted("89.9 deg", speed="30 m/s")).oblique
    assert grazing.sliding_regime == "slides throughout" and 0.99 < grazing.summary["tangential_restitution"] < 1.0
    smooth = fm.simulate(slanted(mu=0.0)).oblique.summary
    assert (smooth["tangential_impulse"], smooth["friction_work"]) == (0.0, 0.0)
    rough = fm.simulate(slanted("20 deg", mu=50.0)).oblique
    assert rough.sliding_regime == "sticks first"
    spinning = slanted()
    spin = -spinning.impactor.path_speed * math.sin(spinning.impactor.angle) / spinning.impactor.radius
    assert fm.simulate(slanted(spin=f"{spin!r} rad/s")).oblique is None  # nothing slides
    only = fm.simulate(slanted("0 deg", spin="3000 rpm")).oblique.summary
    assert only["tangential_rebound_velocity"] < 0.0 and abs(only["rebound_spin"]) < 3000.0 * math.tau / 60.0


def test_a_contact_that_yields_is_bracketed_and_slides_throughout_by_its_restitution():
    """v₂ = v₁ − (1 + I) µ (1 + e) V_n."""
    history = fm.simulate(slanted("75 deg", law="elastoplastic", target=fm.HalfSpace("mild steel")))
    found, scene = history.oblique, history.scene
    before = scene.impactor.path_speed * math.sin(scene.impactor.angle)
    lost = 3.5 * 0.2 * (1.0 + history.summary["coefficient_of_restitution"]) * scene.approach_velocity
    assert found.sliding_regime == "slides throughout" and found.estimated < 1e-3
    assert found.summary["contact_point_rebound_velocity"] == pytest.approx(before - lost, abs=1e-3 * before)
    slow = fm.simulate(slanted("20 deg", law="elastoplastic", target=fm.HalfSpace("mild steel")))
    assert slow.oblique.low < slow.oblique.high
    assert any("two models give a sliding velocity" in warning for warning in slow.warnings)


def test_run_prints_it_and_json_has_it(tmp_path, capsys):
    path = tmp_path / "slanted.toml"
    path.write_text(slanted(spin="1000 rpm").to_toml(), encoding="utf-8")
    assert main(["run", str(path)]) == 0
    printed = capsys.readouterr()
    assert "oblique: slides first" in printed.out and "rebound spin" in printed.out
    assert "obliqueness" not in printed.err
    assert main(["run", str(path), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)["oblique"]
    history = fm.simulate(slanted(spin="1000 rpm"))
    assert table["rebound_angle"] == {"value": history.oblique.summary["rebound_angle"], "units": "rad"}
    assert history.oblique.friction_work.check("[energy]")
    assert next(e for e in history.effects if e.name == "obliqueness").state == "simulated"


def test_what_cannot_be_simulated_is_refused_in_a_sentence(tmp_path):
    scene = slanted()
    for refused in (
        lambda: fm.simulate_batch(scene, velocity=["1 m/s", "2 m/s"]),
        lambda: fd.sweep(scene, {"impactor.angle": ["10 deg", "20 deg"]}),
        lambda: fm.ImpactComponent(scene),
        lambda: fmu_wrapper.export(scene, tmp_path / "x.fmu"),
    ):
        with pytest.raises(fm.SimulationError, match=r"the normal motion only, but contact\.friction is 0\.2"):
            refused()
    given = fm.Contact("hertz", effective_modulus="100 GPa", friction=0.2)
    with pytest.raises(fm.SimulationError, match="friction needs Young's modulus and Poisson's ratio of both bodies"):
        fm.simulate(fm.Scene(scene.impactor, scene.target, given))
    sticky = fm.Contact("jkr", work_of_adhesion="0.1 J/m^2", friction=0.2)
    with pytest.raises(fm.SimulationError, match="friction under adhesion that pulls is not supported"):
        fm.simulate(fm.Scene(scene.impactor, scene.target, sticky))
    with pytest.raises(fm.SceneError, match="friction"):
        fm.Contact("hertz", friction=-0.1)
    with pytest.raises(fm.SceneError, match='"solid" or "shell" is needed'):
        fm.Sphere("5 mm", "1 m/s", material=STEEL, shape="cube")


def test_no_event_is_missed_where_sliding_stops_at_the_turn():
    """ψ₁ = 2χ: the contact sticks for a moment only. ψ₂ has no jump there."""
    chi = 1.0675
    found = [after(chi, before) for before in np.linspace(2.0 * chi - 0.02, 2.0 * chi + 0.02, 9)]
    assert np.abs(np.diff(found, 2)).max() < 1e-4
