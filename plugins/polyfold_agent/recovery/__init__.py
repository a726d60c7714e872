"""Did a fold take effect? The picture after it is compared with the one before it, folded along the line.

Nothing here knows the garment: what is expected comes from the depth image before the fold, mirrored across the line,
so any grounding will do. The paper's method has no recovery; thresholds were set on the benchmark's tasks with seeds
2000 and 2001, where each arm in turn was made to miss.

:mod:`~polyfold_agent.recovery.inspection` says what went wrong; it asks :mod:`~polyfold_agent.recovery.displacement`
how the whole garment was moved, :mod:`~polyfold_agent.recovery.expectation` what the picture should look like, and
:mod:`~polyfold_agent.recovery.bringing_over` how to bring over what one of two arms left behind.
"""

from polyfold_agent.recovery.attempt import Attempt, Motion
from polyfold_agent.recovery.inspection import Finding, inspect

__all__ = ["Attempt", "Finding", "Motion", "inspect"]
