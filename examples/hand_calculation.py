"""FILM by hand: the tungsten-carbide ball of Big-Alabo, Cartmell & Harrison 2017 with `math` alone.

Numbers in brackets are the paper's equations. `simulate(scene, segments=5, linearisation="chord")` gives the same
numbers to rounding.
"""

from math import acos, atan2, cos, hypot, pi, sqrt

N = 5  # segments per stage
M, R, V0, S_Y = 0.06074, 0.010, 0.25, 1.0e9  # kg, m, m/s, Pa: Table 2
E = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)  # Pa


def stage(force, begin, end, t, v):
    """Indentation, time and velocity at the end of a stage, or where the motion stops on the way there."""
    for r in range(N):
        d_r, d_s = (begin + i * (end - begin) / N for i in (r, r + 1))  # (7)
        k = (force(d_s) - force(d_r)) / (d_s - d_r)  # (6)
        omega, c = sqrt(k / M), d_r - force(d_r) / k
        a, b = v / omega, d_r - c
        radius, phase = hypot(a, b), atan2(b, a)  # after (17), with time from the beginning of the segment
        if d_s > c + radius:  # the segment is not crossed: maximum indentation
            return c + radius, t + (pi / 2 - phase) / omega, 0.0
        side = 1.0 if end > begin else -1.0  # the sign in (18): loading or unloading
        angle = pi / 2 - side * acos((d_s - c) / radius)
        t, v = t + (angle - phase) / omega, omega * radius * cos(angle)  # (18), (17)
    return end, t, v


def main():
    """Summary of the impact, SI, by the library's names."""
    k = 4 / 3 * E * sqrt(R)
    d_y = (1.1 * pi * R * S_Y / k) ** 2
    _, t_y, v_y = stage(lambda d: k * d**1.5, 0.0, d_y, 0.0, V0)  # (19a)
    # (21), the energy balance for the end of loading, from yield on: solved for x = δ_m − δ_y by Newton's method
    x = d_y
    for _ in range(20):
        x -= (0.4 * k * x**2.5 + k * d_y**1.5 * x - 0.5 * M * v_y**2) / (k * x**1.5 + k * d_y**1.5)
    # the chords do more work than the law, so the motion stops a little before δ_y + x
    d_m, t_m, _ = stage(lambda d: k * (d - d_y) ** 1.5 + k * d_y**1.5, d_y, d_y + x, t_y, v_y)  # (19b)
    f_m = k * (d_m - d_y) ** 1.5 + k * d_y**1.5
    k_u = k * sqrt(1 + ((d_m - d_y) / (12.93 * d_y)) ** 1.5)  # with R_d of (20)
    d_f = d_m - (f_m / k_u) ** (2 / 3)
    _, t_f, v_f = stage(lambda d: k_u * max(d - d_f, 0.0) ** 1.5, d_m, d_f, t_m, 0.0)  # (19e)
    return {
        "maximum_force": f_m,
        "maximum_indentation": d_m,
        "time_of_maximum_indentation": t_m,
        "contact_duration": t_f,
        "permanent_indentation": d_f,
        "rebound_velocity": v_f,
        "coefficient_of_restitution": -v_f / V0,
    }


if __name__ == "__main__":
    for name, value in main().items():
        print(f"{name:30}{value:.12g}")
