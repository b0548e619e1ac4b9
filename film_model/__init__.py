"""Impacts of compact bodies by the force–indentation linearisation method (FILM)."""

from film_model.batch import BatchResult, simulate_batch
from film_model.bodies import Beam, BendingStiffness, Body, HalfSpace, Plate, Rod, Sphere
from film_model.component import ImpactComponent
from film_model.contact import Contact
from film_model.errors import Outcome, SceneError, SimulationError
from film_model.history import Event, History, Samples
from film_model.laws import LAWS, AbstractLaw, BigAlabo, Hertz, Meyer, Parameter, Power, Stage, Stronge, Unloading
from film_model.materials import Material, material
from film_model.scene import Effects, Scene, Solver
from film_model.solve import simulate
from film_model.version import __version__

__all__ = [
    "LAWS",
    "AbstractLaw",
    "BatchResult",
    "Beam",
    "BendingStiffness",
    "BigAlabo",
    "Body",
    "Contact",
    "Effects",
    "Event",
    "HalfSpace",
    "Hertz",
    "History",
    "ImpactComponent",
    "Material",
    "Meyer",
    "Outcome",
    "Parameter",
    "Plate",
    "Power",
    "Rod",
    "Samples",
    "Scene",
    "SceneError",
    "SimulationError",
    "Solver",
    "Sphere",
    "Stage",
    "Stronge",
    "Unloading",
    "__version__",
    "material",
    "simulate",
    "simulate_batch",
]
