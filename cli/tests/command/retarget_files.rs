//! Promise: `retarget` reads arrays, motion capture, clips of scenes and keyframes of rigs, and guesses a missing map
//! from names. It writes tables for humanoid learning, and figures as .bvh and .glb that move like the source.

use crate::forked_rig::*;

fn humanoid() -> String {
    model("humanoid/humanoid.json")
}

fn text(path: &str) -> String {
    std::fs::read_to_string(path).unwrap()
}

fn json(path: &str) -> serde_json::Value {
    serde_json::from_str(&text(path)).unwrap()
}

pub(crate) fn rows(path: &str) -> Vec<Vec<f64>> {
    let text = text(path);
    let row = |line: &str| {
        line.split(',')
            .map(|number| number.parse().unwrap())
            .collect()
    };
    text.lines().map(row).collect()
}

#[test]
fn rig_keyframes_are_retargeted_by_names() {
    let folder = Folder::new("retarget-by-names");
    let (rig, robot) = (humanoid(), model("aldebaran_nao.urdf"));
    let out = folder.file("walk.json");
    let run = kinopt!("retarget {rig} {robot} --base-joint free --fps 10 --out {out}");
    assert_eq!(run.status.code(), Some(0));
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "--print-map");
    let guessed = json(&out);
    let run = kinopt!("retarget {rig} {robot} --base-joint free --fps 10 --up y --print-map");
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "--up z changes it");
    // The printed map, saved and given again, gives the same result.
    let printed = kinopt!("retarget {rig} {robot} --base-joint free --fps 10 --print-map");
    let printed = String::from_utf8(printed.stdout).unwrap();
    let both = folder.file("both.json");
    let run = kinopt!("retarget {rig} {robot} --base-joint free --fps 10 --print-map --out {both}");
    assert_eq!(String::from_utf8(run.stdout).unwrap(), printed);
    assert_eq!(json(&both), guessed);
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "frames, 10 per second");
    assert_eq!(
        messages.matches("parts are driven").count(),
        1,
        "{messages}"
    );
    // Frames of 0.033333 s.
    let steps = model("captures/steps.bvh");
    let out_of_steps = folder.file("steps.npz");
    let run = kinopt!("retarget {steps} {robot} --base-joint free --out {out_of_steps}");
    let messages = String::from_utf8(run.stdout).unwrap();
    says!(messages => "181 frames, 30 per second");
    let saved = folder.file("map.json");
    let _ = kinopt!("retarget {rig} {robot} --base-joint free --fps 10 --save-map {saved}");
    assert_eq!(text(&saved), printed);
    says!(printed => "\"left_thigh\": \"left_thigh\" | left_shank");
    let _ = answer!("retarget {rig} {robot} --map {saved} --base-joint free --fps 10 --out {out}");
    assert_eq!(json(&out), guessed);
    assert_eq!(guessed["fps"], 10.0);
}

#[test]
fn csv_table_has_the_learning_format() {
    let folder = Folder::new("retarget-csv");
    let (rig, robot) = (humanoid(), model("aldebaran_nao.urdf"));
    let (csv, out) = (folder.file("walk.csv"), folder.file("walk.json"));
    let command = format!("retarget {rig} {robot} --base-joint free --fps 5");
    let _ = answer!("{command} --out {csv}");
    let _ = answer!("{command} --out {out}");
    let q = json(&out);
    for (row, q) in rows(&csv).iter().zip(list(&q["q"])) {
        let q: Vec<f64> = list(q)
            .iter()
            .map(|number| number.as_f64().unwrap())
            .collect();
        // The quaternion w, x, y, z is written as x, y, z, w.
        assert_eq!(
            (&row[..3], &row[3..6], row[6], &row[7..]),
            (&q[..3], &q[4..7], q[3], &q[7..])
        );
    }
    let _ = answer!("{command} --header --out {csv}");
    assert!(text(&csv).starts_with("time,root_joint/x,"));
}

/// Mean direction error of all limbs, degrees.
fn mean_direction_error(report: &serde_json::Value) -> f64 {
    let limbs = list(&report["score"]["limbs"]);
    let means = limbs
        .iter()
        .map(|limb| limb["angle"]["mean"].as_f64().unwrap());
    means.sum::<f64>() / limbs.len() as f64
}

#[test]
fn figures_move_as_the_source() {
    let folder = Folder::new("retarget-figures");
    let rig = humanoid();
    let (glb, bvh) = (folder.file("walk.glb"), folder.file("walk.bvh"));
    for out in [&glb, &bvh] {
        let report = answer!("retarget {rig} {rig} --fps 10 --out {out}");
        // Retargeting of a rig to itself.
        assert!(mean_direction_error(&report) < 5.0, "{report}");
    }
    // A written file, read again, moves the rig equally. Both formats have y up.
    let named = "humanoid";
    for (source, options) in [
        (&glb, format!("--clip {named} --fps 10")),
        (&bvh, String::new()),
    ] {
        let again = folder.file("again.json");
        let report = answer!("retarget {source} {rig} {options} --out {again}");
        assert!(mean_direction_error(&report) < 5.0, "{source}: {report}");
    }
    // A scene's file gets one more clip, in its own axes.
    let more = folder.file("more.glb");
    let report = answer!("retarget {bvh} {glb} --fps 10 --out {more}");
    assert!(mean_direction_error(&report) < 5.0, "{report}");
    let info = answer!("info {more}");
    assert_eq!(list(&info["clips"]).len(), 2);
    // The output is upright with y up, although the rig has z up.
    for file in [&glb, &bvh] {
        let placed = answer!("fk {file} --frame left_foot --frame head");
        let up = |frame: &str| placed["frames"][frame]["position"][1].as_f64().unwrap();
        assert!(up("head") - up("left_foot") > 1.0, "{file}: {placed}");
    }
}

