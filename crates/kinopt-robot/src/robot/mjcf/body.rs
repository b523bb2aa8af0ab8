//! `<worldbody>` and the bodies, frames, joints, sites and geoms in it.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::geom::{self, Geom};
use super::inertial;
use super::joint::{self, JointElement, JointType};
use super::mesh::Mesh;
use super::orientation::placement;
use super::segment;
use super::tree::Tag;
use crate::robot::Inertial;
use crate::robot::xml::{ParseIssue, Read, RobotFileError};
use kinopt_kinematics::spatial::Placement;

/// Elements that create bodies or joints and that the reader does not support.
const UNSUPPORTED: [&str; 4] = ["replicate", "attach", "composite", "flexcomp"];

/// A body and the elements fixed to it.
#[derive(Clone, Debug)]
pub(super) struct BodyElement<'a> {
    pub(super) tag: Tag<'a>,
    /// Index of the parent body; `None` for the world.
    pub(super) parent: Option<usize>,
    pub(super) parent_from_body: Placement<f64>,
    pub(super) joints: Vec<JointElement<'a>>,
    pub(super) sites: Vec<Site<'a>>,
    pub(super) geoms: Vec<Geom<'a>>,
    pub(super) inertial: Option<Inertial>,
}

/// A site: a named pose on a body.
#[derive(Clone, Debug)]
pub(super) struct Site<'a> {
    pub(super) tag: Tag<'a>,
    pub(super) body_from_site: Placement<f64>,
}

/// Reader of bodies, with the elements that it left out.
pub(super) struct BodyReader<'r, 'a> {
    pub(super) compiler: &'r Compiler,
    pub(super) defaults: &'r Defaults<'a>,
    pub(super) meshes: &'r HashMap<String, Mesh>,
    /// Faults of elements that no joint depends on.
    pub(super) left_out: Vec<RobotFileError>,
}

/// An element whose contents belong to a body, its pose in the body, and the default class that applies in it.
type PendingElement<'a> = (Tag<'a>, Placement<f64>, Option<&'a str>);

impl<'a> BodyReader<'_, 'a> {
    /// All bodies in MuJoCo's order: the world first, parents before children.
    pub(super) fn read(&mut self, root: Tag<'a>) -> Read<Vec<BodyElement<'a>>> {
        let mut worlds: Vec<PendingElement<'a>> = Vec::new();
        for world in root.children_named("worldbody") {
            worlds.push((world, Placement::identity(), world.text("childclass")));
        }
        let first = worlds.first().map_or(root, |(world, ..)| *world);
        let mut bodies = Vec::new();
        // Body element, its contents, index of the parent, pose in the parent.
        let mut pending = vec![(first, worlds, None, Placement::identity())];
        while let Some((tag, contents, parent, parent_from_body)) = pending.pop() {
            let index = bodies.len();
            let mut body = BodyElement {
                tag,
                parent,
                parent_from_body,
                joints: Vec::new(),
                sites: Vec::new(),
                geoms: Vec::new(),
                inertial: None,
            };
            let mut children = Vec::new();
            self.fill(&mut body, contents, &mut children)?;
            check_free(&body)?;
            bodies.push(body);
            let children = children.into_iter().rev();
            pending.extend(children.map(
                |(contents, parent_from_child): (PendingElement<'a>, _)| {
                    (contents.0, vec![contents], Some(index), parent_from_child)
                },
            ));
        }
        Ok(bodies)
    }

    /// Reads the elements of a body, also those within `<frame>`, and lists the child bodies.
    fn fill(
        &mut self,
        body: &mut BodyElement<'a>,
        mut contents: Vec<PendingElement<'a>>,
        children: &mut Vec<(PendingElement<'a>, Placement<f64>)>,
    ) -> Read<()> {
        contents.reverse();
        let mut pending: Vec<(Tag<'a>, Placement<f64>, Option<&'a str>)> = Vec::new();
        while let Some((container, body_from_container, class)) = contents.pop() {
            pending.extend(
                container
                    .children()
                    .rev()
                    .map(|child| (child, body_from_container, class)),
            );
            while let Some((child, body_from_child, class)) = pending.pop() {
                self.child(
                    body,
                    (child, body_from_child, class),
                    &mut pending,
                    children,
                )?;
            }
        }
        Ok(())
    }

    fn child(
        &mut self,
        body: &mut BodyElement<'a>,
        (child, body_from_frame, class): PendingElement<'a>,
        pending: &mut Vec<PendingElement<'a>>,
        children: &mut Vec<(PendingElement<'a>, Placement<f64>)>,
    ) -> Read<()> {
        match child.name() {
            "body" => {
                let body_from_child = body_from_frame
                    * placement(&Attributes::without_defaults(child), self.compiler)?;
                let class = child.text("childclass").or(class);
                self.defaults.class(child, class)?;
                children.push(((child, Placement::identity(), class), body_from_child));
            }
            "frame" => {
                let body_from_child = body_from_frame
                    * placement(&Attributes::without_defaults(child), self.compiler)?;
                let class = child.text("childclass").or(class);
                self.defaults.class(child, class)?;
                pending.extend(
                    child
                        .children()
                        .rev()
                        .map(|inner| (inner, body_from_child, class)),
                );
            }
            "joint" | "freejoint" => {
                let joint =
                    joint::read(child, self.compiler, self.defaults, class, &body_from_frame)?;
                body.joints.push(joint);
            }
            "site" => {
                let site = Attributes::of(child, self.defaults, class)?;
                let frame_from_site = match segment::read(&site)? {
                    Some(segment) => segment.placement,
                    None => placement(&site, self.compiler)?,
                };
                let body_from_site = body_from_frame * frame_from_site;
                body.sites.push(Site {
                    tag: child,
                    body_from_site,
                });
            }
            "geom" => {
                let context = (self.compiler, self.defaults, self.meshes);
                match geom::read(child, context, class, &body_from_frame) {
                    Ok(geom) => {
                        self.left_out.extend(geom.missing_shape());
                        body.geoms.push(geom);
                    }
                    Err(error) => self.left_out.push(error),
                }
            }
            "inertial" => match inertial::read(child, self.compiler) {
                Ok(inertial) => body.inertial = Some(inertial),
                Err(error) => self.left_out.push(error),
            },
            name if UNSUPPORTED.contains(&name) => {
                let element = name.to_owned();
                return Err(child.fault(ParseIssue::UnsupportedElement { element }));
            }
            _ => {}
        }
        Ok(())
    }
}

fn check_free(body: &BodyElement<'_>) -> Read<()> {
    let free = body
        .joints
        .iter()
        .find(|joint| joint.kind == JointType::Free);
    match free {
        Some(joint) if body.joints.len() > 1 || body.parent != Some(0) => {
            Err(joint.tag.fault(ParseIssue::MisplacedFreeJoint))
        }
        _ => Ok(()),
    }
}
