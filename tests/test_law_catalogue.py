"""Properties that all laws share, and the mistakes in their parameters."""

import random

import numpy as np
import pytest
from cases import DAMPED, LAWS, MASS, SPHERE, YIELD, combinations, scene
from law_cases import CONTACTS, scene_text

import film_model as fm
from film_model.problem.curve import curve_of
from film_model.studies import quadrature

GIVES_ENERGY = ("stronge",)  # between V_Y and 2.54 V_Y, with a warning


@pytest.mark.parametrize("target", ["half-space", "plate"])
@pytest.mark.parametrize("law", list(CONTACTS))
def test_a_scene_file_runs_everywhere(law, target):
    """On half-space and plate, alone, in a component and in a batch, and read from its own text."""
    case = fm.Scene.from_text(scene_text(law, target))
    assert fm.Scene.from_text(case.to_toml()) == case
    history = fm.simulate(case, accuracy=1e-7)
    assert history.outcome is fm.Outcome.SEPARATED
    component = fm.ImpactComponent(case, accuracy=1e-7)
    event = component.step("10 ms").events[-1]
    assert event.name == "contact_ends"
    assert event.time == pytest.approx(history.summary["contact_duration"], rel=1e-12)
    assert event.impactor_velocity == pytest.approx(history.summary["rebound_velocity"], rel=1e-12)
    batch = fm.simulate_batch(case, velocity=["0.1 m/s", "0.25 m/s"], accuracy=1e-6)
    for name in ("maximum_force", "contact_duration", "rebound_velocity"):
        assert batch.summary[name][1] == pytest.approx(history.summary[name], rel=2e-6)


@pytest.mark.slow
@combinations(target=["half-space", "plate"], law=[name for name in LAWS if name not in ("big-alabo-printed", *DAMPED)])
def test_the_march_agrees_with_answers_that_do_not_use_the_core(law, target):
    for velocity in (0.02, 0.25):
        case = scene(law, target, velocity=velocity).replace({"effects.gravity": False})
        got = fm.simulate(case, accuracy=1e-10).summary
        if target == "half-space":
            exact = quadrature.quadrature(LAWS[law], MASS, velocity)
        else:
            exact = quadrature.integrate(LAWS[law], MASS, velocity, case.target_impedance, rtol=1e-11)
        for name in quadrature.REFERENCE_VALUES:
            scale = max(abs(exact[name]), 1e-3 * case.kinetic_energy if "energy" in name else 0.0)
            assert got[name] == pytest.approx(exact[name], rel=3e-9, abs=3e-9 * scale + 1e-15), (name, velocity)


@pytest.mark.parametrize("law", [name for name in LAWS if name not in GIVES_ENERGY])
def test_no_impact_gains_energy(law):
    case = scene(law).replace({"effects.gravity": False})
    last = 1.5 if law != "saturating" else 1.0
    speeds = np.geomspace(1e-3, last, 200)
    batch = fm.simulate_batch(case, velocity=[f"{v!r} m/s" for v in speeds.tolist()], accuracy=1e-6)
    assert not batch.failed.any()
    assert (batch.summary["coefficient_of_restitution"] <= 1.0 + 1e-9).all()
    assert (batch.summary["energy_absorbed"] >= -1e-9 * 0.5 * MASS * speeds**2).all()
    assert (batch.summary["permanent_indentation"] >= -1e-12).all()


@pytest.mark.parametrize("law", [name for name in LAWS if name not in (*GIVES_ENERGY, *DAMPED)])
def test_no_sequence_of_loads_gains_energy(law):
    """The energy dissipated by the end of a contact never decreases, whatever loads were applied before."""
    rng = random.Random(law)
    component = fm.ImpactComponent(scene(law, velocity=0.2), segments=40)
    period = 20e-6
    lost = 0.0
    for _ in range(60):
        component.step(period * rng.uniform(0.05, 1.0), external_force=rng.uniform(-800.0, 800.0))
        saved = component.save()
        while component.phase not in ("separated", "approaching"):
            component.step(period, external_force=-3000.0, stop_at_events=True)
        released = component._motion.contact.spent
        component.restore(saved)
        assert released >= lost - 1e-12 * component.problem.approach**2
        lost = max(lost, released)
    reversible = all(stage.unloading is None for stage in LAWS[law].stages())
    assert (lost > 1e-3 * component.problem.approach**2) is not reversible


