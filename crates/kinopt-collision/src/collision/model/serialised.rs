//! Serialised form of collision models. Deserialisation repeats all checks.

use serde::{Deserialize, Serialize};

use super::{CollisionModel, CollisionModelError, CollisionObject, LinkHalfSpace};
use crate::collision::{Shape, ShapeError, ShapeKind};
use kinopt_kinematics::model::{FrameId, FrameRef, Model, ParameterMap};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Serialised collision model.
#[derive(Serialize, Deserialize)]
pub(super) struct CollisionModelDocument {
    model: Model,
    map: ParameterMap,
    objects: Vec<ObjectParts>,
    pairs: Vec<[FrameId; 2]>,
    #[serde(default)]
    planes: Vec<PlaneParts>,
    notes: Vec<String>,
}

#[derive(Serialize, Deserialize)]
struct PlaneParts {
    link: FrameId,
    world_from_plane: Placement<f64>,
    passed: Vec<FrameId>,
}

#[derive(Serialize, Deserialize)]
struct ObjectParts {
    name: String,
    link: FrameId,
    link_from_shape: Placement<f64>,
    shape: ShapeParts,
}

/// Serialised shapes of links.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ShapeParts {
    Sphere(f64),
    Capsule(f64, f64),
    Cylinder(f64, f64),
    Box([f64; 3]),
    Convex(Vec<Vector3<f64>>),
    Mesh(Vec<Vector3<f64>>, Vec<[u32; 3]>),
    Points(Vec<Vector3<f64>>, f64),
    /// Half-space or height field, which deserialisation rejects.
    Boundless,
}

impl From<&Shape> for ShapeParts {
    fn from(shape: &Shape) -> Self {
        match shape.kind() {
            ShapeKind::Sphere { radius } => Self::Sphere(*radius),
            ShapeKind::Capsule { radius, length } => Self::Capsule(*radius, *length),
            ShapeKind::Cylinder { radius, length } => Self::Cylinder(*radius, *length),
            ShapeKind::Cuboid { size } => Self::Box(*size),
            ShapeKind::Convex(hull) => Self::Convex(hull.vertices().to_vec()),
            ShapeKind::Mesh(mesh) => {
                Self::Mesh(mesh.vertices().to_vec(), mesh.triangles().to_vec())
            }
            ShapeKind::Points(cloud) => Self::Points(cloud.positions().to_vec(), cloud.radius()),
            ShapeKind::HalfSpace | ShapeKind::HeightField(_) => Self::Boundless,
        }
    }
}

impl ShapeParts {
    fn shape(self) -> Result<Shape, ShapeError> {
        match self {
            Self::Sphere(radius) => Shape::sphere(radius),
            Self::Capsule(radius, length) => Shape::capsule(radius, length),
            Self::Cylinder(radius, length) => Shape::cylinder(radius, length),
            Self::Box(size) => Shape::cuboid(size),
            Self::Convex(points) => Shape::convex(&points),
            Self::Mesh(vertices, triangles) => Shape::mesh(vertices, triangles),
            Self::Points(positions, radius) => Shape::points(positions, radius),
            Self::Boundless => Ok(Shape::half_space()),
        }
    }
}

impl From<CollisionModel> for CollisionModelDocument {
    fn from(collision_model: CollisionModel) -> Self {
        let object = |object: CollisionObject| ObjectParts {
            shape: (&object.shape).into(),
            name: object.name,
            link: object.link,
            link_from_shape: object.link_from_shape,
        };
        let plane = |plane: LinkHalfSpace| PlaneParts {
            link: plane.link,
            world_from_plane: plane.obstacle.placement,
            passed: plane.passed,
        };
        Self {
            planes: collision_model.planes.into_iter().map(plane).collect(),
            model: collision_model.model,
            map: collision_model.map,
            objects: collision_model.objects.into_iter().map(object).collect(),
            pairs: collision_model.pairs,
            notes: collision_model.notes,
        }
    }
}

impl TryFrom<CollisionModelDocument> for CollisionModel {
    type Error = CollisionModelError;

    fn try_from(parts: CollisionModelDocument) -> Result<Self, CollisionModelError> {
        let model = parts.model;
        let object = |object: ObjectParts| {
            let shape = object.shape.shape();
            let fault = |source| CollisionModelError::Shape {
                link: model
                    .frames()
                    .get(object.link.index())
                    .map_or("?".into(), |f| f.name.clone()),
                object: object.name.clone(),
                source,
            };
            Ok(CollisionObject {
                shape: shape.map_err(fault)?,
                name: object.name,
                link: object.link,
                link_from_shape: object.link_from_shape,
            })
        };
        let objects = parts.objects.into_iter().map(object);
        let objects: Vec<_> = objects.collect::<Result<_, CollisionModelError>>()?;
        if parts.map.sources().len() != model.configuration_len() {
            let (given, expected) = (parts.map.sources().len(), model.configuration_len());
            return Err(CollisionModelError::ForeignMap { given, expected });
        }
        let mut collision_model = Self::assemble(&model, parts.map, objects, parts.notes)?;
        for plane in parts.planes {
            FrameRef::from(plane.link).resolve(&model)?;
            let at = plane.world_from_plane;
            collision_model
                .planes
                .push(LinkHalfSpace::new(&model, plane.link, at, plane.passed));
        }
        collision_model.pairs.clear();
        for [a, b] in parts.pairs {
            collision_model = collision_model.with_checked(a, b)?;
        }
        Ok(collision_model)
    }
}
