"""The identified model taken away: source code, FMU, scenes, linear models. One file a format."""