@pytest.mark.parametrize("law", [fm.Thornton(*SPHERE, 1.6e9), fm.YigitChristoforou(*SPHERE, YIELD)], ids=repr)
def test_slope_is_continuous_at_yield(law):
    curve, h = curve_of(law), 1e-6
    below, above = (curve.force(1.0) - curve.force(1 - h)) / h, (curve.force(1 + h) - curve.force(1.0)) / h
    assert below == pytest.approx(above, rel=2e-6)


BAD_TABLES = [
    ("", "line 1: a heading is needed, with units"),
    ("indentation, force\n0,0\n1,1\n", "line 1: a heading is needed, with units"),
    ("indentation (um)\n0\n1\n", "line 1: a heading is needed"),
    ("indentation (N), force (N)\n0,0\n", 'line 1: indentation: "1 N" is a force, a length is needed'),
    ("indentation (um), force (kN)\n0,0\n1,x\n", 'line 3: force is "x", a number is needed'),
    ("indentation (um), force (kN)\n0,0\n1\n", 'line 3: force is "", a number is needed'),
    ("indentation (um), force (kN)\n0,0\n2,1\n2,2\n", "indentation: point 3, 2e-06 m, is not above the one before"),
    ("indentation (um), force (kN)\n0,0\n2,2\n3,1\n", "force: point 3, 1000 N, is below the one before, 2000 N"),
    ("indentation (um), force (kN)\n1,0\n2,1\n", "indentation: the first value is 1e-06 m; it must be 0 m"),
    ("indentation (um), force (kN)\n0,0\n", "1 points; 2 to 5000 are allowed"),
    ("indentation (um), force (kN)\n0,0\n1,0\n", "force: is zero everywhere"),
    ("indentation (um), force (kN)\n" + "".join(f"{k},{k}\n" for k in range(5001)), "more than 5000 rows"),
]


