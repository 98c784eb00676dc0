"""`python -m harness` and the console script are the command `harness`."""

import atexit
import gc
import sys

# New objects after which Python looks for cyclic garbage, 700 by default. It then looks through all modules again and
# again while a command imports them, which took a twentieth of a short one's time; memory grows by 2 to 5 %.
_COLLECT_AFTER = 100_000


def main() -> None:
    """Run the command; an interrupt while it is being imported ends it as one later on does."""
    gc.set_threshold(_COLLECT_AFTER)
    atexit.register(gc.freeze)  # at its end Python looks through everything once more, for half a second
    try:
        from harness.cli.main import main as command

        command(prog_name="harness")
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
