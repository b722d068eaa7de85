"""`python -m torsade` is `torsade`."""

from __future__ import annotations

from torsade.cli import main

if __name__ == "__main__":
    main()