@pytest.mark.parametrize(("rows", "said"), BAD_TABLES)
def test_an_invalid_table_is_refused_with_its_line(tmp_path, rows, said):
    (tmp_path / "curve.csv").write_text(rows, encoding="utf-8")
    path = tmp_path / "scene.toml"
    path.write_text(scene_text("tabulated", contact='file = "curve.csv"'), encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        fm.Scene.from_toml(path)
    [mistake] = caught.value.mistakes
    assert (mistake.key, mistake.line) == ("contact.file", 15)
    assert said in mistake.message and "curve.csv" in mistake.message


TWO = 'indentation = ["0 um", "10 um"]\nforce = ["0 N", "5 N"]\n'
BAD_CONTACTS = [
    ("linear-dashpot", 'stiffness = "1 N/m"', "contact.damping: give restitution or damping"),
    (
        "linear-dashpot",
        'stiffness = "1 N/m"\nrestitution = 0.5\ndamping = "1 N*s/m"',
        "contact.damping: give restitution or damping, not both",
    ),
    ("linear-dashpot", 'stiffness = "1 N/m"\ndamping = "1 N/m"', "is a stiffness, an impedance is needed"),
    ("tsuji", "", 'contact.restitution: missing: law "tsuji" needs it'),
    ("tsuji", "restitution = 1.1", "contact.restitution: 1.1 must be above 0 and at most 1"),
    ("tsuji", "restitution = 0", "contact.restitution: 0 must be > 0"),
    ("hunt-crossley", "", "contact.hysteresis_damping: give restitution or hysteresis_damping"),
    ("hunt-crossley", 'hysteresis_damping = "1 m/s"', "is a velocity, an inverse velocity is needed"),
    ("kuwabara-kono", 'dissipation_time = "-1 us"', 'contact.dissipation_time: "-1 us" must be >= 0'),
    (
        "kuwabara-kono",
        'dissipation_time = "1 us"\nunloading = "brake"',
        'contact.unloading: law "kuwabara-kono" is damped: it takes no rule of unloading',
    ),
    ("thornton", 'yield_pressure = "1 N"', 'contact.yield_pressure: "1 N" is a force, a pressure is needed'),
    ("thornton", 'yield_pressure = "0 Pa"', 'contact.yield_pressure: "0 Pa" must be > 0'),
    ("thornton", 'hardness = "1 Pa"', 'contact.hardness: unknown key; it belongs to law "kogut-etsion"'),
    ("kogut-etsion", 'hardness = "1 GPa"\nconstants = "old"', 'contact.constants: "old" is not allowed'),
    ("kogut-etsion", 'hardness = "1 GPa"\npoissons_ratio = 0.5', "contact.poissons_ratio: 0.5 is out of range"),
    ("jackson-green", 'unloading = "brakes"', 'contact.unloading: "brakes" is not allowed: "brake" or "retrace"'),
    (
        "walton-braun",
        'loading_stiffness = "2 N/m"\nunloading_stiffness = "1 N/m"',
        "contact.unloading_stiffness: 1 N/m must be >= loading_stiffness 2 N/m",
    ),
    ("walton-braun", 'loading_stiffness = "2 N/m"', "contact.unloading_stiffness: missing"),
    (
        "luding",
        'loading_stiffness = "2 N/m"\nplastic_stiffness = "2 N/m"\nplasticity_depth = 0.1',
        "contact.plastic_stiffness: 2 N/m must be > loading_stiffness 2 N/m",
    ),
    ("tan-sun", 'critical_indentation = "5 um"', "contact.stiffness: missing"),
    (
        "tan-sun",
        'stiffness = "1e9 N/m"\ncritical_indentation = "5 um"',
        'contact.stiffness: "1e9 N/m" is a stiffness, N/m^1.5 is needed',
    ),
    (
        "tan-sun",
        'stiffness = "1 N/m^1.5"\ncritical_indentation = "5 um"\nunloading_exponent = 1.2',
        "contact.unloading_exponent: 1.2 must be >= exponent 1.5: it would give energy",
    ),
    (
        "tan-sun",
        'stiffness = "1 N/m^1.5"\ncritical_indentation = "5 um"\nreloading_exponent = 3',
        "contact.reloading_exponent: 3 must be <= unloading_exponent 2.5: it would give energy",
    ),
    (
        "tan-sun",
        'stiffness = "1 N/m^1.5"\ncritical_indentation = "5 um"\npermanent_fraction = 2',
        "contact.permanent_fraction: 2 must be <= 1",
    ),
    ("tabulated", "", 'contact.indentation: missing: law "tabulated" needs file, or indentation and force'),
    ("tabulated", 'force = ["0 N", "1 N"]', "contact.indentation: missing"),
    ("tabulated", TWO + 'file = "x.csv"', "contact.indentation: give file, or indentation and force, not both"),
    ("tabulated", 'file = "no such.csv"', 'contact.file: "no such.csv" cannot be read: No such file'),
    ("tabulated", "file = 5", "contact.file: 5 is not a text"),
    ("tabulated", TWO.replace('"10 um"', "10"), "contact.indentation: value 2: 10 has no unit, a length is needed"),
    ("tabulated", TWO.replace('["0 N", "5 N"]', '"5 N"'), 'contact.force: "5 N" is not a list, a force is needed'),
    ("tabulated", TWO.replace('"5 N"]', '"5 N", "6 N"]'), "contact.force: 3 values for 2 indentations"),
    ("tabulated", TWO.replace('"0 um", "10 um"', '"0 um", "-1 um"'), "it must increase"),
    ("tabulated", TWO.replace('"0 N"', '"-1 N"'), "contact.force: the first value is -1 N; it must be >= 0 N"),
]


@pytest.mark.parametrize(("law", "contact", "said"), BAD_CONTACTS)
def test_invalid_parameters_are_named(law, contact, said):
    with pytest.raises(fm.SceneError) as caught:
        fm.Scene.from_text(scene_text(law, contact=contact))
    assert any(said in str(mistake) for mistake in caught.value.mistakes), str(caught.value)


def test_missing_material_data_are_named():
    text = '[impactor]\nradius = "1 mm"\nmass = "1 g"\nvelocity = "1 m/s"\n[target]\nkind = "half-space"\n[contact]\n'
    with pytest.raises(fm.SceneError, match=r"contact.poissons_ratio: missing: law .kogut-etsion. needs it"):
        fm.Scene.from_text(text + 'law = "kogut-etsion"\nhardness = "1 GPa"\neffective_modulus = "9 GPa"')
    with pytest.raises(fm.SceneError, match=r"contact.yield_pressure: missing: law .thornton. needs it, or a yield"):
        fm.Scene.from_text(text + 'law = "thornton"\neffective_modulus = "9 GPa"')
    with pytest.raises(fm.SceneError, match=r"contact.effective_modulus: missing"):
        fm.Scene.from_text(text + 'law = "tabulated"\n' + TWO)
    reversible = fm.Scene.from_text(
        text + 'law = "tabulated"\nunloading = "retrace"\n' + TWO.replace('"5 N"', '"5 kN"')
    )
    assert fm.simulate(reversible).summary["coefficient_of_restitution"] == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(ValueError, match=r"Tabulated.force: point 2, -1 N"):
        fm.Tabulated([0, 1e-6], [0.0, -1.0])
    with pytest.raises(ValueError, match="reload_exponent"):
        fm.Unloading(residual=fm.Power(), exponent=1.5, reload_exponent=2.0)
