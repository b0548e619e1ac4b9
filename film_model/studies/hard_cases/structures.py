"""The cases of targets that vibrate: DOP853 on the same modes, the energy, rest, and structures that are refused."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from film_model.effects.choose import problem_of
from film_model.scene import Contact, Effects, Scene, Sphere
from film_model.solve import vibration
from film_model.solve.component import ImpactComponent
from film_model.solve.structures import structure_of
from film_model.studies import modal_reference
from film_model.studies.hard_cases.case import Finding, HardCase
from film_model.studies.hard_cases.loads import rejected
from film_model.targets import Plate, Structure


def _struck(target: Plate | Structure, mass: str, velocity: str) -> Scene:
    """An elastic steel ball on a target that vibrates, without weight."""
    ball = Sphere("12 mm", velocity, material="bearing steel", mass=mass)
    effects = Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    return Scene(ball, target, Contact("hertz"), effects)


def _on_modes(scene: Scene, highest: float) -> Callable[[], Finding]:
    """highest: frequency of the modes that both follow, rad/s."""

    def run() -> Finding:
        """The events of DOP853 on the same modes, its values, and the energy that impactor and modes keep."""
        tolerance = 1e-12  # of a step, of the core and of DOP853: every further contact multiplies the errors before it
        problem = problem_of(scene)
        unit, scales = problem.scales.time, problem.scales
        structure = structure_of(scene.target, highest, unit)  # type: ignore[arg-type]
        found = vibration.run(problem, structure, tolerance, 1.0)
        tables, rest = structure.tables, structure.omitted * scales.force / scales.length
        other = modal_reference.integrate(
            problem, tables.frequency * unit, tables.share * problem.mass, rest, 1.0, 1.0 / unit, tolerance
        )
        contacts = "1 contact" if found.contacts == 1 else f"{found.contacts} contacts"
        if found.event_names != [event.name for event in other.events]:
            return Finding(f"{contacts}, other events than the reference", math.inf)
        error = max(
            abs(getattr(found.summary, name) / getattr(other.summary, name) - 1.0)
            for name in ("maximum_force", "maximum_indentation", "contact_duration", "final_velocity")
        )
        before = 0.5 * problem.approach**2
        balance = abs(0.5 * found.summary.final_velocity**2 + found.energy - before) / before
        if balance > 1e-9:
            return Finding(f"{contacts}; worst balance", math.inf, balance=balance)
        return Finding(contacts, error, balance=balance)

    return run


def _rests() -> Finding:
    """A ball that its weight presses on a damped sheet stops; then the force is the weight."""
    sheet = Plate("aluminium", "1 mm", size=["100 mm", "80 mm"], damping_ratio=0.02)
    scene = replace(_struck(sheet, "20 g", "0.05 m/s"), effects=Effects(gravity=True, boundary_reflections=True))
    component = ImpactComponent(scene)
    for _ in range(400):
        outputs = component.step("5 ms").outputs
        if outputs.phase == "resting":
            break
    weight = component.problem.load * component.problem.scales.force
    error = abs(outputs.contact_force / weight - 1.0)  # type: ignore[reportPossiblyUnbound]
    return Finding(f"{component.phase} after {outputs.contact_count} contacts", error)  # type: ignore[reportPossiblyUnbound]


def _sheet(thickness: str) -> Plate:
    return Plate("aluminium", thickness, size=["150 mm", "100 mm"], position=["60 mm", "40 mm"])


def _modes(frequency: list[str], modal_mass: list[str]) -> Structure:
    return Structure(material="mild steel", frequency=frequency, modal_mass=modal_mass)


def structures() -> Iterator[HardCase]:
    """Contacts that are lost and come back, modes of any stiffness and mass, and structures that are refused."""
    square = Plate("aluminium", "4 mm", size=["120 mm", "120 mm"], position=["35 mm", "50 mm"])
    for name, why, scene, highest in (
        ("sheet of 0.5 mm", "contact is lost and comes back", _struck(_sheet("0.5 mm"), "20 g", "1 m/s"), 4e4),
        (
            "2 kg on a sheet of 1 mm",
            "the ball stays while the sheet swings",
            _struck(_sheet("1 mm"), "2 kg", "0.3 m/s"),
            2e4,
        ),
        (
            "1 um/s on a plate",
            "contact outlasts most vibrations",
            _struck(_sheet("4 mm"), "0.2 kg", "1 um/s"),
            1e5,
        ),
        ("square plate", "vibrations in pairs of the same frequency", _struck(square, "50 g", "1 m/s"), 1e5),
        (
            "frequencies 1e-9 apart",
            "two vibrations that are nearly one",
            _struck(_modes(["200 Hz", "200.0000002 Hz"], ["1 kg", "0.5 kg"]), "50 g", "1 m/s"),
            1e9,
        ),
        (
            "light structure",
            "the ball has four times the modal mass: contact after contact",
            _struck(_modes(["100 Hz", "650 Hz"], ["50 g", "20 g"]), "0.2 kg", "0.1 m/s"),
            1e9,
        ),
        (
            "structure that nothing holds",
            "it moves away as a whole",
            _struck(_modes(["0 Hz", "300 Hz"], ["0.3 kg", "0.1 kg"]), "50 g", "1 m/s"),
            1e9,
        ),
        (
            "frequencies 6000 times apart",
            "a slow vibration, and one of which a contact sees hundreds of periods",
            _struck(_modes(["50 Hz", "0.3 MHz"], ["0.3 kg", "10 mg"]), "50 g", "1 m/s"),
            1e9,
        ),
    ):
        yield HardCase(f"vibrating: {name}", why, _on_modes(scene, highest))
    yield HardCase("vibrating: pressed ball", "bounces that grow shorter on a damped sheet, until it rests", _rests)
    for name, why, make in (
        ("negative modal mass", "no such structure", lambda: _modes(["100 Hz"], ["-1 kg"])),
        ("frequency that is no number", "not a number", lambda: _modes(["nan Hz"], ["1 kg"])),
        (
            "struck at a support",
            "no vibration moves there",
            lambda: Plate("aluminium", "1 mm", size=["150 mm", "100 mm"], position=["0 mm", "40 mm"]),
        ),
    ):
        yield HardCase(f"vibrating: {name}", why, rejected(make))
