"""The Modelica wrapper of contact FMUs, compiled and run by Rumoca with Hertz's law in place of an imported FMU."""

from pathlib import Path

import numpy as np
import pytest
from cases import scene

import film_model as fm

rumoca = pytest.importorskip("rumoca", reason='needs pip install "film-model[interop]"')

WRAPPER = Path(__file__).parents[1] / "examples" / "modelica" / "FilmContact.mo"
MODELICA = """
package Modelica "The classes of the Modelica Standard Library that the wrapper uses"
  package Units
    package SI
      type Length = Real(unit = "m");
      type Force = Real(unit = "N");
    end SI;
  end Units;
  package Mechanics
    package Translational
      package Interfaces
        connector Flange_a
          Modelica.Units.SI.Length s;
          flow Modelica.Units.SI.Force f;
        end Flange_a;
        connector Flange_b
          Modelica.Units.SI.Length s;
          flow Modelica.Units.SI.Force f;
        end Flange_b;
        partial model PartialTwoFlanges
          Flange_a flange_a;
          Flange_b flange_b;
        end PartialTwoFlanges;
      end Interfaces;
    end Translational;
  end Mechanics;
end Modelica;
"""
SYSTEM = """
block Hertz
  extends FilmContact.ContactForce;
  parameter Real stiffness = 1;
equation
  contact_force = stiffness * max(indentation, 0.0) ^ 1.5;
end Hertz;
model Body
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange;
  parameter Real m = 1;
  parameter Real start = 0;
  parameter Real speed = 0;
  Real s(start = start, fixed = true);
  Real v(start = speed, fixed = true);
equation
  flange.s = s;
  der(s) = v;
  m * der(v) = flange.f;
end Body;
model System
  Body ball(m = %(mass)r, speed = %(speed)r);
  Body target(m = %(other)r, start = 0.001, speed = %(drift)r);
  FilmContact.Contact contact(gap = 0.001, redeclare Hertz fmu(stiffness = %(stiffness)r));
equation
  connect(ball.flange, contact.flange_a);
  connect(contact.flange_b, target.flange);
end System;
"""


def test_two_bodies_on_flanges_are_the_impact_of_simulate():
    on = scene("hertz", "body").replace({"effects.gravity": False})
    history = fm.simulate(on, accuracy=1e-6)
    scales = history.problem.scales
    given = {
        "mass": on.mass,
        "speed": on.impactor.velocity,
        "other": on.target.own_mass,
        "drift": on.target.velocity,
        "stiffness": scales.force / scales.length**1.5,
    }
    text = MODELICA + WRAPPER.read_text("utf-8") + SYSTEM % given
    model = rumoca.Session().loads(text, model="System", filename="system.mo")
    end = 1.2 * history.duration
    result = model.simulate((0.0, end), dt=end / 1000, config=rumoca.SimConfig(rtol=1e-9, atol=1e-13))
    forces = np.asarray(result["contact.fmu.contact_force"])
    assert forces.max() == pytest.approx(history.summary["maximum_force"], rel=1e-5)
    rebound = history.summary["rebound_velocity"]
    assert np.asarray(result["ball.v"])[-1] == pytest.approx(rebound, abs=1e-6 * on.approach_velocity)
