//! Morph targets (blend shapes): shapes mixed into the mesh at rest, before bones move it.

use glam::{Vec3, Vec4};

use crate::mesh::TriangleMesh;

/// The differences of one shape from the rest, at the vertices where there are any.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    name: String,
    vertices: Vec<u32>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tangents: Vec<Vec3>,
}

/// What is wrong with a morph target or its use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MorphError {
    /// A target's lists are not as long as its list of vertices.
    #[error("target `{target}`: {given} {what}s for {vertices} vertices")]
    DeltaCount {
        /// The target's name.
        target: String,
        /// "normal delta", …
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many vertices the target lists.
        vertices: usize,
    },
    /// The vertices are not listed in rising order, each once.
    #[error("target `{target}`: vertex {vertex} does not come after the one before it")]
    Order {
        /// The target's name.
        target: String,
        /// The vertex.
        vertex: u32,
    },
    /// A delta is NaN or infinite.
    #[error("target `{target}`, vertex {vertex}: the {what} is not finite")]
    NonFinite {
        /// The target's name.
        target: String,
        /// "position delta", …
        what: &'static str,
        /// Which vertex of the mesh.
        vertex: u32,
    },
    /// A target names a vertex that the mesh does not have.
    #[error("target `{target}`: vertex {vertex} is out of range; there are {vertices} vertices")]
    VertexOutOfRange {
        /// The target's name.
        target: String,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A shape has another number of vertices than the mesh it is taken from.
    #[error("target `{target}`: a shape of {given} vertices for a mesh of {vertices}")]
    ShapeCount {
        /// The target's name.
        target: String,
        /// How many the shape has.
        given: usize,
        /// How many the mesh has.
        vertices: usize,
    },
    /// There is not one weight per target.
    #[error("{given} weights for {targets} morph targets: {names}")]
    WeightCount {
        /// How many weights.
        given: usize,
        /// How many targets.
        targets: usize,
        /// The targets' names.
        names: String,
    },
    /// A weight is NaN or infinite.
    #[error("target `{target}`: the weight {weight} is not finite")]
    NonFiniteWeight {
        /// The target's name.
        target: String,
        /// The weight.
        weight: f32,
    },
    /// A buffer of vertices is neither empty nor as long as the mesh.
    #[error("{given} {what} for a mesh of {vertices} vertices")]
    VertexCount {
        /// "positions", "normals" or "tangents".
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many the mesh has.
        vertices: usize,
    },
}

impl MorphTarget {
    /// A target of sparse deltas: `vertices` in rising order, and for each its position's delta in
    /// the model's unit. Normals' and tangents' deltas may be left empty.
    ///
    /// # Errors
    /// The lists differ in length, vertices do not rise, or a number is not finite.
    pub fn new(
        name: impl Into<String>,
        vertices: Vec<u32>,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        tangents: Vec<Vec3>,
    ) -> Result<Self, MorphError> {
        let target: String = name.into();
        let lists = [
            ("position delta", &positions, false),
            ("normal delta", &normals, true),
            ("tangent delta", &tangents, true),
        ];
        for (what, list, optional) in lists {
            if list.len() != vertices.len() && !(optional && list.is_empty()) {
                return Err(MorphError::DeltaCount {
                    target,
                    what,
                    given: list.len(),
                    vertices: vertices.len(),
                });
            }
            let broken = list.iter().zip(&vertices).find(|(d, _)| !d.is_finite());
            if let Some((_, &vertex)) = broken {
                return Err(MorphError::NonFinite {
                    target,
                    what,
                    vertex,
                });
            }
        }
        let fall = vertices.windows(2).find(|pair| pair[0] >= pair[1]);
        if let Some(&[_, vertex]) = fall {
            return Err(MorphError::Order { target, vertex });
        }
        Ok(Self {
            name: target,
            vertices,
            positions,
            normals,
            tangents,
        })
    }

