"""Workers of a dask scheduler: one that runs already, or one whose workers are jobs of a queue."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from typing import Any

from torsade.errors import TorsadeError, quoted
from torsade.sweep.lanes import Shared

__all__ = ["OPTIONS", "QUEUES", "check_options", "connected"]

QUEUES = {"slurm": "SLURMCluster", "pbs": "PBSCluster"}
"""Queueing systems, and what dask-jobqueue calls them."""

OPTIONS: dict[str, type[str] | type[int]] = {
    "queue": str,
    "account": str,
    "cores": int,
    "memory": str,
    "walltime": str,
    "processes": int,
}
"""What [cluster] may say of a job; dask's own configuration, jobqueue.yaml, says the rest."""

INSTALL = 'pip install "torsade[cluster]"'
PATIENCE = "10s"


def check_options(options: Mapping[str, Any]) -> None:
    """Refuse what [cluster] may not say.

    Raises
    ------
    TorsadeError
        When an option is unknown, has a value of another kind, or could be more than one line of a script.
    """
    for name, value in options.items():
        if name not in OPTIONS:
            raise TorsadeError(
                f"[cluster] has {name!r}; it takes {', '.join(OPTIONS)}; set others in dask's jobqueue.yaml"
            )
        kind = OPTIONS[name]
        fits = (
            isinstance(value, kind) and not isinstance(value, bool) and (isinstance(value, str) or value > 0)
        )
        if not fits or (kind is str and (not value.isprintable() or not value.strip())):
            wanted = "one line of text" if kind is str else "a whole number above 0"
            raise TorsadeError(f"{name} in [cluster] is {quoted(value)}; give {wanted}")


def connected(scheduler: str, workers: int | None, options: Mapping[str, Any]) -> Shared:
    """The workers of a scheduler.

    Parameters
    ----------
    scheduler : an address such as tcp://10.0.0.1:8786, or a name in `QUEUES`
    workers : how many to ask a queue for
    options : what a job of a queue needs, by names in `OPTIONS`

    Raises
    ------
    TorsadeError
        When dask is not installed, nobody answers at the address, or the queue takes no jobs.
    """
    if scheduler not in QUEUES and "://" not in scheduler:
        raise TorsadeError(
            f"--scheduler is {quoted(scheduler)}; give an address such as tcp://127.0.0.1:8786, or "
            f"{' or '.join(QUEUES)}"
        )
    check_options(options)
    cluster = None if scheduler not in QUEUES else _queue(scheduler, workers, options)
    try:
        client = _client(cluster if cluster is not None else scheduler)
    except TorsadeError:
        if cluster is not None:
            cluster.close()
        raise

    def count() -> int:
        try:
            return len(client.nthreads())
        except OSError:  # the scheduler is away; whether it comes back, its futures will say
            return 0

    def release() -> None:
        client.close()
        if cluster is not None:
            cluster.close()

    return Shared(client.get_executor(pure=False), count, release)


def _client(where: Any) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise TorsadeError(
            f"--scheduler needs dask, which is not installed; install it with {INSTALL}"
        ) from None
    # Their tracebacks say less than the one sentence that follows.
    for name in ("distributed", "distributed.client", "tornado.application", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    make: Callable[..., Any] = Client
    try:
        return make(where, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        reason = " ".join(str(error).split()).rstrip(".")[:120] or type(error).__name__
        raise TorsadeError(
            f"no dask scheduler answers at {str(where)!r} ({reason}); start one with dask scheduler, and "
            "workers with dask worker ADDRESS --nthreads 1"
        ) from None


def _queue(name: str, workers: int | None, options: Mapping[str, Any]) -> Any:
    """A cluster whose workers are jobs."""
    try:
        import dask_jobqueue
    except ImportError:
        raise TorsadeError(
            f"--scheduler {name} needs dask-jobqueue, which is not installed; install it with {INSTALL}"
        ) from None
    make: Callable[..., Any] = getattr(dask_jobqueue, QUEUES[name])
    try:
        # Every process of a job is a worker with one thread.
        cluster = make(**{"cores": 1, "processes": options.get("cores", 1), "memory": "2GB", **options})
        cluster.scale(n=workers or 1)
    except Exception as error:  # whatever the queue's own commands say
        reason = " ".join(str(error).split()).rstrip(".")[:200] or type(error).__name__
        raise TorsadeError(
            f"{name} takes no jobs ({reason}); see that its commands work here, and set [cluster] in the "
            "TOML file"
        ) from None
    return cluster
