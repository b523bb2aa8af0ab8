"""Arrow tables of arrays: a row of a column holds one number, or the numbers of a target or a configuration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from ..errors import InvalidValueError
from ..types import Floats


def table(**columns: ArrayLike) -> pa.Table:
    """A table of arrays of N rows: shape (N,) becomes a column of values, (N, 4, 4) one of 16 numbers for each row.

    ``table(target=targets, number=range(len(targets)))``. Rows of numbers are fixed-size lists, which Parquet preserves
    and other programs read. Raises ``InvalidValueError`` for different lengths.
    """
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    lengths = {name: len(values) if values.ndim else None for name, values in arrays.items()}
    if None in lengths.values() or len(set(lengths.values())) > 1:
        raise InvalidValueError(f"columns must have one length, not {lengths}")
    return pa.table({name: column(values) for name, values in arrays.items()})


def column(values: ArrayLike) -> pa.Array:
    """A column of an array of shape (N, ...): the other axes become the list of a row.

    Raises Arrow's ``ArrowInvalid`` for values that no column can hold.
    """
    array = np.asarray(values)
    if array.ndim == 1:
        return pa.array(array)
    width = int(np.prod(array.shape[1:]))
    return pa.FixedSizeListArray.from_arrays(pa.array(array.reshape(-1)), width)


def numbers(table: pa.Table, name: str, shape: Sequence[int] = (-1,)) -> Floats:
    """The numbers of a column as float64, shape (N, *shape), without a copy if the layout matches.

    Accepts lists of any nesting and tensors of Ray and Arrow; one length of ``shape`` may be -1. Raises
    ``InvalidValueError`` for a column that is missing, has empty entries, rows of other lengths, or no numbers.
    """
    if name not in table.column_names:
        raise InvalidValueError(f"there is no column {name!r} among {table.column_names}")
    values = table.column(name)
    values = values.chunk(0) if values.num_chunks == 1 else values.combine_chunks()
    while not _is_flat(values):
        if values.null_count:
            raise InvalidValueError(f"column {name!r} has empty entries")
        if isinstance(values, pa.ExtensionArray):
            values = values.storage
            continue
        lengths = values.value_lengths()
        if len(values) and len(lengths.unique()) > 1:
            raise InvalidValueError(f"column {name!r} has rows of different lengths")
        values = values.flatten()
    if values.null_count or not _is_number(values.type):
        problem = "empty entries" if values.null_count else f"{values.type} for numbers"
        raise InvalidValueError(f"column {name!r} has {problem}")
    array = np.asarray(values.to_numpy(zero_copy_only=False), dtype=np.float64)
    rows = table.num_rows
    try:
        # Without rows their length is unknown.
        return array.reshape(rows, *(shape if rows else np.maximum(shape, 0)))
    except ValueError:
        width = array.size // max(rows, 1)
        raise InvalidValueError(
            f"column {name!r} has {width} numbers a row, not {int(np.prod(shape))}"
        ) from None


def _is_flat(values: pa.Array) -> bool:
    kind = values.type
    nested = (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    return not (isinstance(values, pa.ExtensionArray) or any(is_kind(kind) for is_kind in nested))


def _is_number(kind: pa.DataType) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))


__all__ = ["column", "numbers", "table"]
