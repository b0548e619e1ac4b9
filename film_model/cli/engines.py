"""film-model contact-for: parameters of another engine's contact law for the impact of a scene file."""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING, Any

from film_model.cli.output import Commands, add_common, add_scene, give, read_scene

if TYPE_CHECKING:
    from film_model.scene import Scene
    from film_model.translate import Translation


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("contact-for", "fit the contact law of another engine to the impacts of a scene", contact_for)
    parser.add_argument("engine", help="name of the engine, e.g. mujoco; another word lists them")
    add_scene(parser)
    parser.add_argument(
        "--velocity",
        metavar="LOW..HIGH",
        help='approach velocities, e.g. 0.1..2 in m/s, or "5 mm/s..2 m/s" (default: half to twice the scene\'s)',
    )
    parser.add_argument("--law", metavar="NAME", help="only this law of the engine (default: all, the closest first)")
    parser.add_argument("--count", type=int, metavar="N", help="number of velocities in the range (default: 9)")
    add_common(parser, plot="compare force and restitution with the closest law's")


def contact_for(options: argparse.Namespace) -> int:
    from film_model import translate
    from film_model.plot.engines import plot_translation

    engine = translate.engine_named(options.engine)
    velocity = _range(options.velocity)
    scene = read_scene(options)
    count = {} if options.count is None else {"count": options.count}
    made = translate.contact_for(engine, scene, velocity, law=options.law, **count)
    table = {"title": scene.title, "engine": engine.name, "laws": [one.to_dict() for one in made]}
    draw = partial(plot_translation, scene, made[0])
    return give(options, lambda: _text(scene, made), lambda: table, made[0].warnings, plot=draw)


def _range(text: str | None) -> tuple[Any, ...]:
    """The two ends of a range; plain numbers are m/s."""
    if text is None:
        return ()
    low, dots, high = text.partition("..")
    ends = (low, high) if dots else (low, low)
    made: list[Any] = []
    for end in ends:
        try:
            made.append(float(end))
        except ValueError:
            made.append(end.strip())
    return tuple(made)


def _text(scene: Scene, made: list[Translation]) -> str:
    """The closest law in full, the others in a row each."""
    width = 20
    best = made[0]
    speeds, at = best.velocities, f"at {best.velocities[0]:.3g} m/s"
    if len(speeds) > 1:
        at = f"at {len(speeds)} velocities, {speeds[0]:.3g} to {speeds[-1]:.3g} m/s"
    lines = [scene.title or "Impact", f"{best.engine.title}, law {best.law.name}: {best.law.formula}"]
    lines += [f"{best.law.source}", ""]
    for p in best.law.parameters:
        number = f"{best.values[p.name]:.6g} {p.unit}".rstrip()
        lines.append(f"  {p.name:{width}}{number:>24}  {p.meaning}")
    lines += ["", f"  {at:{width + 24}}{'error (rms)':>12}{'worst':>10}"]
    for name, error in best.errors.items():
        worst = f"{100 * error.worst:+.1f} % at {error.velocity:.3g} m/s"
        lines.append(f"  {name:{width + 24}}{100 * error.rms:>10.1f} %{worst:>22}")
    if best.tangential:
        lines += ["", f"  {'friction, ψ₂ over ψ₁, against ours':{width + 24}}{'error (rms)':>12}{'worst':>10}"]
    for name, one in best.tangential.items():
        lines.append(f"  {name:{width + 24}}{one.rms:>12.3f}{one.worst:>+10.3f} at ψ₁ = {one.before:.3g}")
    if len(made) > 1:
        lines += ["", f"  {'other laws':{width + 24}}{'force':>10}{'duration':>10}{'restitution':>13}  (rms)"]
    for one in made[1:]:
        force, duration, restitution = (f"{100 * error.rms:.1f} %" for error in one.errors.values())
        lines.append(f"  {one.law.name:{width + 24}}{force:>10}{duration:>10}{restitution:>13}")
        numbers = (f"{p.name} {one.values[p.name]:.6g} {p.unit}".rstrip() for p in one.law.parameters)
        lines.append(f"    {', '.join(numbers)}")
    lines += ["", *(f"  {note}" for note in best.law.notes), "", best.paste()]
    return "\n".join(lines)
