"""The few demonstrations that tests learn from."""

from polyfold_baselines.demos.demonstrating import DemoPlan

PLAN = DemoPlan(
    tasks=("square-corner-bottom_left", "square-triangle-top_left-then-top_right", "rectangle-middle-left"),
    seeds=(1000, 1002),
    edge_length=0.022,
)
