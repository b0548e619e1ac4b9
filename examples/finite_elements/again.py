"""Later impacts on the same dent, at the velocity of the rebound and at that of the first: a table, in minutes.

`python examples/finite_elements/again.py` compiles the program of run.py and prints rows of docs/finite_elements.md:
restitution of the first, second and third impact; largest depth and force of the second over those of the first;
energy that yielding takes in the second, over that of its ball. Loading takes twice as long as in run.py: what moves in
the half-space after an impact disturbs the next one.
"""

import numpy as np
from run import Impact, Mesh, printed

FIRST = (
    *(Impact(velocity, 200.0, hardening) for hardening in (0.0, 0.2) for velocity in (5.0, 50.0, 200.0)),
    *(Impact(50.0, 50.0), Impact(200.0, 1000.0), Impact(1000.0, 200.0)),
)
MESH = Mesh(elements=20, slowness=120.0)


def impacts(impact: Impact, later: tuple[float, ...], mesh: Mesh = MESH) -> list[tuple[float, float, float, float]]:
    """Restitution, largest depth [R] and force [Y R²], energy of yielding over that of the ball: of each impact."""
    found, history = [], list[list[float]]()
    for word, *rest in printed(impact, mesh, later):
        numbers = [float(number) for number in rest]
        if word == "history":
            history.append(numbers)
        elif word == "end":
            _, depth, force = np.array(history).T
            near = depth > 0.95 * depth.max()  # smoothed: single values of the force scatter
            peak = np.polyval(np.polyfit(depth[near] - depth.max(), force[near], 1), 0.0)
            found.append((numbers[0], float(depth.max()), 2.0 * np.pi * float(peak), numbers[5]))
            history = []
    return found


def main() -> None:
    for impact in FIRST:
        for name, later in (("of the rebound", 0.0), ("of the first", 1.0)):
            one, two, three = impacts(impact, (later, later))
            ratios = " | ".join(f"{two[k] / one[k]:.3f}" for k in (1, 2))
            values = f"{one[0]:.4f} | {two[0]:.4f} | {three[0]:.4f} | {ratios} | {two[3]:.4f}"
            given = f"{impact.velocity:g} | {impact.stiffness:g} | {impact.hardening:g}"
            print(f"| {given} | {name} | {values} |", flush=True)


if __name__ == "__main__":
    main()
