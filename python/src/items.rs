//! Iteration over objects that have a length and an index.

use pyo3::PyClass;
use pyo3::prelude::*;

use crate::arrays;

/// Iterator over the items of an object in order.
#[pyclass(module = "kinopt")]
pub(crate) struct Items {
    owner: Py<PyAny>,
    next: usize,
    count: usize,
}

impl Items {
    pub(crate) fn of<T: PyClass>(owner: &Bound<'_, T>) -> PyResult<Self> {
        Ok(Self {
            owner: owner.clone().into_any().unbind(),
            next: 0,
            count: owner.as_any().len()?,
        })
    }
}

#[pymethods]
impl Items {
    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__<'py>(&mut self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        if self.next == self.count {
            return Ok(None);
        }
        self.next += 1;
        self.owner.bind(py).get_item(self.next - 1).map(Some)
    }
}

/// Returns the text of item `i`, or a list of all `count` texts without `i`.
pub(crate) fn explained<'py>(
    py: Python<'py>,
    i: Option<isize>,
    count: usize,
    text: impl Fn(usize) -> PyResult<String>,
) -> PyResult<Bound<'py, PyAny>> {
    if let Some(i) = i {
        let text = text(arrays::resolve_index(i, count)?)?;
        return Ok(text.into_pyobject(py)?.into_any());
    }
    let mut texts = Vec::with_capacity(count);
    for i in 0..count {
        if i.is_multiple_of(1024) {
            py.check_signals()?;
        }
        texts.push(text(i)?);
    }
    Ok(texts.into_pyobject(py)?.into_any())
}
