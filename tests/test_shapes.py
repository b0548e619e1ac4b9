"""Cones, flat ends and surfaces with two radii of curvature: their stiffness from geometry, in every simulation."""

import math

import mpmath
import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model.base.errors import SceneError, SimulationError
from film_model.effects.choose import choose
from film_model.explorer.content import Content
from film_model.scene.noses import oval

RUBBER = {"youngs_modulus": "5 MPa", "poissons_ratio": 0.49, "density": "1100 kg/m^3", "loss_factor": 0.0}
LIGHT = fm.Effects(gravity=False, wave_losses=False)
CONE = {"shape": "cone", "half_angle": "70 deg", "radius": "30 mm"}
CYLINDER = {"shape": "cylinder", "length": "40 mm", "radius": "5 mm"}
ELLIPSOID = {"shape": "ellipsoid", "length": "40 mm", "radius": "8 mm", "second_radius": "30 mm"}


def scene(shape, **target):
    body = fm.Sphere(velocity="0.5 m/s", material="bearing steel", **shape)
    return fm.Scene(body, fm.HalfSpace(fm.Material(**RUBBER), **target), effects=LIGHT)


def power_force(mass, velocity, stiffness, exponent):
    """Largest force of an elastic impact: ½ m V² = K δ^(q+1)/(q+1)."""
    depth = ((exponent + 1.0) * 0.5 * mass * velocity**2 / stiffness) ** (1.0 / (exponent + 1.0))
    return stiffness * depth**exponent


def johnson(large, small):
    """Radius of the ball of equal force, and area of the ellipse over its circle: Johnson 1985, (4.25) to (4.26c), with
    the complete integrals in 40 digits, for E = F = 1."""
    with mpmath.workdps(40):
        large, small = mpmath.mpf(large), mpmath.mpf(small)

        def sides(m):
            return mpmath.ellipe(m) / (1 - m) - mpmath.ellipk(m), mpmath.ellipk(m) - mpmath.ellipe(m)

        low, high = mpmath.mpf("1e-12"), 1 - mpmath.mpf("1e-14")
        m = mpmath.findroot(lambda m: sides(m)[0] / sides(m)[1] - large / small, (low, high), solver="anderson")
        over, under = sides(m)
        axes = mpmath.sqrt(1 - m)
        c = mpmath.cbrt(3 * mpmath.sqrt(large * small) * axes**1.5 * mpmath.sqrt(over * under) / (mpmath.pi * m))
        depth = 3 * mpmath.sqrt(axes) * mpmath.ellipk(m) / (2 * mpmath.pi * c)
        radius = (0.75 / depth**1.5) ** 2
        return float(radius), float(c**2 / (radius * depth))


@pytest.mark.parametrize("ratio", [1.1, 2.0, 100.0, 1e5])
def test_elliptic_contact_is_johnsons(ratio):
    found, (radius, spread) = oval(0.003 * ratio, 0.003), johnson(0.003 * ratio, 0.003)
    assert found.radius == pytest.approx(radius, rel=1e-12)
    assert found.spread == pytest.approx(spread, rel=1e-12)
    assert oval(0.003, 0.003 * ratio) == found


def test_circle_is_an_ellipse_of_equal_radii():
    assert oval(0.004, 0.004) == pytest.approx((0.004, 1.0), rel=1e-14)


def test_line_contact_is_approached_as_johnson_says():
    """Far from a circle δ/c tends to the logarithm of a line contact: κ → 0 with R'/R'' = 1/(κ² (ln(4/κ) − 1))."""
    axis = 1e-5
    found = oval(1.0 / (axis**2 * (math.log(4.0 / axis) - 1.0)), 1.0)
    assert found.spread == pytest.approx(4.0 * axis * math.log(4.0 / axis) ** 2 / math.pi**2, rel=1e-8)


