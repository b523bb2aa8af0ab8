//! The shapes of a robot and the links that are kept apart.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use kinopt::collision::{self, Fineness, MeshUse};
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::SphereModel;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::model::Model;
use crate::pickling;
use crate::rig::Rig;
use crate::signals::interruptible;
use crate::srdf::Srdf;
use crate::world::Obstacle;

/// Shapes on the links of a robot, and the pairs of links that must not touch. Made by `Robot.collision_model`.
///
/// At first all pairs of links with shapes are enabled, except those of one body (joined by fixed joints) and of neighbours
/// (joined by one moving joint). An `Arm` or `Problem` that is given a model takes its pairs as they
/// are; without one they leave out what nearly always touches, as `with_pairs_sampled` does: begin with that where pairs are edited.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct CollisionModel {
    pub(crate) inner: Arc<collision::CollisionModel>,
    /// Those that were given; without any they are made where they are needed.
    pub(crate) spheres: Option<Arc<collision::SphereModel>>,
    /// Made when an arm or a problem first keeps its shapes apart.
    checker: OnceLock<collision::Checker>,
}

impl From<collision::CollisionModel> for CollisionModel {
    fn from(inner: collision::CollisionModel) -> Self {
        Self::of_parts(Arc::new(inner), None)
    }
}

/// Convex pieces of a mesh at most.
const PIECES: usize = 16;

/// How a robot's shapes are taken.
pub(crate) struct Taking {
    pub(crate) packages: Vec<PathBuf>,
    pub(crate) meshes: String,
    pub(crate) leave_out_missing: bool,
}

impl CollisionModel {
    fn of_parts(
        inner: Arc<collision::CollisionModel>,
        spheres: Option<Arc<collision::SphereModel>>,
    ) -> Self {
        Self {
            inner,
            spheres,
            checker: OnceLock::new(),
        }
    }

    /// What keeps its shapes apart, in a world without obstacles; made once.
    pub(crate) fn checker(&self) -> collision::Checker {
        let made = || {
            let model = collision::CollisionModel::clone(&self.inner);
            match &self.spheres {
                Some(spheres) => collision::Checker::new(model).with_spheres((**spheres).clone()),
                None => collision::Checker::covered(model),
            }
        };
        self.checker.get_or_init(made).clone()
    }

    pub(crate) fn of(robot: &kinopt::robot::Robot, taking: &Taking) -> PyResult<Self> {
        let meshes = match taking.meshes.as_str() {
            "hull" => MeshUse::Hull,
            "parts" => MeshUse::Parts,
            "pieces" => MeshUse::Pieces(PIECES),
            "triangles" => MeshUse::Triangles,
            other => {
                return Err(invalid(format!(
                    "meshes must be \"hull\", \"parts\", \"pieces\" or \"triangles\", not {other:?}"
                )));
            }
        };
        let mut builder = collision::CollisionModel::builder(robot).with_meshes(meshes);
        for folder in &taking.packages {
            builder = builder.with_package_folder(folder);
        }
        if taking.leave_out_missing {
            builder = builder.leaving_out_missing_meshes();
        }
        Ok(builder.build().or_raise()?.into())
    }

    /// The same with other pairs of links.
    fn changed(&self, inner: collision::CollisionModel) -> Self {
        Self::of_parts(Arc::new(inner), self.spheres.clone())
    }

    fn names(&self, links: &[kinopt::model::FrameId]) -> Vec<String> {
        let frames = self.inner.model().frames();
        links
            .iter()
            .map(|link| frames[link.index()].name.clone())
            .collect()
    }
}

