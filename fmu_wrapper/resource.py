"""`resources/model.film`: the data of an exported model, the structure `model_data` of runtime/model.h."""

from __future__ import annotations

import ctypes as c
import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.base.units import scene_unit
from film_model.core import native
from film_model.core.modal import LEVELS, Tables
from film_model.laws.elastoplastic import FLATTENED, SUNK
from film_model.laws.hertz import hertz_stiffness
from film_model.problem import stresses
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem
from film_model.scene import STANDARD_GRAVITY, Scene
from film_model.scene.friction_table import FrictionTable
from film_model.scene.rolling import sliding_of
from film_model.solve.component import ImpactComponent
from film_model.solve.sensed import weights_of
from film_model.solve.vibration import Vibration
from fmu_wrapper.assumptions import Validity
from fmu_wrapper.layout import (
    DAMPING,
    MAGIC,
    OF_DAMPING,
    OF_LAW,
    REASON,
    RESTITUTION_TERMS,
    SCALING,
    SHAPED,
    Data,
    Friction,
    Modes,
    Relaxing,
    Stresses,
)
from fmu_wrapper.powers import (
    SMALLER,
    damping_factor,
    damping_power,
    exponent_is_free,
    field_of,
    own_page,
    powers_of,
    rational,
    restitution_series,
)
from fmu_wrapper.variables import KINDS, OF_FRICTION, RIGID, STATES, VARIABLES, Kind, Variable, reference, settable

NAME, NOTES, SCENE = "model.film", "notes.json", "scene.toml"
NAMES = (NAME, NOTES, SCENE)

MOST_MODES = 20_000
"""Largest number of natural vibrations of an FMU, limited by memory: 6 kB of address space each in every instance."""
OF_LINES = ("target_stiffness", "loading_segments", "unloading_segments")
"""Parameters that an FMU of viscoelastic bodies does not have."""
OF_HALF_SPACES = ("target_impedance", *OF_LINES)
"""Parameters that an FMU on a vibrating target does not have."""
UNUSED = {"target_impedance": RIGID}
"""Start values that are not the smallest, of parameters that an FMU does not have."""

_SETTABLE = settable()


def model_data(
    problem: Problem,
    kind: Kind,
    gap: float,
    segments: tuple[int, int],
    nominal: tuple[float, float, float],
    validity: Validity,
    vibration: Vibration | None = None,
    tolerance: float = 0.0,
) -> Data:
    """The data of an export, without its token. gap: at the start, m. nominal: of the normal states, SI. vibration:
    on a vibrating target, with the modes to follow. tolerance: of the steps of viscoelastic bodies.

    Raises SimulationError for more than `MOST_MODES` modes,
    ValueError for a start value outside the range of its variable.
    """
    scene, law = problem.scene, problem.law
    data = Data()
    data.magic = MAGIC
    data.kind = KINDS.index(kind)
    data.linearisation = native.CHORD if scene.solver.linearisation == "chord" else native.WORK_PRESERVING
    data.length_scale, data.force_scale = problem.scales.length, problem.scales.force
    start = {**_of_scene(problem), "initial_gap": gap}
    start |= dict(zip(("loading_segments", "unloading_segments"), segments, strict=True))
    powers = {name: powers_of(law, name, problem) for name in SCALING}
    damping = {name: damping_power(law, name, problem) for name in DAMPING}
    series = restitution_series(law, problem)
    missing = _missing(problem, vibration)
    for k, variable in enumerate(VARIABLES[:_SETTABLE]):
        name = variable.name
        exists = kind in variable.causality and name not in missing
        if name in powers:
            exists = exists and powers[name] is not None
        elif name in OF_DAMPING:
            exists = exists and bool(damping[name])
        elif name in ("restitution", "exponent"):
            exists = series is not None if name == "restitution" else exponent_is_free(law)
        if name in OF_LAW:
            own, (low, high) = getattr(law, field_of(law, name)) if exists else 0.0, _range(variable)
            exists = exists and low <= own <= high
            data.start[k] = own if exists else low
        else:
            data.start[k] = start.get(name, 0.0) if exists else UNUSED.get(name, max(variable.low or 0.0, 0.0))
        data.available[k] = exists and not (name in damping and damping[name] is None)
        check_range(variable, data.start[k])
        data.valid[k][:] = (-math.inf, math.inf)
    for k, name in enumerate(SCALING):
        data.length_power[k], data.force_power[k] = powers[name] or (0.0, 0.0)
    _put_damping(data, problem, damping, series)
    _put_validity(data, validity)
    data.speed = max(scene.approach_velocity, 1e-9)
    data.nominal[: len(nominal)] = nominal
    data.stresses = _stresses(problem)
    data.curve = curve_of(problem.law).native
    _put_family(data, problem)
    _put_relaxation_and_friction(data, problem, tolerance)
    if vibration is not None:
        _put_modes(data, problem, vibration, weights_of(scene.target, vibration.tables, vibration.highest))
    data.size = c.sizeof(Data) + len(data.tail)
    return data


