"""When does loading end on a compliant plate? At the maximum indentation, not when the ball stops.

Big-Alabo, Cartmell & Harrison 2017 load the contact of a plastic law until the impactor's velocity is zero. On a plate
the indentation decreases before that, because the plate moves away faster than the ball: until the ball stops, the
contact would unload along its loading curve and return the plastic work. This example integrates both rules with scipy,
for a steel ball on aluminium and Thornton's law, and compares them with `simulate`.
"""

from math import pi, sqrt

from scipy.integrate import solve_ivp

import film_model as fm

BALL = fm.Sphere(radius="5 mm", velocity="1.5 m/s", material="bearing steel")
PLATE = fm.Plate(material="aluminium 6061-T6", thickness="4 mm")
YIELD_PRESSURE = 442e6  # Pa, 1.6 times the yield strength


def impact(scene: fm.Scene, stops: bool) -> dict[str, float]:
    """Summary by scipy's DOP853. stops: unloading begins when the ball stops instead of at the maximum indentation."""
    mass, radius, impedance = scene.effective_mass, scene.effective_radius, scene.target_impedance
    stiffness = 4.0 / 3.0 * scene.effective_modulus * sqrt(radius)
    yields = (pi * YIELD_PRESSURE / (2.0 * scene.effective_modulus)) ** 2 * radius

    def loading(depth: float) -> float:
        elastic = stiffness * min(max(depth, 0.0), yields) ** 1.5
        return elastic + pi * radius * YIELD_PRESSURE * max(depth - yields, 0.0)

    def march(force, start, begin, end):
        def motion(_, state):
            return state[1] - force(state[0]) / impedance, -force(state[0]) / mass

        def over(_, state):
            return end(motion(0.0, state), state)

        over.terminal, over.direction = True, -1
        found = solve_ivp(motion, (begin, begin + 1.0), start, "DOP853", events=over, rtol=1e-12, atol=1e-15)
        return found.t[-1], found.y[:, -1]

    start = (0.0, scene.approach_velocity)
    turned, turn = march(loading, start, 0.0, lambda rate, _: rate[0])
    time, state = march(loading, start, 0.0, lambda _, state: state[1]) if stops else (turned, turn)
    depth, force = state[0], loading(state[0])
    deformed = max(stiffness * depth**1.5 / force, 1.0)  # R_p/R
    dent = depth - (force / (stiffness * sqrt(deformed))) ** (2.0 / 3.0)

    def unloading(depth: float) -> float:
        return stiffness * sqrt(deformed) * max(depth - dent, 0.0) ** 1.5

    duration, (_, rebound) = march(unloading, state, time, lambda _, state: state[0] - dent)
    return {
        "maximum_indentation": turn[0],
        "time_of_maximum_indentation": turned,
        "permanent_indentation": dent,
        "contact_duration": duration,
        "rebound_velocity": rebound,
        "unloading_begins": time,
    }


def main() -> dict[str, dict[str, float]]:
    """Summaries, SI: loading until the maximum indentation, until the ball stops, and the package's."""
    scene = fm.Scene(BALL, PLATE, fm.Contact("thornton", yield_pressure=f"{YIELD_PRESSURE} Pa"))
    summary = fm.simulate(scene, accuracy=1e-10).summary
    return {
        "maximum indentation": impact(scene, stops=False),
        "ball stops": impact(scene, stops=True),
        "simulate": {name: value for name, value in summary.items() if value is not None},
    }


if __name__ == "__main__":
    columns = main()
    print(f"{'':32}" + "".join(f"{name:>16}" for name in columns))
    for quantity in columns["maximum indentation"]:
        cells = (column.get(quantity) for column in columns.values())
        print(f"{quantity:32}" + "".join(f"{'' if cell is None else f'{cell:.6g}':>16}" for cell in cells))
    right, wrong = (columns[name]["rebound_velocity"] for name in ("maximum indentation", "ball stops"))
    print(f"Loading until the ball stops: the rebound is off by {wrong / right - 1.0:+.0%}.")