#[pymethods]
impl CollisionModel {
    /// Capsules along the bones of a rig, as thick as the skin that follows each of them most; a bone whose skin is wider
    /// than thick gets several side by side. Bones that touch at rest may touch. It is of the rig's `Skeleton`.
    ///
    /// Raises `InvalidValueError` for a rig without a mesh or weights.
    #[classmethod]
    fn of_skin(_class: &Bound<'_, PyType>, py: Python<'_>, rig: &Rig) -> PyResult<Self> {
        let rig = &rig.inner;
        let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
            return Err(invalid("the rig has no mesh with weights"));
        };
        let made = py.detach(|| collision::CollisionModel::of_skin(&rig.skeleton, mesh, weights));
        Ok(made.or_raise()?.into())
    }

    /// The model that it is of.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::new(self.inner.model().clone());
        Model { inner }
    }

    /// The links that have shapes, in the model's order.
    #[getter]
    fn links(&self) -> Vec<String> {
        self.names(self.inner.links())
    }

    /// The shapes of all links: obstacles attached to their links, each with a name of its own.
    #[getter]
    fn shapes(&self) -> Vec<Obstacle> {
        let frames = self.inner.model().frames();
        let shapes = self.inner.objects().iter().map(|own| {
            let (shape, place) = (own.shape.clone(), own.link_from_shape);
            let link = frames[own.link.index()].name.clone();
            Obstacle(collision::Obstacle::new(
                own.name.as_str(),
                shape,
                place,
                Some(link),
            ))
        });
        shapes.collect()
    }

    /// The pairs of links that are kept apart.
    #[getter]
    fn pairs(&self) -> Vec<(String, String)> {
        let frames = self.inner.model().frames();
        let name = |link: kinopt::model::FrameId| frames[link.index()].name.clone();
        self.inner
            .pairs()
            .iter()
            .map(|[a, b]| (name(*a), name(*b)))
            .collect()
    }

    /// What was left out or mended on the way here.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// Whether two links are kept apart.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn is_checked(&self, first: &str, second: &str) -> PyResult<bool> {
        self.inner.is_checked(first, second).or_raise()
    }

    /// The same model, but these two links may touch. A link and an obstacle are let touch by the world: `World.allow_touch`.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn with_ignored(&self, first: &str, second: &str) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_ignored(first, second).or_raise()?))
    }

    /// The same model with these two links kept apart.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn with_checked(&self, first: &str, second: &str) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_checked(first, second).or_raise()?))
    }

    /// The same model without the pairs that an SRDF file disables.
    ///
    /// Raises `InvalidValueError` for an SRDF file that was read for another robot.
    pub(crate) fn with_srdf(&self, srdf: &Srdf) -> PyResult<Self> {
        if srdf.model().name() != self.inner.model().name() {
            return Err(invalid(format!(
                "the SRDF file was read for `{}`, not for `{}`",
                srdf.model().name(),
                self.inner.model().name()
            )));
        }
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_srdf(srdf.inner())))
    }

    /// The same model without the pairs that cannot touch, and without those that touch in at least 95 % of so many random configurations. Of a pair that
    /// touches in none its distance is made less from where it came nearest; it is left out only where that leads to no touch.
    ///
    /// Raises `InvalidValueError` where the model's lengths are no numbers.
    #[pyo3(signature = (samples = 10_000, seed = 0))]
    fn with_pairs_sampled(&self, py: Python<'_>, samples: u64, seed: u64) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        let sampled = interruptible(py, || model.with_pairs_sampled(samples, seed))?;
        Ok(self.changed(sampled.or_raise()?))
    }

    /// The same model without the pairs that touch at a configuration, shape (nq,).
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn with_touching_ignored(&self, q: &Bound<'_, PyAny>) -> PyResult<Self> {
        let q = arrays::vector_of(q, "q", self.inner.model().configuration_len())?;
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_touching_ignored(&q).or_raise()?))
    }

    /// An SRDF document that disables every pair of links with shapes that is not kept apart.
    fn to_srdf(&self) -> String {
        self.inner.to_srdf()
    }

    /// Spheres that cover the shapes: as few as are found that stick out by at most `overhang` metres, or at most
    /// `per_link` a link that stick out as little as is found. One of the two is given.
    ///
    /// Raises `InvalidValueError` for numbers that are not positive, or an overhang that needs millions of cells.
    #[pyo3(signature = (overhang = None, *, per_link = None))]
    fn spheres(
        &self,
        py: Python<'_>,
        overhang: Option<f64>,
        per_link: Option<usize>,
    ) -> PyResult<SphereModel> {
        let fineness = match (overhang, per_link) {
            (Some(overhang), None) => Fineness::Overhang(overhang),
            (None, Some(count)) => Fineness::PerLink(count),
            _ => return Err(invalid("spheres takes either overhang or per_link")),
        };
        let spheres = interruptible(py, || collision::SphereModel::of(&self.inner, fineness))?;
        Ok(spheres.or_raise()?.into())
    }

    /// The same model with spheres by which its configurations are looked through, instead of those that are made anew where it is given
    /// to an `Arm` or a `Problem`. They are grown by the gaps that they leave, so that nothing is called free that is not. Raises nothing.
    fn with_spheres(&self, spheres: &SphereModel) -> Self {
        Self::of_parts(Arc::clone(&self.inner), Some(Arc::clone(&spheres.inner)))
    }

    /// Whether its checker is made, which every arm and problem of it shares: for tests.
    #[getter]
    fn _is_covered(&self) -> bool {
        self.checker.get().is_some()
    }

    /// Itself, as nothing changes it: a copy would be covered anew.
    fn __deepcopy__(model: Bound<'_, Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        model.unbind()
    }

    #[classmethod]
    fn _rebuild(_class: &Bound<'_, PyType>, json: &str) -> PyResult<Self> {
        type Parts = (collision::CollisionModel, Option<collision::SphereModel>);
        let (inner, spheres): Parts = serde_json::from_str(json).or_raise()?;
        Ok(Self::of_parts(Arc::new(inner), spheres.map(Arc::new)))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, &(&*self.inner, self.spheres.as_deref()))
    }

    fn __repr__(&self) -> String {
        format!(
            "CollisionModel({:?}, {} on {}, {})",
            self.inner.model().name(),
            kinopt::counted(self.inner.objects().len(), "shape"),
            kinopt::counted(self.inner.links().len(), "link"),
            kinopt::counted(self.inner.pairs().len(), "pair")
        )
    }
}
