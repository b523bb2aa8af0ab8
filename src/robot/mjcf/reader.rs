//! From a document to a robot.

use std::path::Path;

use super::attributes::Attributes;
use super::body::{Body, BodyReader};
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::equality::{self, Coupling};
use super::inertial::of_geoms;
use super::joint::{JointElement, Kind};
use super::mesh;
use super::names::{self, FreshNames, Names, WORLD};
use super::tree::Tree;
use crate::model::{
    BallLimits, FrameId, Joint, JointId, JointKind, Limits, Model, ModelBuilder, ModelError,
};
use crate::robot::closure::ClosureKind;
use crate::robot::xml::{Fault, Mended, Repair, RobotFileError};
use crate::robot::{Drive, Link, Mimic, Robot};
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// What MuJoCo calls a model without a name.
const NAMELESS: &str = "MuJoCo Model";

impl Robot {
    /// Reads an MJCF file, as MuJoCo's models are written in, with the files that it includes.
    ///
    /// Bodies and sites become frames under their names, the world's is `world`; an unnamed body is `body/ID` by
    /// MuJoCo's number, an unnamed joint or site BODY/hinge, BODY/site and so on, and a site with a body's name
    /// `site/NAME`. A configuration is MuJoCo's `qpos`: joints in the order of the document, a free joint as x, y, z
    /// and a quaternion w, x, y, z, a ball as its quaternion, `ref` counted in. A free joint NAME is `NAME/x`,
    /// `NAME/y`, `NAME/z` and `NAME/rotation`. Ranges are limits where MuJoCo has it so; MuJoCo limits a ball's whole
    /// angle, of which a cone about z and a twist of the same size are taken that together stay within it, with a
    /// note in [`repairs`](Self::repairs).
    ///
    /// Joints that an active linear `equality` couples follow; `connect` and `weld` are in
    /// [`closures`](Self::closures); others are left out with a note. `inertial`s, or the masses of geoms that
    /// need no mesh's file, are kept with the geoms ([`link`](Self::link)): those of groups 0 to 2 as visuals, those
    /// with a contact type as collisions, planes, height fields and ellipsoids not at all. `actuatorfrcrange` is
    /// the [`effort_limit`](Self::effort_limit). Masses are as they stand: `settotalmass`, `boundmass` and
    /// `balanceinertia` change none. Actuators, sensors, tendons and the like are not looked at.
    ///
    /// ```
    /// use kinopt::robot::Robot;
    ///
    /// let text = r#"<mujoco><worldbody><body name="arm" pos="0 0 1">
    ///   <joint name="hinge" axis="0 1 0" range="-90 90"/><site name="tip" pos="0.5 0 0"/>
    /// </body></worldbody></mujoco>"#;
    /// let robot = Robot::parse_mjcf(text, "arm.xml")?;
    /// assert_eq!(robot.model().degrees_of_freedom(), 1);
    /// assert!(robot.model().frame("tip").is_ok());
    /// # Ok::<(), kinopt::robot::RobotFileError>(())
    /// ```
    ///
    /// # Errors
    /// What is wrong with the file, with line and name: see [`RobotFileError`] and [`Fault`](super::Fault).
    pub fn read_mjcf(path: impl AsRef<Path>) -> Result<Self, RobotFileError> {
        robot(&Tree::read(path.as_ref())?)
    }

    /// Reads an MJCF document from memory; `file` is the name that errors give it, beside which files that it
    /// includes are looked for.
    ///
    /// # Errors
    /// As [`read_mjcf`](Self::read_mjcf).
    pub fn parse_mjcf(text: &str, file: &str) -> Result<Self, RobotFileError> {
        robot(&Tree::parse(text, file)?)
    }
}

/// An MJCF file as one document, with the files that it includes put in: what [`Robot::parse_mjcf`] needs no other
/// file for. Lines are no longer the file's.
///
/// # Errors
/// A file that cannot be read, is no XML, or includes itself.
pub fn mjcf_with_includes(path: impl AsRef<Path>) -> Result<String, RobotFileError> {
    Ok(Tree::read(path.as_ref())?.text())
}