def _put_relaxation_and_friction(data: Data, problem: Problem, tolerance: float) -> None:
    """The series of viscoelastic bodies, and what friction depends on besides its parameters."""
    if problem.relaxation is not None:
        data.relaxation = Relaxing(problem.relaxation.law(1.0), tolerance)
    sliding = sliding_of(problem.scene, at_rest=True)
    if sliding is not None:
        number, table = problem.scene.impactor.inertia_number, sliding.table.rows if sliding.table else ()
        (depth, speed), lever = data.nominal[:2], sliding.impactor.lever
        slips = sliding.ratio * float(sliding.friction) * depth or depth  # before all slides
        data.nominal[3:] = (slips, speed, speed / lever, problem.mass * speed)
        data.friction = Friction(sliding.ratio, lever, number, len(table))
        data.tail += np.array(table).tobytes()


def _put_damping(data: Data, problem: Problem, powers: dict[str, float | None], series: Array | None) -> None:
    """The damping factor, its powers and its series in the restitution."""
    data.damping = damping_factor(problem.law, problem)
    data.restitution[:] = [0.0] * RESTITUTION_TERMS if series is None else series
    for k, name in enumerate(DAMPING):
        data.damping_power[k] = powers[name] or 0.0 if data.available[reference(name)] else 0.0


def _missing(problem: Problem, vibration: Vibration | None) -> tuple[str, ...]:
    """Parameters and inputs of impacts that this one does not have."""
    friction = problem.scene.contact.friction
    unknown = tuple(name for name in OF_FRICTION if reference(name) < _SETTABLE) if friction is None else ()
    unknown += ("friction",) if isinstance(friction, FrictionTable) else ()
    if vibration is not None:
        return (*unknown, *OF_HALF_SPACES)
    if problem.relaxation is not None:
        return (*unknown, *OF_LINES)
    return (*unknown, "target_impedance" if problem.given.compliance > 0.0 else "target_stiffness")


def _of_scene(problem: Problem) -> dict[str, float]:
    """Start values of the parameters that are not the law's, SI."""
    scene = problem.scene
    sliding = sliding_of(scene, at_rest=True)
    return {
        "friction": friction if isinstance(friction := scene.contact.friction, float) else 0.0,
        "initial_tangential_velocity": 0.0 if sliding is None else float(sliding.along),
        "initial_spin": scene.impactor.spin or 0.0,
        "mass": problem.mass,
        "initial_velocity": scene.approach_velocity,
        "target_impedance": min(problem.given.impedance, RIGID),
        "target_stiffness": 1.0 / problem.given.compliance if problem.given.compliance > 0.0 else math.inf,
        "gravity": STANDARD_GRAVITY if problem.load > 0.0 else 0.0,
        "input_extrapolation": 1.5,  # right in a master that steps all FMUs side by side, then exchanges outputs
    }


def _put_modes(data: Data, problem: Problem, vibration: Vibration, weights: Array) -> None:
    """The modes of a vibrating target and its sensors; `rest` is the compliance of the others."""
    tables, start, count = vibration.tables, vibration.start, vibration.modes
    if count > MOST_MODES:
        raise SimulationError(
            f"the target has {count} natural vibrations at this accuracy, and an FMU at most {MOST_MODES}: ask for a "
            "coarser accuracy"
        )
    rest = start.rest * problem.scales.length / problem.scales.force
    data.modes = Modes(tables.longest, rest, start.tolerance, count, LEVELS, len(weights))
    data.tail += np.concatenate([weights.ravel(), tables.frequency, tables.share, tables.ratio]).tobytes()


