"""The environment ``polyfold`` of LeRobot: one folding task; a step is a fold."""

from dataclasses import dataclass, field

from lerobot.configs.types import FeatureType, PolicyFeature  # pyright: ignore[reportMissingImports]
from lerobot.envs.configs import EnvConfig  # pyright: ignore[reportMissingImports]
from lerobot.utils.constants import ACTION, OBS_IMAGE, OBS_STATE  # pyright: ignore[reportMissingImports]
from polyfold_interchange.environment import register

register()


@EnvConfig.register_subclass("polyfold")
@dataclass
class PolyFoldEnv(EnvConfig):
    """Which task, and the garments' mesh.

    Attributes:
        task: id of a task of ``polyfold70``.
        edge_length: of the mesh [m].
    """

    task: str | None = "square-triangle-top_left"
    fps: int = 1
    edge_length: float = 0.018
    render_mode: str = "rgb_array"
    features: dict[str, PolicyFeature] = field(
        default_factory=lambda: {
            ACTION: PolicyFeature(type=FeatureType.ACTION, shape=(8,)),
            "agent_pos": PolicyFeature(type=FeatureType.STATE, shape=(4,)),
            "pixels": PolicyFeature(type=FeatureType.VISUAL, shape=(400, 400, 3)),
        }
    )
    features_map: dict[str, str] = field(
        default_factory=lambda: {ACTION: ACTION, "agent_pos": OBS_STATE, "pixels": OBS_IMAGE}
    )

    @property
    def package_name(self) -> str:
        """What is imported where the environment is not known yet."""
        return "lerobot_env_polyfold"

    @property
    def gym_id(self) -> str:
        """Its name in Gymnasium."""
        return f"polyfold/{self.task}"

    @property
    def gym_kwargs(self) -> dict:
        """What it is made with."""
        return {"edge_length": self.edge_length, "render_mode": self.render_mode}