def test_largest_forces_are_those_of_the_energy():
    cone, cylinder, ellipsoid = (scene(shape) for shape in (CONE, CYLINDER, ELLIPSOID))
    modulus, density = cone.effective_modulus, cone.impactor.material.density
    tangent = math.tan(math.radians(70.0))
    masses = (
        math.pi * 0.03**3 / (3 * tangent),
        math.pi * 0.005**2 * 0.04,
        math.pi / 3 * 0.04**2 * (0.008 * 0.03) ** 0.5,
    )
    powers = (
        (2 / math.pi * modulus * tangent, 2.0),
        (2 * modulus * 0.005, 1.0),
        (4 / 3 * modulus * johnson(0.03, 0.008)[0] ** 0.5, 1.5),
    )
    for made, volume, power in zip((cone, cylinder, ellipsoid), masses, powers, strict=True):
        assert made.mass == pytest.approx(density * volume, rel=1e-12)
        history = fm.simulate(made, accuracy=1e-9)
        assert history.summary["maximum_force"] == pytest.approx(power_force(made.mass, 0.5, *power), rel=1e-8)
        assert fm.Scene.from_text(made.to_toml()) == made
    depth = fm.simulate(cone).summary["maximum_indentation"]
    assert fm.simulate(cone).summary["contact_radius"] == pytest.approx(2 / math.pi * tangent * depth, rel=1e-12)
    assert fm.simulate(cylinder).summary["contact_radius"] == 0.005


def test_shaft_and_groove_are_on_both_sides_of_a_flat():
    ball = {"radius": "10 mm"}
    shaft, flat, groove = (
        scene(ball, **target) for target in ({"second_radius": "5 mm"}, {}, {"second_radius": "-12 mm"})
    )
    forces = [fm.simulate(made).summary["maximum_force"] for made in (shaft, flat, groove)]
    assert forces == sorted(forces)
    assert shaft.effective_radius == pytest.approx(johnson(0.01, 1 / 300.0)[0], rel=1e-12)
    summary = fm.simulate(shaft).summary
    area = math.pi * summary["contact_radius"] ** 2
    assert summary["peak_pressure"] == pytest.approx(1.5 * summary["maximum_force"] / area, rel=1e-9)


@pytest.mark.parametrize(
    ("shape", "target", "path", "ends"),
    [
        (CONE, {}, "impactor.half_angle", ("60 deg", "85 deg")),
        ({"radius": "10 mm"}, {"second_radius": "5 mm"}, "target.second_radius", ("2 mm", "60 mm")),
        (CYLINDER, {}, "impactor.radius", ("2 mm", "9 mm")),
    ],
)
def test_sweeps_have_the_values_of_single_impacts(shape, target, path, ends):
    made = scene(shape, **target)
    found = fd.sweep(made, {path: {"from": ends[0], "to": ends[1], "count": 60}}, workers=1)
    name = path.replace(".", "_")
    for place in (0, 17, 59):
        value = f"{float(found[name].values[place])!r} {found[name].attrs['units']}"
        alone = fm.simulate(made.replace({path: value})).summary
        for result in ("maximum_force", "contact_radius", "contact_duration"):
            assert found[result].values[place] == pytest.approx(alone[result], rel=1e-5), result


def test_derivatives_are_those_of_the_power():
    """F_m ∝ tan(α)^(1/3) m^(2/3), where the mass of the given density is ∝ 1/tan α: F_m ∝ tan(α)^(−1/3)."""
    made = scene(CONE)
    history = fm.simulate(made, accuracy=1e-9, derivatives=["impactor.half_angle"])
    angle, force = math.radians(70.0), history.summary["maximum_force"]
    wanted = -force / (3.0 * math.sin(angle) * math.cos(angle))
    assert history.derivatives.of("maximum_force", "impactor.half_angle").magnitude == pytest.approx(wanted, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "target"),
    [pytest.param(CONE, {}, marks=pytest.mark.slow), ({"radius": "10 mm"}, {"second_radius": "5 mm"})],
)
def test_component_and_fmu_are_the_simulation(shape, target, tmp_path):
    made = scene(shape, **target)
    wanted = fm.simulate(made).summary
    component, largest = fm.ImpactComponent(made), 0.0
    while component.phase != "separated":
        result = component.step("1 ms")
        largest = max([largest, *(event.contact_force for event in result.events)])
    assert largest == pytest.approx(wanted["maximum_force"], rel=2e-4)
    fmu_wrapper.export(made, tmp_path / "nose.fmu", 3)
    found = fmu_wrapper.run(tmp_path / "nose.fmu")
    assert float(found.maximum_force) == pytest.approx(wanted["maximum_force"], rel=2e-4)
    if not shape.get("shape"):
        for name in ("contact_radius", "peak_pressure"):
            assert float(found[name]) == pytest.approx(wanted[name], rel=2e-4)


