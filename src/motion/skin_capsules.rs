//! Capsules for the bones of a character, fitted to its skin.

use crate::SizeMismatch;
use crate::collision::{CollisionModel, CollisionModelError, CollisionObject, Shape};
use crate::mesh::TriangleMesh;
use crate::model::{Model, ParameterMap};
use crate::scalar::elementary;
use crate::skeleton::{BallSkeleton, BoneId, Skeleton};
use crate::skinning::SkinWeights;
use crate::spatial::{Matrix3, Placement, Vector3};

/// Smallest number of vertices for which a bone gets a shape.
const MIN_VERTICES: usize = 8;
/// Fraction of a bone's vertices that is cut off at each end of an extent, as blend weights reach into neighbouring
/// bones.
const TRIMMED_SHARE: f64 = 0.05;

/// A collision model of a character: capsules along the bones of a skeleton, fitted to the skin.
///
/// Each vertex belongs to the bone with its largest weight. 90 % of a bone's vertices lie between the sides of its
/// capsules. A bone with a wide cross-section, such as a chest or a foot, gets several parallel capsules. Collision
/// pairs that overlap in the rest pose, as neighbours do, are disabled.
///
/// ```
/// use kinopt::io::rig::Rig;
/// use kinopt::motion::skin_capsules;
///
/// let rig = Rig::read("models/humanoid/humanoid.json")?;
/// let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else { unreachable!() };
/// let model = skin_capsules(&rig.skeleton, mesh, weights)?;
/// assert!(model.is_checked("left_hand", "spine")?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error if the weights do not match the mesh and the skeleton.
pub fn skin_capsules(
    skeleton: &Skeleton,
    mesh: &TriangleMesh,
    weights: &SkinWeights,
) -> Result<CollisionModel, CollisionModelError> {
    model_of_skin(skeleton, skeleton.model(), mesh, weights)
}

/// As [`skin_capsules`], for a skeleton with ball joints.
///
/// # Errors
/// As [`skin_capsules`].
pub fn ball_skin_capsules(
    skeleton: &BallSkeleton,
    mesh: &TriangleMesh,
    weights: &SkinWeights,
) -> Result<CollisionModel, CollisionModelError> {
    model_of_skin(skeleton.skeleton(), skeleton.model(), mesh, weights)
}

fn model_of_skin(
    skeleton: &Skeleton,
    model: &Model,
    mesh: &TriangleMesh,
    weights: &SkinWeights,
) -> Result<CollisionModel, CollisionModelError> {
    let (bones, positions) = (skeleton.bones(), mesh.positions());
    SizeMismatch::check("rows of weights", weights.vertex_count(), positions.len())?;
    SizeMismatch::check("columns of weights", weights.bone_count(), bones.len())?;
    let mut skin: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); bones.len()];
    for (vertex, position) in positions.iter().enumerate() {
        let influences = weights.influences(vertex).iter();
        // Ties go to the first bone.
        let strongest = influences.fold(None, |strongest: Option<(usize, f64)>, influence| {
            let (bone, weight) = (influence.bone as usize, influence.weight);
            let is_stronger = strongest.is_none_or(|(_, max_weight)| weight > max_weight);
            if is_stronger {
                Some((bone, weight))
            } else {
                strongest
            }
        });
        if let Some((bone, _)) = strongest {
            let point = Vector3::new(position.x.into(), position.y.into(), position.z.into());
            skin[bone].push(bones[bone].model_from_rest.inverse().apply(point));
        }
    }
    let mut objects = Vec::new();
    for (index, (bone, points)) in bones.iter().zip(skin).enumerate() {
        if points.len() < MIN_VERTICES {
            continue;
        }
        let tail = skeleton.tail(BoneId::new(index));
        for (k, (bone_from_shape, shape)) in capsules(&points).into_iter().enumerate() {
            let name = format!("{}_{k}", bone.name);
            objects.push(CollisionObject::new(name, tail, bone_from_shape, shape));
        }
    }
    let map = ParameterMap::identity(model);
    let collision_model = CollisionModel::assemble(model, map, objects, Vec::new())?;
    Ok(collision_model.with_touching_ignored(&model.neutral())?)
}

/// Capsules along x that cover most of the points. The points are in the bone's frame.
fn capsules(points: &[Vector3<f64>]) -> Vec<(Placement<f64>, Shape)> {
    // Principal axes of the cross-section.
    let count = points.len() as f64;
    let middle = points.iter().fold(Vector3::zero(), |sum, p| sum + *p) * count.recip();
    let moment = |f: fn(Vector3<f64>) -> f64| points.iter().map(|p| f(*p - middle)).sum::<f64>();
    let (yy, zz, yz) = (
        moment(|p| p.y * p.y),
        moment(|p| p.z * p.z),
        moment(|p| p.y * p.z),
    );
    let (sin, cos) = elementary::sin_cos(0.5 * elementary::atan2(2.0 * yz, yy - zz));
    let wide = Vector3::new(0.0, cos, sin);
    let thin = Vector3::new(0.0, -sin, cos);
    let [along, across, through] = [Vector3::UNITS[0], wide, thin].map(|axis| extent(points, axis));
    let (half_wide, half_thin) = (across.1.max(through.1), across.1.min(through.1));
    let side = if across.1 >= through.1 { wide } else { thin };
    if half_thin <= 0.0 {
        return Vec::new();
    }
    // The spacing of parallel capsules is at most their diameter, except beyond the limit of their number.
    let max_offset = half_wide - half_thin;
    let gaps = (max_offset / half_thin).ceil().min(16.0);
    let centre = Vector3::UNITS[0] * along.0 + wide * across.0 + thin * through.0;
    let length = 2.0 * (along.1 - half_thin);
    // Rotates the capsule's axis from z to x.
    let [x, y, z] = Vector3::UNITS;
    let rotation = Matrix3::from_columns(y, z, x);
    let shape = match length > 0.0 {
        true => Shape::capsule(half_thin, length),
        false => Shape::sphere(half_thin.min(half_wide)),
    };
    // Skin too thin for a shape.
    let Ok(shape) = shape else {
        return Vec::new();
    };
    let placement = |k: usize| {
        let share = if gaps > 0.0 {
            2.0 * k as f64 / gaps - 1.0
        } else {
            0.0
        };
        Placement::new(rotation, centre + side * (max_offset * share))
    };
    (0..=gaps as usize)
        .map(|k| (placement(k), shape.clone()))
        .collect()
}

/// The middle and half the width of the range of most points along an axis, metres.
fn extent(points: &[Vector3<f64>], axis: Vector3<f64>) -> (f64, f64) {
    let mut values: Vec<f64> = points.iter().map(|p| p.dot(axis)).collect();
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len() - 1;
    let trimmed = (TRIMMED_SHARE * last as f64).floor() as usize;
    let (low, high) = (values[trimmed], values[last - trimmed]);
    (0.5 * (low + high), 0.5 * (high - low))
}
