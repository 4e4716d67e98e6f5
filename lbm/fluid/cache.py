"""Compilation of kernels, and their cache on disk.

Numba's own cache looks at the one file in which a kernel stands, so a kernel would outlive a change in the
collision it inlines. Here the key is a hash of all sources of the package: any edit compiles anew.
The cache lies in ``$LBM_CACHE_DIR``, else under the user's cache directory (``$XDG_CACHE_HOME``).
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import warnings
from pathlib import Path

from numba import njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator

_PACKAGE = Path(__file__).parent.parent
_kernels: list = []
_trouble: set[str] = set()
# Reading a damaged pickle can end in any of these.
_UNREADABLE = (
    OSError, EOFError, pickle.UnpicklingError, ValueError, TypeError, KeyError, IndexError, AttributeError,
    ImportError, MemoryError, OverflowError,
)  # fmt: skip


@functools.cache
def source_hash() -> str:
    """SHA-256 over names and contents of the package's Python files, first 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        digest.update(str(path.relative_to(_PACKAGE)).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def directory() -> Path:
    """Where this version of the package keeps its compiled kernels."""
    if chosen := os.environ.get("LBM_CACHE_DIR"):
        root = Path(chosen)
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "lbm"
    return root / source_hash()


class _Locator(_CacheLocator):
    def __init__(self, py_func, py_file):
        self._py_file = py_file
        self._line = py_func.__code__.co_firstlineno

    @classmethod
    def from_function(cls, py_func, py_file):
        return cls(py_func, py_file)

    def get_cache_path(self):
        return str(directory())

    def get_source_stamp(self):
        return source_hash()

    def get_disambiguator(self):
        return str(self._line)


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012


class _Cache(FunctionCache):
    """Without a cache that can be used, kernels are compiled anew and kept in memory only; that is said once.

    A damaged index or kernel is thrown away, so that this run writes it anew.
    """

    _impl_class = _Implementation

    def load_overload(self, sig, target_context):
        try:
            return super().load_overload(sig, target_context)
        except PermissionError as error:
            _warn("unreadable", f"cannot be read ({error}); set LBM_CACHE_DIR to a folder that can")
        except NotADirectoryError:
            pass  # said when it is to be written
        except _UNREADABLE:
            try:
                self._cache_file.flush()
                _warn("damaged", "holds a damaged index or kernel, which is replaced now")
            except OSError as error:
                _warn("unwritable", f"is damaged and cannot be written ({error}); delete it to mend that")
        return None

    def save_overload(self, sig, data):
        try:
            super().save_overload(sig, data)
        except OSError as error:
            _warn(
                "unwritable",
                f"cannot be written ({error or type(error).__name__}); set LBM_CACHE_DIR to a folder that can",
            )


class CacheWarning(UserWarning):
    """Compiled kernels are not kept on disk, or those there are of no use: every process compiles them again."""


def _warn(kind: str, what: str) -> None:
    if kind not in _trouble:
        _trouble.add(kind)
        text = f"kernel cache {directory()} {what}; kernels are compiled anew"
        warnings.warn(text, CacheWarning, stacklevel=2)


def kernel(function=None, *, parallel=True):
    """Compile ``function`` on first call and keep the result on disk.

    ``error_model="numpy"``: a division by zero gives inf and no branch, which would stop vectorisation.
    ``contract`` allows fused multiply-add and assumes nothing about NaN or infinity.
    """
    if function is None:
        return functools.partial(kernel, parallel=parallel)
    compiled = njit(function, parallel=parallel, nogil=True, error_model="numpy", fastmath={"contract"})
    compiled._cache = _Cache(function)
    _kernels.append(compiled)
    return compiled


inlined = njit(forceinline=True, error_model="numpy", fastmath={"contract"})
"""A function that kernels contain: compiled as they are, whichever of them is compiled first."""


def compiled_count() -> int:
    """Kernel specialisations compiled in this process, as opposed to read from the cache."""
    return sum(sum(k.stats.cache_misses.values()) for k in _kernels)


def is_empty() -> bool:
    """Whether this version of the package has not compiled its sweeps on this machine yet."""
    return not any(directory().glob("kernels.sweep*.nbc"))


def keeps() -> bool:
    """Whether later processes will find what this one has compiled, as far as is known."""
    return not _trouble & {"unreadable", "unwritable"}
