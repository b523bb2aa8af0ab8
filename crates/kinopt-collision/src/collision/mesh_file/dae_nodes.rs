//! Geometry instances of a COLLADA scene, with their transforms.

use roxmltree::Node;

use super::dae_document::{Collada, children, named};
use kinopt_kinematics::file::ReadError;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Largest depth of nested nodes and instances.
const DEPTH_LIMIT: usize = 64;
/// Largest number of nodes and of geometry instances: instances of nodes can multiply.
const COUNT_LIMIT: usize = 100_000;

/// An affine map, which may scale, shear and mirror.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    linear: Matrix3<f64>,
    shift: Vector3<f64>,
}

impl Affine {
    const fn new(linear: Matrix3<f64>, shift: Vector3<f64>) -> Self {
        Self { linear, shift }
    }

    fn identity() -> Self {
        Self::new(Matrix3::identity(), Vector3::zero())
    }

    pub(super) fn apply(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.linear * point + self.shift
    }

    fn then(&self, inner: &Self) -> Self {
        Self::new(self.linear * inner.linear, self.apply(inner.shift))
    }

    /// True if the map reverses orientation.
    pub(super) fn mirrors(&self) -> bool {
        let Matrix3 { x, y, z } = self.linear;
        x.cross(y).dot(z) < 0.0
    }
}

/// The geometry instances of a scene, with their transforms.
pub(super) struct Instances<'c, 'a> {
    collada: &'c Collada<'a>,
    instances: Vec<(Node<'a, 'a>, Affine)>,
    nodes: usize,
}

impl<'c, 'a> Instances<'c, 'a> {
    /// Instances of the displayed scene, or else of the first scene. Without scenes, all geometries without a
    /// transform.
    pub(super) fn of(collada: &'c Collada<'a>) -> Result<Vec<(Node<'a, 'a>, Affine)>, ReadError> {
        let root = collada.root();
        let shown = named(root, "scene").and_then(|scene| named(scene, "instance_visual_scene"));
        let scene = match shown {
            Some(shown) => Some(collada.referred(shown, "url")?),
            None => named(root, "library_visual_scenes")
                .and_then(|library| named(library, "visual_scene")),
        };
        let mut instances = Self {
            collada,
            instances: Vec::new(),
            nodes: 0,
        };
        match scene {
            Some(scene) => instances.of_node(scene, &Affine::identity(), 0)?,
            None => {
                let libraries = children(root, "library_geometries");
                let all = libraries.flat_map(|library| children(library, "geometry"));
                instances.instances = all.map(|one| (one, Affine::identity())).collect();
            }
        }
        Ok(instances.instances)
    }

    fn of_node(
        &mut self,
        node: Node<'a, 'a>,
        parent: &Affine,
        depth: usize,
    ) -> Result<(), ReadError> {
        self.nodes += 1;
        if depth > DEPTH_LIMIT || self.nodes.max(self.instances.len()) > COUNT_LIMIT {
            let problem = "more nodes within nodes than a mesh has";
            return Err(self.collada.fail(node, problem));
        }
        let mut transform = *parent;
        for child in node.children() {
            match child.tag_name().name() {
                "node" => self.of_node(child, &transform, depth + 1)?,
                "instance_node" => {
                    let other = self.collada.referred(child, "url")?;
                    self.of_node(other, &transform, depth + 1)?;
                }
                "instance_geometry" => {
                    let geometry = self.collada.referred(child, "url")?;
                    self.instances.push((geometry, transform));
                }
                "instance_controller" => {
                    let controller = self.collada.referred(child, "url")?;
                    if let Some(skin) = named(controller, "skin") {
                        let geometry = self.collada.referred(skin, "source")?;
                        self.instances.push((geometry, transform));
                    }
                }
                tag => {
                    if let Some(local) = self.transform(child, tag)? {
                        transform = transform.then(&local);
                    }
                }
            }
        }
        Ok(())
    }

    fn transform(&self, node: Node<'a, 'a>, tag: &str) -> Result<Option<Affine>, ReadError> {
        let needed = match tag {
            "matrix" => 16,
            "translate" | "scale" => 3,
            "rotate" => 4,
            "lookat" | "skew" => {
                let problem = format!("<{tag}> is not read; bake it into the points");
                return Err(self.collada.fail(node, problem));
            }
            _ => return Ok(None),
        };
        let n: Vec<f64> = self.collada.numbers(node)?;
        if n.len() != needed || n.iter().any(|x| !x.is_finite()) {
            let problem = format!("<{tag}> needs {needed} finite numbers");
            return Err(self.collada.fail(node, problem));
        }
        let column = |k: usize| Vector3::new(n[k], n[4 + k], n[8 + k]);
        let [x, y, z] = Vector3::UNITS;
        Ok(Some(match tag {
            "matrix" => Affine::new(
                Matrix3 {
                    x: column(0),
                    y: column(1),
                    z: column(2),
                },
                column(3),
            ),
            "translate" => Affine::new(Matrix3::identity(), Vector3::new(n[0], n[1], n[2])),
            "scale" => Affine::new(
                Matrix3 {
                    x: x * n[0],
                    y: y * n[1],
                    z: z * n[2],
                },
                Vector3::zero(),
            ),
            _ => {
                let axis = Vector3::new(n[0], n[1], n[2]);
                let length = axis.norm();
                let sin_cos = elementary::sin_cos(n[3].to_radians());
                match length > 0.0 {
                    true => Affine::new(
                        Matrix3::rotation(axis * (1.0 / length), sin_cos),
                        Vector3::zero(),
                    ),
                    false => Affine::identity(),
                }
            }
        }))
    }
}
