"""Impacts of compact bodies by the force–indentation linearisation method (FILM)."""

from film_model.batch import BatchResult, simulate_batch
from film_model.bodies import BendingStiffness, Body, HalfSpace, Plate, Rod, Sphere
from film_model.component import ImpactComponent
from film_model.contact import Contact
from film_model.errors import Outcome, SceneError, SimulationError
from film_model.history import Event, History, Samples
from film_model.laws import (
    LAWS,
    AbstractLaw,
    BigAlabo,
    BrakeUnloading,
    Hertz,
    JacksonGreen,
    KogutEtsion,
    Luding,
    Meyer,
    Parameter,
    Power,
    Retrace,
    RigidPlastic,
    Stage,
    Stronge,
    Tabulated,
    TanSun,
    Thornton,
    Unloading,
    WaltonBraun,
    YigitChristoforou,
)
from film_model.materials import Material, material
from film_model.scene import Effects, Scene, Solver
from film_model.solve import simulate
from film_model.version import __version__

__all__ = [
    "LAWS",
    "AbstractLaw",
    "BatchResult",
    "BendingStiffness",
    "BigAlabo",
    "Body",
    "BrakeUnloading",
    "Contact",
    "Effects",
    "Event",
    "HalfSpace",
    "Hertz",
    "History",
    "ImpactComponent",
    "JacksonGreen",
    "KogutEtsion",
    "Luding",
    "Material",
    "Meyer",
    "Outcome",
    "Parameter",
    "Plate",
    "Power",
    "Retrace",
    "RigidPlastic",
    "Rod",
    "Samples",
    "Scene",
    "SceneError",
    "SimulationError",
    "Solver",
    "Sphere",
    "Stage",
    "Stronge",
    "Tabulated",
    "TanSun",
    "Thornton",
    "Unloading",
    "WaltonBraun",
    "YigitChristoforou",
    "__version__",
    "material",
    "simulate",
    "simulate_batch",
]
