//! JSON format of worlds.

use std::collections::{BTreeSet, HashMap};
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::pose::FilePose;
use super::{Obstacle, World, WorldError};
use crate::collision::mesh_file::MeshFile;
use crate::collision::shape::{Shape, ShapeError, ShapeKind};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem};
use kinopt_kinematics::file_access::AllowedFiles;
use kinopt_kinematics::spatial::Vector3;

/// Defines the kinds of obstacles with their dimensions and common fields, and the lists of a file.
macro_rules! kinds {
    ($($list:ident: $kind:ident { $($(#[$attribute:meta])* $measure:ident: $type:ty),* })*) => {
        $(
            #[derive(Serialize, Deserialize)]
            #[serde(deny_unknown_fields)]
            struct $kind {
                name: String,
                $($(#[$attribute])* $measure: $type,)*
                #[serde(default, skip_serializing_if = "at_origin")]
                position: [f64; 3],
                #[serde(default, skip_serializing_if = "Option::is_none")]
                quaternion: Option<[f64; 4]>,
                #[serde(default, skip_serializing_if = "Option::is_none")]
                rotation: Option<[[f64; 3]; 3]>,
                #[serde(default, skip_serializing_if = "Option::is_none")]
                attached: Option<String>,
                #[serde(default, skip_serializing_if = "Vec::is_empty")]
                may_touch: Vec<String>,
            }
        )*

        #[derive(Default, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        struct Contents {
            $(#[serde(skip_serializing_if = "Vec::is_empty", deserialize_with = "objects")] $list: Vec<$kind>,)*
            #[serde(skip_serializing_if = "Vec::is_empty")]
            order: Vec<String>,
            /// Names in `may_touch` that need not exist.
            #[serde(skip_serializing_if = "BTreeSet::is_empty")]
            may_be_missing: BTreeSet<String>,
        }

        /// Reads all obstacles of a file, kind by kind.
        fn read_all(contents: Contents, reader: &Reader<'_>) -> Result<World, ReadError> {
            let mut world = World::new();
            world.may_be_missing = contents.may_be_missing;
            $(for (index, entry) in contents.$list.into_iter().enumerate() {
                let location = || FileLocation::Json(format!("{}[{index}]", stringify!($list)));
                let pose = FilePose {
                    position: entry.position,
                    quaternion: entry.quaternion,
                    rotation: entry.rotation,
                };
                let placement = pose.placement().map_err(|problem| reader.fail(location(), problem))?;
                let measures = $kind::shape(reader, location(), $(entry.$measure),*)?;
                let shape = measures.map_err(|error| {
                    reader.invalid(location(), WorldError::Shape { name: entry.name.clone(), error })
                })?;
                let added = world.add(&entry.name, shape, placement);
                let attached = added.and_then(|()| match &entry.attached {
                    Some(frame) => world.attach(&entry.name, frame, placement),
                    None => Ok(()),
                });
                let allowed = attached.and_then(|()| {
                    entry.may_touch.iter().try_for_each(|with| world.allow_collision(&entry.name, with))
                });
                allowed.map_err(|error| reader.invalid(location(), error))?;
            })*
            Ok(world)
        }

        /// The names in all lists, in the order of the kinds.
        fn names(contents: &Contents) -> Vec<String> {
            let mut all = Vec::new();
            $(all.extend(contents.$list.iter().map(|entry| entry.name.clone()));)*
            all
        }
    };
}

kinds! {
    boxes: Cuboid { size: [f64; 3] }
    cylinders: Cylinder { radius: f64, length: f64 }
    spheres: Sphere { radius: f64 }
    capsules: Capsule { radius: f64, length: f64 }
    planes: Plane {}
    convex: Convex { points: Vec<[f64; 3]> }
    meshes: Mesh {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scale: Option<[f64; 3]>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        vertices: Vec<[f64; 3]>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        triangles: Vec<[u32; 3]>
    }
    height_fields: HeightField { heights: Vec<f64>, columns: usize, spacing: [f64; 2] }
    points: Points { positions: Vec<[f64; 3]>, radius: f64 }
}

/// A value that must be a JSON object. serde would accept an array too, and an empty one as an empty world.
struct Object<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ObjectVisitor(PhantomData))
    }
}

struct ObjectVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for ObjectVisitor<T> {
    type Value = Object<T>;

    fn expecting(&self, text: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        text.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Object)
    }
}

fn objects<'de, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    let all = Vec::<Object<T>>::deserialize(deserializer)?;
    Ok(all.into_iter().map(|Object(one)| one).collect())
}

/// Context of the reader of one file.
struct Reader<'f> {
    file: &'f str,
    /// Mesh files that may be opened; `None` opens none.
    allowed: Option<&'f AllowedFiles>,
}

