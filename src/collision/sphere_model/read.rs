//! Sphere models out of files.

use std::path::Path;

#[cfg(feature = "urdf")]
use super::NamedSpheres;
use super::solid::Solid;
use super::{SphereGroup, SphereModel, gap, yaml};
#[cfg(feature = "urdf")]
use crate::collision::ShapeKind;
use crate::collision::model::pairs_apart;
use crate::collision::shape::LARGEST;
use crate::collision::{Ball, CollisionModel};
use crate::file::{Place, ReadError, ReadProblem, read_with};
use crate::model::FrameId;

/// The longest file that is read.
const LENGTH_LIMIT: u64 = 64 << 20;

impl SphereModel {
    /// Spheres that others made: cuRobo's `collision_spheres` (`.yaml`, `.yml`), or with feature `urdf` the spheres of a
    /// spherised URDF, whose links are found by their names.
    ///
    /// They are taken as they are, but that cuRobo switches spheres off by a radius below 0: those are left out, with a
    /// [note](Self::notes). How far they stick out of the model's shapes is measured, and how much of those they leave
    /// uncovered, their [gap](SphereGroup::gap), by which a [`Checker`](crate::collision::Checker) grows them; where a link has no shapes, its spheres are its shape. Which of them are kept apart
    /// the model says, and of links without shapes there that they are not adjacent.
    ///
    /// # Errors
    /// A file that cannot be read, or a link that the model does not have.
    pub fn read(path: impl AsRef<Path>, model: &CollisionModel) -> Result<Self, ReadError> {
        read_with(path.as_ref(), LENGTH_LIMIT, |bytes, file| {
            Self::parse(bytes, file, model)
        })
    }

    /// Reads a file's bytes; `file` is its name, which says the format and stands in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8], file: &str, model: &CollisionModel) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let at = Place::Byte(error.valid_up_to());
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
            let fine = |ball: &Ball| {
                let numbers = ball.centre.to_array().into_iter().chain([ball.radius]);
                numbers.into_iter().all(|x| x.abs() <= LARGEST)
            };
            if let Some(index) = spheres.iter().position(|ball| !fine(ball)) {
                let problem =
                    format!("link `{name}`: sphere {index} has a number beyond {LARGEST:e} m");
                return Err(ReadError::of_file(file, problem));
            }
        }
        let mut groups = Vec::new();
        let mut overhang: f64 = 0.0;
        for (name, spheres) in named {
            if spheres.is_empty() {
                continue;
            }
            let found = model.model().frame(&name);
            let link = found.map_err(|error| invalid(file, error))?;
            let objects: Vec<_> = model.objects_of(link).collect();
            let solid = Solid::new(objects.iter().copied());
            let mut uncovered = 0.0;
            if !solid.is_empty() {
                uncovered = gap::gap(&objects, &spheres);
                let out = spheres
                    .iter()
                    .map(|s| s.radius + solid.signed_distance(s.centre));
                overhang = out.fold(overhang, f64::max);
            }
            groups.push(SphereGroup::new(link, &name, spheres).with_gap(uncovered));
        }
        groups.sort_by_key(|group| group.link);
        if let Some(twice) = groups.windows(2).find(|two| two[0].link == two[1].link) {
            let problem = format!("has the link `{}` twice", twice[0].name);
            return Err(ReadError::of_file(file, problem));
        }
        Ok(Self {
            pairs: pairs(model, &groups),
            groups,
            overhang,
            notes,
        })
    }
}

fn pairs(model: &CollisionModel, groups: &[SphereGroup]) -> Vec<[usize; 2]> {
    let links: Vec<FrameId> = groups.iter().map(|group| group.link).collect();
    let apart = pairs_apart(model.model(), &links);
    let known = |link: &FrameId| model.links().binary_search(link).is_ok();
    let mut pairs = Vec::new();
    for a in 0..links.len() {
        for b in a + 1..links.len() {
            let pair = [links[a], links[b]];
            let checked = match pair.iter().all(known) {
                true => model.pairs().binary_search(&pair).is_ok(),
                false => apart.binary_search(&pair).is_ok(),
            };
            if checked {
                pairs.push([a, b]);
            }
        }
    }
    pairs
}

/// The spheres of each link; other shapes than spheres are refused.
#[cfg(feature = "urdf")]
fn of_urdf(text: &str, file: &str) -> Result<NamedSpheres, ReadError> {
    let robot = crate::robot::Robot::reader().lenient().parse(text, file);
    let robot = robot.map_err(|error| invalid(file, error))?;
    // Its shapes are spheres: no file of a mesh is opened.
    let model = CollisionModel::builder(&robot).confined().build();
    let model = model.map_err(|error| invalid(file, error))?;
    let mut named: NamedSpheres = Vec::new();
    for &link in model.links() {
        let name = model.name_of(link);
        let mut spheres = Vec::new();
        for object in model.objects_of(link) {
            let ShapeKind::Sphere { radius } = *object.shape.kind() else {
                let problem = format!("link `{name}` has a collision shape that is no sphere");
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
    ReadError::new(file, Place::File, ReadProblem::invalid(error))
}
