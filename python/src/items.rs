//! One item after another of what has a length and an index.

use pyo3::PyClass;
use pyo3::prelude::*;

/// Goes over the items of something in order.
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
