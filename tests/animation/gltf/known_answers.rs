//! Promise: a posed scene agrees with its glTF file. The expected values are computed here by 4×4 matrices and the
//! formulas of the specification, independent of the library.

use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};
use kinopt::animation::Pose;
use kinopt::io::gltf::{Note, Scene, ScenePosing};
use kinopt::skinning::SkinningMethod;
use support::fault_tables::ExpectedError;
use support::gltf_text::{Numbers, at};

fn posed(scene: &Scene, pose: &Pose) -> Vec<Vec3> {
    let mut posing = ScenePosing::new(scene, SkinningMethod::LinearBlend).unwrap();
    posing.mesh(pose).unwrap().positions().to_vec()
}

fn close(ours: &[Vec3], expected: &[DVec3], within: f64) {
    assert_eq!(ours.len(), expected.len());
    for (vertex, (a, b)) in ours.iter().zip(expected).enumerate() {
        assert!(
            a.as_dvec3().distance(*b) <= within,
            "vertex {vertex}: {a} instead of {b}"
        );
    }
}

/// Two joints, the upper one bound at another position than at rest, and a scaled root. The children precede their
/// parents in the file.
struct TwoJoints {
    vertices: Vec<[f32; 3]>,
    weights: Vec<[f32; 4]>,
    bound: [DMat4; 2],
}

impl TwoJoints {
    fn new() -> Self {
        let turned = DMat4::from_rotation_translation(
            DQuat::from_rotation_x(0.3),
            DVec3::new(0.1, -1.0, 0.2),
        );
        Self {
            vertices: vec![
                [0.0, 0.0, 0.0],
                [0.5, 1.0, 0.0],
                [0.0, 2.0, 0.5],
                [1.0, 1.5, -1.0],
            ],
            weights: vec![
                [1.0, 0.0, 0.0, 0.0],
                [0.5, 0.5, 0.0, 0.0],
                [0.25, 0.75, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
            ],
            bound: [DMat4::IDENTITY, turned],
        }
    }

    fn file(&self) -> (Numbers, String) {
        let mut numbers = Numbers::default();
        let positions = numbers.floats(&self.vertices);
        let joints = numbers.shorts(&[[0, 1, 0, 9_999]; 4]);
        let weights = numbers.floats(&self.weights);
        let bound = self.bound.map(|m| m.as_mat4().to_cols_array());
        let bound = numbers.floats(&bound);
        let indices = numbers.shorts(&[[0], [1], [2], [1], [3], [2]]);
        let times = numbers.floats(&[[0.5], [1.5]]);
        let half = (0.5f32).sqrt();
        let turns = numbers.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half]]);
        let rest = format!(
            r#""nodes":[
                {{"name":"upper","translation":[0,1,0]}},
                {{"name":"lower","children":[0],"rotation":[0,{half},0,{half}]}},
                {{"name":"root","children":[1,3],"translation":[1,2,3],"scale":[2,2,2]}},
                {{"name":"body","mesh":0,"skin":0,"translation":[100,100,100]}}
            ],
            "scenes":[{{"nodes":[2]}}],"scene":0,
            "meshes":[{{"name":"tube","primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"indices":{indices}}}]}}],
            "skins":[{{"joints":[1,0],"inverseBindMatrices":{bound}}}],
            "animations":[{{"name":"bend","samplers":[{{"input":{times},"output":{turns}}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"rotation"}}}}]}}]"#
        );
        (numbers, rest)
    }

    /// Skinned vertices Σ_j w_j W_j B_j⁻¹ v, with the upper joint rotated about z by an angle in radians.
    fn expected(&self, angle: f64) -> Vec<DVec3> {
        let root = DMat4::from_scale_rotation_translation(
            DVec3::splat(2.0),
            DQuat::IDENTITY,
            DVec3::new(1.0, 2.0, 3.0),
        );
        let lower = root * DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let upper = lower * DMat4::from_translation(DVec3::Y) * DMat4::from_rotation_z(angle);
        let moved = [lower * self.bound[0], upper * self.bound[1]];
        let vertices = self.vertices.iter().zip(&self.weights);
        vertices
            .map(|(v, w)| {
                let v = DVec4::new(v[0].into(), v[1].into(), v[2].into(), 1.0);
                (moved[0] * v * f64::from(w[0]) + moved[1] * v * f64::from(w[1])).truncate()
            })
            .collect()
    }
}

