"""Datasets of targets on several processes and machines, by Ray Data: ``pip install 'kinopt[ray]'``.

``solve`` maps a dataset of targets to one of solutions. ``solve_files`` maps a folder of Parquet files to another one
and can be interrupted and continued. ``retarget_files`` retargets a folder of motion captures. ``build_reach_map`` builds
a reach map in parts. Workers hold a ``SolveArm`` or a ``SolveProblem``, with an arm or a problem. ``table`` and
``numbers`` convert numpy arrays to Arrow tables and back.
"""

from importlib.util import find_spec

if find_spec("ray") is None or find_spec("pyarrow") is None:
    raise ImportError("kinopt.ray needs Ray Data: pip install 'kinopt[ray]'")

from .datasets import TableSolver, solve
from .files import solve_files, write_blocks
from .movements import retarget_files
from .reach import build_reach_map
from .solving import SolveArm, SolveProblem
from .tables import column, numbers, table

__all__ = [
    "SolveArm",
    "SolveProblem",
    "TableSolver",
    "build_reach_map",
    "column",
    "numbers",
    "retarget_files",
    "solve",
    "solve_files",
    "table",
    "write_blocks",
]
