//! Conversion of an MJCF document to a robot.

use std::path::Path;

use super::body::{BodyElement, BodyReader};
use super::build::Build;
use super::compiler::Compiler;
use super::contact;
use super::defaults::Defaults;
use super::equality;
use super::inertial::BodyInertia;
use super::inertias;
use super::loops;
use super::mesh;
use super::passive;
use super::tree::ElementTree;
use crate::robot::xml::{ParseIssue, Read, Repair, RobotFileError, root_name};
use crate::robot::{Link, Robot};
use kinopt_kinematics::model::ModelBuilder;

/// MuJoCo's default name of a model.
const DEFAULT_NAME: &str = "MuJoCo Model";

impl Robot {
    /// Reads an MJCF file, the format of MuJoCo's models, with the files that it includes.
    ///
    /// # Frames and names
    ///
    /// Bodies and sites become frames under their names; the world body is `world`. An unnamed body is `body/ID` with
    /// MuJoCo's body id. An unnamed joint or site is named after its body, for example BODY/hinge or BODY/site. A site
    /// with the name of a body is `site/NAME`.
    ///
    /// # Joints
    ///
    /// A configuration is MuJoCo's `qpos`: joints in the order of the document, with `ref` included. A free joint has
    /// x, y, z and a quaternion w, x, y, z; a ball joint has a quaternion. A free joint NAME becomes `NAME/x`,
    /// `NAME/y`, `NAME/z` and `NAME/rotation`. Ranges are limits if MuJoCo enforces them. The limit of a ball joint
    /// bounds its [rotation angle](kinopt_kinematics::model::BallLimits::angle). An angle of π or more is no limit; larger angles
    /// give a note. `actuatorfrcrange` is the [`effort_limit`](Self::effort_limit).
    ///
    /// An active linear joint `equality` makes a mimic joint. Mimic joints do not restrict their source joints unless
    /// [`with_mimic_limits`](Self::with_mimic_limits) is called. `connect` and `weld` become
    /// [`loops`](kinopt_kinematics::model::Model::loops) of the model. An unnamed loop is BODY/connect or BODY/weld after its first
    /// body. Constraints to a `mocap` body, which is a target, and other relations are left out with a note.
    ///
    /// # Shapes and contacts
    ///
    /// Geoms are stored in the [`link`](Self::link). Those of groups 0 to 2 are visuals; those with contact bits are
    /// collision shapes. Planes are no link shapes, but moving links avoid collisions with them. Height fields are left
    /// out with a note. Enabled collision pairs follow MuJoCo's rules: contact bits, `exclude`, `pair`, and no
    /// collisions with the parent unless it is fixed to the world.
    ///
    /// # Masses
    ///
    /// Masses come from `inertial`, or from geoms that need no mesh file. `inertiafromgeom`, `inertiagrouprange` and
    /// `settotalmass` are supported. `boundmass`, `boundinertia` and `balanceinertia` are ignored.
    ///
    /// The reader does not open mesh files. A body without `inertial` that has a mesh has no known centre of mass, and
    /// no known mass unless the geom states it. [`repairs`](Self::repairs) lists such bodies and
    /// [`Link::left_to_meshes`] says what is unknown. [`masses`](Self::masses) returns an error if a joint moves one of
    /// them. Actuators and fixed tendons are read only for the [passive joints](Self::passive_joints). Sensors and
    /// other elements are ignored.
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
    /// A fault of the file, with line and element: see [`RobotFileError`] and [`ParseIssue`].
    pub fn read_mjcf(path: impl AsRef<Path>) -> Result<Self, RobotFileError> {
        Self::mjcf_reader().read(path)
    }

    /// Reads an MJCF document from memory. `file` is the path for error messages; included files are resolved relative
    /// to its folder.
    ///
    /// # Errors
    /// As [`read_mjcf`](Self::read_mjcf).
    pub fn parse_mjcf(text: &str, file: &str) -> Result<Self, RobotFileError> {
        Self::mjcf_reader().parse(text, file)
    }

