"""A ball dropped from 5 mm bounces to rest on a steel plate: every bounce, and the dent.

The first bounce leaves the dent, in which all later ones are elastic. What brings the ball to rest is the plate, whose
waves carry energy away.
"""

import film_model as fm


def main() -> fm.Bounces:
    """All bounces until the ball rests."""
    scene = fm.Scene(
        fm.Sphere(radius="5 mm", drop_height="5 mm", material="bearing steel"),
        fm.Plate("mild steel", thickness="12 mm"),
    )
    return fm.bounce(scene, accuracy=1e-6)


if __name__ == "__main__":
    bounces = main()
    for number, b in enumerate(bounces.bounces, 1):
        if number <= 5 or number % 20 == 0 or number == len(bounces.bounces):
            print(f"{number:6}{b.time * 1e3:10.3f} ms{b.height * 1e6:10.3f} um{b.restitution:8.4f}")
    print(bounces.outcome)
