//! Promise: an output folder holds the results of one request, whatever program began it. Finished files are kept,
//! unfinished ones are removed, and differences between requests are named.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use kinopt::motion::retarget::{BodyMap, RetargetOptions, UpAxis};
use kinopt::robot::{BaseJoint, Robot};
use kinopt_bindings::retarget_folder::{FolderError, FolderSettings, MotionFolder, unfinished};
use support::arms::floating_nao;
use support::fault_tables::ExpectedError;

/// Folders of a test, removed at its end.
struct Folders(PathBuf);

impl Folders {
    fn new(name: &str) -> Self {
        let root = std::env::temp_dir().join(format!("kinopt-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        fs::create_dir_all(root.join("from/deeper")).unwrap();
        for file in ["one.bvh", "deeper/two.npy", ".hidden.bvh", "notes.txt"] {
            fs::write(root.join("from").join(file), "").unwrap();
        }
        Self(root)
    }

    fn source(&self) -> PathBuf {
        self.0.join("from")
    }

    fn out(&self) -> PathBuf {
        self.0.join("into")
    }

    fn find(&self) -> MotionFolder {
        MotionFolder::find(&self.source(), &self.out(), "npz").unwrap()
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The reported differences between a request and the one with which the folder was begun.
fn differs(folders: &Folders, begun: &FolderSettings<'_>, query: &FolderSettings<'_>) -> String {
    folders.find().begin(begun, true).unwrap();
    match folders.find().begin(query, false) {
        Ok(_) => String::new(),
        Err(FolderError::OtherQuestion { differs, .. }) => differs.join(", "),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn finished_files_are_kept_and_partial_ones_removed() {
    let folders = Folders::new("folder-done");
    let robot = floating_nao();
    let query = FolderSettings::new(&robot, RetargetOptions::default());
    let begun = folders.find().begin(&query, false).unwrap();
    let outs = begun
        .iter()
        .map(|movement| movement.out.strip_prefix(folders.out()).unwrap());
    assert!(outs.eq(["deeper/two.npz", "one.npz"].map(Path::new)));
    assert!(begun.iter().all(|movement| !movement.done_before));
    fs::write(&begun[0].out, "whole").unwrap();
    fs::write(unfinished(&begun[1].out), "half").unwrap();
    let done = |again: bool| {
        let begun = folders.find().begin(&query, again).unwrap();
        begun
            .iter()
            .map(|movement| movement.done_before)
            .collect::<Vec<_>>()
    };
    assert_eq!(done(false), [true, false]);
    assert!(!unfinished(&begun[1].out).exists());
    assert_eq!(done(true), [false, false]);
    // Its source is newer now.
    let source = fs::File::options()
        .write(true)
        .open(&begun[0].source)
        .unwrap();
    let later = SystemTime::now() + Duration::from_secs(60);
    source.set_modified(later).unwrap();
    assert_eq!(done(false), [false, false]);
}

/// Options in a map equal the same options outside of it.
#[test]
fn equal_requests_are_equal_however_stated() {
    let folders = Folders::new("folder-question");
    let robot = floating_nao();
    let drives = "{\"hips\": \"torso\", \"foot\": \"left_sole\"}";
    let all = format!(
        "{{\"joints\": [\"hips\", \"foot\"], \"fps\": 30, \"up\": \"y\", \"drives\": {drives}}}"
    );
    let all = BodyMap::from_json(&all, "").unwrap();
    let alone = BodyMap::from_json(&format!("{{\"drives\": {drives}}}"), "").unwrap();
    let joints = ["hips", "foot"].map(str::to_owned);
    let plain = FolderSettings::new(&robot, RetargetOptions::default());
    let by_map = plain.clone().with_map(&all);
    let changed = plain.clone().with_map(&alone).with_joints(&joints[..]);
    let changed = changed.with_frame_rate(30.0).with_up(UpAxis::Y);
    assert_eq!(differs(&folders, &by_map, &changed), "");
    assert_eq!(differs(&folders, &by_map, &plain), "fps, joints, map, up");
}

#[test]
fn differences_between_requests_are_named() {
    let folders = Folders::new("folder-another");
    let robot = floating_nao();
    let plain = FolderSettings::new(&robot, RetargetOptions::default());
    let mut others = Vec::new();
    for (name, change) in [
        (
            "whole",
            (|request| request.whole = true) as fn(&mut FolderSettings<'_>),
        ),
        ("clip", |request| request.clip = Some("Walk")),
        ("skeleton", |request| request.skeleton = Some("cmu")),
        ("keep_clear", |request| request.keep_clear = Some(0.01)),
        ("world", |request| request.world = Some("{}".to_owned())),
        ("acceleration", |request| {
            request.options.acceleration = 1e-3
        }),
        ("contact_speed", |request| {
            request.options.contacts.speed = 0.2
        }),
        ("contact_height", |request| {
            request.options.contacts.height = 0.1
        }),
        ("windows", |request| request.options.windows.ahead = 20),
        ("more", |request| request.more.push("header".to_owned())),
    ] {
        let mut other = plain.clone();
        change(&mut other);
        others.push((name, other));
    }
    for (name, other) in &others {
        assert_eq!(differs(&folders, &plain, other), *name);
        assert_eq!(differs(&folders, other, other), "", "{name}");
    }
    // Robots whose head rotates less or more slowly or is higher, and one with larger hands.
    let text = fs::read_to_string("../models/aldebaran_nao.urdf").unwrap();
    for (old, new) in [
        ("upper=\"2.0857\"", "upper=\"2\""),
        ("velocity=\"0\"", "velocity=\"1\""),
        ("0 0 0.1265", "0 0 0.1275"),
        ("sphere radius=\"0.028\"", "sphere radius=\"0.029\""),
    ] {
        assert!(text.contains(old), "{old}");
        let text = text.replacen(old, new, 1);
        let changed = Robot::reader().parse(&text, "changed.urdf").unwrap();
        let changed = changed.with_base_joint(BaseJoint::FREE).unwrap();
        let other = FolderSettings::new(&changed, RetargetOptions::default());
        assert_eq!(differs(&folders, &plain, &other), "target", "{new}");
    }
}

/// A folder whose request is missing or invalid is left unchanged.
#[test]
fn folder_without_a_valid_request_is_rejected() {
    let folders = Folders::new("folder-lost");
    let robot = floating_nao();
    let query = FolderSettings::new(&robot, RetargetOptions::default());
    fs::create_dir_all(folders.out()).unwrap();
    for text in ["", "[1]", "{\"kinopt\": "] {
        fs::write(folders.out().join("retarget.json"), text).unwrap();
        let half = folders.out().join(".part.one.npz");
        fs::write(&half, "half").unwrap();
        folders
            .find()
            .begin(&query, false)
            .says("has results of other settings");
        assert!(half.exists());
    }
}

#[test]
fn written_files_are_never_read_as_motions() {
    let folders = Folders::new("folder-itself");
    let from = folders.source();
    let refused = MotionFolder::find(&from, &from, "bvh").unwrap_err();
    assert!(
        matches!(refused, FolderError::IntoItself { .. }),
        "{refused}"
    );
    assert!(MotionFolder::find(&from, &from, "npz").is_ok());
    // A subfolder: existing files in it are no motions of the folder.
    let into = from.join("deeper");
    let robot = floating_nao();
    let query = FolderSettings::new(&robot, RetargetOptions::default());
    let found = MotionFolder::find(&from, &into, "bvh").unwrap();
    let begun = found.begin(&query, false).unwrap();
    assert_eq!(begun.len(), 1);
    assert_eq!(begun[0].out, into.join("one.bvh"));
}

/// Methods and fields set the same options.
#[test]
fn builder_methods_set_their_fields() {
    let folders = Folders::new("folder-said");
    let robot = floating_nao();
    let plain = FolderSettings::new(&robot, RetargetOptions::default());
    let request = || plain.clone();
    for (name, changed_query) in [
        ("clip", request().with_clip("Walk")),
        ("skeleton", request().with_skeleton("cmu")),
        ("keep_clear", request().with_keep_clear(0.01)),
        ("world", request().with_world("{}".to_owned())),
        ("whole", request().with_whole(true)),
        ("fps", request().with_frame_rate(30.0)),
        ("up", request().with_up(UpAxis::Y)),
    ] {
        assert_eq!(differs(&folders, &plain, &changed_query), name);
    }
}
