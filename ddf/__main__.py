"""`python -m ddf`: the command line."""

from ddf.cli import main

if __name__ == "__main__":
    main(prog_name="ddf")