fn robot(tree: &Tree) -> Result<Robot, RobotFileError> {
    let root = tree.root();
    if root.name() != "mujoco" {
        return Err(root.fault(Fault::NotMujoco));
    }
    let compiler = Compiler::read(root)?;
    let defaults = Defaults::read(root)?;
    let mut left_out = Vec::new();
    let meshes = mesh::read_all(root, &compiler, &defaults, &mut left_out);
    let mut reader = BodyReader {
        compiler: &compiler,
        defaults: &defaults,
        meshes: &meshes,
        left_out,
    };
    let bodies = reader.read(root)?;
    let mut left_out = reader.left_out;
    let equalities = equality::read_all(root, &defaults)?;

    let mut build = Build::new(root.text("model").unwrap_or(NAMELESS));
    build.add(&bodies)?;
    let mimics = build.couple(&equalities, &mut left_out)?;
    let Build {
        builder,
        names,
        drawn,
        drives,
        mut repairs,
        ..
    } = build;

    let unsound = |source| RobotFileError::Model {
        file: tree.file().to_owned(),
        source,
    };
    let model: Result<Model, ModelError> = builder.build();
    let mut robot = model
        .and_then(|model| Robot::new(model, mimics))
        .map_err(unsound)?;
    let placements = equality::as_drawn(&robot.model, &drawn);
    for equality in &equalities {
        let kind = match equality.tag.name() {
            "connect" => ClosureKind::Connect,
            "weld" => ClosureKind::Weld,
            _ => continue,
        };
        let closure = equality::closure(equality, kind, &names, &placements)?;
        robot.closures.push(closure);
    }
    robot.drives = drives;
    robot.links = bodies
        .into_iter()
        .map(|body| link(body, &compiler))
        .collect();
    repairs.extend(left_out.into_iter().filter_map(Repair::left_out));
    repairs.sort_by_key(|repair| repair.line);
    robot.repairs = repairs;
    Ok(robot)
}

/// A model as it grows, and what goes with it.
struct Build<'a> {
    builder: ModelBuilder,
    names: Names<'a>,
    /// The configuration in which the file draws the robot: MuJoCo's `qpos0`.
    drawn: Vec<f64>,
    drives: Vec<Drive>,
    repairs: Vec<Repair>,
}

/// What something stands on, and where.
type Stand = (Option<JointId>, Placement<f64>);

impl<'a> Build<'a> {
    fn new(name: &str) -> Self {
        Self {
            builder: Model::builder(name),
            names: Names::default(),
            drawn: Vec::new(),
            drives: Vec::new(),
            repairs: Vec::new(),
        }
    }

