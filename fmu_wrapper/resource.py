"""`resources/model.film`: what an export fixes, as the runtime's structure `model_data` (runtime/model.h)."""

from __future__ import annotations

import ctypes as c
import math
from dataclasses import replace
from typing import Any

from film_model.bodies import STANDARD_GRAVITY
from film_model.core import native
from film_model.curve import curve_of
from film_model.laws.law import AbstractLaw, law_fields
from film_model.problem import Problem
from film_model.scene import Scene
from film_model.units import scene_unit
from fmu_wrapper.variables import KINDS, RIGID, STATES, VARIABLES, Kind, Variable, reference, settable

NAME, NOTES = "model.film", "notes.json"
MAGIC = b"FILMFMU1"
SCALING = ("radius", "effective_modulus", "yield_strength")
"""Parameters that the march's length and force scales are powers of."""
DAMPING = (*SCALING, "mass", "initial_velocity")
"""Parameters that the factor of a damped law's damping is powers of."""

_SETTABLE = settable()
_D, _I = c.c_double, c.c_int32
_PROBES = (2.0, 5.0)


class Data(c.Structure):
    """model_data of runtime/model.h."""

    _fields_ = (
        ("magic", c.c_char * 8),
        ("size", c.c_uint64),
        ("checksum", c.c_uint64),
        ("token", c.c_char * 64),
        ("kind", _I),
        ("linearisation", _I),
        ("available", _I * _SETTABLE),
        ("even", _I),
        ("start", _D * _SETTABLE),
        ("length_scale", _D),
        ("length_power", _D * len(SCALING)),
        ("force_scale", _D),
        ("force_power", _D * len(SCALING)),
        ("damping", _D),
        ("damping_power", _D * len(DAMPING)),
        ("speed", _D),
        ("nominal", _D * len(STATES)),
        ("curve", native.Curve),
    )


def model_data(
    scene: Scene,
    problem: Problem,
    kind: Kind,
    gap: float,
    segments: tuple[int, int],
    nominal: tuple[float, float, float],
) -> Data:
    """The data of an export but for its token. `gap`: at the start, m; `nominal`: of the states, SI.

    Raises ValueError for a start value that the FMU would not take.
    """
    law = problem.law
    data = Data()
    data.magic, data.size = MAGIC, c.sizeof(Data)
    data.kind = KINDS.index(kind)
    data.linearisation = native.CHORD if scene.solver.linearisation == "chord" else native.WORK_PRESERVING
    data.length_scale, data.force_scale = problem.scales.length, problem.scales.force
    start = {
        "mass": problem.mass,
        "initial_velocity": scene.approach_velocity,
        "initial_gap": gap,
        "target_impedance": min(scene.target_impedance, RIGID) if problem.gamma > 0.0 else RIGID,
        "gravity": STANDARD_GRAVITY if problem.load > 0.0 else 0.0,
        "loading_segments": segments[0],
        "unloading_segments": segments[1],
    }
    powers = {name: powers_of(law, name, problem) for name in SCALING}
    damping = {name: damping_power(law, name, problem) for name in DAMPING}
    for k, variable in enumerate(VARIABLES[:_SETTABLE]):
        name = variable.name
        exists = kind in variable.causality
        if name in powers:
            exists = exists and powers[name] is not None
            data.start[k] = getattr(law, name) if exists else variable.low
        else:
            data.start[k] = start.get(name, 0.0) if exists else max(variable.low or 0.0, 0.0)
        data.available[k] = exists and not (name in damping and damping[name] is None)
        check_range(variable, data.start[k])
    for k, name in enumerate(SCALING):
        data.length_power[k], data.force_power[k] = powers[name] or (0.0, 0.0)
    data.damping = _damping(law, problem)
    for k, name in enumerate(DAMPING):
        data.damping_power[k] = damping[name] or 0.0 if data.available[reference(name)] else 0.0
    data.speed = max(scene.approach_velocity, 1e-9)
    data.nominal[:] = nominal
    data.curve = problem.curve.native
    return data