impl Reader<'_> {
    fn fail(&self, location: FileLocation, problem: String) -> ReadError {
        ReadError::malformed(self.file, location, problem)
    }

    fn invalid(&self, location: FileLocation, error: WorldError) -> ReadError {
        ReadError::new(self.file, location, ReadProblem::invalid(error))
    }
}

/// A shape or its error. The outer error is a read error of its file.
type ShapeResult = Result<Result<Shape, ShapeError>, ReadError>;

/// Defines the shape of each kind from its dimensions.
macro_rules! shapes {
    ($($kind:ident($($measure:ident: $type:ty),*) = $shape:expr;)*) => {
        $(impl $kind {
            fn shape(_: &Reader<'_>, _: FileLocation, $($measure: $type),*) -> ShapeResult {
                Ok($shape)
            }
        })*
    };
}

shapes! {
    Cuboid(size: [f64; 3]) = Shape::cuboid(size);
    Cylinder(radius: f64, length: f64) = Shape::cylinder(radius, length);
    Sphere(radius: f64) = Shape::sphere(radius);
    Capsule(radius: f64, length: f64) = Shape::capsule(radius, length);
    Plane() = Ok(Shape::half_space());
    Convex(points: Vec<[f64; 3]>) = Shape::convex(&vectors(points));
    HeightField(heights: Vec<f64>, columns: usize, spacing: [f64; 2]) =
        Shape::height_field(heights, columns, spacing);
    Points(positions: Vec<[f64; 3]>, radius: f64) = Shape::points(vectors(positions), radius);
}

impl Mesh {
    fn shape(
        reader: &Reader<'_>,
        location: FileLocation,
        file: Option<String>,
        scale: Option<[f64; 3]>,
        vertices: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
    ) -> ShapeResult {
        let scale = scale.unwrap_or([1.0; 3]);
        let mesh = match (file, vertices.is_empty() && triangles.is_empty()) {
            (Some(_), false) => {
                let problem = "has both a `file` and triangles; only one is allowed";
                return Err(reader.fail(location, problem.to_owned()));
            }
            (Some(file), true) => {
                let Some(allowed) = reader.allowed else {
                    let problem = format!(
                        "names the file {file:?}; files are opened only for a world that is read from a file"
                    );
                    return Err(reader.fail(location, problem));
                };
                let parse = |bytes: Vec<u8>| MeshFile::parse(&bytes, &file);
                let read = allowed
                    .open(&file)
                    .and_then(|bytes| parse(bytes).map_err(ReadError::without_contents));
                read.map_err(|error| ReadError::referred(reader.file, location, error))?
            }
            (None, _) => MeshFile {
                points: vectors(vertices),
                triangles,
            },
        };
        let mesh = mesh.scaled(scale);
        Ok(Shape::mesh(mesh.points, mesh.triangles))
    }
}

/// Parses a world from JSON.
pub(super) fn parse(
    bytes: &[u8],
    file: &str,
    allowed: Option<&AllowedFiles>,
) -> Result<World, ReadError> {
    let Object(contents) = kinopt_mesh::json::parse(bytes, file)?;
    read(contents, &Reader { file, allowed })
}

