//! Promise: so it is for captures, for figures that movements are brought onto, for folders of movements, and for what of them is refused.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use kinopt::animation::Armature;
use kinopt::io::rig::Rig;
use kinopt::motion::retarget::{
    BodyMap, Capture, ContactDetection, FigureTarget, FootShapes, RetargetOptions, Retargeting,
    UpAxis,
};
use kinopt::motion::trajectory::Windows;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt_bindings::retarget_folder::{FolderQuestion, MovementFolder, QUESTION, unfinished};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};
use crate::walking_person::{BOXES, biped, capture};

/// Captures that are none, and what a fitting refuses.
fn refusals() -> Value {
    let mut digest = Digest::new();
    let names = |names: &[&str]| {
        names
            .iter()
            .map(|&name| name.to_owned())
            .collect::<Vec<_>>()
    };
    let ab = || names(&["a", "b"]);
    let (inf, far) = (f64::INFINITY, 2e12);
    for captured in [
        Capture::new(ab(), &[0.0; 6], 0.0),
        Capture::new(ab(), &[0.0; 6], f64::NAN),
        Capture::new(names(&["a", "a"]), &[0.0; 6], 1.0),
        Capture::new(ab(), &[0.0; 7], 1.0),
        Capture::new(ab(), &[], 1.0),
        Capture::new(vec![], &[0.0; 3], 1.0),
        Capture::new(
            ab(),
            &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, inf, 0.0, 0.0],
            1.0,
        ),
        Capture::new(ab(), &[0.0, far, 0.0, 0.0, 0.0, 0.0], 1.0),
        Capture::new(ab(), &[0.0, 1e12, 0.0, 0.0, 0.0, -1e12], 1.0),
        Capture::new(ab(), &[1.0; 12], 3.0),
    ] {
        match captured {
            Ok(captured) => {
                add_text(
                    &mut digest,
                    &format!(
                        "{captured:?} {} {:?} {:?}",
                        captured.frames(),
                        captured.frame(1),
                        captured.frame(2)
                    ),
                );
                add_text(
                    &mut digest,
                    &format!("{:?} {:?}", captured.joint("b"), captured.joint("c")),
                );
            }
            Err(error) => add_error(&mut digest, &error),
        }
    }
    let body = biped(BOXES[0], BOXES[1]);
    let walker = capture(2, false);
    let map = BodyMap::guess(&walker, body.model()).unwrap().map;
    for case in 0..14 {
        let (mut map, mut options) = (map.clone(), RetargetOptions::default());
        match case {
            0 => map.drives.clear(),
            1 => map.drives[0].joint = "nobody".to_owned(),
            2 => map.drives[0].frame = "nowhere".to_owned(),
            3 => map.drives[1].frame = map.drives[0].frame.clone(),
            4 => map.drives[1].weight = -1.0,
            5 => map.drives[1].scale = Some(0.0),
            6 => map.contacts = Some(vec!["nobody".to_owned()]),
            7 => options.landing_weight = 0.0,
            8 => options.acceleration = -1.0,
            9 => options.contacts = ContactDetection::default().with_speed(-1.0),
            10 => options.contacts = ContactDetection::default().with_height(f64::NAN),
            11 => options.contacts = ContactDetection::default().with_shortest(-1.0),
            12 => options.contacts = ContactDetection::default().with_lead(f64::INFINITY),
            _ => options.tolerance = -1.0,
        }
        match Retargeting::new(&body, &map, &walker, options) {
            Ok(retargeting) => add_text(
                &mut digest,
                &format!("{:?}", retargeting.whole().map(|found| found.q)),
            ),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

/// Movements on figures of either kind, and back as clips.
fn figures() -> Value {
    let mut digest = Digest::new();
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let steps = Capture::of_clip(&read.armature, &read.clip, 2.0).unwrap();
    for rate in [0.3, 0.0] {
        match Capture::of_clip(&read.armature, &read.clip, rate) {
            Ok(few) => add_text(&mut digest, &format!("{few:?}")),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    add_error(
        &mut digest,
        &Capture::of_clip(&read.armature, &read.clip, 1e9).unwrap_err(),
    );
    let turning = read.turning_bones();
    let own = Armature::of_skeleton(&rig.skeleton);
    let targets = [
        (FigureTarget::new(&rig.skeleton, UpAxis::Z).unwrap(), &own),
        (
            FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap(),
            &read.armature,
        ),
        (
            FigureTarget::of_armature(&read.armature, &turning, UpAxis::Z).unwrap(),
            &read.armature,
        ),
    ];
    for (figure, armature) in &targets {
        let model = figure.robot().model();
        let map = BodyMap::guess(&steps, model).unwrap();
        let options = RetargetOptions::default().with_up(UpAxis::Y);
        let retargeting = Retargeting::new(figure.robot(), &map.map, &steps, options).unwrap();
        add_text(
            &mut digest,
            &format!(
                "{:?} {:?} {:?}",
                figure.up(),
                retargeting.model_stands_along(),
                map.notes
            ),
        );
        let mut q = retargeting.per_frame().unwrap().q;
        digest.doubles(q.iter().copied());
        (5..7).for_each(|seed| q.extend(model.random_configuration(seed)));
        let clip = figure.clip("moved", armature, &q, 5.0).unwrap();
        for (bone, channel) in clip.channels(armature).unwrap() {
            add_text(&mut digest, &format!("{bone:?} {channel:?}"));
        }
        for (rate, q) in [(f64::NAN, &q[..]), (5.0, &[])] {
            add_error(
                &mut digest,
                &figure.clip("x", armature, q, rate).unwrap_err(),
            );
        }
    }
    let q = targets[0].0.robot().model().neutral();
    add_error(
        &mut digest,
        &targets[0].0.clip("x", &read.armature, &q, 5.0).unwrap_err(),
    );
    digest.value()
}

/// A folder's question as it is noted, and what of another is told.
fn folders() -> Value {
    let mut digest = Digest::new();
    let root = std::env::temp_dir().join(format!("kinopt-same-folders-{}", std::process::id()));
    let _ = fs::remove_dir_all(&root);
    let (from, into) = (root.join("from"), root.join("into"));
    fs::create_dir_all(from.join("deeper")).unwrap();
    for file in [
        "b.BVH",
        "a.npy",
        "deeper/c.glb",
        "deeper/d.gltf",
        ".hidden.bvh",
        "notes.txt",
        "z.fbx",
    ] {
        fs::write(from.join(file), "").unwrap();
    }
    let told = |error: &dyn std::fmt::Display| {
        error
            .to_string()
            .replace(&root.display().to_string(), "ROOT")
            .replace('\\', "/")
    };
    let name = |path: &Path| {
        path.strip_prefix(&root)
            .unwrap()
            .display()
            .to_string()
            .replace('\\', "/")
    };
    let biped = biped(BOXES[0], BOXES[1]);
    let other = biped_with_more(&biped);
    let map = BodyMap::from_json(
        "{\"joints\": [\"a\"], \"fps\": 30, \"up\": \"y\", \"drives\": {\"a\": \"pelvis\"}}",
        "",
    )
    .unwrap();
    let joints = ["a", "b"].map(str::to_owned);
    let own = RetargetOptions::default;
    let plain = FolderQuestion::new(&biped, own());
    let with = |options| FolderQuestion::new(&biped, options);
    let mut more = plain.clone();
    more.more.push("words".to_owned());
    let questions = [
        plain.clone(),
        plain.clone().with_map(&map),
        plain.clone().with_skeleton("smpl"),
        plain.clone().with_joints(&joints[..]),
        plain.clone().with_frame_rate(12.5),
        plain.clone().with_up(UpAxis::Y),
        plain.clone().with_clip("walk"),
        plain.clone().with_whole(true),
        plain.clone().with_keep_clear(0.02),
        plain.clone().with_world("{}".to_owned()),
        more,
        FolderQuestion::new(&other, own()),
        with(own().with_up(UpAxis::Y)),
        with(own().with_contacts(ContactDetection::default().with_speed(1.0))),
        with(own().with_contacts(ContactDetection::default().with_height(0.3))),
        with(own().with_contacts(ContactDetection::default().with_shortest(0.3))),
        with(own().with_contacts(ContactDetection::default().with_lead(0.3))),
        with(own().with_shapes(FootShapes::of(&biped))),
        with(own().with_landing_weight(2.0)),
        with(own().with_acceleration(1.0)),
        with(own().with_tolerance(0.5)),
        with(own().with_windows(Windows::new(3, 1))),
        with(own().with_windows(Windows::new(3, 1))).with_whole(true),
        plain
            .clone()
            .with_map(&map)
            .with_joints(&joints[..])
            .with_up(UpAxis::Z)
            .with_frame_rate(1.0),
    ];
    let folder = MovementFolder::find(&from, &into, "npz").unwrap();
    for question in &questions {
        let begun = folder.begin(question, true).unwrap();
        for movement in begun {
            add_text(
                &mut digest,
                &format!(
                    "{} {} {}",
                    name(&movement.source),
                    name(&movement.out),
                    movement.done_before
                ),
            );
        }
        // Not the version of the library.
        let text = fs::read_to_string(into.join(QUESTION)).unwrap();
        let text: Vec<&str> = text
            .lines()
            .filter(|line| !line.contains("\"kinopt\""))
            .collect();
        add_text(&mut digest, &text.join("\n"));
        for asked in &questions {
            add_text(
                &mut digest,
                &folder
                    .begin(asked, false)
                    .map_or_else(|error| told(&error), |begun| begun.len().to_string()),
            );
        }
    }
    fs::write(into.join(QUESTION), "nothing").unwrap();
    add_text(
        &mut digest,
        &told(&folder.begin(&plain, false).unwrap_err()),
    );
    let begun = folder.begin(&plain, true).unwrap();
    fs::write(&begun[1].out, "x").unwrap();
    fs::write(unfinished(&begun[2].out), "x").unwrap();
    add_text(&mut digest, &name(&unfinished(&begun[2].out)));
    for again in [false, true] {
        let done = folder.begin(&plain, again).unwrap().into_iter();
        add_text(
            &mut digest,
            &format!("{:?}", done.map(|own| own.done_before).collect::<Vec<_>>()),
        );
    }
    digest.word(unfinished(&begun[2].out).exists().into());
    fs::write(from.join("a.bvh"), "").unwrap();
    let empty = root.join("empty");
    fs::create_dir(&empty).unwrap();
    for (from, into, ending) in [
        (&from, &into, "npz"),
        (&empty, &into, "npz"),
        (&root.join("nowhere"), &into, "npz"),
        (&from, &from, "bvh"),
        (&from, &from, "csv"),
    ] {
        let found = MovementFolder::find(from, into, ending);
        add_text(
            &mut digest,
            &found.map_or_else(|error| told(&error), |_| "found".to_owned()),
        );
    }
    let _ = fs::remove_dir_all(&root);
    digest.value()
}

/// The same with a tool.
fn biped_with_more(biped: &Robot) -> Robot {
    let tool = Placement::translation(Vector3::new(0.1, 0.0, 0.0));
    biped.clone().with_tool("tool", "left_hand", tool).unwrap()
}

#[test]
fn of_figures_and_folders() {
    check(&[
        ("captures: what is refused", refusals()),
        ("figures that are moved", figures()),
        ("folders of movements", folders()),
    ]);
}
