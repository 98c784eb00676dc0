"""What scripts, notebooks and the commands call: read, compare, diagnose, predict, replay, each with what it writes.

Nothing here prints, reads the command line, or starts a process unless asked to. These modules import quickly; what
takes seconds to import is imported where it is used, so that an answer to a bad input does not wait for it.
"""
