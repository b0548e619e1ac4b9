"""Vector lanes on fixed targets: contacts in series with springs, and impactors that stop on free bodies."""

import numpy as np
import pytest

import film_model as fm
from film_model.core import families, native
from film_model.effects.many import problems_of
from film_model.problem.summary import difference

MATERIAL = {"youngs_modulus": "209 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3", "yield_strength": "0.5 GPa"}
VELOCITY, RATIO = "impactor.velocity", "target.material.poissons_ratio"
LINES = native.mesh(native.WORK_PRESERVING, 400, 400, ways=native.LINES)


def problem_on(target, law, path, effects, **given):
    """Forty impacts of steel that share a curve or a family."""
    ball = fm.Sphere("10 mm", velocity="1 m/s", material=MATERIAL)
    scene = fm.Scene(ball, target, fm.Contact(law, **given), fm.Effects(gravity=False, **effects))
    ends = {VELOCITY: (0.05, 10.0), RATIO: (0.2, 0.4), "target.material.youngs_modulus": (1e11, 4e11)}[path]
    (problem,) = problems_of(scene, {path: np.geomspace(*ends, 40)}, 40)
    return problem


def off_lines(problem, count):
    """The largest difference of a march on `count` segments from that on 400 lines."""
    exact, lines = problem.march(LINES)
    status, found = problem.march(native.mesh(native.WORK_PRESERVING, count, count))
    assert (status == exact).all() and (status == native.EVENT).all()
    return float(difference(problem, found, lines).max())


@pytest.mark.parametrize(("law", "path", "given"), [
    ("hertz", VELOCITY, {}),
    ("stronge", VELOCITY, {}),
    ("jackson-green", "target.material.youngs_modulus", {}),
    ("jackson-green", RATIO, {}),
    ("kogut-etsion", RATIO, {"hardness": "1.4 GPa"}),
])  # fmt: skip
@pytest.mark.parametrize("thickness", ["20 mm", "2 mm"])
def test_contacts_in_series_converge_to_the_march(law, path, given, thickness):
    plate = fm.Plate(MATERIAL, thickness, size=["400 mm", "400 mm"])
    still = {"boundary_reflections": True, "target_inertia": False, "target_motion": True}
    problem = problem_on(plate, law, path, still, **given)
    assert problem.own.spring is not None
    assert off_lines(problem, 6) < 2e-5
    assert off_lines(problem, 24) < 3e-8


def test_instructions_give_the_same_bytes_in_series():
    plate = fm.Plate(MATERIAL, "2 mm", size=["400 mm", "400 mm"])
    problem = problem_on(plate, "stronge", VELOCITY, {"boundary_reflections": True, "target_inertia": False})
    curve, spring = problem.impacts.curve.native, problem.own.spring
    mesh = native.mesh(native.WORK_PRESERVING, 6, 6)
    found = [
        families.batch(families.Rows(curve, compliance=spring), mesh, problem.start, using)[1].tobytes()
        for using in range(native.instructions() + 1)
    ]
    assert len(set(found)) == 1
    alone = [
        families.batch(families.Rows(curve, compliance=spring[k : k + 1]), mesh, problem.start[k : k + 1])[1].tobytes()
        for k in range(spring.size)
    ]
    assert b"".join(alone) == found[0]


@pytest.mark.parametrize(
    ("law", "given"), [("jackson-green", {}), ("big-alabo", {}), ("jkr", {"work_of_adhesion": "0.1 J/m^2"})]
)
@pytest.mark.parametrize("radius", ["20 mm", "90 mm", "200 mm", "1 m", "100 m", "1 km"])
def test_impactors_stop_on_free_bodies_as_in_the_march(law, given, radius):
    problem = problem_on(fm.Body(MATERIAL, radius=radius), law, VELOCITY, {}, **given)
    assert (problem.start["stop_velocity"] < 0.0).all()
    exact, lines = problem.march(LINES)
    status, found = problem.march(native.mesh(native.WORK_PRESERVING, 24, 24))
    assert (status == exact).all()
    stops = lines.time_impactor_stops
    assert np.isfinite(stops).any() and (np.isnan(stops) == np.isnan(found.time_impactor_stops)).all()
    np.testing.assert_allclose(found.time_impactor_stops, stops, rtol=2e-7)
