"""A contact law of your own: a headform on a crushable foam liner.

The liner is linear until its cells crush, then has a plateau (tanh) that stiffens as the cells close (exponential). It
unloads along a straight line to a permanent indentation of 70 % of the crushed depth.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

import film_model as fm
from film_model.studies import quadrature

CRUSH = 0.05  # of the thickness
PLATEAU = 0.04  # force of the plateau above that at crush, in units of stiffness × thickness
DENSIFICATION = 6.0  # rate of the exponential over the thickness


def crushing(x):
    """Force over stiffness × thickness, at an indentation of x thicknesses beyond which the cells crush."""
    y = x - CRUSH
    return CRUSH + PLATEAU * (np.tanh(y / CRUSH) + 0.2 * np.expm1(DENSIFICATION * y))


@dataclass(frozen=True)
class Foam(fm.AbstractLaw):
    """stiffness: N/m before crush. thickness: m."""

    name: ClassVar[str] = "foam"
    summary: ClassVar[str] = "linear, then a plateau and densification"
    source: ClassVar[str] = "this example"

    stiffness: float
    thickness: float

    def scales(self, energy):
        return self.thickness, self.stiffness * self.thickness

    def stages(self):
        dent = fm.Unloading(residual=lambda x: 0.7 * (x - CRUSH), exponent=1.0)
        return (
            fm.Stage("linear", 0.0, CRUSH, fm.Power(slope=1.0)),
            fm.Stage("crushing", CRUSH, 0.9, crushing, dent),
        )


def main() -> tuple[fm.History, dict[str, float]]:
    """The history, and the exact summary to compare with."""
    law = Foam(stiffness=600e3, thickness=0.030)
    scene = fm.Scene(
        fm.Sphere(radius="80 mm", mass="5 kg", velocity="4 m/s"),
        fm.HalfSpace(),
        fm.Contact(law),
        fm.Effects(gravity=False),
        title="Headform on a foam liner",
    )
    return fm.simulate(scene, accuracy=1e-8), quadrature.quadrature(law, scene.mass, scene.approach_velocity)


if __name__ == "__main__":
    history, exact = main()
    print(
        f"error of the fitted law {history.problem.curve.fit_error:.1e}, of the march {history.accuracy.estimated:.1e}"
    )
    print(f"{'':30}{'FILM':>16}{'quadrature':>16}")
    for name, value in exact.items():
        print(f"{name:30}{history.summary[name]:16.9g}{value:16.9g}")
