"""What contact-for prints, run in the engines themselves; each test is skipped where its engine is not installed."""

import math

import engine_runs
import pytest
from cases import BALL, STEEL

import film_model as fm
from film_model.translate import ENGINES, contact_for

pytestmark = pytest.mark.slow

ELASTOPLASTIC = fm.Scene(
    fm.Sphere(velocity="0.5 m/s", **BALL), fm.HalfSpace(material=STEEL), contact=fm.Contact(law="big-alabo")
)
TWO_BALLS = fm.Scene(
    ELASTOPLASTIC.impactor, fm.Body(radius="15 mm", mass="100 g", material=STEEL), contact=ELASTOPLASTIC.contact
)
ERRORS = {"force": 1e-3, "duration": 2e-3, "restitution": 1e-3}
"""Allowed differences between an engine and our march of its law; a step is 5e-4 of the contact."""


def fitted(engine, law, scene=ELASTOPLASTIC):
    return contact_for(ENGINES[engine], scene, (0.1, 2), law=law)[0]


def compare(made, run, *arguments, allowed=ERRORS, rows=(0, -1)):
    """The engine against what contact-for says of it, at both ends of the range."""
    for at in rows:
        found = run(made, float(made.velocities[at]), *arguments)
        for name, most in allowed.items():
            assert found[name] == pytest.approx(made.found[name][at], rel=most), (name, at)


def test_mujoco():
    made = fitted("mujoco", "constraint")
    compare(made, engine_runs.run_mujoco)


def test_two_balls():
    compare(fitted("mujoco", "constraint", TWO_BALLS), engine_runs.run_mujoco)
    compare(fitted("lammps", "hertz", TWO_BALLS), engine_runs.run_lammps)


@pytest.mark.parametrize("joint", ["<freejoint/>", '<joint type="slide" axis="0 0 1"/>'])
def test_mujoco_with_friction(joint):
    """An elliptic cone leaves the normal force as it is, on either joint; a pyramidal one does not."""
    made = fitted("mujoco", "constraint")
    rough = made.paste().replace('condim="1"', 'condim="3" friction="0.5 0.5 0.005 0.0001 0.0001"')
    rough = rough.replace("<freejoint/>", joint)
    found = engine_runs.run_mujoco(made, 0.1, rough)["force"]
    assert found == pytest.approx(made.found["force"][0], rel=1e-3)
    if "slide" not in joint:
        assert engine_runs.run_mujoco(made, 0.1, rough.replace("elliptic", "pyramidal"))["force"] > 1.1 * found


def test_drake_continuous():
    compare(fitted("drake", "point"), engine_runs.run_drake)


@pytest.mark.parametrize("approximation", ["kLagged", "kSimilar", "kTamsi"])
def test_drake_discrete(approximation):
    allowed = {"force": 3e-3, "duration": 2e-3, "restitution": 4e-3}
    compare(fitted("drake", "point"), engine_runs.run_drake, approximation, allowed=allowed)


def test_drake_sap():
    """Its own law at the printed step, 200 a contact; with the dissipation of the other law a ball does not rebound."""
    allowed = {"force": 0.015, "duration": 5e-3, "restitution": 0.03}
    compare(fitted("drake", "sap"), engine_runs.run_drake, allowed=allowed)
    assert engine_runs.run_drake(fitted("drake", "point"), 2.0, "kSap")["restitution"] < 1e-3


def test_hydroelastic_force_of_drake():
    """Within h²/(4Rδ) of the integral, h the length of the facets."""
    drake = pytest.importorskip("pydrake.all")
    radius, depth, modulus, length = 0.05, 5e-3, 1e6, 5e-3
    ball, target = drake.ProximityProperties(), drake.ProximityProperties()
    drake.AddCompliantHydroelasticProperties(length, modulus, ball)
    drake.AddRigidHydroelasticProperties(length, target)
    for one in (ball, target):
        drake.AddContactMaterial(dissipation=0.3, friction=drake.CoulombFriction(), properties=one)
    builder = drake.DiagramBuilder()
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder, 0.0)
    plant.set_contact_model(drake.ContactModel.kHydroelastic)
    body = plant.AddRigidBody("ball", drake.SpatialInertia.SolidSphereWithMass(1.0, radius))
    at = drake.RigidTransform()
    plant.RegisterCollisionGeometry(body, at, drake.Sphere(radius), "ball", ball)
    below = drake.RigidTransform([0, 0, -0.5])
    plant.RegisterCollisionGeometry(plant.world_body(), below, drake.Box(1, 1, 1), "target", target)
    plant.Finalize()
    diagram = builder.Build()
    context = plant.GetMyContextFromRoot(root := diagram.CreateDefaultContext())
    plant.SetFreeBodyPose(context, body, drake.RigidTransform([0, 0, radius - depth]))
    speed = drake.SpatialVelocity([0, 0, 0], [0, 0, -1.0])
    plant.SetFreeBodySpatialVelocity(context=context, body=body, V_JpJc=speed)
    results = plant.get_contact_results_output_port().Eval(context)
    force = abs(results.hydroelastic_contact_info(0).F_Ac_W().translational()[2])
    exact = math.pi * modulus * depth**2 * (1 - 2 * depth / (3 * radius)) * 1.3
    assert root is not None
    assert 1 - 1.5 * length**2 / (4 * radius * depth) < force / exact < 1.0


def test_bullet():
    """Its implicit step is of first order: 2000 in the contact."""
    allowed = {"force": 2e-3, "duration": 2e-3, "restitution": 4e-3}
    compare(fitted("bullet", "contact"), engine_runs.run_bullet, allowed=allowed)
    compare(fitted("bullet", "contact", TWO_BALLS), engine_runs.run_bullet, allowed=allowed)


@pytest.mark.parametrize("scene", [ELASTOPLASTIC, TWO_BALLS])
def test_newton(scene):
    """From the middle velocity on: at 0.1 m/s a step is 4 nm, four units in the last place of a 32-bit position."""
    compare(fitted("newton", "semi-implicit", scene), engine_runs.run_newton, rows=(4, -1))


def test_modelica():
    compare(fitted("modelica", "elasto-gap"), engine_runs.run_modelica)


@pytest.mark.parametrize("law", [law.name for law in ENGINES["lammps"].laws])
def test_lammps(law):
    compare(fitted("lammps", law), engine_runs.run_lammps)


@pytest.mark.parametrize("law", [law.name for law in ENGINES["liggghts"].laws])
def test_liggghts(law, tmp_path):
    compare(fitted("liggghts", law), engine_runs.run_liggghts, tmp_path)


@pytest.mark.parametrize("law", [law.name for law in ENGINES["yade"].laws])
def test_yade(law, tmp_path):
    compare(fitted("yade", law), engine_runs.run_yade, tmp_path)
