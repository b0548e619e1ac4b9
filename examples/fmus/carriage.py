"""A drop tower's carriage: a mass on a spring and a damper, as an FMU made by PythonFMU.

m z'' + c z' + k z = force, solved in closed form for a force that is held over each step.
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Carriage(Fmi2Slave):
    """Input force [N]; outputs displacement [m] and velocity [m/s]. Less than critically damped."""

    author = "film-model contributors"
    description = "A mass on a spring and a damper"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mass, self.stiffness, self.damping = 0.5, 2e5, 20.0
        self.force = self.displacement = self.velocity = 0.0
        for name in ("mass", "stiffness", "damping"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        self.register_variable(Real("force", causality=Fmi2Causality.input))
        for name in ("displacement", "velocity"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        decay = 0.5 * self.damping / self.mass
        omega = math.sqrt(self.stiffness / self.mass - decay**2)
        rest = self.force / self.stiffness
        z, v = self.displacement - rest, self.velocity
        cosine, sine = math.cos(omega * step_size), math.sin(omega * step_size) / omega
        fading = math.exp(-decay * step_size)
        self.displacement = rest + fading * (z * (cosine + decay * sine) + v * sine)
        self.velocity = fading * (v * (cosine - decay * sine) - z * (omega**2 + decay**2) * sine)
        return True
