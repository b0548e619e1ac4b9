"""simulate_chain(chain) → ChainMotion: how bodies in a row or a tree collide."""

from __future__ import annotations

import math
import os
import warnings as python_warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import STATUSES, ImpactWarning, SimulationError, shown
from film_model.base.foreign import Dataset, Figure
from film_model.base.late import Late
from film_model.base.units import format_si
from film_model.core import chaining, native
from film_model.laws.yielding import yield_point
from film_model.problem.chain_contacts import ChainContact, contacts_of, speed_of
from film_model.scene import STANDARD_GRAVITY
from film_model.scene.chain import Chain
from film_model.solve.chain_places import displacements
from film_model.solve.chain_vibrations import Followed, Structure, first_frequency, refined
from film_model.solve.sensed import quantities_of, split_rows

FINEST = 1e-14
"""Tolerance of a step, over approach velocity and indentation: elastic chains then keep energy to 1e-12."""

ENDED = "contact is open everywhere, and no neighbours approach"
"""Outcome of a chain that is not followed for a duration."""

BODIES: dict[str, tuple[str, str]] = {
    "body_mass": ("mass", "mass of the body"),
    "initial_velocity": ("velocity", "velocity at the start"),
    "final_velocity": ("velocity", "velocity at the end"),
}
"""Values of each body, with dimension and meaning."""

CONTACTS: dict[str, tuple[str, str]] = {
    "largest_force": ("force", "largest contact force"),
    "time_of_largest_force": ("time", "time of the largest contact force"),
    "largest_indentation": ("length", "largest indentation"),
    "contact_begins": ("time", "when contact first begins; of bodies that touch at the start, when a wave arrives"),
    "contact_ends": ("time", "when contact last ends"),
    "energy_absorbed": ("energy", "work done on the contact, less what it gave back"),
}
"""Values of each contact, likewise, in the order of the chain's `links`."""


class EnergyBalance(NamedTuple):
    """Energies, J. weight: work of gravity. absorbed: by all contacts; while they touch, also what they store.
    vibrations: of the target, with what their damping has taken. error: kinetic energy before + weight - absorbed -
    vibrations - kinetic energy after, which is 0 but for the error of the solution."""

    kinetic_before: float
    kinetic_after: float
    weight: float
    absorbed: float
    vibrations: float
    error: float


