//! Names of bodies, joints and sites, and generated names for those without one.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::body::BodyElement;
use super::joint::JointElement;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};
use kinopt_kinematics::model::{FrameId, JointId, UnknownName};

/// MuJoCo's name of the world body.
pub(super) const WORLD: &str = "world";

/// A joint that equalities can refer to.
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedJoint {
    pub(super) id: JointId,
    pub(super) is_scalar: bool,
    pub(super) reference: f64,
}

/// Named elements of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct ElementNames<'a> {
    joints: HashMap<&'a str, NamedJoint>,
    bodies: HashMap<&'a str, FrameId>,
    sites: HashMap<&'a str, FrameId>,
}

impl<'a> ElementNames<'a> {
    pub(super) fn add_joint(&mut self, element: &JointElement<'a>, id: JointId) {
        if let Some(name) = element.tag.text("name") {
            let joint = NamedJoint {
                id,
                is_scalar: element.kind.is_scalar(),
                reference: element.reference,
            };
            self.joints.insert(name, joint);
        }
    }

    pub(super) fn add_body(&mut self, tag: Tag<'a>, id: FrameId) {
        let name = match tag.name() {
            "body" => tag.text("name"),
            _ => Some(WORLD),
        };
        self.bodies.extend(name.map(|name| (name, id)));
    }

    pub(super) fn add_site(&mut self, tag: Tag<'a>, id: FrameId) {
        let name = tag.text("name");
        self.sites.extend(name.map(|name| (name, id)));
    }

    /// Id of the joint of a name.
    pub(super) fn joint_named(&self, name: &str) -> Option<JointId> {
        self.joints.get(name).map(|joint| joint.id)
    }

    /// The named frames of a body and of its sites.
    pub(super) fn frames_of(&self, body: &BodyElement<'_>) -> Vec<FrameId> {
        let sites = body.sites.iter().filter_map(|site| site.tag.text("name"));
        let sites = sites.filter_map(|name| self.sites.get(name));
        let body_frame = body.tag.text("name").and_then(|name| self.bodies.get(name));
        body_frame.into_iter().chain(sites).copied().collect()
    }

    pub(super) fn joint(&self, element: &Attributes<'_>, name: &str) -> Read<NamedJoint> {
        look_up(&self.joints, "joint", element, name)
    }

    pub(super) fn body(&self, element: &Attributes<'_>, name: &str) -> Read<FrameId> {
        look_up(&self.bodies, "body", element, name)
    }

    pub(super) fn site(&self, element: &Attributes<'_>, name: &str) -> Read<FrameId> {
        look_up(&self.sites, "site", element, name)
    }
}

fn look_up<T: Copy>(
    by_name: &HashMap<&str, T>,
    kind: &'static str,
    element: &Attributes<'_>,
    name: &str,
) -> Read<T> {
    by_name.get(name).copied().ok_or_else(|| {
        let mut valid: Vec<&str> = by_name.keys().copied().collect();
        valid.sort_unstable();
        element.fault(UnknownName::new(kind, name, valid).into())
    })
}

/// Generator of unique names, for elements without a name and for sites named like a body.
#[derive(Clone, Debug, Default)]
pub(super) struct FreshNames {
    /// Names in use, each with the last number that was appended to it.
    used: HashMap<String, usize>,
}

impl FreshNames {
    /// Returns the name, or the first of NAME/2, NAME/3, … that is not in use.
    pub(super) fn fresh(&mut self, name: String) -> String {
        let mut number = self.used.get(&name).copied().unwrap_or(0);
        let mut fresh = name.clone();
        while self.used.contains_key(&fresh) {
            number += 1;
            fresh = format!("{name}/{}", number + 1);
        }
        self.used.insert(name, number);
        self.used.insert(fresh.clone(), number);
        fresh
    }

    /// Marks a name as used.
    pub(super) fn reserve(&mut self, name: &str) {
        self.used.insert(name.to_owned(), 0);
    }
}

/// The names that the file gives to joints, and to bodies and sites. Returns an error for a repeated name.
pub(super) fn file_names(bodies: &[BodyElement<'_>]) -> Read<[FreshNames; 2]> {
    let [mut joints, mut frames] = [FreshNames::default(), FreshNames::default()];
    let joint_tags = bodies
        .iter()
        .flat_map(|body| body.joints.iter().map(|joint| joint.tag));
    let body_tags = bodies.iter().map(|body| body.tag);
    let site_tags = bodies
        .iter()
        .flat_map(|body| body.sites.iter().map(|site| site.tag));
    check_unique(joint_tags, &mut joints, None)?;
    check_unique(body_tags.skip(1), &mut frames, Some(WORLD))?;
    check_unique(site_tags, &mut frames, None)?;
    Ok([joints, frames])
}

fn check_unique<'a>(
    tags: impl Iterator<Item = Tag<'a>>,
    names: &mut FreshNames,
    reserved: Option<&'a str>,
) -> Read<()> {
    let mut lines: HashMap<&str, u32> = reserved.into_iter().map(|name| (name, 1)).collect();
    for tag in tags {
        let Some(name) = tag.text("name") else {
            continue;
        };
        if let Some(first_line) = lines.insert(name, tag.line()) {
            return Err(tag.fault(ParseIssue::DuplicateName { first_line }));
        }
        names.reserve(name);
    }
    Ok(())
}
