"""The posed problem without a hidden effect, shared with the tests of identification."""

from tests.posed import plain

__all__ = ["plain"]
