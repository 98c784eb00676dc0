"""Fuzzing: changed copies of good inputs through every door of the harness; a door opens or says one message."""
