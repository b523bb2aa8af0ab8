//! Bones and their builder.

use kinopt::model::{Limits, UnknownName};
use kinopt::skeleton::BoneId;
use kinopt::spatial::Placement;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use super::Skeleton;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::placement;

/// A bone at rest and its joint limits.
///
/// It lies along x of its own frame, from its tail at the origin to its tip at (length, 0, 0). Its three angles are
/// rotations: the first twist about x, the bend about z, the second twist about x.
///
/// A bone: its name, its parent's name (None: a root), its length, `model_from_rest`, a 4 x 4 placement of the bone at
/// rest in the model, in the rig's unit (None: the identity), and `limits`, shape (3, 2), the lowest and highest first
/// twist, bend and second twist in radians (None: no limits).
///
/// Raises `InvalidValueError` for other shapes. The builder of the skeleton raises other errors of a bone.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Bone {
    /// Unique name within the skeleton.
    #[pyo3(get)]
    name: String,
    /// Parent bone; None for a root.
    #[pyo3(get)]
    parent: Option<String>,
    /// Length from tail to tip, in the rig's unit; zero is allowed.
    #[pyo3(get)]
    length: f64,
    model_from_rest: Placement<f64>,
    limits: [Limits; 3],
}

impl Bone {
    /// A bone of a skeleton.
    pub(super) fn of(bones: &[kinopt::skeleton::Bone], bone: &kinopt::skeleton::Bone) -> Self {
        let parent = bone.parent.and_then(|parent| bones.get(parent.index()));
        Self {
            name: bone.name.clone(),
            parent: parent.map(|parent| parent.name.clone()),
            length: bone.length,
            model_from_rest: bone.model_from_rest,
            limits: bone.limits,
        }
    }

    fn of_parent(&self, parent: Option<BoneId>) -> kinopt::skeleton::Bone {
        kinopt::skeleton::Bone {
            name: self.name.clone(),
            parent,
            length: self.length,
            model_from_rest: self.model_from_rest,
            limits: self.limits,
        }
    }
}

#[pymethods]
impl Bone {
    #[new]
    #[pyo3(signature = (name, parent = None, *, length = 0.0, model_from_rest = None, limits = None))]
    fn new(
        name: String,
        parent: Option<String>,
        length: f64,
        model_from_rest: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let model_from_rest = match model_from_rest {
            Some(value) => placement::placement(value, "model_from_rest")?,
            None => Placement::identity(),
        };
        let mut ranges = [Limits::UNBOUNDED; 3];
        if let Some(limits) = limits {
            let rows = arrays::rows(limits, "limits", 2)?;
            if rows.shape()[0] != 3 {
                return Err(invalid(format!(
                    "limits has shape ({}, 2), expected (3, 2)",
                    rows.shape()[0]
                )));
            }
            for (range, row) in ranges.iter_mut().zip(rows.chunks_exact(2)) {
                *range = Limits::new(row[0], row[1]);
            }
        }
        Ok(Self {
            name,
            parent,
            length,
            model_from_rest,
            limits: ranges,
        })
    }

    /// The bone's frame at rest in the model, shape (4, 4).
    #[getter]
    fn model_from_rest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        placement::to_array(py, &self.model_from_rest)
    }

    /// Lowest and highest first twist, bend and second twist, shape (3, 2), radians; infinite for none.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ends: Vec<f64> = self
            .limits
            .iter()
            .flat_map(|l| [l.lower, l.upper])
            .collect();
        arrays::list(py, &ends).reshape([3, 2])
    }

    /// Tail at rest in the model, shape (3,), in the rig's unit.
    #[getter]
    fn rest_tail<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.of_parent(None).rest_tail().to_array())
    }

    /// Tip at rest in the model, shape (3,), in the rig's unit.
    #[getter]
    fn rest_tip<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.of_parent(None).rest_tip().to_array())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            &self.name,
            &self.parent,
            self.length,
            self.model_from_rest(py)?,
            self.limits(py)?,
        );
        pickling::by_arguments::<Self>(py, parts, &["length", "model_from_rest", "limits"])
    }

    fn __repr__(&self) -> String {
        match &self.parent {
            Some(parent) => format!(
                "Bone({:?} on {parent:?}, length {})",
                self.name, self.length
            ),
            None => format!("Bone({:?}, length {})", self.name, self.length),
        }
    }
}

/// Collects the bones of a skeleton called `name`, parents before children.
#[pyclass(module = "kinopt")]
pub(crate) struct SkeletonBuilder {
    name: String,
    /// Bones added so far.
    #[pyo3(get)]
    bones: Vec<Bone>,
}

#[pymethods]
impl SkeletonBuilder {
    #[new]
    pub(super) fn new(name: String) -> Self {
        let bones = Vec::new();
        Self { name, bones }
    }

    /// Adds a bone; arguments are as for `Bone`. `limits` is in radians.
    ///
    /// Raises `UnknownNameError` for a parent that was not added before, `InvalidValueError` for an invalid rest
    /// placement or limits.
    #[pyo3(signature = (name, parent = None, *, length = 0.0, model_from_rest = None, limits = None))]
    fn add(
        &mut self,
        name: String,
        parent: Option<String>,
        length: f64,
        model_from_rest: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let bone = Bone::new(name, parent, length, model_from_rest, limits)?;
        self.bones.push(bone);
        Ok(())
    }

    /// Validates the bones and creates the skeleton.
    ///
    /// Raises `InvalidValueError` with the first invalid bone, `UnknownNameError` for a parent that does not precede
    /// its child.
    fn build(&self) -> PyResult<Skeleton> {
        skeleton(&self.name, &self.bones)
    }

    fn __repr__(&self) -> String {
        format!(
            "SkeletonBuilder({:?}, {} bones)",
            self.name,
            self.bones.len()
        )
    }
}

/// Builds a skeleton of bones with parents by name.
pub(super) fn skeleton(name: &str, bones: &[Bone]) -> PyResult<Skeleton> {
    let mut builder = kinopt::Skeleton::builder(name);
    let mut ids = Vec::with_capacity(bones.len());
    for (index, bone) in bones.iter().enumerate() {
        let earlier = &bones[..index];
        let parent = match &bone.parent {
            Some(parent) => {
                let parent_index = earlier.iter().position(|other| other.name == *parent);
                let names = earlier.iter().map(|other| other.name.as_str());
                let parent_index =
                    parent_index.ok_or_else(|| UnknownName::new("bone", parent, names));
                Some(ids[parent_index.or_raise()?])
            }
            None => None,
        };
        ids.push(builder.add(bone.of_parent(parent)));
    }
    builder.build().or_raise().map(Skeleton::from)
}
