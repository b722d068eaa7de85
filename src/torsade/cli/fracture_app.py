"""The commands about breaking that run nothing: `torsade trials`, `torsade material`, their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

__all__ = ["add_commands"]

TRIALS_EXAMPLES = """Examples:

torsade trials trials.csv

torsade trials trials.csv --length "20 cm" --radius "0.85 mm" --strength "18 MPa"

torsade trials trials.csv --slow "20 mm/s" --json"""

MATERIAL_EXAMPLES = """Examples:

torsade material --radius "0.7 mm" --radius-error "0.025 mm" --buckling masses.csv

torsade material --radius "0.7 mm" --weights masses.csv --pendulum swing.csv --inertia "2 kg mm^2" --json"""

_JSON = "Print JSON, and nothing else, on the standard output."


def add_commands(app: App) -> None:
    """Add both."""
    app.command(_trials, name="trials", help_epilogue=TRIALS_EXAMPLES, version_flags=[])
    app.command(_material, name="material", help_epilogue=MATERIAL_EXAMPLES, version_flags=[])


def _trials(
    file: Annotated[
        str,
        Parameter(
            name="FILE",
            help="CSV with a line for each broken rod and units in the headings: lengths_mm (all pieces, "
            "with blanks between them) or pieces, twist_deg, end_distance_mm or limit_curvature_per_m, "
            "speed_mm_per_s.",
        ),
    ],
    /,
    *,
    length: Annotated[str, Parameter(help="Length of the rods [default: 24 cm].")] = "24 cm",
    radius: Annotated[str, Parameter(help="Their radius [default: 0.7 mm].")] = "0.7 mm",
    material: Annotated[str, Parameter(help="What they are made of [default: spaghetti].")] = "spaghetti",
    strength: Annotated[
        str, Parameter(help="Effective stress at which they break [default: 19 MPa].")
    ] = "19 MPa",
    criterion: Annotated[
        str,
        Parameter(
            help="Stress criterion: effective, von_mises, von_mises_printed, max_principal or "
            "max_principal_printed [default: effective]."
        ),
    ] = "effective",
    amplification: Annotated[
        str | None,
        Parameter(help="By how much bending waves raise the curvature [default: 1.428, linear theory]."),
    ] = None,
    sectors: Annotated[
        str, Parameter(help="Sectors of the plane of twist and curvature [default: 10].")
    ] = "10",
    rays: Annotated[
        str,
        Parameter(
            help="Between them: ellipse (equal angles) or printed (as in the thesis) [default: ellipse]."
        ),
    ] = "ellipse",
    slow: Annotated[
        str | None,
        Parameter(help='Fit the power law of breaks up to this speed, such as "20 mm/s" [default: all].'),
    ] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """Say what trials of breaking rods say together: pieces, smallest fragment, sectors, fits.

    Numbers per speed, and fits, are of rods without twist.
    """
    from torsade.cli.trials import trials

    return trials(
        file, length, radius, material, strength, criterion, amplification, sectors, rays, slow, json
    )


def _material(
    *,
    radius: Annotated[str, Parameter(help='Radius of all samples, such as "0.7 mm".')],
    radius_error: Annotated[str | None, Parameter(help="Its standard error [default: none].")] = None,
    buckling: Annotated[
        str | None,
        Parameter(help="CSV with mass_g, shown when an upright sample buckles, and length_mm: gives E."),
    ] = None,
    weights: Annotated[
        str | None, Parameter(help="CSV with mass_g and length_mm of samples: gives the density.")
    ] = None,
    pendulum: Annotated[
        str | None,
        Parameter(
            help="CSV with time_s, angle_deg and length_mm of the rod, and sample where there are several: "
            "gives mu, and with the density b."
        ),
    ] = None,
    inertia: Annotated[
        str | None, Parameter(help='Moment of inertia of the pendulum\'s mass, such as "2 kg mm^2".')
    ] = None,
    inertia_error: Annotated[str | None, Parameter(help="Its standard error [default: none].")] = None,
    mass_height: Annotated[
        str | None, Parameter(help="Height of the mass: gives b as the thesis has it, too.")
    ] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """Work out a rod's material from measurements: E, density, mu, twist damping b and Poisson's ratio.

    Errors are standard errors, of the scatter of samples and of the radius together.
    """
    from torsade.cli.material import material

    return material(
        radius, radius_error, buckling, weights, pendulum, inertia, inertia_error, mass_height, json
    )