def test_yield_is_warned_of_and_never_simulated():
    steel = {"material": "mild steel", "radius": "10 mm"}
    blunt = fm.Scene(fm.Sphere(**steel | CONE, velocity="1 m/s"), fm.HalfSpace("mild steel"))
    shaft = fm.Scene(fm.Sphere(**steel, velocity="1 m/s"), fm.HalfSpace("mild steel", second_radius="5 mm"))
    for made, law in ((blunt, "meyer"), (shaft, "hertz")):
        with pytest.warns(fm.ImpactWarning, match="plasticity"):
            history = fm.simulate(made)
        assert history.to_dict()["law"] == law
        assert history.summary["coefficient_of_restitution"] == pytest.approx(1.0, abs=0.02)
    slow = shaft.replace({"impactor.velocity": "1 mm/s"})
    assert next(effect for effect in choose(slow).effects if effect.name == "plasticity").state == "not needed"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"impactor.length": "1 mm"}, 'impactor.length: only shape "cylinder" or "ellipsoid" has it'),
        ({"impactor.half_angle": None}, 'impactor.half_angle: missing: shape "cone" needs it'),
        ({"impactor.angle": "20 deg"}, 'impactor.angle: only a ball has it, not shape "cone"'),
        ({"target.radius": "1 m"}, 'target.radius: shape "cone" needs a flat target'),
        ({"contact.law": "hertz"}, 'contact.law: law "hertz" is of balls'),
        ({"contact.unloading": "brake"}, "contact.unloading: Brake's rule is of balls"),
        ({"contact.friction": 0.1}, "contact.friction: friction is simulated of balls"),
        ({"effects.plasticity": True}, "effects.plasticity: true, but laws that yield are of balls"),
        (
            {"impactor.shape": "flat punch", "impactor.half_angle": None},
            "impactor.mass: missing: give mass: the volume",
        ),
    ],
)
def test_what_a_shape_cannot_have_is_said(changes, message):
    with pytest.raises(SceneError, match=message.replace("(", "\\(")):
        scene(CONE).replace(changes)


def test_law_that_yields_and_narrow_groove_are_refused():
    made = scene({"radius": "10 mm"}, second_radius="5 mm")
    with pytest.raises(SceneError, match='law "stronge" is of balls'):
        made.replace({"contact.law": "stronge", "contact.yield_strength": "1 MPa"})
    with pytest.raises(SceneError, match=r"target.second_radius: -9 mm is a hollow: it must be < -10 mm"):
        made.replace({"target.second_radius": "-9 mm"})
    damped = made.replace({"contact.law": "tsuji", "contact.restitution": 0.7})
    assert fm.simulate(damped).summary["coefficient_of_restitution"] == pytest.approx(0.7, rel=1e-3)
    with pytest.raises(SimulationError, match="contacts of balls"):
        Content([("scene", made)])


def test_contact_beyond_the_base_is_warned_of():
    soft = scene({**CONE, "radius": "2 mm", "mass": "200 g"})
    with pytest.warns(fm.ImpactWarning, match="the cone is pressed in beyond its base"):
        fm.simulate(soft)


def test_many_ovals_are_ovals():
    ratios = np.geomspace(1.0, 1e4, 50)
    many = oval(0.01 * ratios, 0.01)
    assert [many.radius[k] for k in (0, 20, 49)] == [oval(float(0.01 * ratios[k]), 0.01).radius for k in (0, 20, 49)]
