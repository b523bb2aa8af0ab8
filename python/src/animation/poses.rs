//! Lists of poses of one armature.

use std::sync::Arc;

use kinopt::animation::Pose as Locals;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose, Poses, poses_of};
use super::pose_parts::{Parts, frozen, rotations};
use crate::arrays::{self, Picked};
use crate::error::{OrRaise, invalid};
use crate::items::Items;
use crate::pickling;
use crate::transforms::{Order, flat, quaternion_argument, shaped};

impl Poses {
    fn array<'py>(
        &self,
        py: Python<'py>,
        numbers: impl Fn(&Locals) -> Vec<f32> + Sync,
        shape: &[usize],
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let all: Vec<f32> = py.detach(|| self.list.iter().flat_map(&numbers).collect());
        frozen(shaped(py, all, &[&[self.list.len()], shape].concat())?)
    }
}

#[pymethods]
impl Poses {
    #[new]
    #[pyo3(signature = (
        armature, poses = None, *, translations = None, rotations_xyzw = None, rotations_wxyz = None,
        scales = None, morph_weights = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        armature: &Bound<'_, Armature>,
        poses: Option<&Bound<'_, PyAny>>,
        translations: Option<&Bound<'_, PyAny>>,
        rotations_xyzw: Option<&Bound<'_, PyAny>>,
        rotations_wxyz: Option<&Bound<'_, PyAny>>,
        scales: Option<&Bound<'_, PyAny>>,
        morph_weights: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let rotations = quaternion_argument(rotations_xyzw, rotations_wxyz, "rotations")?;
        let stacks = [
            translations,
            rotations.map(|(q, _)| q),
            scales,
            morph_weights,
        ];
        if let Some(poses) = poses {
            if stacks.iter().any(Option::is_some) {
                return Err(invalid("poses are given as a list and as arrays"));
            }
            let (list, _) = poses_of(poses)?;
            for pose in &list {
                armature.rest().clone().cross_fade(pose, 0.0).or_raise()?;
            }
            return Ok(Self::of(armature, list));
        }
        let mut lengths = stacks.iter().flatten().map(|stack| stack.len());
        let count = lengths.next().transpose()?.unwrap_or(0);
        for length in lengths {
            if length? != count {
                return Err(invalid("the arrays are of different numbers of poses"));
            }
        }
        let mut list = Vec::with_capacity(count);
        for i in 0..count {
            let rows = (
                item(translations, i)?,
                item(scales, i)?,
                item(morph_weights, i)?,
            );
            let turned = match rotations {
                Some((q, order)) => Some((q.get_item(i)?, order)),
                None => None,
            };
            let parts = Parts {
                translations: rows.0.as_ref(),
                rotations: turned.as_ref().map(|(q, order)| (q, *order)),
                scales: rows.1.as_ref(),
                morph_weights: rows.2.as_ref(),
            };
            list.push(parts.pose(armature)?);
        }
        Ok(Self::of(armature, list))
    }

    /// Armature of the poses.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Local translations of the bones, shape (N, bones, 3), float32.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| flat(locals.translations()).collect();
        self.array(py, numbers, &[self.armature.bones(), 3])
    }

    /// Local rotations of the bones, shape (N, bones, 4), float32: x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Xyzw), &[self.armature.bones(), 4])
    }

    /// Local rotations of the bones, shape (N, bones, 4), float32: w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Wxyz), &[self.armature.bones(), 4])
    }

    /// Local scales of the bones along their own axes, shape (N, bones, 3), float32.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| flat(locals.scales()).collect();
        self.array(py, numbers, &[self.armature.bones(), 3])
    }

    /// Weights of the morph targets, shape (N, targets), float32.
    #[getter]
    fn morph_weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| locals.morph_weights().to_vec();
        self.array(py, numbers, &[self.armature.morph_targets().len()])
    }

    fn __iter__(slf: &Bound<'_, Self>) -> PyResult<Items> {
        Items::of(slf)
    }

    fn __len__(&self) -> usize {
        self.list.len()
    }

    fn __getitem__<'py>(&self, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = index.py();
        match arrays::pick(index, self.list.len())? {
            Picked::One(i) => {
                let pose = Pose::of(&self.armature, self.list[i].clone());
                Ok(Bound::new(py, pose)?.into_any())
            }
            Picked::Some(indices) => {
                let picked = indices.iter().map(|&i| self.list[i].clone());
                let picked = Self::of(&self.armature, picked.collect());
                Ok(Bound::new(py, picked)?.into_any())
            }
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&*self.list).or_raise()?;
        pickling::by_rebuild::<Self>(py, (self.armature(), text))
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let list: Vec<Locals> = serde_json::from_str(text).or_raise()?;
        for pose in &list {
            armature.rest().clone().cross_fade(pose, 0.0).or_raise()?;
        }
        Ok(Self::of(armature, list))
    }

    fn __repr__(&self) -> String {
        format!(
            "Poses({} of {} bones)",
            self.list.len(),
            self.armature.bones()
        )
    }
}

/// Item of a stacked array.
fn item<'py>(stack: Option<&Bound<'py, PyAny>>, i: usize) -> PyResult<Option<Bound<'py, PyAny>>> {
    stack.map(|stack| stack.get_item(i)).transpose()
}