/// Builds a world from the contents of a file.
fn read(mut contents: Contents, reader: &Reader<'_>) -> Result<World, ReadError> {
    let order = std::mem::take(&mut contents.order);
    let mut world = read_all(contents, reader)?;
    if order.is_empty() {
        return Ok(world);
    }
    let at = |index: usize| FileLocation::Json(format!("order[{index}]"));
    let mut ranks: HashMap<&str, usize> = HashMap::new();
    for (index, name) in order.iter().enumerate() {
        world
            .obstacle(name)
            .map_err(|error| reader.invalid(at(index), error))?;
        if ranks.insert(name, index).is_some() {
            return Err(reader.fail(at(index), format!("{name:?} is in the order twice")));
        }
    }
    if let Some(missing) = world.obstacles().find(|o| !ranks.contains_key(&*o.name)) {
        let problem = format!("obstacle {:?} is missing in it", missing.name);
        return Err(reader.fail(FileLocation::Json("order".to_owned()), problem));
    }
    world.sort_by_key(|o| ranks.get(&*o.name).copied());
    Ok(world)
}

/// A world as JSON.
pub(super) fn text(world: &World) -> String {
    // Cannot fail: numbers of obstacles are finite and keys are strings.
    serde_json::to_string_pretty(&contents(world)).unwrap_or_default()
}

#[cfg(feature = "serde")]
impl Serialize for World {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        contents(self).serialize(to)
    }
}

#[cfg(feature = "serde")]
impl<'de> Deserialize<'de> for World {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let (file, allowed) = ("a world", None);
        let Object(contents) = Object::deserialize(from)?;
        read(contents, &Reader { file, allowed }).map_err(serde::de::Error::custom)
    }
}

fn contents(world: &World) -> Contents {
    let mut contents = Contents {
        may_be_missing: world.may_be_missing.clone(),
        ..Contents::default()
    };
    for obstacle in world.obstacles() {
        push(&mut contents, obstacle);
    }
    let names = names(&contents);
    if !world.obstacles().map(|o| &o.name).eq(&names) {
        contents.order = world.obstacles().map(|o| o.name.clone()).collect();
    }
    contents
}

fn push(contents: &mut Contents, obstacle: &Obstacle) {
    /// Adds an entry with the common fields.
    macro_rules! entry {
        ($list:ident: $kind:ident { $($measure:ident: $value:expr),* }) => {{
            let FilePose { position, quaternion, rotation } = FilePose::of(&obstacle.placement);
            contents.$list.push($kind {
                name: obstacle.name.clone(),
                $($measure: $value,)*
                position,
                quaternion,
                rotation,
                attached: obstacle.attached.clone(),
                may_touch: obstacle.allowed_collisions.clone(),
            });
        }};
    }
    match obstacle.shape.kind() {
        &ShapeKind::Sphere { radius } => entry!(spheres: Sphere { radius: radius }),
        &ShapeKind::Capsule { radius, length } => {
            entry!(capsules: Capsule { radius: radius, length: length });
        }
        &ShapeKind::Cylinder { radius, length } => {
            entry!(cylinders: Cylinder { radius: radius, length: length });
        }
        &ShapeKind::Cuboid { size } => entry!(boxes: Cuboid { size: size }),
        ShapeKind::HalfSpace => entry!(planes: Plane {}),
        ShapeKind::Convex(hull) => entry!(convex: Convex { points: arrays(hull.vertices()) }),
        ShapeKind::Mesh(mesh) => entry!(meshes: Mesh {
            file: None,
            scale: None,
            vertices: arrays(mesh.vertices()),
            triangles: mesh.triangles().to_vec()
        }),
        ShapeKind::HeightField(field) => entry!(height_fields: HeightField {
            heights: field.heights().to_vec(),
            columns: field.columns(),
            spacing: field.spacing()
        }),
        ShapeKind::Points(cloud) => entry!(points: Points {
            positions: arrays(cloud.positions()),
            radius: cloud.radius()
        }),
    }
}

fn at_origin(position: &[f64; 3]) -> bool {
    *position == [0.0; 3]
}

fn vectors(arrays: Vec<[f64; 3]>) -> Vec<Vector3<f64>> {
    arrays.into_iter().map(Vector3::from).collect()
}

fn arrays(vectors: &[Vector3<f64>]) -> Vec<[f64; 3]> {
    vectors.iter().map(|v| v.to_array()).collect()
}
