"""The public names of `film_model`, which loads this module when the first of them is used."""

from typing import TYPE_CHECKING, Any

import film_model.laws as laws
import film_model.targets as targets
from film_model.base.errors import ImpactWarning, Outcome, SceneError, SimulationError
from film_model.base.materials import Material, material
from film_model.scene import Contact, Effects, Scene, Solver, Sphere
from film_model.scene.chain import Chain
from film_model.scene.chain_body import ChainBody
from film_model.solve.batch import BatchResult, simulate_batch
from film_model.solve.bounce import Bounces, bounce
from film_model.solve.chain_motion import ChainMotion, simulate_chain
from film_model.solve.component import ImpactComponent
from film_model.solve.derivatives import Derivatives
from film_model.solve.history import Event, History, Samples
from film_model.solve.simulate import simulate

if TYPE_CHECKING:
    from film_model.laws import *  # noqa: F403
    from film_model.targets import *  # noqa: F403

__all__ = [
    "BatchResult",
    "Bounces",
    "Chain",
    "ChainBody",
    "ChainMotion",
    "Contact",
    "Derivatives",
    "Effects",
    "Event",
    "History",
    "ImpactComponent",
    "ImpactWarning",
    "Material",
    "Outcome",
    "Samples",
    "Scene",
    "SceneError",
    "SimulationError",
    "Solver",
    "Sphere",
    "bounce",
    "material",
    "simulate",
    "simulate_batch",
    "simulate_chain",
]
__all__ += laws.__all__  # a new law is listed there only
__all__ += targets.__all__  # likewise a new kind of target


def __getattr__(name: str) -> Any:
    """A law or a kind of target, whose files are loaded when they are first used."""
    return getattr(laws if name in laws.__all__ else targets, name)
