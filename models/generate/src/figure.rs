//! Conversion of bones and parts to a rig.

use glam::{DMat3, DVec3};
use kinopt::animation::EulerClip;
use kinopt::io::rig::Rig;
use kinopt::mesh::{TriangleMesh, single_precision};
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::skinning::SkinWeights;
use kinopt::spatial::{Matrix3, Placement};

use crate::Failure;
use crate::polygonise::polygonise;
use crate::remesh::remesh;
use crate::surface::{Part, Shape, Surface};
use crate::weights::weights;

/// Bone specification, in metres and degrees.
#[derive(Clone, Debug)]
pub(crate) struct BoneSpec {
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    pub(crate) tail: DVec3,
    pub(crate) tip: DVec3,
    /// Direction in which a positive bend moves the tip at rest.
    pub(crate) towards: DVec3,
    /// Ranges of first twist, bend and second twist, degrees.
    pub(crate) limits: [[f64; 2]; 3],
}

/// Figure under construction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figure {
    pub(crate) bones: Vec<BoneSpec>,
    pub(crate) surface: Surface,
}

/// Axes with x along `along` and y as close to `towards` as possible.
pub(crate) fn axes(along: DVec3, towards: DVec3) -> DMat3 {
    let x = along.normalize();
    let z = x.cross(towards).normalize();
    DMat3::from_cols(x, z.cross(x), z)
}

impl Figure {
    /// Index of a bone by its name; an error for an unknown one.
    pub(crate) fn bone(&self, name: &str) -> Result<usize, Failure> {
        let index = self.bones.iter().position(|bone| bone.name == name);
        index.ok_or_else(|| format!("there is no bone `{name}`").into())
    }

    /// Skeleton of the bones.
    pub(crate) fn skeleton(&self, name: &str) -> Result<Skeleton, Failure> {
        // Ids exist only for added bones, so parents are looked up in order.
        let mut bones: Vec<Bone> = Vec::new();
        for spec in &self.bones {
            let parent = match spec.parent {
                Some(index) => Skeleton::new(name, bones.clone())?.bone_at(index),
                None => None,
            };
            let DMat3 {
                x_axis,
                y_axis,
                z_axis,
            } = axes(spec.tip - spec.tail, spec.towards);
            let [x, y, z] = [x_axis, y_axis, z_axis].map(|column| column.to_array().into());
            bones.push(Bone {
                name: spec.name.clone(),
                parent,
                length: spec.tip.distance(spec.tail),
                model_from_rest: Placement::new(
                    Matrix3::from_columns(x, y, z),
                    spec.tail.to_array().into(),
                ),
                limits: spec
                    .limits
                    .map(|[low, high]| Limits::new(low.to_radians(), high.to_radians())),
            });
        }
        Ok(Skeleton::new(name, bones)?)
    }

    /// Rig with its skin, meshed on a grid of cubes with edges of `step` metres.
    pub(crate) fn rig(
        &self,
        skeleton: Skeleton,
        clip: EulerClip,
        pinned: &[&str],
        step: f64,
    ) -> Result<Rig, Failure> {
        let [low, high] = self.bounds();
        let soup = polygonise(&self.surface, low, high, step);
        let soup = remesh(soup, &self.surface);
        let round = |p: &DVec3| single_precision(p.to_array().into());
        let positions = soup.positions.iter().map(round).collect();
        let mesh = TriangleMesh::new(positions, Vec::new(), soup.triangles.clone())?;
        if !mesh.is_closed() {
            return Err("the mesh is not closed".into());
        }
        let count = self.bones.len();
        let mut builder = SkinWeights::builder(soup.positions.len(), count);
        for (vertex, row) in weights(&soup, &self.surface, count).into_iter().enumerate() {
            for (bone, weight) in row {
                builder.add(vertex, bone, weight)?;
            }
        }
        let mut constrained = Vec::new();
        for name in pinned {
            constrained.push(skeleton.bone(name)?);
        }
        Ok(Rig {
            skeleton,
            mesh: Some(mesh),
            weights: Some(builder.build()?),
            clip,
            constrained,
            notes: Vec::new(),
        })
    }

    /// Box around all parts, with a margin.
    fn bounds(&self) -> [DVec3; 2] {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for part in self.surface.limbs.iter().flat_map(|(parts, _)| parts) {
            let (extent, radius) = match part.shape {
                Shape::RoundCone {
                    length,
                    r0,
                    r1,
                    wide,
                    thick,
                } => (length, r0.max(r1) * wide.max(thick).max(1.0)),
                Shape::Ellipsoid(half) => (0.0, half.max_element()),
                Shape::Block { half, .. } => (0.0, half.length()),
                Shape::Cylinder { radius, half, .. } => (0.0, radius.hypot(half)),
            };
            for end in [part.origin, part.origin + part.axes.x_axis * extent] {
                low = low.min(end - DVec3::splat(radius + 0.02));
                high = high.max(end + DVec3::splat(radius + 0.02));
            }
        }
        [low, high]
    }
}

/// Mirror image of a part in the plane y = 0, attached to `bone`.
pub(crate) fn mirrored(part: &Part, bone: usize) -> Part {
    let flip = DVec3::new(1.0, -1.0, 1.0);
    let DMat3 {
        x_axis,
        y_axis,
        z_axis,
    } = part.axes;
    // Every shape is symmetric in z, so a reversed z axis keeps the axes right-handed.
    let axes = DMat3::from_cols(x_axis * flip, y_axis * flip, -(z_axis * flip));
    Part {
        bone,
        origin: part.origin * flip,
        axes,
        ..*part
    }
}