def check_range(variable: Variable, value: float) -> None:
    """ValueError where a variable of an FMU does not take a value (SI)."""
    low = -math.inf if variable.low is None else variable.low
    high = math.inf if variable.high is None else variable.high
    if not low <= value <= high:
        unit = f" {scene_unit(variable.dimension)}" if variable.dimension else ""
        raise ValueError(f"{variable.name}: {value:g}{unit} is out of range: from {low:g} to {high:g}{unit}")


def powers_of(law: AbstractLaw, name: str, problem: Problem) -> tuple[float, float] | None:
    """Powers of a law's parameter in its length and force scales.

    None when the law has no such parameter, when its dimensionless stages change with it (the curve that is shipped
    would no longer hold), or when the scales are no powers of it.
    """
    value = getattr(law, name, None)
    if name not in law_fields(type(law)) or value is None:
        return None
    energy = 0.5 * problem.mass * max((problem.approach * problem.scales.velocity) ** 2, 1e-300)
    base = law.scales(energy)
    found: list[tuple[float, float]] = []
    for factor in _PROBES:
        other: AbstractLaw = replace(law, **{name: value * factor})  # type: ignore[type-var]
        if bytes(curve_of(other).native) != bytes(problem.curve.native):
            return None
        length, force = (math.log(b / a) / math.log(factor) for a, b in zip(base, other.scales(energy), strict=True))
        found.append((_plain(length), _plain(force)))
    return found[0] if found[0] == found[1] else None


def damping_power(law: AbstractLaw, name: str, problem: Problem) -> float | None:
    """Power of a parameter in what the curve's damping is multiplied with; 0 without damping or such a parameter.

    None when it is no power of it: then the FMU does not have the parameter.
    """
    base = _damping(law, problem)
    if base == 0.0 or (name in SCALING and powers_of(law, name, problem) is None):
        return 0.0
    found: list[float] = []
    for factor in _PROBES:
        other, length = law, 1.0
        if name in SCALING:
            other = replace(law, **{name: getattr(law, name) * factor})  # type: ignore[type-var]
            length = other.scales(1.0)[0] / law.scales(1.0)[0]
        mass, velocity = (factor if name == one else 1.0 for one in ("mass", "initial_velocity"))
        ratio = _damping(other, problem, mass, velocity, length) / base
        found.append(_plain(math.log(ratio) / math.log(factor)) if ratio > 0.0 else math.nan)
    return found[0] if found[0] == found[1] else None


def _damping(
    law: AbstractLaw, problem: Problem, mass: float = 1.0, velocity: float = 1.0, length: float = 1.0
) -> float:
    """What the curve's damping is multiplied with, N s/m, for so many times the problem's mass, velocity and length."""
    speed = problem.scene.approach_velocity
    return float(law.damping_factor(mass * problem.mass, velocity * speed, length * problem.scales.length))


def _plain(power: float) -> float:
    """The fraction with a small denominator that a power stands for."""
    near = round(power * 60.0) / 60.0
    return near if abs(near - power) < 1e-12 else power


def finished(data: Data, token: str) -> bytes:
    """The file: data with its token and checksum."""
    data.token = token.encode()
    content = bytes(data)[Data.token.offset :]
    data.checksum = _fnv1a(content)
    return bytes(data)


def read(content: bytes) -> Data:
    """Data from a file's bytes. Raises ValueError if they are damaged or of another version."""
    if len(content) != c.sizeof(Data) or not content.startswith(MAGIC):
        raise ValueError(f"{NAME}: {len(content)} bytes are no data of this version of film-model")
    data = Data.from_buffer_copy(content)
    if data.checksum != _fnv1a(content[Data.token.offset :]):
        raise ValueError(f"{NAME}: damaged, its checksum does not fit")
    return data


def start_values(data: Data) -> dict[str, float]:
    """Start values of the parameters and inputs this FMU has, SI."""
    return {v.name: data.start[k] for k, v in enumerate(VARIABLES[:_SETTABLE]) if data.available[k]}


def has(data: Data, name: str) -> bool:
    """Whether this FMU has the variable."""
    k = reference(name)
    return KINDS[data.kind] in VARIABLES[k].causality and (k >= _SETTABLE or bool(data.available[k]))


def _fnv1a(content: bytes) -> int:
    hash_: Any = 14695981039346656037
    for byte in content:
        hash_ = ((hash_ ^ byte) * 1099511628211) & 0xFFFFFFFFFFFFFFFF
    return hash_
