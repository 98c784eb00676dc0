import pytest

from harness.viewing.player import SEEK, Player, keys_told


def test_time_goes_on_by_the_speed_and_stops_at_the_end() -> None:
    """Show two recorded seconds a second, and stand still at the end."""
    player = Player(1.0, 4.0, speed=2.0)
    player.advance(0.5)
    assert player.time == 2.0
    player.advance(10.0)
    assert player.time == 4.0
    assert player.paused


def test_space_pauses_and_begins_anew_at_the_end() -> None:
    """Stand still while paused; start from the beginning where all was shown."""
    player = Player(0.0, 2.0)
    player.press("space")
    player.advance(1.0)
    assert player.time == 0.0
    player.press("space")
    player.advance(5.0)
    player.press("space")
    assert (player.time, player.paused) == (0.0, False)


def test_arrows_seek_within_what_is_shown() -> None:
    """Go on and back by a second, never beyond the ends."""
    player = Player(1.0, 2.5)
    player.press("right")
    assert player.time == 1.0 + SEEK
    player.press("right")
    assert player.time == 2.5
    for _ in range(3):
        player.press("left")
    assert player.time == 1.0


def test_up_and_down_change_the_speed() -> None:
    """Double the speed and halve it again."""
    player = Player(0.0, 1.0, speed=0.5)
    player.press("up")
    assert player.speed == 1.0
    player.press("down")
    assert player.speed == 0.5


def test_enter_switches_the_effects() -> None:
    """Begin with the effects, and switch between the runs."""
    player = Player(0.0, 1.0, runs=2)
    runs = [player.run]
    for _ in range(2):
        player.press("enter")
        runs.append(player.run)
    assert runs == [1, 0, 1]


@pytest.mark.parametrize(("runs", "told"), [(1, False), (2, True)])
def test_the_key_of_the_effects_is_told_where_there_are_any(runs: int, told: bool) -> None:
    """Name enter only if it does something."""
    assert ("enter" in dict(keys_told(runs))) is told


def test_other_keys_do_nothing() -> None:
    """Leave everything as it is."""
    player = Player(0.0, 1.0)
    player.press("")
    assert player == Player(0.0, 1.0)
