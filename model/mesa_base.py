"""Mesa's classes, adapted so that what they offer in public works on a game or is refused."""

import inspect
import itertools
import random
from collections.abc import Callable, Sequence
from typing import Any, Final, NoReturn, TypeVar

import mesa
import numpy as np
from mesa import DataCollector
from mesa.agent import AgentSet
from mesa.experimental.continuous_space import ContinuousSpace
from mesa.model import RNGLike, SeedLike

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_SEED

Rng = RNGLike | SeedLike
"""What Mesa and `numpy.random.default_rng` take as a source of random numbers."""

_MAX_DIGITS: Final = 1000
"""Maximum length of a seed as text."""
_TIME: Final = vars(mesa.Model).get("time")
"""The observable `time` of Mesa 3.5; None before."""

_Init = TypeVar("_Init", bound=Callable[..., None])


def hide_seed(init: _Init) -> _Init:
    """Hide the argument `seed` of a model's ``__init__`` from `inspect.signature`.

    `mesa.batch_run` of Mesa 3.5 overwrites the argument `seed`, even if the sweep has values for it. Without
    `seed` in the signature it sets `rng`, and leaves the values of `seed`.
    """
    signature = inspect.signature(init)
    shown = [parameter for name, parameter in signature.parameters.items() if name != "seed"]
    init.__signature__ = signature.replace(parameters=shown)  # type: ignore[attr-defined]
    return init


def label_samples(collector: DataCollector, times: Sequence[float]) -> None:
    """Set the times (s) of all rows of a collector. Mesa 3.5 needs them for `mesa.batch_run`.

    Mesa itself adds a time for each call of `collect`, but none if there are agent reporters only.
    """
    if hasattr(collector, "_collection_steps"):
        collector._collection_steps[:] = times


def seed_of_run(seed: float | str | None, rng: Rng | None) -> int:
    """Return the seed of a run, given `seed` or `rng` as Mesa takes them; draw it if both are None.

    `seed` may be a text, as from a text box of Mesa's page. A whole number `rng` is a seed. From any other
    `rng` the seed is drawn, so that a generator gives another seed to each model.
    """
    if seed is not None and rng is not None:
        raise InputError("rng", rng, "must not be given together with seed")
    if seed is not None:
        return _whole_number("seed", seed)
    if isinstance(rng, int | np.integer):
        return _whole_number("rng", rng)
    try:
        return int(np.random.default_rng(rng).integers(MAX_SEED))
    except (TypeError, ValueError):
        raise InputError("rng", rng, "must be a whole number ≥ 0 or a random generator") from None


def _whole_number(field: str, given: object) -> int:
    number: object = given
    if isinstance(given, float | np.floating):
        number = int(given) if float(given).is_integer() else None
    elif isinstance(given, str):
        number = int(given) if given.strip().isdecimal() and len(given) <= _MAX_DIGITS else None
    if not isinstance(number, int | np.integer) or isinstance(number, bool) or number < 0:
        raise InputError(field, given, "must be a whole number ≥ 0")
    return int(number)


class RobotSpace(ContinuousSpace):
    """Mesa's space of the robots; `agent_positions` is a read-only view of the array of the kernel."""

    def __init__(self, half: float, size: int, random: random.Random) -> None:
        super().__init__([[-half, half], [-half, half]], torus=False, random=random, n_agents=size)
        self._share(np.empty((2, size)).T)  # the kernel needs contiguous columns

    def _share(self, positions: Any) -> None:
        self.positions: Floats = positions
        """Centres of the robots (m), shape (n, 2)."""
        self._agent_positions = positions
        active = positions[: self._n_agents]
        active.flags.writeable = False
        self.agent_positions = active

    def _add_agent(self, agent: mesa.Agent) -> int:
        if self._n_agents == len(self.positions):
            agent.model.deregister_agent(agent)
            raise InputError("space", agent, "has only robots: create a space for other agents")
        index: int = super()._add_agent(agent)
        self._share(self.positions)
        return index

    def _remove_agent(self, agent: mesa.Agent) -> None:
        super()._remove_agent(agent)
        self._share(self.positions[: self._n_agents])


class RobotSet(AgentSet):
    """A copy of the set of agents: it can be sorted, shuffled and selected from, but not changed."""

    def _refuse(self, agent: mesa.Agent) -> NoReturn:
        raise InputError("agents", agent, "cannot be changed: use model.remove(robot), or a list")

    add = discard = remove = _refuse


class MesaModel(mesa.Model):
    """A Mesa model with a seed, whose sets of agents are copies.

    Attributes
    ----------
    seed : int
        Seed of the run.
    """

    scenario = property(lambda _: None, lambda _, scenario: None)
    """None. Mesa 3.5 has experimental scenarios; its page passes one to each new model that has one."""

    def __init__(self, seed: float | str | None, rng: Rng | None) -> None:
        self.seed = seed_of_run(seed, rng)
        self._unique_ids = itertools.count(1)
        super().__init__(rng=self.seed)
        self.publish_time(0.0)
        self._seed = self.seed  # Mesa 3.3 forgets it, and `reset_randomizer` needs it
        if isinstance(rng, np.random.Generator):
            self.rng = rng

    def publish_time(self, time: float) -> None:
        """Notify the observers of `time`, which Mesa 3.5 has."""
        if _TIME is not None:
            _TIME.__set__(self, time)

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("a game has one clock, model.env of SimPy: schedule events there")

    schedule_event = schedule_recurring = _refuse

    @property  # type: ignore[misc]  # Mesa has a setter, which only refuses
    def agents(self) -> AgentSet:
        """The agents, a copy."""
        return RobotSet(self._all_agents, self.random)

    @property
    def agents_by_type(self) -> dict[type[mesa.Agent], AgentSet]:
        """The agents by their class, copies."""
        return {kind: RobotSet(agents, self.random) for kind, agents in self._agents_by_type.items()}

    def register_agent(self, agent: mesa.Agent) -> None:
        """Register an agent; Mesa calls this when the agent is created."""
        # Mesa 3.3 counts the agents of each model in a dictionary of the class, which would keep all models.
        getattr(mesa.Agent, "_ids", {}).pop(self, None)
        self._check_agent(agent)
        if agent not in self._all_agents:
            super().register_agent(agent)  # type: ignore[no-untyped-call]
            agent.unique_id = next(self._unique_ids)

    def _check_agent(self, agent: mesa.Agent) -> None:
        """Raise an `InputError` if an agent must not be registered."""

    def __reduce_ex__(self, _: object) -> NoReturn:
        raise TypeError("a game cannot be copied or pickled; play it again from model.game and model.seed")
