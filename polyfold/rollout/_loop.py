"""The one loop: see, decide, fold, see again. Everything that runs an episode runs this."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import closing

from polyfold import plugins
from polyfold.config import Experiment, checked_seed
from polyfold.garments import Garment
from polyfold.plugins.interfaces import Agent, Simulator, UsesComponents
from polyfold.rollout._inputs import Start
from polyfold.rollout._rollout import Rollout
from polyfold.rollout._sentences import plain
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import Task
from polyfold.types import Episode, Role


def build_agent(experiment: Experiment) -> Agent:
    """Construct the experiment's agent with the components that it is made of."""
    spec = experiment.agent
    agent = plugins.component_class("agents", spec.name.partition(":")[0])
    uses = agent.uses if isinstance(agent, UsesComponents) else ()
    components = {field: plugins.create_chosen(experiment, field) for field in uses}
    return plugins.create("agents", spec.name, spec.params, **components)


def run_episode(
    experiment: Experiment,
    garment: Garment,
    instruction: str,
    seed: int,
    simulator: Simulator | None = None,
    agent: Agent | None = None,
    task: Task | None = None,
    agent_seed: int | None = None,
    role: Role = "method",
    judge: Callable[[Episode], Episode] | None = None,
) -> Episode:
    """Run one episode from a sentence to the final picture.

    A refusal, a failed grounding, an unusable plan, a language model that can't be reached or a diverged fold ends the
    episode with ``failure`` set; what was done until then is kept. Other errors (a bug, a missing plugin, a key that is
    not accepted) are raised.

    Args:
        experiment: the components.
        garment: what lies on the table.
        instruction: what to do with it.
        seed: decides the pose on the table, and the agent's random choices unless ``agent_seed`` does.
        simulator, agent: instances to reuse; by default they are constructed from the experiment.
        task: what guidance is made from, for agents that require some.
        agent_seed: decides the agent's random choices.
        role: what observers are told that the episode is for.
        judge: scores the episode before observers are told of its end.

    Raises:
        ConfigError: if the agent requires guidance and no task is given, the instruction is no text, or the seed no
            whole number.
    """
    if simulator is None:
        with closing(plugins.create_chosen(experiment, "simulator")) as own:
            return run_episode(
                experiment, garment, instruction, seed, own, agent, task, agent_seed, role=role, judge=judge
            )
    instruction, seed = plain(instruction), checked_seed(seed)
    agent = agent or build_agent(experiment)
    transcript = Transcript(
        plugins.create_chosen(experiment, "llm") if "instruction" in agent.requires else None,
        {"task": task.id if task else None, "garment": garment.name, "seed": seed, "instruction": instruction},
    )
    clock = time.perf_counter()
    observation = simulator.reset(garment, seed)
    start = Start(experiment, garment, instruction, task, observation, simulator.state(), transcript, simulator)
    rollout = Rollout(start, role)
    rollout.seconds["reset"] = time.perf_counter() - clock
    agent_seed = seed if agent_seed is None else agent_seed
    error = rollout.follow(agent, instruction, seed, agent_seed)
    episode = rollout.episode(seed, agent_seed, error)
    episode = episode if judge is None else judge(episode)
    plugins.notify("on_episode_end", episode=episode, role=role)
    return episode
