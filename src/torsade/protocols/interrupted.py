"""What is said of a run that Ctrl-C or SIGTERM ended."""

from __future__ import annotations

from pathlib import Path

from torsade.errors import counted

__all__ = ["Interrupted"]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or SIGTERM during a run, after what there is was saved.

    Attributes: `time` of the last frame [s], `frames` recorded, `part`, the folder that holds them, or None;
    `earlier`, the folder of a run that was to be gone on with, which is as it was; `whole`, that of one which
    was complete when the signal was heard. `when` says what was going on before there was a frame.
    """

    def __init__(
        self,
        time: float,
        frames: int,
        part: Path | None,
        earlier: Path | None = None,
        whole: Path | None = None,
        when: str = "",
    ) -> None:
        self.time, self.frames, self.part = time, frames, part
        before = "before the first frame" if earlier is None else "before a further frame"
        reached = f"at t = {time:.4g} s" if frames else when or before
        what = f"{counted(frames, 'frame')} {'is' if frames == 1 else 'are'} saved"
        lost = "nothing is saved" if earlier is None else f"{str(earlier)!r} is as it was"
        kept = lost if part is None else f"{what} in {str(part)!r}"
        if whole is not None:
            kept = f"the result is complete in {str(whole)!r}"
        super().__init__(f"interrupted {reached}; {kept}")