#[test]
fn map_of_another_robot_is_completed_by_names() {
    let folder = Folder::new("retarget-map-of-another");
    let (rig, robot) = (humanoid(), model("aldebaran_nao.urdf"));
    let (map, out) = (folder.file("map.json"), folder.file("walk.json"));
    std::fs::write(
        &map,
        r#"{"fps": 10, "drives": {"g1.urdf": {"pelvis": "torso"}}}"#,
    )
    .unwrap();
    let run = kinopt!("retarget {rig} {robot} --map {map} --base-joint free --fps 10 --out {out}");
    let messages = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(0), "{messages}");
    says!(messages => "humanoid.json: the map drives no frame of the target, so drives are guessed from names");
    let guessed = folder.file("guessed.json");
    let _ = answer!("retarget {rig} {robot} --base-joint free --fps 10 --out {guessed}");
    assert_eq!(json(&out), json(&guessed));
}

#[test]
fn array_of_a_known_skeleton_needs_only_its_name() {
    let folder = Folder::new("retarget-smpl");
    let names = 24;
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (2, {names}, 3), }}");
    bytes.extend(format!("{header:<117}\n").bytes());
    for _ in 0..2 {
        for joint in 0..names {
            let at = [
                0.01 * f64::from(joint),
                0.02 * f64::from(joint),
                1.0 - 0.03 * f64::from(joint),
            ];
            bytes.extend(at.iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    let source = folder.file("poses.npy");
    std::fs::write(&source, bytes).unwrap();
    let (rig, out) = (humanoid(), folder.file("poses.npz"));
    let report = answer!("retarget {source} {rig} --map smpl --fps 30 --out {out}");
    assert_eq!(report["frames"], 2);
    let command = format!("retarget {source} {rig} --fps 30 --out {out}x.npz");
    refused!("{command} --map lafan1" => 1, "does not fit the skeleton lafan1");
    refused!("{command} --map smpk" => 2, "did you mean `smpl`");
    refused!("{command}" => 1, "names of its 24 joints are missing");
    assert!(!std::path::Path::new(&format!("{out}x.npz")).exists());
}

#[test]
fn capture_without_frames_writes_no_file() {
    let folder = Folder::new("retarget-no-frames");
    let (bvh, out) = (folder.file("empty.bvh"), folder.file("empty.json"));
    let robot = model("aldebaran_nao.urdf");
    let joint =
        "OFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n";
    let empty =
        format!("HIERARCHY\nROOT Hips\n{{\n{joint}}}\nMOTION\nFrames: 0\nFrame Time: 0.1\n");
    std::fs::write(&bvh, empty).unwrap();
    refused!("retarget {bvh} {robot} --base-joint free --out {out}" => 1, "empty.bvh | no frames");
    assert!(!std::path::Path::new(&out).exists());
}

/// Subject that sways over both feet, upright along z in the file.
const Z_UP: &str = "HIERARCHY
ROOT Hips
{
OFFSET 0 0 90
CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
JOINT LeftFoot
{
OFFSET 15 0 -90
CHANNELS 3 Zrotation Yrotation Xrotation
End Site
{
OFFSET 0 -10 0
}
}
JOINT RightFoot
{
OFFSET -15 0 -90
CHANNELS 3 Zrotation Yrotation Xrotation
End Site
{
OFFSET 0 -10 0
}
}
}
MOTION
Frames: 9
Frame Time: 0.0333333
0 0 90 0 0 0 0 0 0 0 0 0
1 0 90 0 0 0 0 0 0 0 0 0
2 0 90 0 0 0 0 0 0 0 0 0
1 0 90 0 0 0 0
";

#[test]
fn capture_upright_along_z_is_taken_upright() {
    let folder = Folder::new("retarget-z-up");
    let robot = model("aldebaran_nao.urdf");
    let source = folder.file("sway.bvh");
    std::fs::write(&source, Z_UP).unwrap();
    let [detected, given, other] =
        ["detected", "given", "other"].map(|name| folder.file(&format!("{name}.json")));
    let run = kinopt!("retarget {source} {robot} --base-joint free --out {detected}");
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "detected from the body; --up y selects the other axis | after 3 whole frames of 9");
    let run = kinopt!("retarget {source} {robot} --base-joint free --up z --out {given}");
    let messages = String::from_utf8(run.stderr).unwrap();
    assert!(!messages.contains("up axis"), "{messages}");
    assert_eq!(json(&detected), json(&given));
    let run = kinopt!("retarget {source} {robot} --base-joint free --up y --out {other}");
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "the body is upright along z, but the up axis is y");
    assert_ne!(json(&other), json(&given));
}

#[test]
fn solved_pose_of_a_capture_keeps_its_channels() {
    let folder = Folder::new("solve-channels");
    let source = folder.file("sway.bvh");
    std::fs::write(&source, Z_UP).unwrap();
    let out = folder.file("posed.bvh");
    let run = kinopt!("solve {source} --target LeftFoot/tip=15,-12,1 --out {out}");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let channels = |text: &str| {
        let lines = text.lines().map(str::trim);
        let channels = lines.filter(|line| line.starts_with("CHANNELS"));
        channels.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(channels(&text(&out)), channels(Z_UP));
}
