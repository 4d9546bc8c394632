"""An FMU instance that can start anew from other start values, without the cost of a new instance."""

from __future__ import annotations

from collections.abc import Mapping

from .fmu import Fmu


class RestartedFmu(Fmu):
    """As Fmu; restart takes it back to initialisation with other start values, as often as wanted.

    It goes back to a state kept in initialisation mode, after everything that follows from the
    parameters (the map of fidelity averaged) has been found.

    Args: as Fmu.
    """

    def _before_start(self) -> None:
        # a value read here makes the native FMU derive its constants, for the state that is kept
        self._read_one(next(name for name, v in self.variables.items() if v.causality == "output"))
        self._blank = self.get_state()

    def restart(self, values: Mapping[str, float]) -> None:
        """Start anew with these start parameters and inputs; all others are those of the first start.

        Args:
            values: by name.

        Raises:
            FmuError: a value is refused, alone or with others.
        """
        self.messages.clear()  # a run restarts every step: only what concerns this start is kept
        self.set_state(self._blank)
        self._assign(values)
        self._call("exitInitializationMode")
