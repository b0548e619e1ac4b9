"""The laws: continuity, work, unloading, custom laws, and errors."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from cases import EFFECTIVE_MODULUS, LAWS, RADIUS, YIELD, scene

import film_model as fm
from film_model.laws.yielding import yield_point, yield_velocity
from film_model.problem.curve import curve_of


def edges(law):
    stages = law.stages()
    return [stage.begin for stage in stages[1:]], stages


@pytest.mark.parametrize("name", [name for name in LAWS if name != "big-alabo-printed"])
def test_force_is_continuous(name):
    curve = curve_of(LAWS[name])
    for edge in edges(LAWS[name])[0]:
        below, above = curve.force(edge * (1 - 1e-13)), curve.force(edge * (1 + 1e-13))
        assert above == pytest.approx(below, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("name", list(LAWS))
def test_work_is_the_integral_of_the_force(name):
    curve = curve_of(LAWS[name])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    at, total = 0.0, 0.0
    for stage in LAWS[name].stages():
        end = stage.end if math.isfinite(stage.end) else stage.begin + 20.0
        x = 0.5 * (nodes + 1)  # squared below: also exact for powers that begin like a root
        for to in (*stage.knots, end):
            points = at + (to - at) * x * x
            total += sum(w * s * (to - at) * curve.force(p) for w, s, p in zip(weights, x, points, strict=True))
            at = to
        assert curve.work(end) == pytest.approx(total, rel=3e-8 if "shifted" in name else 1e-11)


def test_the_printed_constants_jump_where_the_paper_does():
    curve = curve_of(LAWS["big-alabo-printed"])
    assert curve.force(82.5 * (1 + 1e-12)) / curve.force(82.5) == pytest.approx(425.6 / 417.7721, rel=1e-7)
    assert any("jumps by +1.87 %" in warning for warning in curve.warnings)
    history = fm.simulate(scene("big-alabo-printed", velocity=12.0))
    assert history.outcome is fm.Outcome.SEPARATED
    assert any("jumps" in warning for warning in history.warnings)


def test_big_alabo_knots():
    """Work and velocity at the knots of (19), from the closed forms."""
    curve = curve_of(LAWS["big-alabo"])
    first = curve.work(1.0)
    assert first == pytest.approx(0.4, rel=1e-14)
    assert curve.work(13.93) / first == pytest.approx(634.4936, rel=1e-6)
    assert curve.work(82.5) / first == pytest.approx(40513.62, rel=1e-6)
    assert curve.force(82.5) == pytest.approx(417.7721, rel=1e-7)


def test_stronge_knots():
    curve = curve_of(LAWS["stronge"])
    assert curve.work(2.0) / curve.work(1.0) == pytest.approx(
        31 / 66 + 35 / 66 * 9 + 25 / 132 * 9 * math.log(3), rel=1e-12
    )
    assert curve.fit_error < 1e-13
    plastic = LAWS["stronge"].stages()[2].begin
    assert plastic == pytest.approx(82.511, abs=5e-4)
    assert curve.work(plastic) / curve.work(1.0) == pytest.approx(40253.34, rel=1e-6)


def test_big_alabo_restitution_has_its_minimum_and_maximum():
    """The force has a plateau above yield: restitution falls to 0.8232 at 1.673 V_Y, recovers to 0.9299 at 8.49 V_Y."""
    speed = yield_velocity(EFFECTIVE_MODULUS, RADIUS, YIELD, 0.06074)
    for ratio, restitution in ((1.673, 0.8232), (8.49, 0.9299)):
        summary = fm.simulate(scene("big-alabo", velocity=ratio * speed)).summary
        assert summary["coefficient_of_restitution"] == pytest.approx(restitution, abs=5e-5)


@pytest.mark.parametrize(("ratio", "warns"), [(1.5, True), (2.4, True), (2.6, False), (0.9, False)])
def test_stronge_warns_of_energy_gain(ratio, warns):
    speed = yield_velocity(EFFECTIVE_MODULUS, RADIUS, YIELD, 0.06074)
    history = fm.simulate(scene("stronge", velocity=ratio * speed))
    said = [warning for warning in history.warnings if "returns" in warning and " J (" in warning]
    assert bool(said) is warns
    assert (history.summary["coefficient_of_restitution"] > 1 + 1e-9) is warns


@pytest.mark.parametrize("name", ["hertz", "meyer", "meyer-shifted"])
def test_reversible_laws_lose_no_energy(name):
    summary = fm.simulate(scene(name)).summary
    assert summary["coefficient_of_restitution"] == pytest.approx(1, rel=1e-12)
    assert summary["energy_absorbed"] == 0
    assert summary["permanent_indentation"] == 0


def test_meyer_with_a_force_step():
    """F = F0 + K δ on a half-space, in closed form. With u = δ + F0/K, a quarter turn of an oscillator from u0."""
    law = fm.Meyer(stiffness=1e7, exponent=1.0, initial_force=100.0)
    ball = fm.Sphere("10 mm", velocity="1 m/s", mass="50 g")
    case = fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))
    omega, offset = math.sqrt(1e7 / 0.05), 100 / 1e7
    amplitude = math.hypot(offset, 1 / omega)
    summary = fm.simulate(case, accuracy=1e-9).summary
    assert summary["maximum_indentation"] == pytest.approx(amplitude - offset, rel=1e-12)
    assert summary["maximum_force"] == pytest.approx(1e7 * amplitude, rel=1e-12)
    assert summary["contact_duration"] == pytest.approx(2 * math.acos(offset / amplitude) / omega, rel=1e-12)


def test_a_scaled_family_shares_one_curve():
    """Radius, modulus and strength set the scales of the laws of spheres, not their stages."""
    assert curve_of(fm.BigAlabo(1e11, 0.02, 5e8)) is curve_of(fm.BigAlabo(2e11, 0.01, 1e9))


def test_yield_point_of_the_paper():
    indentation, _ = yield_point(EFFECTIVE_MODULUS, RADIUS, YIELD)
    assert indentation == pytest.approx(2.31411636e-6, rel=1e-9)


@dataclass(frozen=True)
class Own(fm.AbstractLaw):
    name = "own"
    stages_given: tuple = ()

    def scales(self, energy):
        return 1e-5, 100.0

    def stages(self):
        return self.stages_given


def own(*stages):
    return Own(tuple(stages))


def opening(**given):
    return fm.Unloading(**({"residual": fm.Power()} | given))


def nowhere(xi):
    return np.where(xi > 1.5, np.nan, 0.1 * xi)


class Rippled:
    """A function that cannot be hashed, so that its curve cannot be cached."""

    __hash__ = None

    def __call__(self, xi):
        return xi


def test_a_law_that_cannot_be_hashed_is_refused():
    with pytest.raises(ValueError, match="law 'own': a law must be a frozen dataclass with hashable fields"):
        curve_of(own(fm.Stage("a", 0.0, 2.0, Rippled())))


def test_a_law_that_changes_has_a_new_curve():
    class Spring(fm.AbstractLaw):
        name, summary, source = "spring", "", ""
        stiffness = 1.0

        def scales(self, energy):
            return 1e-6, 1.0

        def stages(self):
            return (fm.Stage("elastic", 0.0, math.inf, fm.Power(coefficient=self.stiffness, exponent=1.0)),)

    law = Spring()
    assert curve_of(law).force(1.0) == 1.0
    law.stiffness = 2.0
    assert curve_of(law).force(1.0) == 2.0


def test_a_fit_that_needs_many_pieces_is_exact_too():
    law = own(fm.Stage("ripple", 0.0, 30.0, lambda x: x + 0.3 * np.sin(3 * x)))
    curve = curve_of(law)
    assert curve.fit_error < 1e-12
    x = np.linspace(0, 30, 999)
    assert [curve.force(p) for p in x] == pytest.approx(x + 0.3 * np.sin(3 * x), abs=1e-11)


def test_a_fit_has_no_coefficients_below_rounding():
    curve = curve_of(own(fm.Stage("cubic", 0.0, 4.0, lambda x: x + 0.2 * x**3)))
    last = curve.native.piece[curve.native.pieces - 1]
    assert (last.force.terms, last.mean.terms) == (4, 4)
    assert curve.fit_error < 1e-14


def test_a_root_is_fitted_in_its_own_variable():
    law = own(fm.Stage("root", 0.0, 4.0, lambda x: np.sqrt(x) + x, root=True))
    curve = curve_of(law)
    assert curve.fit_error < 1e-13
    assert curve.work(4.0) == pytest.approx(2 / 3 * 8 + 8, rel=1e-12)
    small = 4e-11  # where the work is 1e-16 of the stage's
    assert curve.work(small) == pytest.approx(2 / 3 * small**1.5 + 0.5 * small**2, rel=1e-9, abs=0)


def test_a_peak_inside_a_stage_is_met_exactly():
    """A softening force: the summary contains its maximum, independent of the nodes."""
    law = own(
        fm.Stage("soft", 0.0, 3.0, lambda x: 2 * x * np.exp(-x) + 0.05 * x),
        fm.Stage("hard", 3.0, np.inf, fm.Power(constant=float(6 * np.exp(-3.0) + 0.15), slope=1.0)),
    )
    ball = fm.Sphere("10 mm", velocity="0.26 m/s", mass="50 g")
    case = fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))
    history = fm.simulate(case, segments=7)
    x = np.linspace(0.5, 1.6, 200001)
    peak = 100.0 * float((2 * x * np.exp(-x) + 0.05 * x).max())
    assert 2e-5 < history.summary["maximum_indentation"] < 3e-5
    assert history.summary["maximum_force"] == pytest.approx(peak, rel=1e-12)


@pytest.mark.parametrize(
    ("stages", "says"),
    [
        ((fm.Stage("a", 0.5, 1.0, fm.Power(slope=1.0)),), "must begin at 0.0"),
        (
            (fm.Stage("a", 0.0, 1.0, fm.Power(slope=1.0)), fm.Stage("b", 1.5, 2.0, fm.Power(slope=1.0))),
            "must begin at 1.0",
        ),
        ((fm.Stage("a", 0.0, np.inf, lambda x: x),), "has no end"),
        ((fm.Stage("a", 0.0, 2.0, lambda x: x - 1.0),), "must be finite and >= 0"),
        ((fm.Stage("a", 0.0, 2.0, lambda x: np.log(x)),), "must be finite and >= 0"),
        ((fm.Stage("a", 0.0, 2.0, lambda x: np.where(x < 1.0, x, np.nan)),), "a force of nan"),
        ((fm.Stage("a", 0.0, 50.0, lambda x: x + np.sin(5.0 * x)),), "stages, split where the force has"),
        ((fm.Stage("a", 0.0, np.inf, fm.Power(slope=1.0), damping=fm.Power(slope=1.0)),), "must say damped = True"),
        ((fm.Stage("a", 0.0, 2.0, lambda x: np.floor(7 * x)),), "cannot be fitted"),
        (
            (fm.Stage("a", 0.0, 2.0, fm.Power(slope=1.0), opening(residual=nowhere)),),
            "the residual of stage 'a' is not finite everywhere",
        ),
        (
            (fm.Stage("a", 0.0, 2.0, fm.Power(slope=1.0), opening(exponent=nowhere)),),
            "the exponent of stage 'a' is not finite everywhere",
        ),
        (
            (fm.Stage("a", 0.0, 2.0, fm.Power(slope=1.0), damping=nowhere),),
            "the damping of stage 'a' is not finite everywhere",
        ),
        (
            (fm.Stage("a", 0.0, 2.0, fm.Power(slope=1.0), opening(exponent=lambda x: 1.5, reload_exponent=np.inf)),),
            "all must be finite, and their work too",
        ),
        (
            (fm.Stage("a", 0.0, 2.0, fm.Power(slope=1.0), opening(), damping=fm.Power(constant=1.0)),),
            "a damped law must have one stage, and no unloading",
        ),
        ((), "0 stages"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_a_wrong_law_is_refused_with_its_name_and_stage(stages, says):
    with pytest.raises(ValueError, match="law 'own'") as caught:
        curve_of(own(*stages))
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("law", "said"),
    [
        (fm.Hertz("115 GPa", 0.01), "Hertz.effective_modulus: .115 GPa. is not a finite number; .* SI floats"),
        (fm.Hertz(115e9, np.nan), "Hertz.radius: nan is not a finite number"),
        (fm.Thornton(115e9, 0.01, -1e9), "Thornton.yield_pressure: -1000000000.0 must be > 0"),
        (fm.Meyer(1e9, 1.5, initial_force=-1.0), "Meyer.initial_force: -1.0 must be >= 0"),
        (fm.WaltonBraun(2e7, 1e7), "WaltonBraun.unloading_stiffness: 1e.07 N/m must be >= loading_stiffness"),
        (fm.TanSun(1e9, 1e-6, unloading_exponent=1.0), "TanSun.unloading_exponent: 1 must be >= exponent"),
        (fm.KogutEtsion(115e9, 0.01, 0.9, 1e9), "poissons_ratio: 0.9 must be > -1 and < 0.5"),
        (fm.BigAlabo(115e9, 0.01, 1e9, "rounded"), 'constants: "rounded" is not allowed: "continuous" or "printed"'),
        (fm.Retrace(fm.Stronge(115e9, 0.0, 1e9)), "radius: 0.0 must be > 0"),
    ],
)
def test_laws_made_in_python_check_the_ranges_of_scenes(law, said):
    with pytest.raises(fm.SceneError, match=f"Contact.law: .*{said}"):
        fm.Contact(law)


def test_a_rule_of_unloading_needs_a_law():
    with pytest.raises(ValueError, match='"hertz" is not a law'):
        fm.Retrace("hertz")


@pytest.mark.parametrize("scales", [(0.0, 1.0), (1e-6, -1.0), (np.nan, 1.0), (1e-6, np.inf)])
def test_wrong_scales_are_refused(scales, monkeypatch):
    law = own(fm.Stage("a", 0.0, np.inf, fm.Power(slope=1.0)))
    monkeypatch.setattr(type(law), "scales", lambda self, energy: scales)
    case = fm.Scene(fm.Sphere("10 mm", velocity="1 m/s", mass="50 g"), fm.HalfSpace(), fm.Contact(law))
    with pytest.raises(ValueError, match=r"law 'own': scales of .* must be finite and > 0"):
        fm.simulate(case)


def test_unloading_needs_exactly_one_rule():
    with pytest.raises(ValueError, match="give exactly one of"):
        fm.Unloading()
    with pytest.raises(ValueError, match="give exactly one of"):
        fm.Unloading(radius_ratio=fm.Power(constant=1.0), residual=fm.Power())


def test_a_work_function_other_than_the_integral_is_refused():
    law = own(fm.Stage("a", 0.0, 2.0, lambda x: x * x, work=lambda x: x**3))
    assert any("differs from the integral" in warning for warning in curve_of(law).warnings)


def test_indentation_beyond_the_last_stage_is_an_error():
    law = own(fm.Stage("short", 0.0, 1.0, fm.Power(slope=1.0)))
    ball = fm.Sphere("10 mm", velocity="10 m/s", mass="50 g")
    case = fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))
    with pytest.raises(fm.SimulationError, match="passed the end of the law's last stage"):
        fm.simulate(case)


def test_a_force_step_beyond_the_impedance_of_a_plate_is_an_error():
    """The impactor's 0.1 m/s would raise 14 N at most on this plate; the law begins at 100 N."""
    law = fm.Meyer(stiffness=1e7, exponent=1.0, initial_force=100.0)
    stiffnesses = fm.BendingStiffness("100 N*m", "30 N*m", "100 N*m", "35 N*m")
    plate = fm.Plate(mass_per_area="3 kg/m^2", bending_stiffness=stiffnesses)
    ball = fm.Sphere("10 mm", velocity="0.1 m/s", mass="50 g")
    case = fm.Scene(ball, plate, contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))
    assert case.target_impedance * 0.1 == pytest.approx(13.86, abs=0.01)
    with pytest.raises(fm.SimulationError, match="first touch"):
        fm.simulate(case)


def test_unloading_that_gains_energy_gives_a_warning():
    """Stronge's law between 1 and 2.54 times the yield velocity."""
    law = fm.Stronge(1.7e11, 0.01, 1e9)
    ball = fm.Sphere("10 mm", velocity=f"{1.5 * yield_velocity(1.7e11, 0.01, 1e9, 0.05)!r} m/s", mass="50 g")
    case = fm.Scene(ball, fm.HalfSpace(), contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))
    history = fm.simulate(case, accuracy=1e-8)
    gained = -history.summary["energy_absorbed"]
    assert gained > 0.0 and history.summary["coefficient_of_restitution"] > 1.0
    (said,) = (warning for warning in history.warnings if "its unloading returns" in warning)
    share = 100.0 * gained / case.kinetic_energy
    assert said == (
        f"law stronge: its unloading returns {gained:.4g} J ({share:.3g} % of the impact energy) more than its loading "
        "stored"
    )
