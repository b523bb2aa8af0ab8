//! From a document to a robot.

use std::path::Path;

use super::body::{Body, BodyReader};
use super::build::Build;
use super::compiler::Compiler;
use super::contact;
use super::defaults::Defaults;
use super::equality;
use super::inertial::Weighed;
use super::loops;
use super::mesh;
use super::passive;
use super::tree::Tree;
use super::weights;
use crate::model::ModelBuilder;
use crate::robot::xml::{Fault, Read, Repair, RobotFileError};
use crate::robot::{Link, Robot};

/// What MuJoCo calls a model without a name.
const NAMELESS: &str = "MuJoCo Model";

impl Robot {
    /// Reads an MJCF file, as MuJoCo's models are written in, with the files that it includes.
    ///
    /// Bodies and sites become frames under their names, the world's is `world`; an unnamed body is `body/ID` by
    /// MuJoCo's number, an unnamed joint or site BODY/hinge, BODY/site and so on, and a site with a body's name
    /// `site/NAME`. A configuration is MuJoCo's `qpos`: joints in the order of the document, a free joint as x, y, z
    /// and a quaternion w, x, y, z, a ball as its quaternion, `ref` counted in. A free joint NAME is `NAME/x`,
    /// `NAME/y`, `NAME/z` and `NAME/rotation`. Ranges are limits where MuJoCo has it so; a ball's limits
    /// its whole [angle](crate::model::BallLimits::angle), of which half a turn and more is no limit; of more there is a note.
    ///
    /// Joints that an active linear `equality` couples follow, and do not restrict the joint that they follow unless
    /// [`with_mimic_limits`](Self::with_mimic_limits) is called; `connect` and `weld` are
    /// [`loops`](crate::model::Model::loops) of the model, unnamed ones BODY/connect and BODY/weld by their first body;
    /// those to a `mocap` body, which is a target, and other relations are left out with a note. `inertial`s, or the masses of geoms that
    /// need no mesh's file, are kept with the geoms ([`link`](Self::link)): those of groups 0 to 2 as visuals, those
    /// with contact bits as collisions. Planes are no link's shapes, but what moves is kept over them; height fields are left out with a note. Which links
    /// touch is as in MuJoCo: bits, `exclude`, `pair`, and parents but those that stand in the world. `actuatorfrcrange` is
    /// the [`effort_limit`](Self::effort_limit). `inertiafromgeom`, `inertiagrouprange` and `settotalmass` count; `boundmass`,
    /// `boundinertia` and `balanceinertia` change nothing. A mesh's file is not opened, so a body without `inertial` that
    /// has one has no known centre, nor a mass where the geom states none: [`repairs`](Self::repairs) names it,
    /// [`Link::left_to_meshes`] says which, and [`masses`](Self::masses) is an error if a joint moves it. Actuators, sensors, tendons and the like are not looked at.
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
    /// What is wrong with the file, with line and name: see [`RobotFileError`] and [`Fault`].
    pub fn read_mjcf(path: impl AsRef<Path>) -> Result<Self, RobotFileError> {
        Self::mjcf_reader().read(path)
    }

    /// Reads an MJCF document from memory; `file` is the name that errors give it, beside which files that it
    /// includes are looked for.
    ///
    /// # Errors
    /// As [`read_mjcf`](Self::read_mjcf).
    pub fn parse_mjcf(text: &str, file: &str) -> Result<Self, RobotFileError> {
        Self::mjcf_reader().parse(text, file)
    }

    /// Reads MJCF with options.
    #[must_use]
    pub fn mjcf_reader() -> MjcfReader {
        MjcfReader::default()
    }
}

/// Reads MJCF with options.
///
/// ```
/// use kinopt::robot::Robot;
///
/// let text = "<mujoco><worldbody><body name='hand'/></worldbody></mujoco>";
/// let robot = Robot::mjcf_reader().confined().parse(text, "hand.xml")?;
/// assert!(robot.is_confined());
/// # Ok::<(), kinopt::robot::RobotFileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct MjcfReader {
    confined: bool,
}

impl MjcfReader {
    setters! {
        /// Confines the robot to the folder of its file: it includes only files below that folder, and is
        /// [confined](Robot::confined).
        pub fn confined(mut self) { self.confined = true }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// As [`Robot::read_mjcf`]; of a confined robot an included file that is elsewhere.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Robot, RobotFileError> {
        let path = path.as_ref();
        let robot = robot(&Tree::read(path, self.confined)?)?.with_file(path);
        Ok(self.confining(robot))
    }

    /// Reads a document from memory; `file` is the name that errors give it, beside which files that it includes are looked for.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(&self, text: &str, file: &str) -> Result<Robot, RobotFileError> {
        let robot = robot(&Tree::parse(text, file, self.confined)?)?;
        Ok(self.confining(robot))
    }

    /// A file as one document, with the files that it includes put in: [`parse`](Self::parse) needs no other file for it. If the file
    /// includes any, lines are no longer those of the file.
    ///
    /// # Errors
    /// A file that cannot be read, is no XML, or includes itself; of a confined robot an included file that is elsewhere.
    pub fn text_with_includes(&self, path: impl AsRef<Path>) -> Result<String, RobotFileError> {
        Tree::text_with_includes(path.as_ref(), self.confined)
    }

    fn confining(&self, robot: Robot) -> Robot {
        match self.confined {
            true => robot.confined(),
            false => robot,
        }
    }
}

fn robot(tree: &Tree) -> Read<Robot> {
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
    let unsound = |source| RobotFileError::Model {
        file: tree.file().to_owned(),
        source,
    };
    let mut model = build.builder.build().map_err(unsound)?;
    let (names, drawn) = (&build.names, &build.drawn);
    let loops = loops::read_all(&equalities, &bodies, names, &model, drawn, &mut left_out)?;
    if !loops.is_empty() {
        let mut builder = ModelBuilder::from_model(&model);
        loops.into_iter().for_each(|closed| builder.close(closed));
        model = builder.build().map_err(unsound)?;
    }
    let mut robot = Robot::new(model, mimics).map_err(unsound)?;
    robot.passive = passive::joints(root, names, &robot);
    robot.drives = build.drives;
    let mut ranges = build.notes;
    for (mimic, mended) in robot.mimics_beyond_range() {
        let at = (robot.mimics().iter()).position(|own| own.joint == mimic);
        if let Some((line, element)) = at.and_then(|at| build.couplings.get(at)) {
            ranges.push(Repair {
                line: *line,
                element: element.clone(),
                mended,
            });
        }
    }
    robot.contacts = Some(contact::read(root, &bodies, &mut left_out));
    let (weights, notes) = weights::weigh(&bodies, &compiler);
    let bodies = bodies.into_iter().zip(weights);
    robot.links = bodies.map(|(body, weight)| link(body, weight)).collect();
    let repairs = left_out.into_iter().filter_map(Repair::left_out);
    robot.repairs = repairs.chain(notes).chain(ranges).collect();
    robot.repairs.sort_by_key(|repair| repair.line);
    Ok(robot)
}

/// What a body is made of.
fn link(body: Body<'_>, weight: Weighed) -> Link {
    let mut link = Link::default();
    match weight {
        Weighed::Nothing => {}
        Weighed::Known(inertial) => link.inertial = Some(inertial),
        Weighed::Left(left) => link.left_to_meshes = Some(left),
    }
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
