//! Promise: knees and elbows of scenes and captures are hinges, which `kinopt info` lists and problem files change.

use std::fmt::Write;

use crate::forked_rig::*;

/// A bone with its offset from the parent, and its children.
struct Joint(&'static str, [f64; 3], Vec<Joint>);

fn leg(names: [&'static str; 4], side: f64) -> Joint {
    let [hip, knee, ankle, toe] = names;
    let toe = Joint(toe, [0.0, -8.0, 15.0], vec![]);
    let ankle = Joint(ankle, [0.0, -42.0, 0.0], vec![toe]);
    Joint(
        hip,
        [side, -5.0, 0.0],
        vec![Joint(knee, [0.0, -45.0, 0.0], vec![ankle])],
    )
}

fn arm(names: [&'static str; 3], side: f64) -> Joint {
    let [shoulder, elbow, hand] = names;
    let hand = Joint(hand, [26.0 * side, 0.0, 0.0], vec![]);
    Joint(
        shoulder,
        [18.0 * side, 12.0, 0.0],
        vec![Joint(elbow, [28.0 * side, 0.0, 0.0], vec![hand])],
    )
}

/// A capture of a person in a T-pose with straight limbs, centimetres, who faces z.
fn person() -> String {
    let arms = vec![
        arm(["LeftArm", "LeftForeArm", "LeftHand"], 1.0),
        arm(["RightArm", "RightForeArm", "RightHand"], -1.0),
    ];
    let hips = Joint(
        "Hips",
        [0.0, 100.0, 0.0],
        vec![
            leg(["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"], 10.0),
            leg(
                ["RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"],
                -10.0,
            ),
            Joint(
                "Spine",
                [0.0, 10.0, 0.0],
                vec![Joint("Chest", [0.0, 20.0, 0.0], arms)],
            ),
        ],
    );
    let (mut text, mut joints) = ("HIERARCHY\n".to_owned(), 0);
    add(&hips, "ROOT", &mut text, &mut joints);
    let zeros = vec!["0"; 3 * joints].join(" ");
    text + &format!("MOTION\nFrames: 1\nFrame Time: 0.1\n{zeros}\n")
}

fn add(
    Joint(name, [x, y, z], children): &Joint,
    kind: &str,
    text: &mut String,
    joints: &mut usize,
) {
    *joints += 1;
    let channels = "CHANNELS 3 Zrotation Xrotation Yrotation";
    writeln!(text, "{kind} {name}\n{{\nOFFSET {x} {y} {z}\n{channels}").unwrap();
    for child in children {
        add(child, "JOINT", text, joints);
    }
    if children.is_empty() {
        text.push_str("End Site\n{\nOFFSET 0 0 1\n}\n");
    }
    text.push_str("}\n");
}

#[test]
fn info_lists_guessed_hinges() {
    let folder = Folder::new("hinges-info");
    let file = folder.text("person.bvh", person());
    let info = answer!("info {file}");
    let hinges = list(&info["hinges"]);
    let bones: Vec<&str> = hinges.iter().map(|hinge| word(&hinge["bone"])).collect();
    assert_eq!(
        bones,
        ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"]
    );
    for (hinge, axis) in hinges
        .iter()
        .zip([[1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
    {
        let found = numbers(&hinge["axis"]);
        assert!((found[0] - axis[0]).abs() < 1e-9 && (found[1] - axis[1]).abs() < 1e-9);
        assert_eq!(hinge["source"], "body direction");
    }
    says!(text!("info {file}") => "LeftLeg about 1.000 0.000 0.000, 0.0 to 150.0 degrees");
}

#[test]
fn straight_knees_bend_forward() {
    let folder = Folder::new("hinges-knees");
    let file = folder.text("person.bvh", person());
    for target in ["10,40,20", "15,30,-20", "30,40,10", "-10,50,30"] {
        let solved = answer!("solve {file} --target LeftFoot={target}");
        assert_eq!(solved["reached"], true, "{target}");
        let q = numbers(&solved["q"]);
        // Twist, bend and twist of LeftLeg, the third bone.
        assert!(q[7] > 0.1, "{target}: {}", q[7]);
        assert_eq!((q[6], q[8]), (0.0, 0.0));
    }
}

#[test]
fn problem_files_change_hinges() {
    let folder = Folder::new("hinges-changed");
    let file = folder.text("person.bvh", person());
    let target = "--target LeftFoot=10,40,20";
    let stiff = "@model.hinges={\"LeftLeg\":{\"axis\":[1,0,0],\"range\":[0,5]}}";
    let solved = answer!("solve {file} {target} '{stiff}'");
    assert_eq!(solved["reached"], false);
    let free = answer!("solve {file} {target} @model.hinges=none");
    assert_eq!(free["reached"], true);
    let unknown = "@model.hinges={\"Knee\":{\"axis\":[1,0,0],\"range\":[0,5]}}";
    refused!("solve {file} {target} '{unknown}'" => 1, "`Knee` | LeftLeg");
    refused!("solve ../models/universal_ur5e.urdf --target flange=0.3,0.2,0.4 @model.hinges=none" => 2, "`hinges`");
}

#[test]
fn vrm_files_are_scenes() {
    let folder = Folder::new("hinges-vrm");
    let file = folder.file("tube.vrm");
    std::fs::copy("../tests/animation/gltf/compressed/tube-draco.glb", &file).unwrap();
    assert_eq!(answer!("info {file}")["kind"], "scene");
    let out = folder.file("bent.vrm");
    answer!("animate {file} --fps 8 --clip-name again --into {out}");
    assert_eq!(list(&answer!("info {out}")["clips"]).len(), 2);
}
