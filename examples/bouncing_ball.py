"""A ball dropped from 5 mm bounces to rest on a steel plate: every bounce, and the dent, in one run of the component.

The first bounce leaves the dent, in which all later ones are elastic. What brings the ball to rest is the plate, whose
waves carry energy away.
"""

from typing import NamedTuple

import film_model as fm


class Bounce(NamedTuple):
    """One contact: times [s], velocities [m/s], force [N] and dent [m]."""

    begins: float
    ends: float
    velocity: float
    rebound: float
    maximum_force: float
    dent: float


def main() -> tuple[list[Bounce], fm.ImpactComponent]:
    """All bounces until the ball rests, and the component at rest."""
    scene = fm.Scene(
        fm.Sphere(radius="5 mm", drop_height="5 mm", material="bearing steel"),
        fm.Plate("mild steel", thickness="12 mm"),
        effects=fm.Effects(gravity=True),
        solver=fm.Solver(accuracy=1e-6),
    )
    component = fm.ImpactComponent(scene)
    component.initialize(initial_gap="5 mm", velocity="0 m/s")
    bounces: list[Bounce] = []
    touch = deepest = None
    while component.phase != "resting":
        for event in component.step("10 ms").events:
            if event.name == "contact_begins":
                touch = deepest = event
            elif event.name == "maximum_indentation":
                deepest = event
            elif event.name == "contact_ends":
                velocities = touch.impactor_velocity, event.impactor_velocity
                bounces.append(Bounce(touch.time, event.time, *velocities, deepest.contact_force, event.indentation))
    return bounces, component


if __name__ == "__main__":
    bounces, component = main()
    print(f"{'':6}{'touches':>12}{'for':>12}{'velocity':>12}{'rebound':>12}{'e':>8}{'force':>10}{'dent':>10}")
    for number, b in enumerate(bounces, 1):
        if number <= 5 or number % 20 == 0 or number == len(bounces):
            print(
                f"{number:6}{b.begins * 1e3:9.3f} ms{(b.ends - b.begins) * 1e6:9.2f} us{b.velocity:8.4f} m/s"
                f"{b.rebound:8.4f} m/s{-b.rebound / b.velocity:8.4f}{b.maximum_force:8.2f} N{b.dent * 1e6:7.4f} um"
            )
    print(f"at rest by {component.time:.3f} s, the weight on it: {component.outputs.contact_force:.6f} N")
