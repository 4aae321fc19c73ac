"""Draw every picture of the README and of the documentation: ``python docs/make_images.py``.

Each is what the example of the same name draws, so the pictures show what the code does.
"""

from __future__ import annotations

import os
import runpy
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
from PIL import Image

IMAGES = Path(__file__).parent / "images"
EXAMPLES = Path(__file__).parents[1] / "examples"


def main() -> None:
    """Run each example in a folder of its own and keep the picture it draws."""
    matplotlib.use("Agg")
    home = Path.cwd()
    for example in sorted(EXAMPLES.glob("*.py")):
        with TemporaryDirectory() as folder:
            os.chdir(folder)
            runpy.run_path(str(example), run_name="__main__")
            os.chdir(home)
            picture = f"{example.stem}.png"
            with Image.open(Path(folder) / picture) as image:
                # A palette keeps the repository small.
                image.convert("RGB").quantize(256).save(IMAGES / picture, optimize=True)


if __name__ == "__main__":
    main()
