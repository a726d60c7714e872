"""The ``polyfold`` agent: segmenter, grounding, planner and policy in a row, with recovery."""