#[test]
fn skin_follows_joints_from_the_bind_pose() {
    let two = TwoJoints::new();
    let (numbers, rest) = two.file();
    let from_text = numbers.read(&rest);
    let from_glb = support::gltf_text::read(&numbers.glb(&rest)).unwrap();
    for scene in [&from_text, &from_glb] {
        // Parents come first, although the file lists them last.
        assert_eq!(scene.armature.names(), ["root", "lower", "upper", "body"]);
        assert_eq!(scene.clip("bend").unwrap().span(), [0.5, 1.5]);
        for (time, share) in [
            (0.0, 0.0),
            (0.5, 0.0),
            (0.75, 0.25),
            (1.0, 0.5),
            (1.5, 1.0),
            (9.0, 1.0),
        ] {
            let angle = share * std::f64::consts::FRAC_PI_2;
            close(
                &posed(scene, &at(scene, 0, time)),
                &two.expected(angle),
                3e-6,
            );
        }
        close(
            &posed(scene, scene.armature.rest()),
            &two.expected(0.0),
            3e-6,
        );
        // As given, although it is not the inverse of the rest pose.
        let skin = scene.meshes[0].skin.as_ref().unwrap();
        let inverse_bind = skin.joint_from_mesh[1];
        let bound = two.bound[1].as_mat4();
        assert_eq!(glam::Mat4::from(inverse_bind), bound);
        scene.clip("walk").says("`walk` | bend");
    }
}

#[test]
fn skinning_methods_agree_for_single_joint_vertices() {
    let mut two = TwoJoints::new();
    two.weights = vec![
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ];
    let (numbers, rest) = two.file();
    // The root scales by two: each joint scales about its bind position, then rotates.
    let scene = numbers.read(&rest);
    let mut posing = ScenePosing::new(&scene, SkinningMethod::DualQuaternion).unwrap();
    let mesh = posing.mesh(&at(&scene, 0, 1.0)).unwrap();
    close(
        mesh.positions(),
        &two.expected(std::f64::consts::FRAC_PI_4),
        3e-6,
    );
}

/// Appendix C.5 of the specification: the value at `time` between two keys.
fn cubic_spline<const N: usize>(
    time: f64,
    [start, end]: [f64; 2],
    value: [[f64; N]; 2],
    leaving: [f64; N],
    arriving: [f64; N],
) -> [f64; N] {
    let td = end - start;
    let t = (time - start) / td;
    let (t2, t3) = (t * t, t * t * t);
    std::array::from_fn(|k| {
        (2.0 * t3 - 3.0 * t2 + 1.0) * value[0][k]
            + td * (t3 - 2.0 * t2 + t) * leaving[k]
            + (-2.0 * t3 + 3.0 * t2) * value[1][k]
            + td * (t3 - t2) * arriving[k]
    })
}

