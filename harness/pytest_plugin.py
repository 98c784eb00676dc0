"""Tolerance checks of a case, as pytest items."""