    /// Returns true for the text of an MJCF document: its root element is `mujoco`.
    #[must_use]
    pub fn is_mjcf(text: &str) -> bool {
        root_name(text) == Some("mujoco")
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
    /// Confines the robot to the folder of its file: it includes only files below that folder, and is
    /// [confined](Robot::confined).
    #[must_use]
    pub fn confined(mut self) -> Self {
        self.confined = true;
        self
    }

    /// Reads a file.
    ///
    /// # Errors
    /// As [`Robot::read_mjcf`]; of a confined robot an included file that is elsewhere.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Robot, RobotFileError> {
        let path = path.as_ref();
        let robot = robot(&ElementTree::read(path, self.confined)?)?.with_file(path);
        Ok(self.confining(robot))
    }

    /// Reads a document from memory. `file` is its path, used in error messages and to resolve included files.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(&self, text: &str, file: &str) -> Result<Robot, RobotFileError> {
        let robot = robot(&ElementTree::parse(text, file, self.confined)?)?;
        Ok(self.confining(robot))
    }

    /// The text of a file with its included files inserted; [`parse`](Self::parse) needs no other file for it. With
    /// includes, line numbers differ from those of the file.
    ///
    /// # Errors
    /// The file cannot be read, is not XML, or includes itself. Also an included file outside the folder of a confined
    /// robot.
    pub fn text_with_includes(&self, path: impl AsRef<Path>) -> Result<String, RobotFileError> {
        ElementTree::text_with_includes(path.as_ref(), self.confined)
    }

    fn confining(&self, robot: Robot) -> Robot {
        match self.confined {
            true => robot.confined(),
            false => robot,
        }
    }
}

fn robot(tree: &ElementTree) -> Read<Robot> {
    let root = tree.root();
    if root.name() != "mujoco" {
        return Err(root.fault(ParseIssue::NotMujoco));
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

    let mut build = Build::new(root.text("model").unwrap_or(DEFAULT_NAME));
    build.add(&bodies)?;
    let mimics = build.couple(&equalities, &mut left_out)?;
    let model_error = |source| RobotFileError::Model {
        file: tree.file().to_owned(),
        source,
    };
    let mut model = build.builder.build().map_err(model_error)?;
    let (names, reference_configuration) = (&build.names, &build.reference_configuration);
    let loops = loops::read_all(
        &equalities,
        &bodies,
        names,
        &model,
        reference_configuration,
        &mut left_out,
    )?;
    if !loops.is_empty() {
        let mut builder = ModelBuilder::from_model(&model);
        loops.into_iter().for_each(|closed| builder.close(closed));
        model = builder.build().map_err(model_error)?;
    }
    let mut robot = Robot::new(model, mimics).map_err(model_error)?;
    robot.passive = passive::joints(root, names, &robot);
    robot.drives = build.drives;
    let mut range_notes = build.notes;
    for (mimic, kind) in robot.mimics_beyond_range() {
        let index = (robot.mimics().iter()).position(|other| other.joint == mimic);
        if let Some((line, element)) = index.and_then(|index| build.couplings.get(index)) {
            range_notes.push(Repair {
                line: *line,
                element: element.clone(),
                mended: kind,
            });
        }
    }
    robot.contacts = Some(contact::read(root, &bodies, &mut left_out));
    let (inertias, notes) = inertias::compute_inertias(&bodies, &compiler);
    let bodies = bodies.into_iter().zip(inertias);
    robot.links = bodies.map(|(body, inertia)| link(body, inertia)).collect();
    let repairs = left_out.into_iter().filter_map(Repair::left_out);
    robot.repairs = repairs.chain(notes).chain(range_notes).collect();
    robot.repairs.sort_by_key(|repair| repair.line);
    Ok(robot)
}

/// Shapes and inertia of a body.
fn link(body: BodyElement<'_>, inertia: BodyInertia) -> Link {
    let mut link = Link::default();
    match inertia {
        BodyInertia::Nothing => {}
        BodyInertia::Known(inertial) => link.inertial = Some(inertial),
        BodyInertia::Missing(missing) => link.left_to_meshes = Some(missing),
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
