"""`python -m harness` and the console script are the command `harness`."""

import sys


def main() -> None:
    """Run the command; an interrupt while it is being imported ends it as one later on does."""
    try:
        from harness.cli.main import main as command

        command(prog_name="harness")
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
