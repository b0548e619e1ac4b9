"""An instance of FMI 3.0 under FMPy whose importer is called in steps."""

from contextlib import contextmanager

from fmpy.fmi3 import FMU3Slave

from fmu_wrapper.instance import Slave

PARTS = 8
"""Of a step, between which the importer is called."""

MOTION = ("indentation", "impactor_velocity", "impactor_displacement", "target_displacement", "contact_force")


def slave_of(fmu):
    """FMPy's instance of FMI 3.0, not instantiated."""
    return FMU3Slave(
        guid=fmu.description.guid,
        unzipDirectory=fmu.folder,
        modelIdentifier=fmu.description.coSimulation.modelIdentifier,
        instanceName="impact",
    )


class Updated(Slave):
    """An instance that calls `update(slave, time, may_set, may_get, finished, can_return)` in its steps.

    `update` returns None, or the time at which the step is to end. required: names of what it sets and gets.
    """

    def __init__(self, fmu, update, required, event_mode=False, early_return=False):
        self.fmu, self.event_mode, self.exchange, self.version = fmu, event_mode, False, 3
        self.failed = []

        def call(_, time, may_set, may_get, finished, can_return, returns, return_time):
            try:
                end = update(self, time, may_set, may_get, finished, can_return)
            except Exception as error:  # ctypes would only print it
                self.failed.append(error)
                return
            if end is not None:
                returns[0], return_time[0] = True, end

        self.instance = slave_of(fmu)
        self.instance.instantiate(
            logMessage=lambda _e, _s, category, text: fmu.log(category, text),
            eventModeUsed=event_mode,
            earlyReturnAllowed=early_return,
            intermediateUpdate=call if update else None,
            requiredIntermediateVariables=[fmu.variables[name][0] for name in required],
        )

    def do_step(self, time, size):
        """One step: whether an event must be handled, whether it returned early, and the time reached."""
        event, _, early, reached = self.instance.doStep(time, size)
        if self.failed:
            raise self.failed.pop()
        return event, early, reached

    def rate(self, name):
        """Time derivative of an output."""
        return self.instance.getOutputDerivatives([self.fmu.variables[name][0]], [1])[0]


@contextmanager
def updated(fmu, update, required, values=None, **modes):
    """A running instance, freed at the end."""
    slave = Updated(fmu, update, required, **modes)
    try:
        slave.initialize(values or {})
        yield slave
    finally:
        slave.instance.freeInstance()
