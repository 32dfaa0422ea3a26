"""The unit of the benchmarks written for pythonfmu: what node.c does with one signal."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class PyNode(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u0 = 0.0
        self.y0 = 0.0
        self.gain = 1.0
        self.bias0 = 0.0
        self.register_variable(Real("u0", causality=Fmi2Causality.input))
        self.register_variable(Real("y0", causality=Fmi2Causality.output))
        for name in ("gain", "bias0"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
            )

    def do_step(self, current_time, step_size):
        self.y0 = self.y0 + step_size * (self.gain * self.u0 + self.bias0 - self.y0)
        return True
