//! Random chains with mimic joints as URDF: prismatic, revolute and continuous joints about skew axes, of which two to
//! seven are free.

use crate::random::Random;

/// URDF of chain `number`, and the name of its last link; the first link is `l0`. Mimic joints may leave no value for
/// their source joint, in which case the robot is invalid.
pub fn follower_chain(number: u64) -> (String, String) {
    let mut random = Random::split_mix(0xF0_110E + 7919 * number);
    let free = 2 + (random.unit() * 6.0) as usize;
    let followers = 1 + (random.unit() * 2.0) as usize;
    let joints = free + followers;
    // Mimic joints and their source joints: any free joint, earlier or later in the chain.
    let mut master: Vec<Option<usize>> = vec![None; joints];
    for _ in 0..followers {
        let follower = (random.unit() * joints as f64) as usize;
        let leader = (random.unit() * joints as f64) as usize;
        if follower != leader && master[leader].is_none() && !master.contains(&Some(follower)) {
            master[follower] = Some(leader);
        }
    }
    let mut text = format!("<robot name=\"followers{number}\"><link name=\"l0\"/>");
    for (i, master) in master.iter().enumerate() {
        let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
        let kind = between(0.0, 1.0);
        let (kind, lower, upper) = match kind {
            _ if master.is_some() && kind < 0.25 => ("prismatic", -2.0, 2.0),
            _ if master.is_some() => ("revolute", -4.0, 4.0),
            k if k < 0.2 => ("prismatic", -0.1, between(0.1, 0.4)),
            k if k < 0.35 => ("continuous", 0.0, 0.0),
            _ => ("revolute", between(-3.1, -0.3), between(0.3, 3.1)),
        };
        let odd = between(0.0, 1.0) < 0.5;
        let axis = match (odd, between(0.0, 3.0) as usize) {
            (true, _) => [(); 3].map(|()| between(-1.0, 1.0)),
            (false, 0) => [1.0, 0.0, 0.0],
            (false, 1) => [0.0, 1.0, 0.0],
            (false, _) => [0.0, 0.0, 1.0],
        };
        let turned = between(0.0, 1.0) < 0.5;
        let xyz = [(); 3].map(|()| between(-0.3, 0.3));
        let rpy = [(); 3].map(|()| if turned { between(-3.0, 3.0) } else { 0.0 });
        let three = |v: [f64; 3]| v.map(|v| v.to_string()).join(" ");
        let mimic = master.map_or(String::new(), |leader| {
            let sign = if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            let (ratio, offset) = (sign * between(0.3, 2.0), between(-0.5, 0.5));
            format!("<mimic joint=\"j{leader}\" multiplier=\"{ratio}\" offset=\"{offset}\"/>")
        });
        text += &format!(
            "<link name=\"l{}\"/><joint name=\"j{i}\" type=\"{kind}\"><parent link=\"l{i}\"/>\
             <child link=\"l{}\"/><origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\
             <limit lower=\"{lower}\" upper=\"{upper}\" effort=\"1\" velocity=\"1\"/>{mimic}</joint>",
            i + 1,
            i + 1,
            three(xyz),
            three(rpy),
            three(axis),
        );
    }
    (text + "</robot>", format!("l{joints}"))
}
