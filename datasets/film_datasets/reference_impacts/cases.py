"""The table of the reference impacts: groups of cases as products of laws, targets and velocities, all in SI."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from film_model.base.fields import written
from film_model.base.units import power_stiffness_unit
from film_model.laws import LAWS
from film_model.laws.example_ball import STEEL_BALL, example_law
from film_model.scene import Scene
from film_model.scene.chain import Chain

_TABLE: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))

ACCURACY: dict[str, float] = _TABLE["accuracy"]
"""Accuracy of the march that a target with edges or a material allows: every decimal of a target with edges takes about
four times as many modes. Of all others `FINEST`."""

FINEST = 1e-11

STEEL, POLYMER, RUBBER, GRANITE, ALUMINA, GLASS = _TABLE["materials"].values()

TARGETS, EDGES = ({name: {**on, "material": STEEL} for name, on in _TABLE[key].items()} for key in ("targets", "edges"))
"""Targets without edges, and those that vibrate."""

ADHESIVE = ("jkr", "dmt", "thornton-ning")


class Case(NamedTuple):
    """name: of its folder. group: what it is about. scene: nested tables, as in a scene file, SI."""

    name: str
    group: str
    scene: Mapping[str, Any]

    @property
    def accuracy(self) -> float:
        """Relative, asked of the march."""
        return ACCURACY.get(self.target if self.group == "vibrating target" else self.group, FINEST)

    @property
    def target(self) -> str:
        """The kind of the target, or "chain" for bodies in a row."""
        return "chain" if self.group == "chain" else self.scene["target"]["kind"]


@lru_cache(maxsize=1)
def cases() -> dict[str, Case]:
    """All cases, by name, in the order of the suite."""
    groups = (_laws(), _adhesive(), _others(), _oblique(), _bouncing(), _chains(), _published())
    return {case.name: case for group in groups for case in group}


def _case(
    name: str, group: str, target: Mapping[str, Any], contact: Mapping[str, Any], ball: Mapping[str, Any]
) -> Case:
    """One case. ball: entries of [impactor]; a ball of steel with a radius of 10 mm unless they say otherwise."""
    moves = target["kind"] != "half-space"
    edges = {name: True for name in ("boundary_reflections", "target_inertia")} if group == "vibrating target" else {}
    effects = {"gravity": group in ("under weight", "bouncing"), **({"target_motion": True} if moves else {}), **edges}
    impactor = {"radius": "0.01 m", "material": STEEL, **ball}
    if impactor.get("material") is STEEL and "mass" not in ball:
        impactor["mass"] = f"{STEEL_BALL.mass!r} kg"
    table = {"impactor": impactor, "target": dict(target), "contact": dict(contact), "effects": effects}
    return Case(name, group, {"title": f"Reference impact {name}", **table})


def _contact(law: str) -> dict[str, Any]:
    """[contact] of a law with its own example values."""
    table: dict[str, Any] = {"law": law}
    for name, value in LAWS[law].example(STEEL_BALL).items():
        dimension = LAWS[law].parameters[name].dimension
        if dimension == "meyer_stiffness":
            exponent: Any = getattr(example_law(LAWS[law]), "exponent")  # noqa: B009
            table[name] = f"{value!r} {power_stiffness_unit(exponent)}"
        else:
            table[name] = written(tuple(map(float, value)) if np.ndim(value) else value, dimension)
    return table


def _laws() -> Iterator[Case]:
    """Every law that does not pull, on every target without edges, at three velocities; under weight and on vibrating
    targets some of them."""
    laws = [name for name in LAWS if name not in ADHESIVE]
    for law, target, speed in product(laws, TARGETS, (0.1, 0.4, 1.2)):
        yield _case(
            f"{law}-{target}-{speed:g}", LAWS[law].family, TARGETS[target], _contact(law), {"velocity": _si(speed)}
        )
    for law, target in product(("hertz", "thornton", "stronge", "tsuji"), ("half-space", "plate")):
        name = f"weight-{law}-{target}"
        yield _case(name, "under weight", TARGETS[target], _contact(law), {"velocity": _si(0.05)})


def _adhesive() -> Iterator[Case]:
    """A bead of polymer, at multiples of about the velocity below which it sticks."""
    bead = {"radius": "50e-6 m", "material": POLYMER}
    plate = {"kind": "plate", "thickness": "60e-6 m", "material": POLYMER}
    contact = {"work_of_adhesion": "0.05 J/m^2"}
    for law, target, speed in product(ADHESIVE, ("half-space", "plate"), (0.1, 0.5, 2.0)):
        given = contact | ({"yield_pressure": "96e6 Pa"} if law == "thornton-ning" else {})
        on = plate if target == "plate" else {"kind": "half-space", "material": POLYMER}
        yield _case(
            f"{law}-{target}-{speed:g}", "adhesive", on, {"law": law, **given}, {"velocity": _si(speed), **bead}
        )


def _others() -> Iterator[Case]:
    """Rubber that relaxes on granite, and targets that vibrate."""
    for times, speed in product(((1e-4,), (1e-3,), (2e-4, 3e-3)), (0.3, 1.0, 3.0)):
        prony = [[0.4 / (1 + k), f"{time!r} s"] for k, time in enumerate(times)]
        name = f"relaxing-{'-'.join(f'{time:g}s' for time in times)}-{speed:g}"
        ball = {"material": {**RUBBER, "prony": prony}, "velocity": _si(speed)}
        yield _case(name, "viscoelastic", {"kind": "half-space", "material": GRANITE}, {"law": "hertz"}, ball)
    for (target, table), law, speed in product(EDGES.items(), ("hertz", "thornton"), (0.05, 0.2)):
        name = f"vibrating-{target}-{law}-{speed:g}"
        yield _case(name, "vibrating target", table, _contact(law), {"velocity": _si(speed)})


def _oblique() -> Iterator[Case]:
    """An elastic ball with friction at angles from sticking to sliding throughout, and with spin."""
    target = TARGETS["half-space"]
    for angle, spin in product((10, 30, 45, 70), (-20.0, 0.0, 20.0)):
        turns = {"spin": f"{spin!r} rad/s"} if spin else {}
        ball = {"velocity": _si(1.0), "angle": _angle(angle), **turns}
        yield _case(f"oblique-{angle}deg-spin{spin:g}", "oblique", target, {"law": "hertz", "friction": 0.25}, ball)


def _bouncing() -> Iterator[Case]:
    """An elastic ball that falls on a plate without end, which moves aside at every bounce."""
    for thickness, height in product((0.005, 0.01), (0.02, 0.1)):
        plate = TARGETS["plate"] | {"thickness": f"{thickness!r} m"}
        name = f"bouncing-{1e3 * thickness:g}mm-{1e3 * height:g}mm"
        yield _case(name, "bouncing", plate, {"law": "hertz"}, {"drop_height": f"{height!r} m"})


def _chains() -> Iterator[Case]:
    """Newton's cradle of three, whose balls touch or not, a ball that strikes a fork, and a small ball on a large one
    that hit the ground."""
    ball = {"radius": "0.01 m", "mass": f"{STEEL_BALL.mass!r} kg", "material": STEEL}
    for speed, gap in ((0.1, 0.0), (0.4, 0.0), (0.4, 2e-6)):
        balls = [{**ball, "velocity": _si(speed), "gap": f"{gap!r} m"}, {**ball, "gap": f"{gap!r} m"}, ball]
        yield _chain(f"cradle-{speed:g}" + ("-gaps" if gap else ""), {"bodies": balls})
    branches = [{**ball, "count": 2, "behind": "stem", "angle": _angle(angle)} for angle in (30, -30)]
    yield _chain("fork-0.4", {"bodies": [{**ball, "velocity": _si(0.4)}, {**ball, "name": "stem"}, *branches]})
    down = [{"radius": size, "material": STEEL, "velocity": _si(0.2)} for size in ("0.01 m", "0.02 m")]
    yield _chain("ball-on-ball-0.2", {"bodies": down, "target": TARGETS["half-space"]})


def _chain(name: str, table: Mapping[str, Any]) -> Case:
    return Case(name, "chain", {"title": f"Reference impact {name}", **table, "contact": {"law": "hertz"}})


def _published() -> Iterator[Case]:
    """Chung & Ooi 2011, Granular Matter 13:643: tests 1 and 2; 3 with Tsuji's damping; 4 (Kharaz, Gorham & Salman 2001)
    to 8 undamped."""
    for (name, values), test in zip(_TABLE["chung_ooi"].items(), (1, 1, 2, 2), strict=True):
        modulus, ratio, density, radius, speed = values
        own = {"youngs_modulus": f"{modulus!r} Pa", "poissons_ratio": ratio, "density": f"{density!r} kg/m^3"}
        rigid = {"effective_modulus": f"{modulus / (1.0 - ratio**2)!r} Pa"} if test == 2 else {}
        target = {"kind": "half-space"} if test == 2 else {"kind": "body", "radius": f"{radius!r} m", "material": own}
        ball = {"radius": f"{radius!r} m", "velocity": _si(speed), "material": own}
        yield _case(f"chung-ooi-{test}-{name}", "published", target, {"law": "hertz", **rigid}, ball)
    for angle in (5, 15, 30, 60):
        ball = {"radius": "0.0025 m", "velocity": _si(3.9), "angle": _angle(angle), "material": ALUMINA}
        contact, target = {"law": "hertz", "friction": 0.092}, {"kind": "half-space", "material": GLASS}
        yield _case(f"chung-ooi-4-{angle}deg", "oblique", target, contact, ball)
    for ratio in (1.19, 2.314, 3.97, 7.124):  # tan θ/µ, at a normal velocity of 5 m/s
        along = 0.3 * ratio
        speed = {"velocity": _si(5.0 * math.hypot(1.0, along)), "angle": f"{math.atan(along)!r} rad"}
        steel = {"youngs_modulus": "208e9 Pa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
        ball = {"radius": "1e-5 m", "material": steel, **speed}
        contact, target = {"law": "hertz", "friction": 0.3}, {"kind": "half-space", "material": steel}
        yield _case(f"chung-ooi-5-{ratio:g}", "oblique", target, contact, ball)
    for name, modulus, ratio, density in (("alumina", 380e9, 0.23, 4000.0), ("cast-iron", 100e9, 0.25, 7000.0)):
        own = {"youngs_modulus": f"{modulus!r} Pa", "poissons_ratio": ratio, "density": f"{density!r} kg/m^3"}
        ball = {"radius": "0.0025 m", "velocity": _si(3.9), "material": own}
        for e in (0.2, 0.6, 0.9):
            contact = {"law": "tsuji", "restitution": e, "effective_modulus": f"{modulus / (1.0 - ratio**2)!r} Pa"}
            yield _case(f"chung-ooi-3-{name}-{e:g}", "damped", {"kind": "half-space"}, contact, ball)
    yield from _spinning()


def _spinning() -> Iterator[Case]:
    """Tests 6 to 8: spin that gives the contact point the velocity of an impact at an angle, on a half-space and on a
    large ball; in 7 an equal ball spins the other way, so that nothing slides."""
    alloy = {"youngs_modulus": "70e9 Pa", "poissons_ratio": 0.33, "density": "2700 kg/m^3"}
    contact, ball = {"law": "hertz", "friction": 0.4}, {"radius": "0.1 m", "velocity": _si(0.2), "material": alloy}
    for angle, (test, target) in product(
        (10, 30, 75),
        ((6, {"kind": "half-space", "material": alloy}), (8, {"kind": "body", "radius": "0.5 m", "material": alloy})),
    ):
        spin = {"spin": f"{0.2 * math.tan(math.radians(angle)) / 0.1!r} rad/s"}
        yield _case(f"chung-ooi-{test}-{angle}deg", "oblique", target, contact, ball | spin)
    twin = {"kind": "body", "radius": "0.1 m", "material": alloy, "spin": "-2.0 rad/s"}
    yield _case("chung-ooi-7", "published", twin, contact, ball | {"spin": "2.0 rad/s"})


def _si(speed: float) -> str:
    return f"{speed!r} m/s"


def _angle(degrees: float) -> str:
    return f"{math.radians(degrees)!r} rad"


def chain_of(case: Case) -> Chain:
    """The chain of a case of group "chain"."""
    return Chain.from_table({**case.scene, "solver": {"accuracy": case.accuracy}})


def scene_of(case: Case) -> Scene:
    """The scene of a case of any other group."""
    return Scene.from_table({**case.scene, "solver": {"accuracy": case.accuracy}})
