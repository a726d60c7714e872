"""The plugins that come with PolyFold are held to what others' are, by the same two lines."""

from polyfold.testing import conformance

test_agent = conformance("agent")
test_baselines = conformance("baselines")
test_fgpnp = conformance("fgpnp")
test_grounding = conformance("grounding")
test_llms = conformance("llms")
test_offline = conformance("offline")
test_planning = conformance("planning")
test_pybullet = conformance(
    "pybullet",
    expected_failures={
        "simulator pybullet: a state can be returned to, and folded on from, to the same end": (
            "its camera's noise goes on, as a real one's would: heights differ by less than a millimetre"
        )
    },
)
test_standard = conformance("standard")
test_xpbd = conformance("xpbd")
