//! Promise: `skin-report --out` draws both skinning methods by twist angle.

use crate::forked_rig::*;

#[test]
fn picture_shows_both_methods() {
    let folder = Folder::new("twist");
    let file = folder.file("twist.svg");
    text!("skin-report --out {file}");
    let svg = std::fs::read_to_string(&file).unwrap();
    says!(svg => "<svg | volume, % | lbs | dqs | 180 degrees");
}
