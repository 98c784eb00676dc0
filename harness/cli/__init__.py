"""The command line: options, calls of the API, printed results."""
