//! Collision shapes of a robot and its enabled collision pairs.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use kinopt::collision::{self, MeshUse, Resolution};
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

/// Collision shapes on the links of a robot, and the enabled collision pairs. Created by `Robot.collision_model`.
///
/// Initially all pairs of links with shapes are enabled, except those of one body (joined by fixed joints) and of
/// neighbours (joined by one moving joint). An `Arm` or `Problem` uses the pairs of a given model. Without a model, it
/// applies `with_pairs_sampled`, which omits pairs that are nearly always in contact. Call `with_pairs_sampled` first
/// before editing pairs.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct CollisionModel {
    pub(crate) inner: Arc<collision::CollisionModel>,
    /// Given spheres; `None` computes them on demand.
    pub(crate) spheres: Option<Arc<collision::SphereModel>>,
    /// Created when an arm or problem first avoids collisions.
    checker: OnceLock<collision::Checker>,
}

impl From<collision::CollisionModel> for CollisionModel {
    fn from(inner: collision::CollisionModel) -> Self {
        Self::of_parts(Arc::new(inner), None)
    }
}

/// Largest number of convex pieces of a mesh.
const MAX_PIECES: usize = 16;

/// Options for the collision shapes of a robot.
pub(crate) struct CollisionOptions {
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

    /// Returns the collision checker in a world without obstacles; created once.
    pub(crate) fn checker(&self) -> collision::Checker {
        let create = || {
            let model = collision::CollisionModel::clone(&self.inner);
            match &self.spheres {
                Some(spheres) => collision::Checker::new(model).with_spheres((**spheres).clone()),
                None => collision::Checker::covered(model),
            }
        };
        self.checker.get_or_init(create).clone()
    }

    pub(crate) fn of(robot: &kinopt::robot::Robot, options: &CollisionOptions) -> PyResult<Self> {
        let meshes = match options.meshes.as_str() {
            "hull" => MeshUse::Hull,
            "parts" => MeshUse::Parts,
            "pieces" => MeshUse::Pieces(MAX_PIECES),
            "triangles" => MeshUse::Triangles,
            other => {
                return Err(invalid(format!(
                    "meshes must be \"hull\", \"parts\", \"pieces\" or \"triangles\", not {other:?}"
                )));
            }
        };
        let mut builder = collision::CollisionModel::builder(robot).with_meshes(meshes);
        for folder in &options.packages {
            builder = builder.with_package_folder(folder);
        }
        if options.leave_out_missing {
            builder = builder.leaving_out_missing_meshes();
        }
        Ok(builder.build().or_raise()?.into())
    }

