"""How fast kernel, engines and commands are, each beside what else one would use, measured in pairs."""
