"""Compilation of kernels, and their cache on disk.

Numba's own cache looks at the one file in which a kernel stands, so a kernel would outlive a change in the
collision it inlines. Here the key is a hash of all sources of the package: any edit compiles anew.
The cache lies in ``$LBM_CACHE_DIR``, else under the user's cache directory (``$XDG_CACHE_HOME``), and is used
where nobody else can have written to it (:mod:`lbm.fluid.private`): reading a kernel runs it. Each kernel is kept
under a seal of its name and bytes, so that a damaged or exchanged one is noticed.
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import warnings
from pathlib import Path

from numba import njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator

from lbm.fluid import private

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


def directory() -> Path | None:
    """Where this version of the package keeps its compiled kernels; None for a user without a home directory."""
    if chosen := os.environ.get("LBM_CACHE_DIR"):
        root = Path(chosen)
    elif caches := os.environ.get("XDG_CACHE_HOME"):
        root = Path(caches) / "lbm"
    else:
        try:
            root = Path.home() / ".cache" / "lbm"
        except RuntimeError:
            return None
    return (root / source_hash()).absolute()


def own_directory() -> Path | None:
    """The directory, made if need be; None, with a warning once, where it is none of this user's alone."""
    place = directory()
    if place is None:
        _warn("unwritable", "has no place, for this user has no home directory; set LBM_CACHE_DIR to a folder")
        return None
    try:
        private.make(place)
        doubt = private.doubt(place)
    except OSError as error:
        _warn("unwritable", f"cannot be used ({error}); set LBM_CACHE_DIR to a folder that can be written")
        return None
    if doubt is not None:
        _warn("unwritable", f"is not used: {doubt}, or set LBM_CACHE_DIR to a folder of your own")
        return None
    return place


class _Locator(_CacheLocator):
    def __init__(self, py_func, py_file):
        self._py_file = py_file
        self._line = py_func.__code__.co_firstlineno

    @classmethod
    def from_function(cls, py_func, py_file):
        return cls(py_func, py_file)

    def get_cache_path(self):
        return str(directory() or os.devnull)

    def get_source_stamp(self):
        return source_hash()

    def get_disambiguator(self):
        return str(self._line)


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012


class _Files(IndexDataCacheFile):
    """Index and kernels of one function, read where they are this user's own and as they were written."""

    def _load_index(self):
        if Path(self._index_path).exists() and private.doubt(Path(self._index_path)):
            raise ValueError("an index that others can write")
        return super()._load_index()

    def _load_data(self, name):
        path = Path(self._data_path(name))
        if private.doubt(path):
            raise ValueError("a kernel that others can write")
        content = path.read_bytes()
        seal, data = content[:_SEAL_BYTES], content[_SEAL_BYTES:]
        if seal != _seal(self._index_name, data):
            raise ValueError("not what was written")
        return pickle.loads(data)

    def _save_data(self, name, data):
        content = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(_seal(self._index_name, content) + content)


_SEAL_BYTES = hashlib.sha256().digest_size


def _seal(name: str, data: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + data).digest()


class _Cache(FunctionCache):
    """Without a cache that can be used, kernels are compiled anew and kept in memory only; that is said once.

    A damaged index or kernel is thrown away, so that this run writes it anew.
    """

    _impl_class = _Implementation

    def __init__(self, py_func):
        super().__init__(py_func)
        impl = self._impl
        self._cache_file = _Files(self._cache_path, impl.filename_base, impl.locator.get_source_stamp())

    def load_overload(self, sig, target_context):
        if own_directory() is None:
            return None
        try:
            return super().load_overload(sig, target_context)
        except PermissionError as error:
            _warn("unreadable", f"cannot be read ({error}); set LBM_CACHE_DIR to a folder that can")
        except _UNREADABLE:
            try:
                with private.written_for_this_user():
                    self._cache_file.flush()
                _warn("damaged", "holds a damaged or foreign index or kernel, which is replaced now")
            except OSError as error:
                _warn("unwritable", f"is damaged and cannot be written ({error}); delete it to mend that")
        return None

    def save_overload(self, sig, data):
        if own_directory() is None:
            return
        try:
            with private.written_for_this_user():
                super().save_overload(sig, data)
        except OSError as error:
            _warn(
                "unwritable",
                f"cannot be written ({error or type(error).__name__}); set LBM_CACHE_DIR to a folder that can",
            )
        except ValueError:
            _warn("unwritable", "holds a foreign index that cannot be replaced; delete it to mend that")


class CacheWarning(UserWarning):
    """Compiled kernels are not kept on disk, or those there are of no use: every process compiles them again."""


def _warn(kind: str, what: str) -> None:
    if kind not in _trouble:
        _trouble.add(kind)
        place = "" if directory() is None else f" {directory()}"
        text = f"kernel cache{place} {what}; kernels are compiled anew"
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
    place = directory()
    return place is None or not any(place.glob("kernels.sweep*.nbc"))


def keeps() -> bool:
    """Whether later processes will find what this one has compiled, as far as is known."""
    return not _trouble & {"unreadable", "unwritable"}