    /// Returns the model with other pairs of links.
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
    /// Capsules along the bones of a rig, with the thickness of the skin whose largest weight is the bone's. A bone
    /// with skin wider than thick gets several parallel capsules. Collisions of bones in contact at rest are allowed.
    /// The model is that of the rig's `Skeleton`.
    ///
    /// Raises `InvalidValueError` for a rig without a mesh or weights.
    #[classmethod]
    fn of_skin(_class: &Bound<'_, PyType>, py: Python<'_>, rig: &Rig) -> PyResult<Self> {
        let rig = &rig.inner;
        let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
            return Err(invalid("the rig has no mesh with weights"));
        };
        let model = py.detach(|| kinopt::motion::skin_capsules(&rig.skeleton, mesh, weights));
        Ok(model.or_raise()?.into())
    }

    /// Kinematic model.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::new(self.inner.model().clone());
        Model { inner }
    }

    /// Links with shapes, in the model's order.
    #[getter]
    fn links(&self) -> Vec<String> {
        self.names(self.inner.links())
    }

    /// Shapes of all links: obstacles attached to their links, with unique names.
    #[getter]
    fn shapes(&self) -> Vec<Obstacle> {
        let frames = self.inner.model().frames();
        let shapes = self.inner.objects().iter().map(|object| {
            let (shape, link_from_shape) = (object.shape.clone(), object.link_from_shape);
            let link = frames[object.link.index()].name.clone();
            Obstacle(collision::Obstacle::new(
                object.name.as_str(),
                shape,
                link_from_shape,
                Some(link),
            ))
        });
        shapes.collect()
    }

    /// Enabled collision pairs of links.
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

    /// Omissions and repairs, one text each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// True if the collision pair of two links is enabled.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn is_checked(&self, first: &str, second: &str) -> PyResult<bool> {
        self.inner.is_checked(first, second).or_raise()
    }

    /// The model with this collision pair disabled. `World.allow_collision` allows collisions of a link and an
    /// obstacle.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn with_ignored(&self, first: &str, second: &str) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_ignored(first, second).or_raise()?))
    }

    /// The model with this collision pair enabled.
    ///
    /// Raises `UnknownNameError` for a link without shapes.
    fn with_checked(&self, first: &str, second: &str) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_checked(first, second).or_raise()?))
    }

    /// The model without the pairs that an SRDF file disables.
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

    /// The model without the pairs that cannot be in contact, and without those in contact in at least 95 % of
    /// `samples` random configurations. For a pair without contact in all samples, a descent minimises the distance
    /// from the nearest sample. The pair is omitted only if the descent finds no contact.
    ///
    /// Raises `InvalidValueError` if the model has lengths that are not finite.
    #[pyo3(signature = (samples = 10_000, seed = 0))]
    fn with_pairs_sampled(&self, py: Python<'_>, samples: u64, seed: u64) -> PyResult<Self> {
        let model = collision::CollisionModel::clone(&self.inner);
        let sampled = interruptible(py, || model.with_pairs_sampled(samples, seed))?;
        Ok(self.changed(sampled.or_raise()?))
    }

    /// The model without the pairs in contact at a configuration, shape (nq,).
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn with_touching_ignored(&self, q: &Bound<'_, PyAny>) -> PyResult<Self> {
        let q = arrays::vector_of(q, "q", self.inner.model().configuration_len())?;
        let model = collision::CollisionModel::clone(&self.inner);
        Ok(self.changed(model.with_touching_ignored(&q).or_raise()?))
    }

    /// SRDF document that disables every pair of links with shapes that is not enabled.
    fn to_srdf(&self) -> String {
        self.inner.to_srdf()
    }

    /// Spheres that cover the shapes: the fewest found that protrude by at most `max_protrusion` metres, or at most
    /// `per_link` spheres for each link with the smallest protrusion found. Exactly one of the two is given.
    ///
    /// Raises `InvalidValueError` for numbers that are not positive, or a `max_protrusion` that needs millions of cells.
    #[pyo3(signature = (max_protrusion = None, *, per_link = None))]
    fn spheres(
        &self,
        py: Python<'_>,
        max_protrusion: Option<f64>,
        per_link: Option<usize>,
    ) -> PyResult<SphereModel> {
        let fineness = match (max_protrusion, per_link) {
            (Some(max_protrusion), None) => Resolution::MaxProtrusion(max_protrusion),
            (None, Some(count)) => Resolution::PerLink(count),
            _ => return Err(invalid("spheres takes either max_protrusion or per_link")),
        };
        let spheres = interruptible(py, || collision::SphereModel::of(&self.inner, fineness))?;
        Ok(spheres.or_raise()?.into())
    }

    /// The model with these spheres for fast collision checks, instead of spheres computed by an `Arm` or a `Problem`.
    /// They are enlarged by their gaps, so a configuration that passes is proven collision-free. Raises nothing.
    fn with_spheres(&self, spheres: &SphereModel) -> Self {
        Self::of_parts(Arc::clone(&self.inner), Some(Arc::clone(&spheres.inner)))
    }

    /// True if its checker exists, which all arms and problems of the model share: for tests.
    #[getter]
    fn _is_covered(&self) -> bool {
        self.checker.get().is_some()
    }

    /// Returns itself: the object is immutable, and a copy would compute its spheres again.
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
