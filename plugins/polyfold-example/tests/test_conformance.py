"""What PolyFold asks of every policy, one test a check."""

from polyfold.testing import conformance

test_conformance = conformance("polyfold-example")