#[test]
fn cubic_splines_equal_the_specification() {
    let mut numbers = Numbers::default();
    let times = numbers.floats(&[[1.0], [3.0]]);
    // Incoming tangent, value, outgoing tangent; the first and the last are not used.
    let moves = [
        [9.0; 3],
        [1.0, 2.0, 3.0],
        [0.5, -1.0, 4.0],
        [-2.0, 0.25, 1.0],
        [4.0, 0.0, -1.0],
        [9.0; 3],
    ];
    let turns = [
        [9.0; 4],
        [0.0, 0.0, 0.0, 1.0],
        [0.3, -0.2, 0.5, 0.1],
        [0.1, 0.4, -0.3, 0.2],
        [0.6, 0.0, 0.0, 0.8],
        [9.0; 4],
    ];
    let scales = [
        [9.0; 3],
        [1.0, 1.0, 2.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.5, 1.0],
        [9.0; 3],
    ];
    let outputs = [
        numbers.floats(&moves),
        numbers.floats(&turns),
        numbers.floats(&scales),
    ];
    // Two morph targets: each key has their incoming tangents, values and outgoing tangents.
    let weights = [
        [9.0],
        [9.0],
        [0.25],
        [0.5],
        [1.0],
        [-1.0],
        [0.5],
        [0.75],
        [1.0],
        [0.0],
        [9.0],
        [9.0],
    ];
    let weighted = numbers.floats(&weights);
    let corners = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let up = numbers.floats(&[[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]]);
    let sampler = |output: usize| {
        format!(r#"{{"input":{times},"output":{output},"interpolation":"CUBICSPLINE"}}"#)
    };
    let samplers: Vec<String> = outputs.into_iter().chain([weighted]).map(sampler).collect();
    let channel = |at: usize, path: &str| {
        format!(r#"{{"sampler":{at},"target":{{"node":0,"path":"{path}"}}}}"#)
    };
    let channels: Vec<String> = ["translation", "rotation", "scale", "weights"]
        .iter()
        .enumerate()
        .map(|(at, path)| channel(at, path))
        .collect();
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{corners}}},"targets":[{{"POSITION":{up}}},{{"POSITION":{up}}}]}}]}}],
        "animations":[{{"samplers":[{}],"channels":[{}]}}]"#,
        samplers.join(","),
        channels.join(",")
    ));
    assert!(scene.notes.contains(&Note::Named {
        node: 0,
        name: "node/0".into()
    }));
    assert_eq!(scene.clips[0].name(), "animation/0");
    assert_eq!(scene.armature.morph_targets(), ["target/0", "target/1"]);
    fn key<const N: usize>(keys: &[[f32; N]], at: usize) -> [f64; N] {
        keys[at].map(f64::from)
    }
    for step in 0..=16 {
        let time = 1.0 + f64::from(step) / 8.0;
        let span = [1.0, 3.0];
        let pose = at(&scene, 0, time);
        let expected = cubic_spline(
            time,
            span,
            [key(&moves, 1), key(&moves, 4)],
            key(&moves, 2),
            key(&moves, 3),
        );
        let moved = pose.translations()[0].to_array().map(f64::from);
        assert!(
            DVec3::from(moved).distance(expected.into()) < 2e-6,
            "{moved:?} {expected:?}"
        );
        let expected = cubic_spline(
            time,
            span,
            [key(&turns, 1), key(&turns, 4)],
            key(&turns, 2),
            key(&turns, 3),
        );
        let turned = pose.rotations()[0].to_array().map(f64::from);
        let expected = DVec4::from(expected).normalize();
        assert!(
            DVec4::from(turned).distance(expected) < 1e-6,
            "{turned:?} {expected:?}"
        );
        let expected = cubic_spline(
            time,
            span,
            [key(&scales, 1), key(&scales, 4)],
            key(&scales, 2),
            key(&scales, 3),
        );
        let scaled = pose.scales()[0].to_array().map(f64::from);
        assert!(DVec3::from(scaled).distance(expected.into()) < 2e-6);
        for target in 0..2 {
            let weight_of = |row: usize| [f64::from(weights[2 * row + target][0])];
            let [expected] = cubic_spline(
                time,
                span,
                [weight_of(1), weight_of(4)],
                weight_of(2),
                weight_of(3),
            );
            assert!((f64::from(pose.morph_weights()[target]) - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn step_and_linear_curves_equal_the_specification() {
    let mut numbers = Numbers::default();
    let times = numbers.floats(&[[0.0], [1.0], [4.0]]);
    let values = numbers.floats(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0]]);
    // Rotations as normalised shorts: 32767 represents 1.
    let shorts: Vec<u8> = [[0i16, 0, 0, 32767], [0, 0, 32767, 0], [0, 0, 32767, 0]]
        .as_flattened()
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let turns = numbers.raw(&shorts, 5122, "VEC4", 3, r#","normalized":true"#);
    let scene = numbers.read(&format!(
        r#""nodes":[{{}},{{}}],"animations":[{{
        "samplers":[{{"input":{times},"output":{values},"interpolation":"STEP"}},{{"input":{times},"output":{values},"interpolation":"LINEAR"}},{{"input":{times},"output":{turns}}}],
        "channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}},{{"sampler":1,"target":{{"node":1,"path":"translation"}}}},{{"sampler":2,"target":{{"node":1,"path":"rotation"}}}}]}}]"#
    ));
    let pose = at(&scene, 0, 0.999);
    assert_eq!(pose.translations()[0], glam::Vec3A::ZERO);
    let pose = at(&scene, 0, 1.0);
    assert_eq!(pose.translations()[0], glam::Vec3A::new(2.0, 0.0, 0.0));
    let pose = at(&scene, 0, 2.5);
    assert!(pose.translations()[1].distance(glam::Vec3A::new(2.0, 1.5, 0.0)) < 1e-6);
    // Half a turn about z in a second, at constant speed.
    let turned = at(&scene, 0, 0.25).rotations()[1] * Vec3::X;
    assert!(
        turned.distance(Vec3::new(0.5f32.sqrt(), 0.5f32.sqrt(), 0.0)) < 1e-6,
        "{turned}"
    );
}