def _put_validity(data: Data, validity: Validity) -> None:
    """Ranges of validity, and the limits of indentation: at yield δ ∝ R/E², for a narrow contact δ ∝ R."""
    for name, found in validity.ranges.items():
        k = reference(name)
        data.valid[k][:] = (found.low, found.high)
        for side, reason in enumerate((found.below, found.above)):
            data.reason[k][side].value = reason.encode()[: REASON - 1]
    data.also[:] = validity.also
    data.limit[:] = (validity.elastic, validity.narrow)
    for k, powers in enumerate(({"radius": 1.0, "effective_modulus": -2.0}, {"radius": 1.0})):
        for name, power in powers.items():
            data.limit_power[k][SCALING.index(name)] = power if data.available[reference(name)] else 0.0


def _stresses(problem: Problem) -> Stresses:
    """The numbers from which the runtime computes what `film_model.problem.stresses` does; 0 for what is unknown."""
    scene = problem.impacts.scene
    modulus, radius = scene.effective_modulus, scene.effective_radius
    known = Stresses(radius)
    if modulus is None or problem.curve.pulls or scene.nose is not None:
        return known
    known.hertz, known.shallow = hertz_stiffness(modulus, radius), stresses.SHALLOW
    known.widening = problem.impacts.law.value("widening")
    known.hertzian = stresses.hertzian(known.widening)
    plastic = stresses.plastic_contact(problem.impacts)
    if plastic is not None:
        own = plastic.constants
        for name in ("onset", "lateness", "pressure", "pressure_bend", "strain"):
            setattr(known, name, getattr(own, name))
        known.first_radius, known.spread, known.share = plastic.first_radius, plastic.spread, plastic.share
        known.hardens, known.pressure_flattened = plastic.hardens, plastic.flattening
        known.flattened, known.sunk = FLATTENED, SUNK
    if scene.oval is not None:
        known.radius *= scene.oval.spread
    elif scene.stressed_poissons_ratio is not None:
        known.shear, known.depth = stresses.shear_below(scene.stressed_poissons_ratio)
    return known


def _put_family(data: Data, problem: Problem) -> None:
    """The curves for other strengths and moduli, of a law whose stages depend on them."""
    law, page = problem.law, own_page(problem)
    if page is None:
        return
    family = data.family
    family.shape, family.low, family.high = law.shape, page.family.low, page.family.high
    family.nodes, family.varying = page.family.nodes, page.family.varying
    for k, name in enumerate(SHAPED):
        probe: Any = replace(law, **{name: getattr(law, name) * SMALLER}) if name in law.shaped_by else law  # type: ignore[type-var]
        family.power[k] = rational(math.log(probe.shape / law.shape) / math.log(SMALLER))
    data.tail = bytes(page.whole) + page.family.memory.tobytes()


def mode_frequencies(data: Data) -> Array:
    """The natural frequencies of a vibrating target, rad/s."""
    return np.frombuffer(data.tail)[-3 * data.modes.count :][: data.modes.count]


def _range(variable: Variable) -> tuple[float, float]:
    """Smallest and largest value of a variable, SI."""
    low = -math.inf if variable.low is None else variable.low
    return low, math.inf if variable.high is None else variable.high


def check_range(variable: Variable, value: float) -> None:
    """Raise ValueError for a value (SI) outside the range of a variable."""
    low, high = _range(variable)
    if not low <= value <= high:
        unit = f" {scene_unit(variable.dimension)}" if variable.dimension else ""
        raise ValueError(f"{variable.name}: {value:g}{unit} is out of range: from {low:g} to {high:g}{unit}")


