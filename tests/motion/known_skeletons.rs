//! Promise: a capture's skeleton is recognised by its joints' names, with any prefix that exporters add, and by no
//! names that several skeletons share.

use kinopt::motion::retarget::KnownSkeleton;

fn known(names: impl IntoIterator<Item = String>) -> Option<&'static str> {
    let names: Vec<String> = names.into_iter().collect();
    KnownSkeleton::of_joints(&names).map(|known| known.name())
}

/// Names common to Mixamo's characters and CMU's captures.
const SHARED_NAMES: &str = "Hips Spine Spine1 Neck Head LeftUpLeg LeftLeg LeftFoot LeftToeBase RightUpLeg RightLeg RightFoot \
    RightToeBase LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm RightForeArm \
    RightHand";

#[test]
fn skeleton_is_recognised_by_its_unique_names() {
    let shared = || SHARED_NAMES.split(' ');
    let mixamo = || shared().chain(["Spine2", "HeadTop_End", "LeftHandThumb1"]);
    assert_eq!(known(mixamo().map(str::to_owned)), Some("mixamo"));
    assert_eq!(
        known(mixamo().map(|name| format!("mixamorig:{name}"))),
        Some("mixamo")
    );
    let cmu = || shared().chain(["LowerBack", "LHipJoint", "RHipJoint", "Neck1"]);
    assert_eq!(known(cmu().map(str::to_owned)), Some("cmu"));
    // All its parts, and no name of its own.
    assert_ne!(known(shared().map(str::to_owned)), Some("cmu"));
    // One part is missing.
    assert_eq!(
        known(cmu().filter(|name| *name != "RightHand").map(str::to_owned)),
        None
    );
}

#[test]
fn joint_lists_are_recognised_as_their_skeletons() {
    for name in KnownSkeleton::names() {
        let skeleton = KnownSkeleton::named(name).unwrap();
        if !skeleton.joints().is_empty() {
            assert_eq!(known(skeleton.joints().iter().cloned()), Some(name));
        }
    }
}
