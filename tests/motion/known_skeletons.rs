//! Promise: a capture's skeleton is known by its joints' names: the exporters' own, with what they write before them, and none by
//! names that several have.

use kinopt::motion::retarget::KnownSkeleton;

fn known(names: impl IntoIterator<Item = String>) -> Option<&'static str> {
    let names: Vec<String> = names.into_iter().collect();
    KnownSkeleton::of_joints(&names).map(|known| known.name())
}

/// What Mixamo's characters and CMU's captures call alike.
const SHARED: [&str; 21] = [
    "Hips",
    "Spine",
    "Spine1",
    "Neck",
    "Head",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightShoulder",
    "RightArm",
    "RightForeArm",
    "RightHand",
];

#[test]
fn a_skeleton_is_known_by_what_it_alone_has() {
    let shared = || SHARED.into_iter();
    let mixamo = || shared().chain(["Spine2", "HeadTop_End", "LeftHandThumb1"]);
    assert_eq!(known(mixamo().map(str::to_owned)), Some("mixamo"));
    assert_eq!(
        known(mixamo().map(|name| format!("mixamorig:{name}"))),
        Some("mixamo")
    );
    let cmu = || shared().chain(["LowerBack", "LHipJoint", "RHipJoint", "Neck1"]);
    assert_eq!(known(cmu().map(str::to_owned)), Some("cmu"));
    // All its parts, and nothing that is its own.
    assert_ne!(known(shared().map(str::to_owned)), Some("cmu"));
    // One part is missing.
    assert_eq!(
        known(cmu().filter(|name| *name != "RightHand").map(str::to_owned)),
        None
    );
}

#[test]
fn joints_of_arrays_are_their_skeletons_own() {
    for name in KnownSkeleton::names() {
        let skeleton = KnownSkeleton::named(name).unwrap();
        if !skeleton.joints().is_empty() {
            assert_eq!(known(skeleton.joints().iter().cloned()), Some(name));
        }
    }
}