def segments_of(data: Data) -> tuple[int, int]:
    """Segments per stage in loading and unloading."""
    loading, unloading = (int(data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
    return loading, unloading


def component_of(scene: Scene, data: Data) -> ImpactComponent:
    """The library's component of the impact that an FMU contains, with the same gap and segments. scene: as served."""
    gap = data.start[reference("initial_gap")]
    if data.modes.count > 0 or data.relaxation.tolerance > 0.0:
        return ImpactComponent(scene, initial_gap=gap)
    return ImpactComponent(scene, initial_gap=gap, segments=segments_of(data))


def vibrations_of(data: Data) -> Tables:
    """The vibrations of the target that an FMU contains, which end its data."""
    frequency, share, ratio = np.frombuffer(data.tail, np.float64)[-3 * data.modes.count :].reshape(3, -1)
    return Tables(frequency, share, ratio, data.modes.longest)


def loading_force(data: Data, indentation: float, rate: float) -> float:
    """Force of the law's loading curve with damping, N, at an indentation ≥ 0 m, without the march."""
    xi, curve = indentation / data.length_scale, data.curve
    stage = sum(curve.stage[k].end < xi for k in range(curve.stages - 1))
    force = native.stage_law(curve, stage, xi)[0] * data.force_scale
    return force + data.damping * _damping(curve, xi) * rate if curve.stage[0].damped else force


def _damping(curve: native.Curve, xi: float) -> float:
    """The damping coefficient of a damped law, divided by its factor."""
    piece = next(piece for piece in curve.piece if xi <= piece.end)
    c: native.Function = piece.damping
    x = (xi - c.origin) * c.per_span
    if c.form == native.POWER:
        return float(c.constant + (c.slope + c.square * x) * x + c.coefficient * x**c.exponent)
    return float(chebval(2.0 * (math.sqrt(x) if c.form == native.ROOT_SERIES else x) - 1.0, c.series[: c.terms]))


def finished(data: Data, token: str) -> bytes:
    """Content of the file: the data with token and checksum."""
    data.token = token.encode()
    content = bytes(data)[Data.token.offset :] + data.tail
    data.checksum = _checksum(content)
    return bytes(data) + data.tail


def read(content: bytes) -> Data:
    """Data from the content of the file. Raises ValueError if it is damaged or written by another version."""
    if len(content) < c.sizeof(Data) or not content.startswith(MAGIC):
        raise ValueError(f"{NAME}: the {len(content)} bytes were not written by this version of film-model")
    data = Data.from_buffer_copy(content)
    data.tail = content[c.sizeof(Data) :]
    if data.size != len(content):
        raise ValueError(f"{NAME}: damaged, it must have {data.size} bytes")
    if data.checksum != _checksum(content[Data.token.offset :]):
        raise ValueError(f"{NAME}: damaged, the checksum does not match")
    return data


def start_values(data: Data) -> dict[str, float]:
    """Start values of the parameters and inputs of this FMU, SI."""
    return {v.name: data.start[k] for k, v in enumerate(VARIABLES[:_SETTABLE]) if data.available[k]}


def has(data: Data, name: str) -> bool:
    """Whether this FMU has the variable."""
    k = reference(name)
    if not has_exchange(data) and k >= reference("rate_of_indentation"):
        return False
    if name in OF_FRICTION and not slides(data):
        return False
    return KINDS[data.kind] in VARIABLES[k].causality and (k >= _SETTABLE or bool(data.available[k]))


def has_exchange(data: Data) -> bool:
    """Whether the FMU is for Model Exchange too: not on a target that vibrates or has a static stiffness, and not of
    viscoelastic bodies."""
    stiff = data.available[reference("target_stiffness")]
    return not (data.modes.count or data.relaxation.tolerance or stiff)


def states_of(data: Data) -> tuple[str, ...]:
    """The continuous states of the FMU in Model Exchange."""
    if KINDS[data.kind] == "contact" or not has_exchange(data):
        return ()
    return tuple(name for name in STATES if has(data, name))


def slides(data: Data) -> bool:
    """Whether the impact has friction: by an input, because with a table of it there is no parameter."""
    return bool(data.available[reference("torque")])


def _checksum(content: bytes) -> int:
    """FNV-1a hash of words of 8 bytes, as `model_checksum` of the runtime."""
    found = 14695981039346656037
    for word in memoryview(content).cast("Q"):
        found = ((found ^ word) * 1099511628211) & 0xFFFFFFFFFFFFFFFF
    return found
