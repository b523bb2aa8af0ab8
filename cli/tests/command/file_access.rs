//! Promise: files that a file names are opened only below its folder and the listed folders, up to the size limit.

use crate::forked_rig::*;

const OBJ: &str =
    "# SECRET\nv 5 5 5\nv 6 5 5\nv 5 6 6\nv 5 5 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const ROBOT: &str = r#"<robot name="r"><link name="a"><collision><geometry><mesh filename="../file_access_outside/mesh.obj"/>
</geometry></collision></link><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;

#[test]
fn files_outside_the_folder_are_opened_when_listed() {
    let (inside, outside) = (
        Folder::new("file_access"),
        Folder::new("file_access_outside"),
    );
    let mesh = outside.text("mesh.obj", OBJ);
    let listed = std::path::Path::new(&mesh)
        .parent()
        .unwrap()
        .display()
        .to_string();
    let world = inside.text(
        "world.json",
        format!(
            r#"{{"meshes":[{{"name":"m","file":{},"position":[3,0,0]}}]}}"#,
            serde_json::to_string(&mesh).unwrap()
        ),
    );
    let robot = inside.text(
        "robot.urdf",
        ROBOT.replace("../file_access_outside/mesh.obj", &mesh),
    );
    let plain = inside.text(
        "plain.urdf",
        ROBOT.replace(
            &ROBOT[ROBOT.find("<collision").unwrap()..ROBOT.find("</link>").unwrap()],
            "",
        ),
    );
    refused!("check {robot} --q 0 --world {world}" => 1, "meshes[0] | outside of the folders");
    answer!("check {robot} --q 0 --world {world} @files.allow_folder=[\"{listed}\"]");
    refused!("check {robot} --q 0 @files.confine=true" => 1, "outside of the folders");
    answer!("check {robot} --q 0 @files.confine=true @collisions.package=[\"{listed}\"]");
    refused!("info {plain} @files.max_file_bytes=x" => 1, "files: | u64");
    let capture = inside.text("rig.json", "{}");
    refused!("info {capture} @files.max_file_bytes=1" => 1, "1 bytes");
}
