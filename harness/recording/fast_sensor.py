"""How many neighbouring position readings an identification uses as one: more than one where the sensor is fast."""

from harness.recording.recording import Recording

# Rate that means have at the least [Hz]. A mean over 15 ms of a ball that accelerates by 2 m/s² is off by
# 2·0.015²/24 = 0.02 mm from the position in the middle, of which the smoothed path knows the greater part.
_ENOUGH = 66.0
_LEAST = 5  # neighbours: means of three save a search no time (docs/diagnosis_experiments.md)
_FEWEST = 2  # positions that have a rate


def neighbours_in_mean(recording: Recording) -> int:
    """How many neighbouring rows make one reading that is used: odd, mostly 1.

    What counts is the rate of the positions that can be used, from the first to the last of them: where the ball is to
    be predicted, only those of the first seconds are known.
    """
    known = recording.time[recording.usable]
    if len(known) < _FEWEST:
        return 1
    rate = (len(known) - 1) / float(known[-1] - known[0])
    every = 2 * ((int(rate / _ENOUGH) + 1) // 2) - 1
    return every if every >= _LEAST else 1
