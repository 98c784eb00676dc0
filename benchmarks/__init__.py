"""Measurements of the product, which neither contains nor needs them."""
