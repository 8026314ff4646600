"""Run the command line from a checkout: `python cli.py evaluate --task prepare`."""

from airhockey.cli import main

if __name__ == "__main__":
    main()
