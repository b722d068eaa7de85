"""Prison escape (thesis 4.6): one end of a two-strand bend is clamped and one is pulled."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from torsade.errors import TorsadeError, quoted
from torsade.protocols.base import Positive
from torsade.protocols.knotted import Knotted
from torsade.protocols.pulled import Experiment
from torsade.units import Force, Length

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.motion.overdamped import Measured
    from torsade.results import Result

__all__ = ["PrisonEscape"]

Direction = Literal["x", "-x", "y", "-y", "z", "-z", "line"]

_AXES = {"x": 0, "y": 1, "z": 2}
_ENDS = re.compile(r"([AB])([01])([AB])([01])")


class PrisonEscape(Knotted):
    """Pull a bend by one end while another is clamped, and see how fast it gives way.

    Strand 0 of a centerline file is A, strand 1 is B; end 0 of a strand is its first node, end 1 its
    last. Either `knot`, a built-in bend, or `centerline`, a file, says what is pulled.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Knotted.hints,
        "bend": "there is no field 'bend'; did you mean 'knot'?",
        "name": "there is no field 'name'; did you mean 'knot'?",
        "length": "there is no field 'length'; a built-in knot takes 'lead', a centerline has its own",
    }

    protocol: Literal["prison-escape"] = "prison-escape"
    knot: str | None = Field(
        None,
        description="Bend (reef, thief, granny, carrick, zeppelin ...), suture (5,-3), or a code.",
    )
    centerline: str | None = Field(
        None, description="File of two strands (.csv, .xyz, .obj, .vect, .npz or .npy), in place of a knot."
    )
    pulled: str | None = Field(
        None,
        description='Clamped end, then pulled end, such as "A1B1"; by default the knot\'s own, or "A0B0" '
        "for a centerline.",
    )
    lead: Annotated[Length, Positive] | None = Field(
        None,
        description="Length of fiber from a built-in knot to its clamped and to its pulled end; by default "
        "16 radii.",
        examples=["5 mm"],
    )
    tail: Annotated[Length, Positive] | None = Field(
        None,
        description="Length of the free ends of a built-in knot, by default 25 radii: when they are used "
        "up a bend slips.",
        examples=["8 mm"],
    )
    force: Annotated[Force, Positive] = Field(15.0, description="Force on the pulled end.")
    direction: Direction = Field(
        "x", description="Direction of the pull: x, -x, y, -y, z, -z, or line (away from the clamped end)."
    )

    @field_validator("knot")
    @classmethod
    def _known_knot(cls, name: str | None) -> str | None:
        if name is None:
            return None
        from torsade.knots.finding import known_bend

        return known_bend(name).name

    @field_validator("pulled")
    @classmethod
    def _two_ends(cls, text: str | None) -> str | None:
        if text is None:
            return None
        ends = _ENDS.fullmatch(text.strip().upper())
        if ends is None or ends[1] == ends[3]:
            raise TorsadeError(
                f"pulled ends {quoted(text)} are not one end of each strand; give the clamped end, then the "
                'pulled end, such as "A1B1" or "A0B0"'
            )
        return ends[0]

    @model_validator(mode="after")
    def _knot_or_centerline(self) -> PrisonEscape:
        self.check_shape('give a knot such as "reef", or a centerline, a file of two strands')
        for name in ("lead", "tail"):
            if self.knot is None and getattr(self, name) is not None:
                raise TorsadeError(
                    f"a centerline has the {name}s that it has; leave {name} out, or give a knot"
                )
        self.check_strain(self.force)
        return self

    def configuration(self) -> Centerline:
        """Two open strands, checked, at the resolution of the run."""
        from torsade.protocols.shapes import check_built, open_strands

        if self.knot is None:
            return open_strands(str(self.centerline), self, 2, "prison-escape pulls two strands")
        from torsade.knots.tied import bend

        # The bend does not care which of its two ends is the clamped one.
        pulled = None if self.pulled is None else "".join(sorted((self.pulled[:2], self.pulled[2:])))
        return check_built(bend(self.knot, self.h, self.lead, self.node_spacing, pulled, self.tail), self.h)

    def grips(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """(strand, end) of the clamped and of the pulled end."""
        text = self.pulled
        if text is None:
            if self.knot is None:
                text = "A0B0"
            else:
                from torsade.knots.finding import known_bend

                text = str(known_bend(self.knot).pulled or "A1B1")
        a, i, b, j = ("AB".index(c) if c in "AB" else int(c) for c in text)
        return (a, i), (b, j)

    def experiment(self, assembly: Assembly, state: State) -> Experiment:
        """One end clamped, one pulled by a constant force; their distance along the pull measured."""
        from torsade import observables, reptation
        from torsade.motion import ends
        from torsade.protocols.slack import take_up_slack

        clamped, pulled = self.grips()
        first, last = ends.end_node(assembly, *clamped), ends.end_node(assembly, *pulled)
        axis = self._axis(state.x[last] - state.x[first])
        boundary = ends.clamp(ends.free(assembly), assembly, *clamped)
        boundary = ends.pull(boundary, assembly, *pulled, self.force * axis)

        def measure(now: State) -> dict[str, float]:
            return {"separation": float(axis @ (now.x[last] - now.x[first]))}

        def observe(now: State, measured: Measured) -> dict[str, float]:
            found = reptation.fit_state(assembly, now, measured.self_torque, (clamped[1], pulled[1]))
            return {"rotation_rate": 0.0 if found is None else float(found.rotation @ axis)}

        def derive(history: Mapping[str, Floats]) -> dict[str, Floats]:
            time = history["time"]
            return {
                "pull_speed": observables.pull_speed(time, history["separation"]),
                "rotation": observables.integral(time, history["rotation_rate"]),
            }

        def conclude(history: Mapping[str, Floats], loose_at: float | None) -> dict[str, float]:
            found = observables.friction(
                history["time"],
                history["separation"],
                force=self.force,
                radius=self.h,
                eta=self.fiber_material.eta,
                loose_at=loose_at,
            )
            numbers = {
                "c_f": found.c_f,
                "c_f_from_s": found.start,
                "pull_speed_m_per_s": found.speed,
                "slipped_at_s": found.slipped_at,
            }
            return {k: v for k, v in numbers.items() if v is not None and math.isfinite(v)}

        def catch(now: State) -> bool:
            # At first any slack is taken up; once the strands have touched, a gap wider than the fiber
            # is an escape.
            reach = 2 * self.h if now.v.any() else math.inf
            return take_up_slack(assembly, now.x, pulled[0], axis, 2 * self.h, reach)

        if not catch(state.copy()):
            raise TorsadeError(
                f"strand {'AB'[pulled[0]]} pulled along {self.direction} never meets strand "
                f"{'AB'[clamped[0]]}; give two strands that are hooked, or other ends in pulled"
            )
        about = {"pulled": "".join(f"{'AB'[s]}{e}" for s, e in (clamped, pulled))}
        sampled, observed = ("separation",), ("rotation_rate",)
        return Experiment(boundary, measure, derive, conclude, catch, sampled, about, observe, observed)

    def _axis(self, apart: Floats) -> Floats:
        """Unit vector of the pull, which must lead away from the clamped end, `apart` [m] before it."""
        import numpy as np

        if self.direction == "line":
            return np.asarray(apart / np.linalg.norm(apart))
        axis = np.zeros(3)
        axis[_AXES[self.direction[-1]]] = -1.0 if self.direction[0] == "-" else 1.0
        if not axis @ apart > 0:
            clamped, pulled = (f"{'AB'[s]}{e}" for s, e in self.grips())
            k = int(np.argmax(np.abs(apart)))
            better = ("-" if apart[k] < 0 else "") + "xyz"[k]
            raise TorsadeError(
                f"a pull along {self.direction} drives the pulled end {pulled} towards the clamped end "
                f"{clamped}; give direction {better!r} or 'line', or other ends in pulled"
            )
        return axis

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`; twist_rad is [strand][time].

        rotation_rad is by how much the knot has turned about the pull, counterclockwise as seen from where it
        is pulled to.
        """
        data, attrs = result.dataset, result.dataset.attrs
        return {
            "protocol": "prison-escape",
            "knot": attrs["knot"],
            "pulled": attrs["pulled"],
            "preset": result.spec["preset"],
            "c_f": attrs.get("c_f"),
            "c_f_from_s": attrs.get("c_f_from_s"),
            "pull_speed_m_per_s": attrs.get("pull_speed_m_per_s"),
            "slipped_at_s": attrs.get("slipped_at_s"),
            "times_s": data["time"].values.tolist(),
            "separation_m": data["separation"].values.tolist(),
            "compression_N": data["compression"].values.tolist(),
            "twist_rad": data["twist"].values.T.tolist(),
            "rotation_rad": data["rotation"].values.tolist(),
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }
