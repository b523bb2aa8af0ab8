//! Promise: bone heat weights solve their equations, sum to 1, are within 0 and 1 and vary smoothly along the skin, not
//! through air. This includes damaged surfaces. Results are reproducible.

use glam::{DVec3, Vec3};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{AutomaticWeights, HeatWeights, SkinWeights, SkinningError};
use nalgebra::{DMatrix, DVector};
use support::bones::humanoid;
use support::random::Random;
use support::skins::{closed_tube, steepest};

fn all_influences() -> HeatWeights {
    let mut all = HeatWeights::default();
    all.heat = 1.0;
    all.most = usize::MAX;
    all
}

/// Three bones in a row along x within a tube of length 8.
fn bones() -> Vec<[DVec3; 2]> {
    let x = |x: f64| DVec3::new(x, 0.0, 0.0);
    vec![[x(0.2), x(3.0)], [x(3.0), x(5.5)], [x(5.5), x(7.8)]]
}

fn check(weights: &SkinWeights) {
    for influences in weights.iter() {
        let sum: f64 = influences.iter().map(|i| i.weight).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        assert!(influences.iter().all(|i| i.weight > 0.0), "{influences:?}");
    }
}

fn row(weights: &SkinWeights, vertex: usize) -> DVector<f64> {
    let mut row = DVector::zeros(weights.bone_count());
    for influence in weights.influences(vertex) {
        row[influence.bone as usize] += influence.weight;
    }
    row
}

/// The same equations in another form: angles by arc cosine, a dense matrix, LU. On this tube all bones are visible and
/// no bound is active.
#[test]
fn weights_solve_their_equations() {
    let mesh = closed_tube(8.0, 0.6, 12, 10);
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
    let count = points.len();
    let bones = bones();
    let (mut system, mut areas) = (DMatrix::zeros(count, count), vec![0.0; count]);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| i as usize);
        for [corner, next, last] in [[a, b, c], [b, c, a], [c, a, b]] {
            let (u, v) = (points[next] - points[corner], points[last] - points[corner]);
            let half = 0.5 / u.angle_between(v).tan();
            for (i, j) in [(next, last), (last, next)] {
                system[(i, j)] -= half;
                system[(i, i)] += half;
            }
            areas[corner] += u.cross(v).length() / 6.0;
        }
    }
    // Its edges conduct well, so no bound is active.
    assert!(system.iter().filter(|x| **x < 0.0).all(|x| *x < -1e-3));
    let mut given = DMatrix::zeros(count, bones.len());
    for (i, p) in points.iter().enumerate() {
        let squared: Vec<f64> = bones
            .iter()
            .map(|[tail, tip]| {
                let along = (p.x.clamp(tail.x, tip.x) - p.x).abs();
                along * along + p.y * p.y + p.z * p.z
            })
            .collect();
        let nearest = squared.iter().copied().fold(f64::INFINITY, f64::min);
        for (bone, _) in squared
            .iter()
            .enumerate()
            .filter(|(_, d)| **d < nearest * 1.0001)
        {
            given[(i, bone)] = areas[i] / nearest;
            system[(i, i)] += areas[i] / nearest;
        }
    }
    let expected = system.lu().solve(&given).unwrap();
    let weights = all_influences().for_segments(&mesh, &bones).unwrap();
    check(&weights);
    // Weights below 1e-4 fade out, and the others lose nearly as little.
    let mut mixed = 0;
    for vertex in 0..count {
        let apart = (row(&weights, vertex).transpose() - expected.row(vertex)).amax();
        assert!(apart < 3e-4, "vertex {vertex}: {apart}");
        mixed += usize::from(expected.row(vertex).max() < 0.9);
    }
    assert!(mixed > 10, "{mixed}");
}

#[test]
fn single_bone_has_all_weights() {
    let mesh = closed_tube(8.0, 0.6, 12, 10);
    let weights = HeatWeights::default()
        .for_segments(&mesh, &bones()[..1])
        .unwrap();
    for influences in weights.iter() {
        assert_eq!(influences.len(), 1);
        assert!((influences[0].weight - 1.0).abs() < 1e-15);
    }
}

#[test]
fn mirrored_mesh_has_mirrored_weights() {
    let mesh = closed_tube(8.0, 0.6, 12, 16);
    let x = |x: f64| DVec3::new(x, 0.0, 0.0);
    let bones = [[x(0.5), x(4.0)], [x(4.0), x(7.5)]];
    let weights = HeatWeights::default().for_segments(&mesh, &bones).unwrap();
    let at = |position: Vec3| {
        let same = |p: &Vec3| p.distance(position) < 1e-4;
        mesh.positions().iter().position(same).unwrap()
    };
    let mut pairs = 0;
    for (vertex, position) in mesh.positions().iter().enumerate() {
        let other = at(Vec3::new(8.0 - position.x, position.y, position.z));
        let [a, b] = [vertex, other].map(|vertex| row(&weights, vertex));
        assert!((a[0] - b[1]).abs() < 1e-6, "{a} {b}");
        pairs += 1;
    }
    assert_eq!(pairs, mesh.positions().len());
}

/// Two fingers side by side in contact: distance weights leak across, heat follows the skin.
#[test]
fn weights_do_not_cross_gaps() {
    let finger = closed_tube(4.0, 0.5, 12, 12);
    let offset = Vec3::new(0.0, 1.01, 0.0);
    let count = finger.positions().len() as u32;
    let positions = finger.positions().iter().copied();
    let both = positions.chain(finger.positions().iter().map(|p| *p + offset));
    let triangles = finger.triangles().iter().copied();
    let triangles = triangles.chain(finger.triangles().iter().map(|t| t.map(|i| i + count)));
    let mesh = TriangleMesh::new(both.collect(), vec![], triangles.collect()).unwrap();
    let bone = |y: f64| [DVec3::new(0.1, y, 0.0), DVec3::new(3.9, y, 0.0)];
    let bones = [bone(0.0), bone(1.01)];
    let heat = HeatWeights::default().for_segments(&mesh, &bones).unwrap();
    let distance = AutomaticWeights::default()
        .for_segments(&mesh, &bones)
        .unwrap();
    let strays = |weights: &SkinWeights| {
        let stray = |vertex: usize| row(weights, vertex)[usize::from(vertex < count as usize)];
        (0..2 * count as usize).map(stray).fold(0.0, f64::max)
    };
    assert!(strays(&distance) > 0.05, "{}", strays(&distance));
    assert_eq!(strays(&heat), 0.0);
}

/// A bone behind a wall heats nothing through it.
#[test]
fn hidden_bones_do_not_heat() {
    let tube = closed_tube(8.0, 1.0, 16, 16);
    let inner = closed_tube(7.4, 0.7, 16, 16);
    let count = tube.positions().len() as u32;
    let within = inner.positions().iter().map(|p| *p + 0.3 * Vec3::X);
    let positions = tube.positions().iter().copied().chain(within);
    let triangles = tube.triangles().iter().copied();
    let triangles = triangles.chain(inner.triangles().iter().map(|t| t.map(|i| i + count)));
    let mesh = TriangleMesh::new(positions.collect(), vec![], triangles.collect()).unwrap();
    let x = |from: f64, to: f64| [DVec3::new(from, 0.0, 0.0), DVec3::new(to, 0.0, 0.0)];
    // All bones are within the inner tube: the outer one sees none and follows the nearest.
    let bones = [x(0.6, 4.0), x(4.0, 7.4)];
    let weights = HeatWeights::default().for_segments(&mesh, &bones).unwrap();
    check(&weights);
    for vertex in 0..count as usize {
        let x = mesh.positions()[vertex].x;
        if (x - 4.0).abs() > 3.0 {
            assert!(row(&weights, vertex)[usize::from(x > 4.0)] > 0.9);
        }
    }
    // With a bone between the two, the outer one sees that one only.
    let more = [
        bones[0],
        bones[1],
        [DVec3::new(0.2, 0.85, 0.0), DVec3::new(7.8, 0.85, 0.0)],
    ];
    let weights = HeatWeights::default().for_segments(&mesh, &more).unwrap();
    for vertex in 0..count as usize {
        assert!(row(&weights, vertex)[2] > 0.99);
    }
}

#[test]
fn seams_are_joined_and_pieces_separate() {
    let mesh = closed_tube(8.0, 0.6, 12, 10);
    // Separate vertices for every triangle, and a vertex without a triangle.
    let corners = mesh.triangles().iter().flatten();
    let mut positions: Vec<Vec3> = corners.map(|i| mesh.positions()[*i as usize]).collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let triangles: Vec<[u32; 3]> = triangles.collect();
    positions.push(Vec3::new(7.0, 2.0, 0.0));
    let torn = TriangleMesh::new(positions, vec![], triangles).unwrap();
    let closed_weights = HeatWeights::default()
        .for_segments(&mesh, &bones())
        .unwrap();
    let weights = HeatWeights::default()
        .for_segments(&torn, &bones())
        .unwrap();
    check(&weights);
    for (corner, vertex) in mesh.triangles().iter().flatten().enumerate() {
        assert!((row(&weights, corner) - row(&closed_weights, *vertex as usize)).amax() < 1e-9);
    }
    let alone = torn.positions().len() - 1;
    assert!(row(&weights, alone)[2] > 1.0 - 1e-12);
}

/// Mirrored halves may meet at 0 and −0.
#[test]
fn halves_at_zero_and_minus_zero_are_joined() {
    let tube = closed_tube(8.0, 0.6, 12, 10);
    let mut positions: Vec<Vec3> = tube.positions().to_vec();
    positions.iter_mut().for_each(|p| p.x -= 4.0);
    let closed_mesh =
        TriangleMesh::new(positions.clone(), vec![], tube.triangles().to_vec()).unwrap();
    let count = positions.len() as u32;
    let beyond = |t: &[u32; 3]| t.iter().any(|i| positions[*i as usize].x > 0.0);
    // The second half has separate vertices, so the seam's are duplicated.
    let split_triangle = |t: &[u32; 3]| if beyond(t) { t.map(|i| i + count) } else { *t };
    let triangles: Vec<[u32; 3]> = closed_mesh.triangles().iter().map(split_triangle).collect();
    let minus = |p: &Vec3| if p.x == 0.0 { p.with_x(-0.0) } else { *p };
    let both = positions.iter().map(minus).chain(positions.iter().copied());
    let halves = TriangleMesh::new(both.collect(), vec![], triangles).unwrap();
    let bones: Vec<_> = bones()
        .iter()
        .map(|b| b.map(|end| end - 4.0 * DVec3::X))
        .collect();
    let [expected, weights] = [&closed_mesh, &halves]
        .map(|mesh| HeatWeights::default().for_segments(mesh, &bones).unwrap());
    let mut seam = 0;
    for (vertex, position) in positions.iter().enumerate() {
        let copies = [vertex, vertex + count as usize];
        for copy in copies {
            let deviation = (row(&weights, copy) - row(&expected, vertex)).amax();
            assert!(deviation < 1e-9, "{position}: {deviation}");
        }
        seam += usize::from(position.x == 0.0);
    }
    assert_eq!(seam, 12);
}

#[test]
fn degenerate_meshes_give_valid_weights() {
    let mut random = Random::new(5);
    let smooth = closed_tube(8.0, 0.6, 12, 20);
    for case in 0..6 {
        let mut positions = smooth.positions().to_vec();
        let mut triangles = smooth.triangles().to_vec();
        match case {
            // Needles: pairs of rings nearly coincide.
            0 => positions.iter_mut().for_each(|p| {
                let ring = (p.x / 0.4).round();
                p.x = if ring % 2.0 == 1.0 {
                    (ring - 1.0) * 0.4 + 1e-5
                } else {
                    p.x
                };
            }),
            // Flat: all on one line.
            1 => positions.iter_mut().for_each(|p| (p.y, p.z) = (0.0, 0.0)),
            // All at one point.
            2 => positions.iter_mut().for_each(|p| *p = Vec3::ONE),
            // Triangles between arbitrary vertices, some with two equal corners.
            3 => triangles
                .iter_mut()
                .for_each(|t| t[1] = random.below(positions.len()) as u32),
            // Degenerate triangles, repeated three times.
            4 => triangles.extend([[0, 1, 1], [0, 1, 2], [0, 1, 2], [0, 1, 2]]),
            _ => triangles.clear(),
        }
        let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap();
        let made = HeatWeights::default();
        let weights = made.for_segments(&mesh, &bones()).unwrap();
        check(&weights);
        assert_eq!(weights, made.for_segments(&mesh, &bones()).unwrap());
    }
    let none = TriangleMesh::new(vec![], vec![], vec![]).unwrap();
    let weights = HeatWeights::default()
        .for_segments(&none, &bones())
        .unwrap();
    assert_eq!(weights.vertex_count(), 0);
}

/// Cotangents at obtuse corners are negative and would move heat from cold to warm. On one connected skin every bone
/// that heats some of it has influence everywhere.
#[test]
fn heat_flows_across_obtuse_corners() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.05, 0.0]].map(Vec3::from);
    let mesh = TriangleMesh::new(corners.to_vec(), vec![], vec![[0, 1, 2]]).unwrap();
    let above = |corner: &Vec3| [corner.as_dvec3() + 0.5 * DVec3::Z; 2];
    let bones: Vec<[DVec3; 2]> = corners.iter().map(above).collect();
    let mut hot = all_influences();
    hot.heat = 100.0;
    let weights = hot.for_segments(&mesh, &bones).unwrap();
    check(&weights);
    for influences in weights.iter() {
        assert_eq!(influences.len(), 3, "{influences:?}");
    }
}

/// A corner that sinks onto its opposite edge. The edge stops conducting for the obtuse corner, and weights converge to
/// those of a degenerate triangle.
#[test]
fn weights_converge_at_a_degenerate_triangle() {
    let mut hot = all_influences();
    // As strong as the flow along the sides of the degenerate triangle.
    hot.heat = 300.0;
    let of_height = |height: f32| -> Vec<DVector<f64>> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, height], [0.5, -1.0]];
        let corners = corners.map(|[x, y]| Vec3::new(x, y, 0.0));
        let triangles = vec![[0, 1, 2], [1, 0, 3]];
        let mesh = TriangleMesh::new(corners.to_vec(), vec![], triangles).unwrap();
        let bones = corners.map(|corner| [corner.as_dvec3() + 0.5 * DVec3::Z; 2]);
        let weights = hot.for_segments(&mesh, &bones).unwrap();
        check(&weights);
        (0..4).map(|vertex| row(&weights, vertex)).collect()
    };
    let mut height = 0.1;
    let mut last = of_height(height);
    while height > 1e-7 {
        height *= 0.98;
        let next = of_height(height);
        for (vertex, (last, next)) in last.iter().zip(&next).enumerate() {
            let jump = (last - next).amax();
            assert!(jump < 0.02, "vertex {vertex} at {height:e}: {jump}");
        }
        last = next;
    }
    // The ends of the edge keep their own bones, since heat flows between them only by the corner.
    assert!(last[0][0] > 1.3 * last[0][1], "{}", last[0]);
}

#[test]
fn weights_are_unit_invariant() {
    let mesh = closed_tube(8.0, 0.6, 12, 10);
    let expected = HeatWeights::default()
        .for_segments(&mesh, &bones())
        .unwrap();
    for unit in [1e-6, 1e6_f64] {
        let positions = mesh.positions().iter().map(|p| *p * unit as f32);
        let scaled = mesh.with_vertices(positions.collect(), vec![]).unwrap();
        let bones: Vec<_> = bones().iter().map(|b| b.map(|end| end * unit)).collect();
        let weights = HeatWeights::default()
            .for_segments(&scaled, &bones)
            .unwrap();
        for vertex in 0..mesh.positions().len() {
            assert!((row(&weights, vertex) - row(&expected, vertex)).amax() < 1e-4);
        }
    }
}

/// The humanoid: limbs follow their own bones, and no weight jumps along an edge.
#[test]
fn humanoid_weights_are_smooth_and_local() {
    let rig = humanoid();
    let (mesh, given) = (rig.mesh.unwrap(), rig.weights.unwrap());
    let made = HeatWeights::default()
        .for_skeleton(&mesh, &rig.skeleton)
        .unwrap();
    check(&made);
    assert!(made.max_influences() <= 8);
    let strongest = |weights: &SkinWeights, vertex: usize| row(weights, vertex).imax();
    let parent = |bone: usize| rig.skeleton.bones()[bone].parent.map(|p| p.index());
    let agree = (0..given.vertex_count()).filter(|&vertex| {
        let (a, b) = (strongest(&given, vertex), strongest(&made, vertex));
        a == b || parent(a) == Some(b) || parent(b) == Some(a)
    });
    let share = agree.count() as f64 / given.vertex_count() as f64;
    assert!(share > 0.97, "{share}");
    let steps = steepest(&mesh, &made);
    assert!(steps < 0.35, "{steps}");
}

#[test]
fn invalid_bones_and_heat_are_rejected() {
    let mesh = closed_tube(8.0, 0.6, 12, 4);
    let options = HeatWeights::default();
    assert_eq!(
        options.for_segments(&mesh, &[]).unwrap_err(),
        SkinningError::NoBones
    );
    let mut broken = bones();
    broken[2][1].z = f64::INFINITY;
    assert_eq!(
        options.for_segments(&mesh, &broken).unwrap_err(),
        SkinningError::NonFiniteBone { bone: 2 }
    );
    for heat in [0.0, -1.0, f64::INFINITY] {
        let mut options = options;
        options.heat = heat;
        let refused = options.for_segments(&mesh, &bones());
        assert_eq!(refused.unwrap_err(), SkinningError::Heat(heat));
    }
}
