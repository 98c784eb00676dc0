"""Cross-validation of ball-and-beam models and engines against recordings."""
