"""``python -m csgmesh``."""

from csgmesh.cli import main

if __name__ == "__main__":
    main()
