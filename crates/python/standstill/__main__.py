"""``python -m standstill``: the command line."""

from standstill._cli import main

if __name__ == "__main__":
    main()
