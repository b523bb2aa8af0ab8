//! `<contact>` and the contact bits of geoms: enabled collision pairs.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::body::BodyElement;
use super::geom::Geom;
use super::names::WORLD;
use super::tree::Tag;
use crate::robot::contacts::{ContactBody, ContactPlane, Contacts};
use crate::robot::xml::{ParseIssue, Read, RobotFileError};
use kinopt_kinematics::model::UnknownName;

/// Reads the contacts of a document. Faulty or unsupported elements go to `left_out`.
pub(super) fn read(
    root: Tag<'_>,
    bodies: &[BodyElement<'_>],
    left_out: &mut Vec<RobotFileError>,
) -> Contacts {
    let mut contacts = Contacts {
        bodies: Vec::with_capacity(bodies.len()),
        includes_parents: includes_parents(root),
        ..Contacts::default()
    };
    for (index, body) in bodies.iter().enumerate() {
        let weld_of = |index: usize| contacts.bodies.get(index).map_or(0, |body| body.weld);
        let parent_weld = body.parent.map_or(0, weld_of);
        let (weld, weld_parent) = match (body.parent, body.joints.is_empty()) {
            (Some(parent), true) => {
                let parent_body = contacts.bodies.get(parent);
                (parent_weld, parent_body.map_or(0, |body| body.weld_parent))
            }
            _ => (index, parent_weld),
        };
        let shapes = body.geoms.iter().filter(|geom| geom.is_collision());
        contacts.bodies.push(ContactBody {
            weld,
            weld_parent,
            bits: shapes.map(|geom| geom.bits).collect(),
        });
        for geom in &body.geoms {
            if let (Some(body_from_plane), true) = (geom.body_from_plane, geom.collides) {
                contacts.planes.push(ContactPlane {
                    name: geom.tag.label().replacen("geom", "plane", 1),
                    body: index,
                    body_from_plane,
                    bits: geom.bits,
                    paired: Vec::new(),
                });
            }
        }
    }
    let (body_names, geom_names) = (body_names(bodies), geom_names(bodies));
    let sections = root.children_named("contact");
    for tag in sections.flat_map(|section| section.children()) {
        let result = match tag.name() {
            "exclude" => exclude(tag, &body_names, &mut contacts),
            "pair" => pair(tag, &geom_names, &mut contacts),
            _ => Ok(()),
        };
        left_out.extend(result.err());
    }
    contacts
}

/// Reads `<option><flag filterparent="disable"/></option>`.
fn includes_parents(root: Tag<'_>) -> bool {
    let options = root.children_named("option");
    let mut flags = options.flat_map(|option| option.children_named("flag"));
    flags.any(|flag| flag.text("filterparent") == Some("disable"))
}

/// Body indices by name.
fn body_names<'b>(bodies: &'b [BodyElement<'_>]) -> HashMap<&'b str, usize> {
    let names = bodies.iter().enumerate().filter_map(|(index, body)| {
        let name = match index {
            0 => Some(WORLD),
            _ => body.tag.text("name"),
        };
        Some((name?, index))
    });
    names.collect()
}

/// Geoms by name, each with the index of its body.
fn geom_names<'b, 'd>(bodies: &'b [BodyElement<'d>]) -> HashMap<&'b str, (usize, &'b Geom<'d>)> {
    let geoms = bodies.iter().enumerate().flat_map(|(index, body)| {
        let geoms = body.geoms.iter();
        geoms.filter_map(move |geom| Some((geom.tag.text("name")?, (index, geom))))
    });
    geoms.collect()
}

fn exclude(tag: Tag<'_>, names: &HashMap<&str, usize>, contacts: &mut Contacts) -> Read<()> {
    let [a, b] = [
        named(tag, "body1", "body", names)?,
        named(tag, "body2", "body", names)?,
    ];
    contacts.excluded.push([a.min(b), a.max(b)]);
    Ok(())
}

/// Enables the collisions of the bodies of a geom pair, or of a body and a plane.
fn pair(
    tag: Tag<'_>,
    geoms: &HashMap<&str, (usize, &Geom<'_>)>,
    contacts: &mut Contacts,
) -> Read<()> {
    let [a, b] = [
        named(tag, "geom1", "geom", geoms)?,
        named(tag, "geom2", "geom", geoms)?,
    ];
    let ignored = |why| Err(tag.fault(ParseIssue::PairNotKept { why }));
    if contacts.bodies[a.0].weld == contacts.bodies[b.0].weld {
        return ignored("the two bodies are rigidly connected");
    }
    for ((body, geom), (other, other_geom)) in [(a, b), (b, a)] {
        if geom.body_from_plane.is_some() && other_geom.is_collision() {
            let plane_name = geom.tag.label().replacen("geom", "plane", 1);
            let mut planes = contacts.planes.iter_mut();
            if let Some(plane) = planes.find(|plane| plane.body == body && plane.name == plane_name)
            {
                plane.paired.push(other);
                return Ok(());
            }
        }
    }
    if !a.1.is_collision() || !b.1.is_collision() {
        return ignored("one of the two has no contact bits, or no shape");
    }
    contacts.paired.push([a.0.min(b.0), a.0.max(b.0)]);
    Ok(())
}

fn named<T: Copy>(
    tag: Tag<'_>,
    attribute: &'static str,
    kind: &'static str,
    by_name: &HashMap<&str, T>,
) -> Read<T> {
    let name = tag.text(attribute);
    let name = name.ok_or_else(|| tag.fault(ParseIssue::MissingAttribute { attribute }))?;
    by_name.get(name).copied().ok_or_else(|| {
        let mut valid: Vec<&str> = by_name.keys().copied().collect();
        valid.sort_unstable();
        Attributes::without_defaults(tag).fault(UnknownName::new(kind, name, valid).into())
    })
}