@dataclass(frozen=True)
class ChainMotion:
    """The motion of a chain, from `simulate_chain`.

    laws: names, of each contact. end: time at which the simulation ends, s. values: the values of `BODIES` and
    `CONTACTS`, SI arrays, nan where one does not exist; as attributes of the same names they have units. counts: how
    often each contact began. estimated: relative error of final velocities and largest forces, from other runs.
    followed: up to which frequency the target's vibrations were followed, and with which tolerance of a step.

    >>> ball = {"radius": "10 mm", "material": "bearing steel"}
    >>> motion = fm.simulate_chain(fm.Chain([{**ball, "velocity": "0.5 m/s"}, {**ball, "count": 2}], "hertz"))
    >>> f"{motion.largest_force[0].to('N'):.2f~P}"
    '438.68 N'
    """

    chain: Chain
    laws: tuple[str, ...]
    outcome: str
    end: float
    values: dict[str, Array] = field(compare=False)
    counts: tuple[int, ...]
    energy: EnergyBalance
    estimated: float
    warnings: tuple[str, ...]
    followed: Followed

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # the values of `BODIES` and `CONTACTS`, added below the class
        def plot(self, path: str | os.PathLike[str] | None = None) -> Figure: ...
        def to_dataset(self, samples: int = 201) -> Dataset: ...
    else:
        plot = Late("film_model.methods:plot_chain")
        to_dataset = Late("film_model.methods:chain_to_dataset")

    def __repr__(self) -> str:
        return f"ChainMotion({len(self.values['body_mass'])} bodies; {self.outcome})"

    @property
    def span(self) -> tuple[float, float]:
        """From when to when to look, s: the duration that was asked for, or while forces act, where each contact is
        taken to last as long after its largest force as before."""
        if self.chain.duration is not None:
            return 0.0, self.end
        begins, peaks = (self.values[name] for name in ("contact_begins", "time_of_largest_force"))
        if np.isnan(begins).all():
            return 0.0, self.end
        first, last = float(np.nanmin(begins)), min(self.end, float(np.nanmax(2.0 * peaks - begins)))
        return max(0.0, first - 0.05 * (last - first)), last

    def sample_si(self, times: Any) -> dict[str, Array]:
        """Motion at ascending times [s], SI: displacement and velocity (bodies, times), indentation and contact_force
        (contacts, times); if the target has sensors, sensor_displacement, sensor_velocity and so on (sensors, times).
        It is computed anew, as exactly as the results. Times after the end are allowed where bodies then fly on for
        ever: without weight, and if the duration is not what ended the motion.
        """
        at = np.atleast_1d(np.asarray(times, np.float64))
        last = math.inf if self.outcome == ENDED and not self.chain.gravity else self.end
        if not (at[0] >= 0.0 and at[-1] <= last and (np.diff(at) >= 0.0).all()):
            raise ValueError(f"times: must ascend from 0 s to the end, {last:g} s")
        contacts = contacts_of(self.chain)
        scales, bodies, count = _Scales.of(self.chain, contacts), len(self.chain.row), len(contacts)
        samples = _runner(self.chain, contacts, scales)(self.followed, at / scales.time).samples.T
        indentation, structure = samples[:count] * scales.length, Structure.of(self.chain)
        moved = samples[2 * count + bodies :].reshape(-1, 3, at.size).swapaxes(0, 1) * scales.length
        rates = np.array([1.0, 1.0 / scales.time, 1.0 / scales.time**2])[:, None, None]
        found = {
            "displacement": displacements(self.chain, indentation, at, structure.at_links(self.chain, moved[0])),
            "velocity": samples[count : count + bodies] * scales.velocity,
            "indentation": indentation,
            "contact_force": samples[count + bodies : 2 * count + bodies] * scales.force,
        }
        if structure.target is not None and structure.target.sensors:
            known = split_rows(structure.target, rates * moved[:, len(structure.points) :])
            found |= {
                f"sensor_{name}": value for name, value in zip(quantities_of(structure.target), known, strict=True)
            }
        return found

    def rows(self, names: Iterable[str]) -> list[dict[str, Any]]:
        """The values of these names, SI, a row for each body or contact; None where one does not exist."""
        columns = ([value if math.isfinite(value) else None for value in self.values[name].tolist()] for name in names)
        return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI: title, laws, outcome, end, bodies and contacts, energy, accuracy and warnings."""
        rows = {key: self.rows(names) for key, names in (("bodies", BODIES), ("contacts", CONTACTS))}
        for row, link, law, count in zip(rows["contacts"], self.chain.links, self.laws, self.counts, strict=True):
            front, behind = (None if end is None else end + 1 for end in link[:2])
            row |= {"law": law, "count": count, "front": front, "behind": behind}
        return {
            "title": self.chain.title,
            "outcome": self.outcome,
            "end": self.end,
            **rows,
            "energy": self.energy._asdict(),
            "accuracy": {"requested": self.chain.accuracy, "estimated": self.estimated},
            "warnings": list(self.warnings),
        }


units.add_quantities(ChainMotion, BODIES | CONTACTS, lambda motion, name: motion.values[name])


class _Scales(NamedTuple):
    """Units of a run in SI."""

    mass: float
    length: float
    velocity: float

    @property
    def time(self) -> float:
        """Length over velocity."""
        return self.length / self.velocity

    @property
    def energy(self) -> float:
        return self.mass * self.velocity**2

    @property
    def force(self) -> float:
        return self.energy / self.length

    @classmethod
    def of(cls, chain: Chain, contacts: list[ChainContact]) -> _Scales:
        mass = max(body.own_mass or 0.0 for body in chain.bodies if not body.fixed)
        return cls(mass, max(contact.length * contact.depth for contact in contacts), speed_of(chain))


def simulate_chain(chain: Chain) -> ChainMotion:
    """The motion of bodies in a row or a tree, each contact by its law with its own history.

    The equations of motion are integrated by DOP853 (order 8) with a step that ends where a contact begins, turns,
    changes its stage or ends. `accuracy` is met by comparison with a run of a coarser tolerance. Momentum is kept to
    rounding, and the energy of elastic chains to 1e-12. For a target that vibrates, the highest frequency is doubled
    until runs agree. Effects that `simulate` decides (waves, rate hardening, vibrations of the half-space, viscosity)
    are not simulated. Bodies are spheres, each of which moves along its line,
    as in a frictionless guide: of the force at a bend the body in front takes the part along its own line, and its
    guide the rest. Ways while bodies touch are short beside their radii.

    >>> small, large = ({"radius": size, "material": "acrylic"} for size in ("5 mm", "20 mm"))
    >>> dropped = fm.Chain([small, {**large, "gap": "1 cm"}], "hertz", fm.HalfSpace("mild steel"), gravity=True)
    >>> fm.simulate_chain(dropped).final_velocity.m.round(3).tolist()
    [-0.527, -0.441]

    Raises SceneError if a law lacks an entry; SimulationError if no body approaches another, for a law whose damping
    depends on the velocity of approach, and if a law ends before the motion turns. Each entry of `warnings` is issued
    as an ImpactWarning.
    """
    done = simulate_chain_quietly(chain)
    for sentence in done.warnings:
        python_warnings.warn(sentence, ImpactWarning, stacklevel=2)
    return done


def simulate_chain_quietly(chain: Chain) -> ChainMotion:
    """As :func:`simulate_chain`, without Python warnings."""
    if not isinstance(chain, Chain):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"simulate_chain takes a Chain, not {shown(chain)}")
    contacts = contacts_of(chain)
    scales = _Scales.of(chain, contacts)
    run = _runner(chain, contacts, scales)
    if chain.vibrates:
        first, inexact = first_frequency(chain, contacts), Structure.of(chain).inexact
        damped = any(contact.law.damped for contact in contacts)
        fine, followed, estimated = refined(run, _difference, chain.accuracy, first, damped, inexact)
        _raise_failure(chain, fine, contacts, scales)
    else:
        followed, tolerance = Followed(0.0, FINEST), max(chain.accuracy * 0.01, FINEST * 10.0)
        fine = run(followed)
        _raise_failure(chain, fine, contacts, scales)
        while (
            estimated := _difference(run(Followed(0.0, tolerance)), fine)
        ) > chain.accuracy and tolerance > FINEST * 10.0:
            tolerance = max(tolerance * 1e-3, FINEST * 10.0)
    values = _values(chain, fine, scales)
    said = _warnings(chain, contacts, values, estimated)
    end = fine.time * scales.time
    if chain.duration is not None and fine.status != native.EVENT:
        end = chain.duration  # to the last bit
    outcome = f"followed for {format_si(end, 'time', 5)}"
    return ChainMotion(
        chain=chain,
        laws=tuple(contact.law.name for contact in contacts),
        outcome=ENDED if fine.status == native.EVENT else outcome,
        end=end,
        values=values,
        counts=tuple(fine.contacts["count"].tolist()),
        energy=_balance(chain, fine, scales, values),
        estimated=estimated,
        warnings=said,
        followed=followed,
    )


def _runner(chain: Chain, contacts: list[ChainContact], scales: _Scales) -> Callable[..., chaining.Run]:
    row = chain.row
    mass = np.array([math.inf if body.fixed else body.own_mass for body in row]) / scales.mass
    structure = Structure.of(chain)
    velocity = np.array([body.velocity for body in row]) / scales.velocity
    given = [
        (
            contact.curve.native,
            contact.length / scales.length,
            contact.force / scales.force,
            contact.depth,
            contact.damping * scales.velocity / contact.force,
            contact.link.gap / scales.length,
            contact.link.along,
            len(row) if contact.link.front is None else contact.link.front,
            len(row) if contact.link.behind is None else contact.link.behind,
            *structure.place(contact.link),
        )
        for contact in contacts
    ]
    fall = _falls(chain) * scales.time / scales.velocity
    limit = math.inf if chain.duration is None else chain.duration / scales.time

    def run(followed: Followed, times: Any = None) -> chaining.Run:
        vibrations = structure.vibrations(followed, scales.mass, scales.time)
        at = [limit] if times is None and chain.vibrates else () if times is None else times
        return chaining.run(
            mass, velocity, fall, given, vibrations, limit=limit, tolerance=followed.tolerance, times=at
        )

    return run


def _falls(chain: Chain) -> Array:
    """Acceleration of each body by its weight, m/s²."""
    held = [0.0 if body.fixed else 1.0 for body in chain.row]
    return (STANDARD_GRAVITY if chain.gravity else 0.0) * np.cos(chain.directions) * held


def _raise_failure(chain: Chain, run: chaining.Run, contacts: list[ChainContact], scales: _Scales) -> None:
    if run.status >= 0:
        return
    at = format_si(run.time * scales.time, "time", 4)
    if run.status == native.TOO_MANY:
        why = f"the chain takes more than {chaining.MOST_STEPS} steps; at {at}: give a shorter duration"
        raise SimulationError(why)
    law, why = contacts[run.failed].law.name, STATUSES[run.status].sentence
    raise SimulationError(f"contact {chain.link_names[run.failed]}, law {law}: {why}; at {at}")


def _difference(coarse: chaining.Run, fine: chaining.Run) -> float:
    """Of velocities over that of approach, and of the largest forces over each that is above a millionth of all."""
    if coarse.status < 0:
        return math.inf
    forces = fine.contacts["largest_force"]
    force = np.abs(coarse.contacts["largest_force"] - forces) / np.maximum(forces, 1e-6 * forces.max(initial=1e-300))
    return float(max(np.abs(coarse.velocity - fine.velocity).max(), force.max(initial=0.0)))


def _values(chain: Chain, run: chaining.Run, scales: _Scales) -> dict[str, Array]:
    row, found = chain.row, run.contacts
    return {
        "body_mass": np.array([math.nan if body.fixed else body.own_mass for body in row], np.float64),
        "initial_velocity": np.array([body.velocity for body in row]),
        "final_velocity": run.velocity * scales.velocity,
        "largest_force": found["largest_force"] * scales.force,
        "time_of_largest_force": found["time_of_largest_force"] * scales.time,
        "largest_indentation": found["largest_indentation"] * scales.length,
        "contact_begins": np.where(found["begins"] < 1e-9, 0.0, found["begins"]) * scales.time,
        "contact_ends": np.where(found["touching"] == 0, found["ends"], math.nan) * scales.time,
        "energy_absorbed": found["work"] * scales.energy,
    }


def _balance(chain: Chain, run: chaining.Run, scales: _Scales, values: dict[str, Array]) -> EnergyBalance:
    mass = np.nan_to_num(values["body_mass"])
    before, after = (0.5 * float(mass @ values[f"{when}_velocity"] ** 2) for when in ("initial", "final"))
    weight = 0.0
    if chain.gravity:
        moved = run.samples[-1:, 2 * len(chain.links) + len(chain.row) :: 3].T * scales.length
        there, at = Structure.of(chain).at_links(chain, moved), np.array([run.time * scales.time])
        moved = displacements(chain, run.indentation[:, None] * scales.length, at, there)
        weight = float((mass * _falls(chain)) @ moved[:, 0])
    absorbed = float(values["energy_absorbed"].sum())
    vibrations = float(run.structure.sum()) * scales.energy
    return EnergyBalance(before, after, weight, absorbed, vibrations, before + weight - absorbed - vibrations - after)


def _warnings(
    chain: Chain, contacts: list[ChainContact], values: dict[str, Array], estimated: float
) -> tuple[str, ...]:
    found = dict[str, None]()
    peaks = zip(*(values[name].tolist() for name in ("largest_force", "largest_indentation")), strict=True)
    for name, contact, (force, depth) in zip(chain.link_names, contacts, peaks, strict=True):
        outside = contact.law.outside(depth / contact.length)
        found |= dict.fromkeys((*contact.curve.warnings, *contact.law.remarks()))
        if outside:
            found[f"contact {name}: {outside}"] = None
        scene, law = contact.scene, contact.law
        if getattr(law, "family", "") == "elastic" and scene.yield_strength and scene.effective_modulus:
            _, most = yield_point(scene.effective_modulus, scene.effective_radius, scene.yield_strength)
            if force > most and not any("yields above" in sentence for sentence in found):
                found[
                    f"contact {name} yields above {format_si(most, 'force', 3)}, its force reaches "
                    f"{format_si(force, 'force', 3)}: law {law.name} is elastic"
                ] = None
    if estimated > chain.accuracy:
        found[
            f"accuracy {chain.accuracy:g} is not reached: estimated relative error {estimated:.1e}; collisions that "
            "follow each other amplify every error"
        ] = None
    return tuple(found)
