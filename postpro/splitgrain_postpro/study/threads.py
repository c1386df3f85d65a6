"""Threads that call the program, and the wait for them, which signals end."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager

from .program import Program

#: A signal that another thread gets does not end a wait: Python looks for it when the wait is over [s]
LOOK_EVERY = 1


@contextmanager
def threads_of(program: Program, workers: int) -> Iterator[ThreadPoolExecutor]:
    """Threads that call the program; INT and TERM end them all, as `KeyboardInterrupt`."""
    pool = ThreadPoolExecutor(workers)
    try:
        with program.ended_by_signals():
            yield pool
        if program.is_stopped:
            raise InterruptedError
    except InterruptedError:
        raise KeyboardInterrupt from None
    except BaseException:
        program.stop()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def as_they_end(futures: Iterable[Future]) -> Iterator[Future]:
    """Futures, each when it has ended."""
    left = set(futures)
    while left:
        done, left = wait(left, timeout=LOOK_EVERY, return_when=FIRST_COMPLETED)
        yield from done


def do_all(pool: Executor, function: Callable, items: Iterable) -> None:
    """Call a function for each of some things, and wait for the end of all; the first error is raised."""
    for future in as_they_end([pool.submit(function, item) for item in items]):
        future.result()
