"""Movies in files: pictures go to ffmpeg one by one; the file has its name once it is whole."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, reason_of
from torsade.places import private
from torsade.view._extra import require

__all__ = ["ENDINGS", "encoder"]

Pixels = NDArray[np.uint8]

ENDINGS = (".mp4", ".gif")

HD = ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]
"""How colours are to be read: players guess otherwise, and these colours are measurements."""

FORMATS = {
    ".mp4": (
        "libx264",
        "yuv420p",
        ["-vf", "scale=out_color_matrix=bt709:out_range=tv", *HD, "-crf", "18", "-movflags", "+faststart"],
        "mp4",
    ),
    ".gif": (
        "gif",
        "pal8",
        ["-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=bayer:bayer_scale=4"],
        "gif",
    ),
}
"""Codec, kind of pixels, further options and container of ffmpeg, by the ending of a file's name."""


@contextmanager
def encoder(path: Path, size: tuple[int, int], fps: float) -> Iterator[Callable[[Pixels], None]]:
    """A function that takes one picture (height, width, 3) after the other, 0 to 255, for a movie.

    What is written has a name of its own until the movie is whole, and is removed if that does not happen.

    Parameters
    ----------
    path : the file, .mp4 (H.264) or .gif
    size : width and height [pixels], multiples of 16
    fps : pictures a second

    Raises
    ------
    TorsadeError
        When the file cannot be written, or imageio-ffmpeg is not there.
    """
    codec, pixels, options, container = FORMATS[path.suffix.lower()]
    ffmpeg = require("imageio_ffmpeg")
    part = private(path, "part")
    try:
        with part.open("wb"):
            pass
        stream = ffmpeg.write_frames(
            str(part), size, fps=fps, codec=codec, pix_fmt_out=pixels, quality=None,
            output_params=[*options, "-f", container], ffmpeg_log_level="error",
        )  # fmt: skip
        written = 0

        def add(picture: Pixels) -> None:
            nonlocal written
            stream.send(np.ascontiguousarray(picture))
            written += 1

        try:
            stream.send(None)
            yield add
        finally:
            stream.close()
        _check(part, path, written)
        part.replace(path)
    except OSError as error:
        reason = "ffmpeg stopped" if error.errno is None else reason_of(error)
        raise TorsadeError(
            f"the movie cannot be written to {str(path)!r} ({reason}); give a path in a folder with room "
            "that can be written"
        ) from error
    finally:
        part.unlink(missing_ok=True)


def _check(part: Path, path: Path, written: int) -> None:
    """Refuse a file that does not hold as many pictures as were given: ffmpeg may have found no room."""
    try:
        found, _ = require("imageio_ffmpeg").count_frames_and_secs(str(part))
    except RuntimeError:
        found = 0
    if found != written:
        raise TorsadeError(
            f"the movie cannot be written to {str(path)!r}: {found} of {written} pictures are in it; make "
            "room, or give another place"
        )
