//! Promise: `retarget` reads motions of SMPL-H as AMASS has them, with rest joints of the file, of a body model or of a
//! default skeleton.

use kinopt_bindings::trajectory_file::{Column, npz};

use crate::forked_rig::*;

const FRAMES: usize = 12;
const JOINTS: usize = 52;

/// Axis-angle vectors of a standing person in AMASS' axes, z up, that lifts the left arm.
fn poses() -> Vec<f64> {
    let mut poses = vec![0.0; FRAMES * 3 * JOINTS];
    for (frame, pose) in poses.chunks_exact_mut(3 * JOINTS).enumerate() {
        // The T-pose has y up: a rotation by 90° about x puts it upright.
        pose[0] = std::f64::consts::FRAC_PI_2;
        // Left shoulder about z, hanging at first.
        pose[3 * 16 + 2] = -1.4 + 0.1 * frame as f64;
        pose[3 * 17 + 2] = 1.4;
    }
    poses
}

fn translations() -> Vec<f64> {
    [0.0, 0.0, 0.92].repeat(FRAMES)
}

type Extra<'a> = (&'a str, &'a [usize], Column<'a>);

fn amass(folder: &Folder, name: &str, extra: &[Extra<'_>]) -> String {
    let (poses, trans, gender) = (poses(), translations(), ["neutral".to_owned()]);
    let mut arrays: Vec<Extra<'_>> = vec![
        ("poses", &[FRAMES, 3 * JOINTS], Column::Numbers(&poses)),
        ("trans", &[FRAMES, 3], Column::Numbers(&trans)),
        ("mocap_framerate", &[], Column::Numbers(&[30.0])),
        ("gender", &[], Column::Words(&gender)),
        ("betas", &[2], Column::Numbers(&[1.0, 0.5])),
    ];
    arrays.extend_from_slice(extra);
    let path = folder.file(name);
    std::fs::write(&path, npz(&arrays).unwrap()).unwrap();
    path
}

#[test]
fn amass_motion_is_retargeted() {
    let folder = Folder::new("smpl");
    let (robot, out) = (model("aldebaran_nao.urdf"), folder.file("out.npz"));
    let source = amass(&folder, "wave.npz", &[]);
    let command = format!("{robot} --base-joint free --out {out}");
    let (text, messages) = crate::forked_rig::succeeds(&format!("retarget {source} {command}"));
    says!(messages => "a default skeleton of 1.7 m is used | the joints' names of smpl");
    says!(text => "12 frames, 30 per second");
    let report = answer!("retarget {source} {command}");
    let limb = |report: &serde_json::Value, name: &str| {
        let limbs = list(&report["score"]["limbs"]).to_vec();
        let limb = limbs.into_iter().find(|limb| limb["limb"] == name).unwrap();
        limb["angle"]["mean"].as_f64().unwrap()
    };
    // An upright subject with hanging arms: a wrong axis would be 90° away.
    assert!(
        limb(&report, "left_thigh") < 15.0 && limb(&report, "right_upper_arm") < 25.0,
        "{report}"
    );
    // Rest joints of the file give no note.
    let rest: Vec<f64> = (0..JOINTS)
        .flat_map(|joint| [0.01 * joint as f64, 0.02, 0.0])
        .collect();
    let source = amass(
        &folder,
        "rest.npz",
        &[("jtr", &[JOINTS, 3], Column::Numbers(&rest))],
    );
    let (_, messages) = crate::forked_rig::succeeds(&format!("retarget {source} {command}"));
    assert!(!messages.contains("default skeleton"), "{messages}");
    // Directories of AMASS have .npz files that are no motions.
    let shape = folder.file("shape.npz");
    let betas = Column::Numbers(&[0.0]);
    std::fs::write(&shape, npz(&[("betas", &[1], betas)]).unwrap()).unwrap();
    refused!("retarget {shape} {command}" => 1, "no array named `trans`; valid names: betas");
}

#[test]
fn body_model_of_another_family_is_rejected() {
    let folder = Folder::new("smpl-model");
    let (robot, out) = (model("aldebaran_nao.urdf"), folder.file("out.npz"));
    let source = amass(&folder, "wave.npz", &[]);
    let body = folder.file("body.npz");
    let arrays: [Extra<'_>; 3] = [
        (
            "J_regressor",
            &[2, 2],
            Column::Numbers(&[1.0, 0.0, 0.0, 1.0]),
        ),
        ("v_template", &[2, 3], Column::Numbers(&[0.0; 6])),
        ("shapedirs", &[2, 3, 1], Column::Numbers(&[0.0; 6])),
    ];
    std::fs::write(&body, npz(&arrays).unwrap()).unwrap();
    let command = format!("retarget {source} {robot} --base-joint free --out {out}");
    refused!("{command} --body-model {body}" => 1, "2 joints, but the motion is of SMPL-H with 52");
    refused!("{command} --body-model -1" => 1, "the height is -1 m");
    let (_, messages) = crate::forked_rig::succeeds(&format!("{command} --body-model 1.8"));
    says!(messages => "a default skeleton of 1.8 m");
}
