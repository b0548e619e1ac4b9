"""Two free balls: velocities before and after, and the balance of momentum and energy.

A ball overtakes a slower one, first gently enough to stay elastic, then fast enough to yield.
"""

from pathlib import Path

import film_model as fm

SCENES = Path(__file__).parent / "scenes"


def collide(scene: fm.Scene) -> dict[str, float]:
    """Velocities [m/s], momenta [kg m/s] and energies [J] of both balls together, before and after."""
    history = fm.simulate(scene, accuracy=1e-8)
    masses = scene.mass, scene.target.own_mass
    before = scene.impactor.speed, scene.target.velocity
    end = history.events[-1]
    after = end.impactor_velocity, end.target_velocity
    return {
        "impactor before": before[0],
        "target before": before[1],
        "impactor after": after[0],
        "target after": after[1],
        "momentum before": sum(m * v for m, v in zip(masses, before, strict=True)),
        "momentum after": sum(m * v for m, v in zip(masses, after, strict=True)),
        "energy before": sum(0.5 * m * v**2 for m, v in zip(masses, before, strict=True)),
        "energy after": sum(0.5 * m * v**2 for m, v in zip(masses, after, strict=True)),
        "energy absorbed": history.summary["energy_absorbed"],
        "restitution": history.summary["coefficient_of_restitution"],
    }


def main() -> dict[str, dict[str, float]]:
    """Results by the impactor's velocity."""
    scene = fm.Scene.from_toml(SCENES / "two_steel_balls.toml")
    return {velocity: collide(scene.replace({"impactor.velocity": velocity})) for velocity in ("0.5 m/s", "5 m/s")}


if __name__ == "__main__":
    results = main()
    print(f"{'':18}" + "".join(f"{velocity:>16}" for velocity in results))
    for name in next(iter(results.values())):
        print(f"{name:18}" + "".join(f"{result[name]:16.9g}" for result in results.values()))
