"""Fuzzing of everything that reads what others wrote: `python -m fuzz TARGET --seconds 600`.

`samples` makes valid inputs with the package itself, `mutate` spoils them, `targets` says what reads them and
what may come of it, `child` goes round with coverage as a guide, `__main__` watches over it.
"""
