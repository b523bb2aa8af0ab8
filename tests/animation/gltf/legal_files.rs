//! Promise: files that the specification allows are read. Unsupported content is omitted with a note.

use kinopt::io::gltf::{Note, Scene};
use support::gltf_text::{Numbers, read, small};

fn notes(scene: &Scene) -> Vec<String> {
    scene.notes.iter().map(Note::to_string).collect()
}

/// Replaces a text that occurs once in the small file, and reads the file.
fn changed(from: &str, to: &str) -> Scene {
    let (numbers, rest) = small();
    let text = numbers.document(&rest);
    assert_eq!(text.matches(from).count(), 1, "{from} in {text}");
    read(text.replacen(from, to, 1).as_bytes()).unwrap()
}

#[test]
fn scene_without_nodes_is_read() {
    let scene = changed(r#"{"nodes":[3]}"#, r#"{"name":"empty"}"#);
    assert_eq!((scene.armature.bones(), scene.meshes.len()), (4, 0));
    let noted = notes(&scene);
    assert!(noted.iter().any(|note| note.contains("mesh")), "{noted:?}");
    let empty = read(br#"{"asset":{"version":"2.0"},"scenes":[{}],"scene":0}"#).unwrap();
    assert_eq!((empty.armature.bones(), empty.clips.len()), (0, 0));
}

#[test]
fn channel_without_a_node_is_omitted() {
    let pointer =
        r#""target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/x"}}}"#;
    let without = [r#""target":{"path":"translation"}"#, pointer];
    for target in without {
        let scene = changed(r#""target":{"node":1,"path":"translation"}"#, target);
        let noted = notes(&scene);
        let location = "animations[0].channels[1].target";
        assert!(
            noted
                .iter()
                .any(|note| note.contains(location) && note.contains("node")),
            "{noted:?}"
        );
        // All other channels are read.
        assert_eq!(scene.clips[0].span(), [0.0, 0.5]);
    }
    let (numbers, rest) = small();
    let rest = rest
        .replace(r#""target":{"node":0,"#, r#""target":{"#)
        .replace(
            r#""target":{"node":1,"path":"translation"}"#,
            r#""target":{"node":1,"path":"pointer"}"#,
        );
    let noted = notes(&numbers.read(&rest));
    for location in ["channels[0].target", "channels[1].target.path"] {
        assert!(
            noted.iter().any(|note| note.contains(location)),
            "{noted:?}"
        );
    }
}

#[test]
fn channel_with_an_unknown_node_is_rejected() {
    for nobody in ["4", "4294967295"] {
        let (numbers, rest) = small();
        // Also next to one that has none.
        for first in [r#""node":0,"#, ""] {
            let rest = rest
                .replace(
                    r#""node":1,"path":"translation""#,
                    &format!(r#""node":{nobody},"path":"translation""#),
                )
                .replace(r#""target":{"node":0,"#, &format!(r#""target":{{{first}"#));
            let error = numbers.refused(&rest);
            let words = [
                "animations[0].channels[1].target.node",
                nobody,
                "nodes are 0 to 3",
            ];
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}

#[test]
fn line_and_point_primitives_are_omitted() {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let others = numbers.floats(&[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    for (mode, word) in [
        (0, "Points"),
        (1, "Lines"),
        (2, "LineLoop"),
        (3, "LineStrip"),
    ] {
        let scene = numbers.read(&format!(
            r#""nodes":[{{"mesh":0}},{{"mesh":1}}],"meshes":[{{"name":"cage","primitives":[
            {{"mode":{mode},"attributes":{{"POSITION":{others}}}}},
            {{"attributes":{{"POSITION":{positions}}},"targets":[{{"POSITION":{positions}}}]}}]}},
            {{"name":"wire","primitives":[{{"mode":{mode},"attributes":{{"POSITION":{others}}}}}]}}]"#
        ));
        // Neither their vertices nor an empty mesh are read.
        assert_eq!(scene.meshes.len(), 1, "{word}");
        let mesh = &scene.meshes[0];
        assert_eq!(
            (mesh.name.as_str(), mesh.mesh.positions().len()),
            ("cage", 3)
        );
        assert_eq!(mesh.morph_targets.targets().len(), 1);
        let noted = notes(&scene);
        for location in ["meshes[0].primitives[0]", "meshes[1].primitives[0]"] {
            let about = |note: &&String| note.contains(location) && note.contains(word);
            assert_eq!(noted.iter().filter(about).count(), 1, "{noted:?}");
        }
    }
}

#[test]
fn texture_without_an_image_is_read() {
    let scene = changed(r#""scene":0"#, r#""textures":[{"sampler":0},{}],"scene":0"#);
    assert_eq!(scene.meshes.len(), 1);
}

#[test]
fn applied_extension_is_not_noted_as_omitted() {
    let scene = changed(
        r#""scene":0"#,
        r#""extensionsUsed":["KHR_mesh_quantization","KHR_xmp"],"extensionsRequired":["KHR_mesh_quantization"],"scene":0"#,
    );
    let noted = notes(&scene);
    assert!(
        !noted.iter().any(|note| note.contains("quantization")),
        "{noted:?}"
    );
    assert!(
        noted.iter().any(|note| note.contains("KHR_xmp")),
        "{noted:?}"
    );
}

#[test]
fn repeated_name_is_kept_by_joint_then_animated_node() {
    let (numbers, rest) = small();
    // The mesh's node precedes the joint, and both have one name. Of the other two nodes the animated one keeps it.
    let rest = rest
        .replace(r#""name":"upper""#, r#""name":"arm""#)
        .replace(r#""name":"lower""#, r#""name":"arm""#)
        .replace(r#""name":"body""#, r#""name":"arm""#);
    let swapped = rest
        .replace(
            r#"{"name":"arm","translation":[0,1,0]},{"name":"arm","children":[0],"rotation":[0,0,0,1]},"#,
            "",
        )
        .replace(
            r#"{"children":[1,2],"#,
            r#"{"name":"arm","translation":[0,1,0]},{"name":"lower","children":[1],"rotation":[0,0,0,1]},{"name":"lower","children":[2,0],"#,
        )
        .replace(r#""joints":[1,0]"#, r#""joints":[1]"#)
        .replace(r#""target":{"node":1,"#, r#""target":{"node":3,"#)
        .replace(r#""target":{"node":0,"#, r#""target":{"node":1,"#)
        .replace(r#""target":{"node":2,"#, r#""target":{"node":0,"#);
    let scene = numbers.read(
        &swapped
            .replace(r#""JOINTS_0""#, r#""_JOINTS""#)
            .replace(r#""WEIGHTS_0""#, r#""_WEIGHTS""#)
            .replace(r#","skin":0"#, ""),
    );
    let names = |name: &str| scene.armature.bone(name).map(|bone| bone.index());
    // Nodes of the file: 0 the mesh's, 1 the joint, 2 motionless, 3 animated and its parent.
    let bone_of = |node: usize| [1, 3, 2, 0][node];
    assert_eq!(names("arm").unwrap(), bone_of(1));
    assert_eq!(names("arm/0").unwrap(), bone_of(0));
    assert_eq!(names("lower").unwrap(), bone_of(3));
    assert_eq!(names("lower/2").unwrap(), bone_of(2));
    // Of joints with one name, the first keeps it.
    let scene = numbers.read(&rest);
    let skin = scene.meshes[0].skin.as_ref().unwrap();
    let joints = skin
        .joints
        .iter()
        .map(|joint| &scene.armature.names()[joint.index()]);
    assert_eq!(joints.collect::<Vec<_>>(), ["arm/1", "arm"]);
}

#[test]
fn inverse_bind_matrices_not_finite_are_rejected() {
    for invalid in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for entry in 0..16 {
            let mut matrix = [
                1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ];
            matrix[entry] = invalid;
            let (mut numbers, rest) = small();
            let bound = numbers.floats(&[[0.0; 16], matrix]);
            let mut identity = matrix;
            identity[entry] = if entry % 5 == 0 { 1.0 } else { 0.0 };
            let second = numbers.floats(&[identity, matrix]);
            let from = rest.find(r#""inverseBindMatrices":"#).unwrap();
            let end = from + rest[from..].find('}').unwrap();
            let with_accessor = |accessor: usize| {
                let entry = format!(r#""inverseBindMatrices":{accessor}"#);
                format!("{}{entry}{}", &rest[..from], &rest[end..])
            };
            assert!(numbers.refused(&with_accessor(bound)).contains("joint 0"));
            let error = numbers.refused(&with_accessor(second));
            let words = ["skins[0].inverseBindMatrices", "skin 0", "joint 1"];
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
            // Also for a skin that no mesh uses.
            let unused = with_accessor(second).replace(r#","skin":0"#, "");
            let error = numbers.refused(&unused);
            assert!(error.contains("joint 1"), "{error}");
        }
    }
}

#[test]
fn extensions_without_bones_are_noted() {
    for name in [
        "VRM",
        "VRMC_vrm",
        "MSFT_lod",
        "KHR_node_visibility",
        "KHR_texture_transform",
        "KHR_xmp_json_ld",
    ] {
        let lists =
            format!(r#""extensionsUsed":["{name}"],"extensionsRequired":["{name}"],"scene":0"#);
        let scene = changed(r#""scene":0"#, &lists);
        assert_eq!((scene.meshes.len(), scene.clips.len()), (1, 1));
        assert!(
            notes(&scene).iter().any(|note| note.contains(name)),
            "{name}"
        );
    }
}
