"""torsade side by side with other programs."""