    /// The target whose full weight turns `rest` into `shape`: deltas of positions, and of normals
    /// where both have them. Vertices that move by no more than `threshold` (in the model's unit) and
    /// whose normal keeps to it as well are left out; 0 leaves out what is equal.
    ///
    /// # Errors
    /// The shape has another number of vertices.
    pub fn between(
        name: impl Into<String>,
        rest: &TriangleMesh,
        shape: &TriangleMesh,
        threshold: f32,
    ) -> Result<Self, MorphError> {
        let mut own = Self {
            name: name.into(),
            ..Self::default()
        };
        if shape.positions().len() != rest.positions().len() {
            return Err(MorphError::ShapeCount {
                target: own.name,
                given: shape.positions().len(),
                vertices: rest.positions().len(),
            });
        }
        let with_normals = !rest.normals().is_empty() && !shape.normals().is_empty();
        let pairs = rest.positions().iter().zip(shape.positions());
        for (vertex, (from, to)) in pairs.enumerate() {
            let moved = *to - *from;
            let normals = (rest.normals().get(vertex), shape.normals().get(vertex));
            let turned = match normals {
                (Some(from), Some(to)) => *to - *from,
                _ => Vec3::ZERO,
            };
            if moved.length() > threshold || turned.length() > threshold {
                own.vertices.push(vertex as u32);
                own.positions.push(moved);
                if with_normals {
                    own.normals.push(turned);
                }
            }
        }
        Ok(own)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The vertices it moves, rising.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// How far it moves each of those vertices, in the model's unit.
    #[must_use]
    pub fn position_deltas(&self) -> &[Vec3] {
        &self.positions
    }

    /// What it adds to the normal of each of those vertices; empty where it leaves normals alone.
    #[must_use]
    pub fn normal_deltas(&self) -> &[Vec3] {
        &self.normals
    }

    /// What it adds to the tangent of each of those vertices; empty where it leaves tangents alone.
    #[must_use]
    pub fn tangent_deltas(&self) -> &[Vec3] {
        &self.tangents
    }
}

/// The morph targets of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTargets {
    targets: Vec<MorphTarget>,
    vertex_count: usize,
}

impl MorphTargets {
    /// Targets for a mesh of so many vertices.
    ///
    /// # Errors
    /// A target names a vertex that does not exist.
    pub fn new(vertex_count: usize, targets: Vec<MorphTarget>) -> Result<Self, MorphError> {
        for target in &targets {
            // They rise, so the last is the largest.
            if let Some(&vertex) = target
                .vertices
                .last()
                .filter(|&&v| v as usize >= vertex_count)
            {
                return Err(MorphError::VertexOutOfRange {
                    target: target.name.clone(),
                    vertex,
                    vertices: vertex_count,
                });
            }
        }
        Ok(Self {
            targets,
            vertex_count,
        })
    }

    /// The targets, in the order of the weights.
    #[must_use]
    pub fn targets(&self) -> &[MorphTarget] {
        &self.targets
    }

    /// How many vertices the mesh has.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Adds Σ_k α_k Δ_k to vertices at rest, in place; buffers that are empty are left out. Normals and
    /// tangents that a target touches come out with unit length (zero where the sum is zero); tangents
    /// keep their sign w.
    ///
    /// Weights α_k are usually 0 to 1, but any finite number is taken; 0 costs nothing. The rest has
    /// the share 1 − Σ_k α_k, so this is the weighted mean of shapes whose weights sum to 1.
    ///
    /// # Errors
    /// There is not one weight per target, one is not finite, or a buffer is neither empty nor one
    /// entry per vertex. Nothing is changed then.
    pub fn apply(
        &self,
        weights: &[f32],
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        tangents: &mut [Vec4],
    ) -> Result<(), MorphError> {
        self.check_weights(weights)?;
        let sizes = [
            ("positions", positions.len()),
            ("normals", normals.len()),
            ("tangents", tangents.len()),
        ];
        for (what, given) in sizes {
            if given != 0 && given != self.vertex_count {
                return Err(MorphError::VertexCount {
                    what,
                    given,
                    vertices: self.vertex_count,
                });
            }
        }
        let active = || self.targets.iter().zip(weights).filter(|(_, w)| **w != 0.0);
        for (target, &weight) in active() {
            add(
                positions,
                &target.vertices,
                &target.positions,
                |p, delta| *p += delta * weight,
            );
            add(normals, &target.vertices, &target.normals, |n, delta| {
                *n += delta * weight
            });
            add(tangents, &target.vertices, &target.tangents, |t, delta| {
                *t += (delta * weight).extend(0.0);
            });
        }
        for (target, _) in active() {
            add(normals, &target.vertices, &target.normals, |n, _| {
                *n = n.normalize_or_zero();
            });
            add(tangents, &target.vertices, &target.tangents, |t, _| {
                *t = t.truncate().normalize_or_zero().extend(t.w);
            });
        }
        Ok(())
    }

    fn check_weights(&self, weights: &[f32]) -> Result<(), MorphError> {
        if weights.len() != self.targets.len() {
            let names: Vec<&str> = self.targets.iter().map(MorphTarget::name).collect();
            return Err(MorphError::WeightCount {
                given: weights.len(),
                targets: self.targets.len(),
                names: names.join(", "),
            });
        }
        let broken = self
            .targets
            .iter()
            .zip(weights)
            .find(|(_, w)| !w.is_finite());
        broken.map_or(Ok(()), |(target, &weight)| {
            Err(MorphError::NonFiniteWeight {
                target: target.name.clone(),
                weight,
            })
        })
    }
}

/// Does something to each listed vertex of a buffer that is there, with its delta.
fn add<T>(buffer: &mut [T], vertices: &[u32], deltas: &[Vec3], mut to: impl FnMut(&mut T, Vec3)) {
    for (&vertex, &delta) in vertices.iter().zip(deltas) {
        if let Some(entry) = buffer.get_mut(vertex as usize) {
            to(entry, delta);
        }
    }
}
