//! Reading of sphere models from files.

use std::path::Path;

#[cfg(feature = "urdf")]
use super::NamedSpheres;
use super::solid::Solid;
use super::{SphereGroup, SphereModel, gap, yaml};
#[cfg(feature = "urdf")]
use crate::collision::ShapeKind;
use crate::collision::model::unconnected_pairs;
use crate::collision::shape::MAX_LENGTH;
use crate::collision::{Ball, CollisionModel};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem, read_with};
use kinopt_kinematics::model::FrameId;

/// Largest file that is read, bytes.
const LENGTH_LIMIT: u64 = 64 << 20;

impl SphereModel {
    /// Reads a sphere model from cuRobo's `collision_spheres` (`.yaml`, `.yml`), or with feature `urdf` from a
    /// spherised URDF. Links are matched by name.
    ///
    /// The spheres are used as they are. cuRobo disables spheres by a radius of 0 or less; those are left out, with a
    /// [note](Self::notes). Their protrusion from the model's shapes and their [gap](SphereGroup::gap) are measured. A
    /// [`Checker`](crate::collision::Checker) enlarges the spheres by the gap. For a link without shapes, the spheres
    /// are its shape.
    ///
    /// Collision pairs are those of the model. For links without shapes in the model, all pairs that are not adjacent
    /// are enabled.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if it names a link that the model does not have.
    pub fn read(path: impl AsRef<Path>, model: &CollisionModel) -> Result<Self, ReadError> {
        read_with(path.as_ref(), LENGTH_LIMIT, |bytes, file| {
            Self::parse(bytes, file, model)
        })
    }

    /// Parses the bytes of a file. The extension of `file` selects the format, and errors report `file`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8], file: &str, model: &CollisionModel) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let at = FileLocation::Byte(error.valid_up_to());
            ReadError::malformed(file, at, "is not UTF-8 text")
        })?;
        let end = file.rsplit('.').next().unwrap_or_default();
        let mut notes = Vec::new();
        let named = match end.to_ascii_lowercase().as_str() {
            "yaml" | "yml" => yaml::parse(text, file, &mut notes)?,
            #[cfg(feature = "urdf")]
            "urdf" => of_urdf(text, file)?,
            _ => {
                let problem = "is of no format of spheres: its name must end in .yaml or .urdf";
                return Err(ReadError::of_file(file, problem));
            }
        };
        for (name, spheres) in &named {
            let is_in_range = |ball: &Ball| {
                let numbers = ball.centre.to_array().into_iter().chain([ball.radius]);
                numbers.into_iter().all(|x| x.abs() <= MAX_LENGTH)
            };
            if let Some(index) = spheres.iter().position(|ball| !is_in_range(ball)) {
                let problem =
                    format!("link `{name}`: sphere {index} has a number beyond {MAX_LENGTH:e} m");
                return Err(ReadError::of_file(file, problem));
            }
        }
        let mut groups = Vec::new();
        let mut max_protrusion: f64 = 0.0;
        for (name, spheres) in named {
            if spheres.is_empty() {
                continue;
            }
            let frame = model.model().frame(&name);
            let link = frame.map_err(|error| invalid(file, error))?;
            let objects: Vec<_> = model.objects_of(link).collect();
            let solid = Solid::new(objects.iter().copied());
            let mut uncovered = 0.0;
            if !solid.is_empty() {
                uncovered = gap::gap(&objects, &spheres);
                let protrusions = spheres
                    .iter()
                    .map(|s| s.radius + solid.signed_distance(s.centre));
                max_protrusion = protrusions.fold(max_protrusion, f64::max);
            }
            groups.push(SphereGroup::new(link, &name, spheres).with_gap(uncovered));
        }
        groups.sort_by_key(|group| group.link);
        if let Some(duplicate) = groups
            .windows(2)
            .find(|neighbours| neighbours[0].link == neighbours[1].link)
        {
            let problem = format!("has the link `{}` twice", duplicate[0].name);
            return Err(ReadError::of_file(file, problem));
        }
        Ok(Self {
            pairs: pairs(model, &groups),
            groups,
            max_protrusion,
            notes,
        })
    }
}

/// Enabled pairs of groups, as indices.
fn pairs(model: &CollisionModel, groups: &[SphereGroup]) -> Vec<[usize; 2]> {
    let links: Vec<FrameId> = groups.iter().map(|group| group.link).collect();
    let unconnected = unconnected_pairs(model.model(), &links);
    let has_shapes = |link: &FrameId| model.links().binary_search(link).is_ok();
    let mut pairs = Vec::new();
    for a in 0..links.len() {
        for b in a + 1..links.len() {
            let pair = [links[a], links[b]];
            let checked = match pair.iter().all(has_shapes) {
                true => model.pairs().binary_search(&pair).is_ok(),
                false => unconnected.binary_search(&pair).is_ok(),
            };
            if checked {
                pairs.push([a, b]);
            }
        }
    }
    pairs
}

/// The spheres of each link. Returns an error for other shapes.
#[cfg(feature = "urdf")]
fn of_urdf(text: &str, file: &str) -> Result<NamedSpheres, ReadError> {
    let robot = kinopt_robot::robot::Robot::reader()
        .lenient()
        .parse(text, file);
    let robot = robot.map_err(|error| invalid(file, error))?;
    // All shapes are spheres, so no mesh file is opened.
    let model = CollisionModel::builder(&robot).confined().build();
    let model = model.map_err(|error| invalid(file, error))?;
    let mut named: NamedSpheres = Vec::new();
    for &link in model.links() {
        let name = model.name_of(link);
        let mut spheres = Vec::new();
        for object in model.objects_of(link) {
            let ShapeKind::Sphere { radius } = *object.shape.kind() else {
                let problem = format!("link `{name}` has a collision shape that is not a sphere");
                return Err(ReadError::of_file(file, problem));
            };
            let centre = object.link_from_shape.translation;
            spheres.push(Ball { centre, radius });
        }
        named.push((name.to_owned(), spheres));
    }
    Ok(named)
}

fn invalid(file: &str, error: impl std::error::Error + Send + Sync + 'static) -> ReadError {
    ReadError::new(file, FileLocation::File, ReadProblem::invalid(error))
}