    /// Adds bodies, their joints and sites: the frames of bodies first, as links are counted by them.
    fn add(&mut self, bodies: &[Body<'a>]) -> Result<(), RobotFileError> {
        let [mut joint_names, mut frame_names] = names::given(bodies)?;
        let mut stands: Vec<Stand> = Vec::with_capacity(bodies.len());
        let mut called: Vec<String> = Vec::with_capacity(bodies.len());
        for (index, body) in bodies.iter().enumerate() {
            let parent = body.parent.and_then(|parent| stands.get(parent).copied());
            let (carrier, at) = parent.unwrap_or((None, Placement::identity()));
            let name = match (index, body.tag.text("name")) {
                (0, _) => WORLD.to_owned(),
                (_, Some(name)) => name.to_owned(),
                (index, None) => frame_names.fresh(format!("body/{index}")),
            };
            let mut stand = (carrier, at * body.parent_from_body);
            for joint in &body.joints {
                stand = self.joint(joint, stand, &name, &mut joint_names);
            }
            let frame = self.builder.frame(name.as_str(), stand.0, stand.1);
            self.names.add_body(body.tag, frame);
            stands.push(stand);
            called.push(name);
        }
        let of_bodies: std::collections::HashSet<&str> =
            called.iter().map(String::as_str).collect();
        for ((body, (carrier, at)), on) in bodies.iter().zip(&stands).zip(&called) {
            for site in &body.sites {
                let name = match site.tag.text("name") {
                    Some(name) if of_bodies.contains(name) => {
                        frame_names.fresh(format!("site/{name}"))
                    }
                    Some(name) => name.to_owned(),
                    None => frame_names.fresh(format!("{on}/site")),
                };
                let frame: FrameId = self
                    .builder
                    .frame(name, *carrier, *at * site.body_from_site);
                self.names.add_site(site.tag, frame);
            }
        }
        Ok(())
    }

    /// Adds a joint of a body that stands where the ones before it leave it.
    fn joint(
        &mut self,
        element: &JointElement<'a>,
        (carrier, at): Stand,
        body: &str,
        joint_names: &mut FreshNames,
    ) -> Stand {
        let name = match element.tag.text("name") {
            Some(name) => name.to_owned(),
            None => joint_names.fresh(format!("{body}/{}", element.kind.name())),
        };
        let anchored = at * Placement::translation(element.anchor);
        let axis = element.axis;
        let id = match element.kind {
            // MuJoCo has it where its numbers say; where the file draws it is how it begins.
            Kind::Free => {
                let Vector3 { x, y, z } = at.translation;
                let Quaternion { w, v } = Quaternion::from_matrix(&at.rotation);
                self.drawn.extend([x, y, z, w, v.x, v.y, v.z]);
                let room = [Limits::UNBOUNDED; 3];
                self.builder.free(name, None, Placement::identity(), room)
            }
            Kind::Ball => {
                self.drawn.extend([1.0, 0.0, 0.0, 0.0]);
                let limits = element
                    .range
                    .and_then(|range| self.cone(element, range.upper));
                self.builder.ball(name, carrier, anchored, axis, limits)
            }
            Kind::Slide | Kind::Hinge => {
                self.drawn.push(element.reference);
                let slides = element.kind == Kind::Slide;
                let unit = super::orientation::direction(axis).unwrap_or(axis);
                let turn = clean(-element.reference);
                let back = match slides {
                    true => Placement::translation(unit * -element.reference),
                    false => Placement::new(Matrix3::rotation(unit, turn), Vector3::zero()),
                };
                let limits = element.range.unwrap_or(Limits::UNBOUNDED);
                let kind = match slides {
                    true => JointKind::Prismatic,
                    false => JointKind::Continuous.within(&limits),
                };
                let joint = Joint::new(name, carrier, anchored * back, kind, axis, limits);
                self.builder.joint(joint)
            }
        };
        self.names.add_joint(element, id);
        self.drives.resize(id.index(), Drive::default());
        self.drives.push(Drive {
            effort: element.effort,
            ..Drive::default()
        });
        match element.kind {
            Kind::Free => (Some(id), Placement::identity()),
            _ => (Some(id), Placement::translation(-element.anchor)),
        }
    }

    /// A cone and a twist that together stay within a whole angle: cos ½angle = cos ½swing · cos ½twist.
    fn cone(&mut self, element: &JointElement<'_>, angle: f64) -> Option<BallLimits> {
        if angle >= std::f64::consts::PI {
            return None;
        }
        let cone = 2.0 * elementary::acos(elementary::cos(angle / 2.0).sqrt());
        self.repairs.push(Repair {
            line: element.tag.line(),
            element: element.tag.label(),
            mended: Mended::ConeWithin { angle, cone },
        });
        Some(BallLimits::cone(cone, Limits::new(-cone, cone)))
    }

    /// The joints that follow others; what couples them otherwise is left out.
    fn couple(
        &mut self,
        equalities: &[Attributes<'_>],
        left_out: &mut Vec<RobotFileError>,
    ) -> Result<Vec<Mimic>, RobotFileError> {
        let mut mimics = Vec::new();
        for equality in equalities {
            match equality.tag.name() {
                "joint" => {}
                "connect" | "weld" => continue,
                other => {
                    let element = other.to_owned();
                    left_out.push(equality.fault(Fault::UnsupportedElement { element }));
                    continue;
                }
            }
            let coupling: Result<Coupling, _> = equality::coupling(equality, &self.names);
            let taken = coupling.and_then(|coupling| {
                equality::take(equality, coupling, &mut mimics, &mut self.builder)
            });
            match taken {
                Err(RobotFileError::Element {
                    fault: Fault::NotLinear | Fault::FollowsAlready { .. },
                    ..
                }) => left_out.extend(taken.err()),
                other => other?,
            }
        }
        Ok(mimics)
    }
}

fn clean(angle: f64) -> (f64, f64) {
    crate::robot::xml::clean_sin_cos(angle)
}

/// What a body is made of.
fn link(body: Body<'_>, compiler: &Compiler) -> Link {
    let from_geoms = || of_geoms(&body.geoms);
    let inertial = match (compiler.inertia_from_geom, body.inertial) {
        (Some(true), _) => from_geoms(),
        (_, Some(inertial)) => Some(inertial),
        (Some(false), None) => None,
        // The world weighs nothing.
        (None, None) => body.parent.and_then(|_| from_geoms()),
    };
    let mut link = Link {
        inertial,
        ..Link::default()
    };
    for geom in body.geoms {
        let Some(shape) = geom.shape else { continue };
        if geom.collides {
            link.collisions.push(shape.clone());
        }
        if geom.is_visual {
            link.visuals.push(shape);
        }
    }
    link
}
