"""KINMAT in Python: kinematics of planar linkages, with the library libkinmat.so.2.

   names, rows = kinmat.run(text)     the table of a deck: the names of its columns, and a row for each instant
   k = kinmat.Kinmat(text)            one set of a deck, with k.columns and k.instants
   row = k.advance(t)                 the row at the time t; a number that does not exist is NaN, see k.flagged

Rows are numpy arrays if numpy is installed, otherwise lists. The exception Rejected holds the message of the command.
The environment variable LIBKINMAT names the library, if it is neither installed nor near this file."""
import ctypes
import os

try:
    import numpy
except ImportError:
    numpy = None


def _library():
    here = os.path.dirname(os.path.abspath(__file__))
    for place in ('.', '../../lib', '../build'):
        path = os.path.join(here, place, 'libkinmat.so.2')
        if os.path.exists(path):
            return path
    return 'libkinmat.so.2'


_lib = ctypes.CDLL(os.environ.get('LIBKINMAT') or _library())
_handle, _text, _int = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int
_doubles = ctypes.POINTER(ctypes.c_double)
for _name, _result, *_arguments in (
        ('version', _text), ('read', _handle, _text, _int, ctypes.POINTER(_int)), ('message', _text, _handle),
        ('columns', _int, _handle), ('column', _text, _handle, _int), ('instants', _int, _handle, _doubles, _int),
        ('advance', _int, _handle, ctypes.c_double, _doubles), ('free', None, _handle)):
    _function = getattr(_lib, 'kinmat_' + _name)
    _function.restype, _function.argtypes = _result, _arguments

_rejected, _system = 1, 3


class Rejected(ValueError):
    """The deck has a fault, or a time is less than the previous time."""


class Kinmat:
    """One set of a deck with its place in the motion."""

    def __init__(self, text, set=1):
        """Reads set number `set` (from 1) of the deck `text`. Raises Rejected."""
        self._k = None
        if isinstance(text, str):
            text = text.encode('utf-8', 'replace')
        status = _int()
        # A text of C ends at a null. Another character that no card may have takes its place, and is rejected.
        self._k = _lib.kinmat_read(text.replace(b'\0', b'\1'), set, ctypes.byref(status))
        if status.value == _system:
            raise MemoryError(_lib.kinmat_message(self._k).decode())
        if status.value == _rejected:
            raise Rejected(_lib.kinmat_message(self._k).decode('utf-8', 'replace'))
        count = _lib.kinmat_columns(self._k)
        self.columns = [_lib.kinmat_column(self._k, i).decode() for i in range(count)]
        times = (ctypes.c_double*_lib.kinmat_instants(self._k, None, 0))()
        _lib.kinmat_instants(self._k, times, len(times))
        self.instants = list(times)
        self.flagged = False
        self._row = (ctypes.c_double*count)()
        self._view = numpy.frombuffer(self._row) if numpy else self._row

    def advance(self, t):
        """Gives the row at the time `t`, by continuity from the previous call. Raises Rejected if `t` is less."""
        status = _lib.kinmat_advance(self._k, t, self._row)
        if status == _rejected:
            raise Rejected('TIME %r IS NOT FINITE, OR BEFORE THE PREVIOUS TIME' % t)
        if status == _system:
            raise MemoryError('NOT ENOUGH MEMORY')
        self.flagged = status != 0
        return self._view.copy() if numpy else list(self._row)

    def __del__(self):
        if self._k:
            _lib.kinmat_free(self._k)


def run(text, set=1):
    """Gives the names of the columns, and the rows of all instants of the deck. Raises Rejected."""
    k = Kinmat(text, set)
    rows = [k.advance(t) for t in k.instants]
    return k.columns, numpy.array(rows) if numpy else rows


def version():
    """Gives the name and the version of the library."""
    return _lib.kinmat_version().decode()
